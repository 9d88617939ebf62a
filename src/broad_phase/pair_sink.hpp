// Runs kernels that put out pairs in any order (cl/broad_phase/pair_sink.clh) and makes one list of them.
#pragma once

#include <cstdint>
#include <vector>

#include "clinch/broad_phase.hpp"
#include "src/broad_phase/algorithm.hpp"
#include "src/broad_phase/inputs.hpp"
#include "src/broad_phase/pair_list.hpp"
#include "src/device/device.hpp"
#include "src/primitives/pair_sort.hpp"

namespace clinch::detail {

/// One kernel whose last parameters are SINK_PARAMS, its own already set.
struct SinkLaunch {
    Kernel* kernel;
    cl_uint own_parameters;  ///< how many stand before SINK_PARAMS
    std::uint32_t tasks;
    /// A work-item takes at most so many, and there are work-items enough for all: for devices where loops end
    /// early. 0: it takes tasks until none is left.
    std::uint32_t most_tasks = 0;
};

/// The last chunk of a work-item: `used` pairs of it are there.
struct PartialChunk {
    std::uint32_t chunk, used;
};

/// Output of any size: the room is guessed from the last call; when it was short, the exact count is known
/// and the kernels run once more; when one buffer cannot hold it, or a stream wants less at a time, the tasks
/// are cut into pieces whose pairs go to the host one after the other. Never a lost pair.
class PairSink {
public:
    PairSink(Device& device, const BroadPhaseOptions& options);

    /// The -D options that a kernel with these filters is built with.
    static const char* defines(const FilterInput& filters) { return filters.any() ? "-DFILTERS=1" : ""; }

    /// Runs all launches in order and puts their pairs, of `bodies` bodies, into `pairs`: sorted if the
    /// options ask for it. Adds to `counts`. Waits.
    void collect(const std::vector<SinkLaunch>& launches, const FilterInput& filters, std::uint32_t bodies,
                 PairList& pairs, FindCounts& counts);

private:
    // What running launches gave: pairs there are, and how many chunks they took.
    struct Outcome {
        std::uint64_t pairs = 0;
        std::uint64_t chunks = 0;
        FindCounts counts;
        bool fits = false;
    };
    struct Part {
        const SinkLaunch* launch;
        std::uint32_t first, end;
    };
    // What is collected in pieces: where it goes, and the pairs one piece may have.
    struct Collection {
        const FilterInput& filters;
        std::uint32_t bodies;
        PairList& pairs;
        FindCounts& counts;
        std::uint64_t most;
        std::vector<std::size_t> sorted_ends{};
    };
    std::size_t groups_of(const Part& part) const;
    std::size_t workers_of(const std::vector<Part>& parts) const;
    void plan(std::uint64_t pairs, std::uint64_t all_workers, std::uint64_t most);
    Outcome run(const std::vector<Part>& parts, const FilterInput& filters, std::uint32_t bodies);
    void launch(const std::vector<Part>& parts, cl_mem filters);
    Outcome read_outcome(std::size_t header, std::size_t tails);
    void close_gaps(const Outcome& outcome);
    void deliver(const Outcome& outcome, std::uint32_t bodies, bool alone, PairList& pairs, FindCounts& counts);
    void collect_all_pieces(const std::vector<Part>& parts, std::uint64_t expected, Collection to);
    void collect_pieces(const Part& part, std::uint64_t expected, Collection& to);
    void collect_piece(const Part& part, Collection& to);
    static void add(const Outcome& outcome, FindCounts& counts);
    std::uint64_t most_pairs() const;

    Device& device_;
    const BroadPhaseOptions& options_;
    FilterMirror filters_;
    PairSort sort_;
    Kernel move_kernel_;
    Buffer pairs_, state_, moves_;
    std::vector<PartialChunk> partial_chunks_;
    std::uint64_t expected_ = 0;  // pairs of the last call
    std::uint32_t chunk_size_ = 0, capacity_ = 0;
};

}  // namespace clinch::detail
