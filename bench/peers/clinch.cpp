// clinch itself: BroadPhase on the devices that CLINCH_DEVICES and the drivers give.
#include "bench/peers/peer.hpp"
#include "clinch/context.hpp"

namespace clinch::peers {
namespace {

BroadPhaseOptions options_of(const std::string& algorithm, Order order) {
    BroadPhaseOptions options;
    options.algorithm = algorithm;
    options.order = order;
    return options;
}

class Clinch : public Peer {
public:
    Clinch(const std::string& algorithm, Order order) : broad_phase_(context_, options_of(algorithm, order)) {}

    Lists run(View<const Aabb> boxes) override { return {broad_phase_.find(boxes)}; }
    std::string chosen() const override { return broad_phase_.report().algorithm; }

private:
    Context context_;
    BroadPhase broad_phase_;
};

}  // namespace

std::unique_ptr<Peer> make_clinch(const std::string& algorithm, Order order) {
    return std::make_unique<Clinch>(algorithm, order);
}

}  // namespace clinch::peers
