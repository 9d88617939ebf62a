#include "clinch/interop/opencl.hpp"

#include <catch2/catch.hpp>
#include <cstring>

#include "bench/scenes/boxes.hpp"
#include "clinch/error.hpp"
#include "tests/broad_phase/oracle.hpp"
#include "tests/device/devices.hpp"

using namespace clinch;

namespace {

// What a caller brings: an OpenCL context, a queue and a buffer made by plain OpenCL calls.
struct Caller {
    cl_device_id device;
    cl_context context;
    cl_command_queue queue;
    cl_mem memory;

    explicit Caller(const std::vector<Aabb>& boxes) {
        const Context found;
        device = found.impl().ids[0];
        cl_int status = 0;
        context = clCreateContext(nullptr, 1, &device, nullptr, nullptr, &status);
        REQUIRE(status == CL_SUCCESS);
        queue = clCreateCommandQueue(context, device, 0, &status);
        REQUIRE(status == CL_SUCCESS);
        memory = clCreateBuffer(context, CL_MEM_READ_ONLY, boxes.size() * sizeof(Aabb), nullptr, &status);
        REQUIRE(status == CL_SUCCESS);
        REQUIRE(clEnqueueWriteBuffer(queue, memory, CL_FALSE, 0, boxes.size() * sizeof(Aabb), boxes.data(), 0, nullptr,
                                     nullptr) == CL_SUCCESS);
    }
    ~Caller() {
        clReleaseMemObject(memory);
        clReleaseCommandQueue(queue);
        clReleaseContext(context);
    }
    Caller(const Caller&) = delete;
    Caller& operator=(const Caller&) = delete;
};

}  // namespace

TEST_CASE("pairs of boxes in the caller's own buffer", "[device][small]") {
    std::vector<Aabb> boxes = scenes::make_boxes("density", 300, 4);
    boxes[230].min[0] = std::nanf("");
    const Caller caller(boxes);
    Context context = make_context(caller.context, caller.device, caller.queue);
    for (const std::string& name : test::names_for(list_devices()[0])) {
        INFO(name);
        BroadPhaseOptions options;
        options.algorithm = name;
        BroadPhase broad_phase(context, options);
        const std::vector<Pair> expected = test::pairs_by_hand(boxes);
        const View<const Pair> found = find_pairs(broad_phase, caller.memory, boxes.size());
        REQUIRE(found.size() == expected.size());
        CHECK(std::equal(found.begin(), found.end(), expected.begin()));
        CHECK(broad_phase.report().rejected.size() == 1);

        const std::vector<Aabb> part(boxes.begin() + 30, boxes.begin() + 260);
        const std::vector<Pair> part_expected = test::pairs_by_hand(part);
        const View<const Pair> part_found = find_pairs(broad_phase, caller.memory, 230, 30);
        REQUIRE(part_found.size() == part_expected.size());
        CHECK(std::equal(part_found.begin(), part_found.end(), part_expected.begin()));

        CHECK_THROWS_AS(find_pairs(broad_phase, caller.memory, 301), Error);
        CHECK_THROWS_AS(find_pairs(broad_phase, caller.memory, 1, 300), Error);
        CHECK_THROWS_AS(find_pairs(broad_phase, caller.memory, 2, SIZE_MAX), Error);
    }
}

TEST_CASE("a buffer of another OpenCL context is refused", "[device]") {
    const std::vector<Aabb> boxes = scenes::make_boxes("uniform", 10, 4);
    const Caller one(boxes), two(boxes);
    Context context = make_context(one.context, one.device, one.queue);
    BroadPhase broad_phase(context);
    CHECK_THROWS_AS(find_pairs(broad_phase, two.memory, 10), Error);
    CHECK_NOTHROW(find_pairs(broad_phase, one.memory, 10));
}
