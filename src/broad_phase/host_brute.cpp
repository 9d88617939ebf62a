// host-brute: every box against every other in plain C++, the oracle of all other algorithms, and the
// fastest for a handful of boxes.
#include <algorithm>
#include <cmath>
#include <vector>

#include "src/broad_phase/algorithm.hpp"
#include "src/primitives/host_parallel.hpp"

namespace clinch::detail {
namespace {

constexpr std::uint64_t rows_at_once = 64;
constexpr std::uint64_t tests_at_once = std::uint64_t{1} << 28;  // between two calls of progress

// What one run of rows found.
struct Found {
    std::vector<Pair> pairs;
    std::uint64_t filtered = 0;
    std::uint64_t unmoving = 0;
};

bool valid(const Aabb& box) {
    for (int d = 0; d < 3; ++d)
        if (!(box.min[d] <= box.max[d]) || !std::isfinite(box.min[d]) || !std::isfinite(box.max[d])) return false;
    return true;
}

void test_rows(View<const Aabb> boxes, const FilterInput& filters, std::uint32_t first, std::uint32_t end,
               Found& found) {
    const auto n = static_cast<std::uint32_t>(boxes.size());
    for (std::uint32_t a = first; a < end; ++a) {
        if (!valid(boxes[a])) continue;
        for (std::uint32_t b = a + 1; b < n; ++b) {
            if (!overlap(boxes[a], boxes[b]) || !valid(boxes[b])) continue;
            if (!filters.allows(a, b))
                ++found.filtered;
            else if (!filters.can_move(a) && !filters.can_move(b))
                ++found.unmoving;
            else
                found.pairs.push_back({a, b});
        }
    }
}

class HostBrute : public BroadPhaseAlgorithm {
public:
    explicit HostBrute(const BroadPhaseOptions& options) : options_(options) {}

    void find(BoxInput& input, const FilterInput& filters, PairList& pairs, FindCounts& counts) override {
        const View<const Aabb> boxes = input.on_host();
        const std::uint64_t n = boxes.size();
        // Each run of rows keeps its own list; put together in order they are sorted.
        std::vector<Found> found((n + rows_at_once - 1) / rows_at_once);
        const std::size_t at_once = std::max<std::size_t>(16, tests_at_once / (n * rows_at_once + 1));
        for (std::size_t run = 0; run < found.size(); run += at_once) {
            if (options_.progress) options_.progress(static_cast<double>(run) / static_cast<double>(found.size()));
            parallel_for(std::min(at_once, found.size() - run), found.size() > 8, [&](std::size_t i) {
                const std::uint64_t first = (run + i) * rows_at_once;
                test_rows(boxes, filters, static_cast<std::uint32_t>(first),
                          static_cast<std::uint32_t>(std::min(n, first + rows_at_once)), found[run + i]);
            });
        }

        std::uint64_t total = 0;
        for (const Found& part : found) total += part.pairs.size();
        check_limit(total, options_);
        for (const Found& part : found) {
            pairs.append(part.pairs);
            counts.pairs_filtered += part.filtered;
            counts.static_pairs += part.unmoving;
        }
        counts.box_tests += n == 0 ? 0 : n * (n - 1) / 2;
        counts.invalid_boxes = !std::all_of(boxes.begin(), boxes.end(), valid);
    }

private:
    const BroadPhaseOptions& options_;
};

}  // namespace

std::unique_ptr<BroadPhaseAlgorithm> make_host_brute(Device*, const BroadPhaseOptions& options) {
    return std::make_unique<HostBrute>(options);
}

}  // namespace clinch::detail
