// Runs the candidates of a cell over the sweep and sums up how fast and how right they were.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "bench/accuracy/candidate.hpp"
#include "bench/accuracy/pairs.hpp"

namespace clinch::accuracy {

/// Errors, regrets and promises are relative to the pair's size.
struct Figures {
    std::size_t pairs = 0;
    double worst = 0, p999 = 0, median = 0;  ///< actual errors
    double promised_median = 0, promised_p99 = 0, promised_worst = 0;
    double ratio = 0;                      ///< worst of actual error to promised one, where the reference is that sure
    double regret = 0;                     ///< worst shortfall of the separation along the normal
    std::size_t broken = 0;                ///< promises that were surely not kept
    std::size_t open = 0;                  ///< promises that the reference is not sure enough to judge
    std::size_t not_numbers = 0;           ///< answers with NaN or infinity in them, or that had to be stopped
    std::size_t missed = 0, invented = 0;  ///< libraries: overlaps denied, and claimed of bodies that are apart
    double ns = 0;                         ///< a pair; 0: not timed
};

struct SettingFigures {
    Setting setting;
    Figures figures;
};

struct CandidateResult {
    Title title;
    bool promises = true;
    Figures all, usual;  ///< of the whole sweep; of the axis "default", which is what was timed
    std::vector<SettingFigures> settings;
};

struct CellResult {
    test::Kind a{}, b{};
    std::uint64_t seed = 0;
    std::size_t pairs = 0, disagreements = 0;  ///< of two references, or of a search and an answer
    std::vector<std::string> sources;          ///< of the references
    std::vector<CandidateResult> candidates;
};

struct Options {
    std::uint64_t seed = 1;
    std::size_t pairs = 0;         ///< a setting
    std::size_t mixture = 0;       ///< poses of the mixture, and of the usual pairs
    std::size_t device_pairs = 0;  ///< timed on a device at once
    double least_seconds = 0;      ///< a host's time is the least of runs that take this long together
    bool quick = false;
    Context* context = nullptr;  ///< none: no device
};

CellResult measure_cell(test::Kind a, test::Kind b, const Options& options);

}  // namespace clinch::accuracy
