// What was measured, as text and as JSON.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "bench/peers/narrow/measure.hpp"

namespace clinch::peers::narrow {

/// A regime and a question, by the name the user knows.
struct Job {
    std::string name;  ///< contact, distance, apart, overlapping
    std::string what;
    Regime regime;
    Question question;
};

/// All four.
const std::vector<Job>& jobs();

struct Outcome {
    Cell cell;
    Job job;
    std::size_t pairs = 0;
    double truth_error = 0.0;  ///< the greatest that the reference admits, of a pair's size
    OracleCheck oracle;
    std::vector<Result> results;
};

/// A row a peer.
void print(const Outcome& outcome);

/// A row an outcome: clinch beside the fastest library that is right, and beside the fastest of all.
void print_summary(const std::vector<Outcome>& outcomes);

nlohmann::ordered_json json_of(const Outcome& outcome);

}  // namespace clinch::peers::narrow
