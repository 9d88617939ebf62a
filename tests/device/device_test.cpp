#include <CL/cl.h>

#include <catch2/catch.hpp>
#include <numeric>

#include "clinch/error.hpp"
#include "clinch/interop/opencl.hpp"
#include "tests/device/devices.hpp"

using namespace clinch;

TEST_CASE("device memory is counted while it is held", "[device][small]") {
    const Context context = test::all_devices();
    for (std::size_t i = 0; i < context.devices().size(); ++i) {
        detail::Device& device = context.impl().open(i);
        {
            detail::Buffer a = device.allocate(1000, "a");
            detail::Buffer b = device.allocate(500, "b");
            CHECK(context.report()[i].bytes == 1500);
            const detail::Buffer moved = std::move(a);
            CHECK(context.report()[i].bytes == 1500);
            device.reserve(b, 400, "b");
            CHECK(b.bytes() == 500);
            device.reserve(b, 2000, "b");  // what grows is given an eighth more
            CHECK(b.bytes() == 2250);
            CHECK(context.report()[i].bytes == 3250);
        }
        CHECK(context.report()[i].bytes == 0);
        CHECK(context.report()[i].peak_bytes == 3250);
    }
}

TEST_CASE("memory is written, read, cleared and mapped", "[device][small]") {
    const Context context = test::all_devices();
    for (std::size_t i = 0; i < context.devices().size(); ++i) {
        detail::Device& device = context.impl().open(i);
        std::vector<std::uint32_t> sent(100), received(100);
        std::iota(sent.begin(), sent.end(), 5u);
        const detail::Buffer buffer = device.allocate(400, "numbers");
        device.write(buffer, sent.data(), 400);
        device.read(buffer, received.data(), 400);
        CHECK(received == sent);
        device.clear(buffer, 40);
        const detail::Mapping mapping = device.map(buffer, 400);
        CHECK(mapping.as<std::uint32_t>()[9] == 0);
        CHECK(mapping.as<std::uint32_t>()[10] == 15);
        CHECK(mapping.as<std::uint32_t>()[99] == 104);
    }
}

TEST_CASE("too much memory is an error that names the use and the size", "[device]") {
    const Context context = test::all_devices();
    detail::Device& device = context.impl().open(0);
    try {
        device.allocate(static_cast<std::size_t>(device.info().max_allocation) + 1, "a mountain");
        FAIL("no error");
    } catch (const Error& error) {
        CHECK(error.code() == ErrorCode::OutOfMemory);
        CHECK(std::string(error.what()).find("a mountain") != std::string::npos);
        CHECK(std::string(error.what()).find(std::to_string(device.info().max_allocation)) != std::string::npos);
    }
    CHECK(context.report()[0].bytes == 0);
}

TEST_CASE("a failing call names itself and its status", "[device]") {
    const Context context = test::all_devices();
    detail::Device& device = context.impl().open(0);
    try {
        device.kernel("primitives/scan", "no_such_kernel");
        FAIL("no error");
    } catch (const Error& error) {
        CHECK(error.code() == ErrorCode::DeviceFailed);
        CHECK(error.opencl_status() == CL_INVALID_KERNEL_NAME);
        CHECK(std::string(error.what()).find("no_such_kernel") != std::string::npos);
    }
    detail::Kernel kernel = device.kernel("primitives/scan", "scan_runs");
    const detail::Buffer b = device.allocate(4, "a number");
    CHECK_THROWS_AS(kernel.args(b, 1u, 1u, 1u, b, 1u), Error);  // one argument too many
}

TEST_CASE("the caller's own context and queue are checked", "[device]") {
    const Context outer = test::all_devices();
    detail::Device& device = outer.impl().open(0);
    cl_int status = 0;
    const cl_device_id id = outer.impl().ids[0];
    cl_context other = clCreateContext(nullptr, 1, &id, nullptr, nullptr, &status);
    REQUIRE(status == CL_SUCCESS);
    CHECK_THROWS_AS(make_context(other, id, device.queue()), Error);
    clReleaseContext(other);
    const Context inner = make_context(device.context(), id, device.queue());
    CHECK(inner.devices().size() == 1);
    CHECK(inner.report()[0].opened);
    CHECK(inner.devices()[0].name == outer.devices()[0].name);
}
