// Finds the pairs of three boxes on the host and, where there is one, on an OpenCL device.
#include <clinch/clinch.hpp>
#include <clinch/interop/opencl.hpp>
#include <cstdio>
#include <vector>

namespace {

bool finds_the_pair(clinch::Context& context, const char* algorithm) {
    const std::vector<clinch::Aabb> boxes = {{{0, 0, 0}, {1, 1, 1}}, {{5, 5, 5}, {6, 6, 6}}, {{1, 1, 1}, {2, 2, 2}}};
    clinch::BroadPhaseOptions options;
    options.algorithm = algorithm;
    clinch::BroadPhase broad_phase(context, options);
    const auto pairs = broad_phase.find(boxes);
    const bool right = pairs.size() == 1 && pairs[0] == clinch::Pair{0, 2};
    std::printf("%s: %s\n", algorithm, right ? "right" : "wrong");
    return right;
}

}  // namespace

int main() {
    clinch::Context host = clinch::Context::host_only();
    if (!finds_the_pair(host, "host-sweep")) return 1;
    if (clinch::list_devices().empty()) return 0;
    clinch::Context context;
    return finds_the_pair(context, "brute") ? 0 : 1;
}
