// The trees of the broad phase `bvh`: one of all bodies, or two where many cannot move.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "src/broad_phase/bvh_tree.hpp"
#include "src/broad_phase/inputs.hpp"
#include "src/device/device.hpp"

namespace clinch::detail {

/// Bodies that cannot move (Motion::Static, Sleeping) get a tree of their own where they are many. That is kept from
/// call to call while they are the same bodies with the same boxes, and is searched against the other tree alone, so
/// that no two of them are ever tested against each other (static and dynamic trees: Bullet's btDbvtBroadphase).
class BvhForest {
public:
    /// Boxes from which on two trees cost less than one, which is launched and waited for half as often.
    static constexpr std::uint32_t fewest_boxes = 4000;

    explicit BvhForest(Device& device, std::uint32_t fewest = fewest_boxes)
        : device_(device), fewest_(fewest), moving_(device), still_(device) {}

    /// Makes the trees hold `boxes`, at least two. Waits. Cost: that of BvhTree::update() for what can move; for
    /// what cannot, a pass over its boxes and 24 bytes a body of memory, and when a box is not what it was, or
    /// the bodies are others, an update() too. When it throws, the next call starts anew.
    void update(BoxInput& boxes, const FilterInput& filters);
    /// Tells the box tests of a search, as BvhTree::searched().
    void searched(std::uint64_t box_tests) { moving_.searched(box_tests); }

    /// There are two trees.
    bool split() const noexcept { return split_; }
    /// The tree whose bodies are to be searched for one another: all, or those that can move. Null: there are none.
    const BvhTree* moving() const noexcept { return split_ && movers_.empty() ? nullptr : &moving_; }
    /// The tree of those that cannot move, to be searched against moving() alone; null: there is none.
    const BvhTree* still() const noexcept { return split_ ? &still_ : nullptr; }
    /// Bodies whose tree the last update took as it was.
    std::uint32_t kept() const noexcept { return kept_; }
    /// There was a box that is no box.
    bool any_invalid() const noexcept {
        return (moving() != nullptr && moving_.any_invalid()) || (split_ && still_.any_invalid());
    }

private:
    bool divide(std::uint32_t n, const FilterInput& filters);
    void take_bodies();
    bool still_boxes_changed(BoxInput& boxes, bool fresh);
    void update_still(BoxInput& boxes, bool same_bodies);

    Device& device_;
    const std::uint32_t fewest_;
    BvhTree moving_, still_;
    Kernel compare_kernel_;
    Buffer still_bodies_, still_boxes_, changed_;
    std::vector<std::uint8_t> is_still_;  // a body: 1 if it cannot move
    std::vector<std::uint32_t> movers_;   // ascending; kept while there are two trees
    std::uint32_t n_ = 0;                 // boxes of the last update that went well, else 0
    std::uint32_t still_count_ = 0, kept_ = 0;
    std::uint64_t version_ = 0;  // of the filters of the last update
    bool split_ = false;
};

}  // namespace clinch::detail
