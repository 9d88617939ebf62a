// FCL: its dynamic AABB tree, all objects registered anew, then collided with itself. One thread. The
// objects are kept from call to call and get the new places and sides within it, as in a program that steps.
#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/narrowphase/collision_object.h>

#include "bench/peers/peer.hpp"

namespace clinch::peers {
namespace {

using Object = fcl::CollisionObjectd;

class Fcl : public Peer {
public:
    Lists run(View<const Aabb> boxes) override {
        if (objects_.size() != boxes.size()) make_objects(boxes.size());
        for (std::size_t i = 0; i < boxes.size(); ++i) {
            const Aabb& box = boxes[i];
            for (int d = 0; d < 3; ++d) shapes_[i]->side[d] = double{box.max[d]} - double{box.min[d]};
            shapes_[i]->computeLocalAABB();
            objects_[i].setTranslation(middle(box));
            objects_[i].computeAABB();
        }
        pairs_.clear();
        fcl::DynamicAABBTreeCollisionManagerd manager;
        manager.registerObjects(handles_);
        manager.setup();
        manager.collide(this, collide);
        return {pairs_};
    }

private:
    static fcl::Vector3d middle(const Aabb& box) {
        fcl::Vector3d c;
        for (int d = 0; d < 3; ++d) c[d] = 0.5 * (double{box.min[d]} + double{box.max[d]});
        return c;
    }

    void make_objects(std::size_t count) {
        shapes_.clear();
        objects_.clear();
        handles_.clear();
        objects_.reserve(count);
        for (std::size_t i = 0; i < count; ++i) {
            shapes_.push_back(std::make_shared<fcl::Boxd>(1.0, 1.0, 1.0));
            objects_.emplace_back(shapes_.back());
            handles_.push_back(&objects_.back());
        }
    }

    std::uint32_t number(const Object* object) const { return static_cast<std::uint32_t>(object - objects_.data()); }

    // FCL has tested the boxes before it calls; false: go on.
    static bool collide(Object* p, Object* q, void* self) {
        Fcl& peer = *static_cast<Fcl*>(self);
        peer.pairs_.push_back({peer.number(p), peer.number(q)});
        return false;
    }

    std::vector<std::shared_ptr<fcl::Boxd>> shapes_;
    std::vector<Object> objects_;
    std::vector<Object*> handles_;
    std::vector<Pair> pairs_;
};

}  // namespace

std::unique_ptr<Peer> make_fcl(const Setup&) {
    return std::make_unique<Fcl>();
}

}  // namespace clinch::peers
