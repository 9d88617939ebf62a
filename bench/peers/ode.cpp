// ODE: its sweep-and-prune space. One thread. The geoms are kept from call to call and get the new places and
// sides within it, as in a program that steps.
#include <ode/ode.h>

#include <new>
#include <type_traits>

#include "bench/peers/peer.hpp"

namespace clinch::peers {
namespace {

class Ode : public Peer {
public:
    Lists run(View<const Aabb> boxes) override {
        if (geoms_.size() != boxes.size()) make_geoms(boxes.size());
        for (std::size_t i = 0; i < boxes.size(); ++i) {
            const Aabb& box = boxes[i];
            const auto middle = [&](int d) { return 0.5 * (double{box.min[d]} + double{box.max[d]}); };
            const auto side = [&](int d) { return static_cast<dReal>(double{box.max[d]} - double{box.min[d]}); };
            dGeomBoxSetLengths(geoms_[i], side(0), side(1), side(2));
            dGeomSetPosition(geoms_[i], static_cast<dReal>(middle(0)), static_cast<dReal>(middle(1)),
                             static_cast<dReal>(middle(2)));
        }
        pairs_.clear();
        dSpaceCollide(space_.get(), this, collide);
        return {pairs_};
    }

private:
    struct Library {
        Library() {
            if (dInitODE2(0) == 0) throw std::bad_alloc();
        }
        ~Library() { dCloseODE(); }
        Library(const Library&) = delete;
        Library& operator=(const Library&) = delete;
    };
    struct Destroy {
        using pointer = dSpaceID;
        void operator()(dSpaceID space) const { dSpaceDestroy(space); }  // and its geoms
    };

    void make_geoms(std::size_t count) {
        space_.reset(dSweepAndPruneSpaceCreate(nullptr, dSAP_AXES_XYZ));
        geoms_.clear();
        numbers_.resize(count);
        for (std::size_t i = 0; i < count; ++i) {
            geoms_.push_back(dCreateBox(space_.get(), 1, 1, 1));
            numbers_[i] = static_cast<std::uint32_t>(i);
            dGeomSetData(geoms_[i], &numbers_[i]);
        }
    }

    static void collide(void* self, dGeomID p, dGeomID q) {
        const auto number = [](dGeomID geom) { return *static_cast<const std::uint32_t*>(dGeomGetData(geom)); };
        static_cast<Ode*>(self)->pairs_.push_back({number(p), number(q)});
    }

    Library library_;
    std::unique_ptr<std::remove_pointer_t<dSpaceID>, Destroy> space_;
    std::vector<dGeomID> geoms_;
    std::vector<std::uint32_t> numbers_;
    std::vector<Pair> pairs_;
};

}  // namespace

std::unique_ptr<Peer> make_ode(const Setup&) {
    return std::make_unique<Ode>();
}

}  // namespace clinch::peers
