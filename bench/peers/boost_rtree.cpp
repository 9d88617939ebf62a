// Boost.Geometry: an R-tree packed from all boxes, one query a box; the queries on all threads.
#include <omp.h>

#include <boost/function_output_iterator.hpp>
#include <boost/geometry.hpp>
#include <boost/geometry/index/rtree.hpp>
#include <cstdint>
#include <utility>

#include "bench/peers/peer.hpp"

namespace clinch::peers {
namespace {

namespace bg = boost::geometry;
using Point = bg::model::point<float, 3, bg::cs::cartesian>;
using Box = bg::model::box<Point>;
using Value = std::pair<Box, std::uint32_t>;
using Tree = bg::index::rtree<Value, bg::index::quadratic<16>>;

Box convert(const Aabb& box) {
    return {Point(box.min[0], box.min[1], box.min[2]), Point(box.max[0], box.max[1], box.max[2])};
}

class BoostRtree : public Peer {
public:
    explicit BoostRtree(unsigned threads) : lists_(threads) {}

    Lists run(View<const Aabb> boxes) override {
        values_.clear();
        values_.reserve(boxes.size());
        for (std::size_t i = 0; i < boxes.size(); ++i)
            values_.emplace_back(convert(boxes[i]), static_cast<std::uint32_t>(i));
        const Tree tree(values_);
        for (List& list : lists_) list.pairs.clear();
        const auto count = static_cast<std::int64_t>(boxes.size());
#pragma omp parallel num_threads(static_cast <int>(lists_.size()))
        {
            std::vector<Pair>& pairs = lists_[static_cast<std::size_t>(omp_get_thread_num())].pairs;
#pragma omp for schedule(dynamic, 1024)
            for (std::int64_t i = 0; i < count; ++i) {
                const auto a = static_cast<std::uint32_t>(i);
                const auto keep = [&pairs, a](const Value& found) {
                    if (a < found.second) pairs.push_back({a, found.second});
                };
                tree.query(bg::index::intersects(values_[a].first), boost::make_function_output_iterator(keep));
            }
        }
        Lists views;
        for (const List& list : lists_) views.emplace_back(list.pairs);
        return views;
    }

private:
    struct alignas(128) List {
        std::vector<Pair> pairs;
    };
    std::vector<Value> values_;
    std::vector<List> lists_;
};

}  // namespace

std::unique_ptr<Peer> make_boost_rtree(const Setup& setup) {
    return std::make_unique<BoostRtree>(setup.threads);
}

}  // namespace clinch::peers
