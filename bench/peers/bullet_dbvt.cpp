// Bullet 2: a dynamic bounding volume tree filled box by box, then collided with itself. One thread.
#include <BulletCollision/BroadphaseCollision/btDbvt.h>

#include "bench/peers/peer.hpp"

namespace clinch::peers {
namespace {

struct Collect : btDbvt::ICollide {
    explicit Collect(std::vector<Pair>& to) : pairs(to) {}
    void Process(const btDbvtNode* p, const btDbvtNode* q) override {
        pairs.push_back({static_cast<std::uint32_t>(p->dataAsInt), static_cast<std::uint32_t>(q->dataAsInt)});
    }
    std::vector<Pair>& pairs;
};

class BulletDbvt : public Peer {
public:
    Lists run(View<const Aabb> boxes) override {
        pairs_.clear();
        btDbvt tree;
        for (std::size_t i = 0; i < boxes.size(); ++i) {
            const float *const low = boxes[i].min, *const high = boxes[i].max;
            const btDbvtVolume volume =
                btDbvtVolume::FromMM(btVector3(low[0], low[1], low[2]), btVector3(high[0], high[1], high[2]));
            tree.insert(volume, nullptr)->dataAsInt = static_cast<int>(i);
        }
        Collect collect(pairs_);
        if (tree.m_root != nullptr) tree.collideTT(tree.m_root, tree.m_root, collect);
        return {pairs_};
    }

private:
    std::vector<Pair> pairs_;
};

}  // namespace

std::unique_ptr<Peer> make_bullet_dbvt(const Setup&) {
    return std::make_unique<BulletDbvt>();
}

}  // namespace clinch::peers
