// CGAL: box_self_intersection_d, a streamed segment tree [Zomorodian and Edelsbrunner 2000], with the cutoff to
// brute force at 500 boxes, where it was quickest on these scenes.
#include <CGAL/Box_intersection_d/Box_with_info_d.h>
#include <CGAL/box_intersection_d.h>
#include <tbb/global_control.h>

#include <cstdint>

#include "bench/peers/peer.hpp"
#include "bench/peers/thread_lists.hpp"

namespace clinch::peers {
namespace {

using Box = CGAL::Box_intersection_d::Box_with_info_d<float, 3, std::uint32_t>;
constexpr std::ptrdiff_t cutoff = 500;

void fill(std::vector<Box>& to, View<const Aabb> boxes) {
    to.clear();
    to.reserve(boxes.size());
    for (std::size_t i = 0; i < boxes.size(); ++i) {
        Aabb box = boxes[i];
        to.emplace_back(box.min, box.max, static_cast<std::uint32_t>(i));
    }
}

class Sequential : public Peer {
public:
    Lists run(View<const Aabb> boxes) override {
        fill(boxes_, boxes);
        pairs_.clear();
        CGAL::box_self_intersection_d(
            boxes_.begin(), boxes_.end(),
            [this](const Box& p, const Box& q) {
                pairs_.push_back({p.info(), q.info()});
            },
            cutoff);
        return {pairs_};
    }

private:
    std::vector<Box> boxes_;
    std::vector<Pair> pairs_;
};

class Parallel : public Peer {
public:
    explicit Parallel(unsigned threads)
        : limit_(tbb::global_control::max_allowed_parallelism, threads),
          arena_(static_cast<int>(threads)),
          lists_(threads) {}

    Lists run(View<const Aabb> boxes) override {
        fill(boxes_, boxes);
        lists_.clear();
        arena_.execute([this] {
            CGAL::box_self_intersection_d<CGAL::Parallel_tag>(
                boxes_.begin(), boxes_.end(),
                [this](const Box& p, const Box& q) {
                    lists_.mine().push_back({p.info(), q.info()});
                },
                cutoff);
        });
        return lists_.views();
    }

private:
    tbb::global_control limit_;
    tbb::task_arena arena_;
    std::vector<Box> boxes_;
    ThreadLists lists_;
};

}  // namespace

std::unique_ptr<Peer> make_cgal(const Setup&) {
    return std::make_unique<Sequential>();
}
std::unique_ptr<Peer> make_cgal_parallel(const Setup& setup) {
    return std::make_unique<Parallel>(setup.threads);
}

}  // namespace clinch::peers
