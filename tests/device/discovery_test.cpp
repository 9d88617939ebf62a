#include <catch2/catch.hpp>
#include <cstdlib>
#include <set>

#include "clinch/context.hpp"
#include "clinch/error.hpp"
#include "tests/device/devices.hpp"

using namespace clinch;

namespace {

// Sets CLINCH_DEVICES while it lives.
class DevicesVariable {
public:
    explicit DevicesVariable(const char* value) { setenv("CLINCH_DEVICES", value, 1); }
    ~DevicesVariable() { unsetenv("CLINCH_DEVICES"); }
    DevicesVariable(const DevicesVariable&) = delete;
    DevicesVariable& operator=(const DevicesVariable&) = delete;
};

ErrorCode code_of(const DeviceFilter& filter, std::string* message = nullptr) {
    ContextOptions options;
    options.devices = filter;
    try {
        const Context context(options);
    } catch (const Error& error) {
        if (message != nullptr) *message = error.what();
        return error.code();
    }
    FAIL("no error");
    return ErrorCode::InvalidArgument;
}

}  // namespace

TEST_CASE("a device filter is read from text", "[host]") {
    CHECK(DeviceFilter::parse("all", "x").indices.empty());
    CHECK_FALSE(DeviceFilter::parse("all", "x").type.has_value());
    CHECK(DeviceFilter::parse("cpu", "x").type == DeviceType::Cpu);
    CHECK(DeviceFilter::parse("gpu", "x").type == DeviceType::Gpu);
    CHECK(DeviceFilter::parse("accelerator", "x").type == DeviceType::Accelerator);
    CHECK(DeviceFilter::parse("0,2", "x").indices == std::vector<std::uint32_t>{0, 2});
    for (const char* wrong : {"", ",", "0,", ",1", "cpu,gpu", "-1", "1.5", "0 1", "4294967296", "CPU"}) {
        INFO(wrong);
        try {
            DeviceFilter::parse(wrong, "--devices");
            FAIL("accepted");
        } catch (const Error& error) {
            CHECK(error.code() == ErrorCode::InvalidArgument);
            CHECK(std::string(error.what()).find("--devices is '" + std::string(wrong) + "'") == 0);
        }
    }
}

TEST_CASE("a host-only context has no device and refuses device work", "[host]") {
    const Context context = Context::host_only();
    CHECK(context.devices().empty());
    CHECK(context.report().empty());
    CHECK_THROWS_AS(context.impl().primary(), Error);
}

TEST_CASE("devices are described and not opened until used", "[device][small]") {
    const std::vector<DeviceInfo> devices = list_devices();
    REQUIRE_FALSE(devices.empty());
    for (std::size_t i = 0; i < devices.size(); ++i) {
        CHECK(devices[i].index == i);
        CHECK_FALSE(devices[i].name.empty());
        CHECK_FALSE(devices[i].platform_version.empty());
        CHECK_FALSE(devices[i].driver_version.empty());
        CHECK_FALSE(devices[i].use.empty());
        CHECK(devices[i].compute_units > 0);
        CHECK(std::set<std::uint32_t>{1, 4, 8, 16}.count(devices[i].lanes) == 1);
        CHECK(devices[i].max_allocation > 0);
    }
    Context context;
    for (const DeviceReport& report : context.report()) CHECK_FALSE(report.opened);
    context.impl().open(0);
    const auto reports = context.report();
    CHECK(reports[0].opened);
    for (std::size_t i = 1; i < reports.size(); ++i) CHECK_FALSE(reports[i].opened);
    CHECK(context.module_count() >= 5);
}

TEST_CASE("filters compose with CLINCH_DEVICES", "[device]") {
    const std::size_t count = list_devices().size();
    {
        const DevicesVariable variable("0");
        CHECK(Context().devices().size() == 1);
    }
    {
        const DevicesVariable variable("all");
        CHECK(Context().devices().size() == count);
    }
    {
        const DevicesVariable variable("1000");
        std::string message;
        CHECK(code_of({}, &message) == ErrorCode::NoDevice);
        CHECK(message.find("CLINCH_DEVICES '1000'") != std::string::npos);
        CHECK(message.find(list_devices()[0].platform) != std::string::npos);
    }
    {
        const DevicesVariable variable("quick");
        CHECK(code_of({}) == ErrorCode::InvalidArgument);
    }
    DeviceFilter accelerators;
    accelerators.type = DeviceType::Accelerator;
    std::string message;
    if (list_devices()[0].type != DeviceType::Accelerator) {
        CHECK(code_of(accelerators, &message) == ErrorCode::NoDevice);
        CHECK(message.find("accelerator") != std::string::npos);
    }
}

TEST_CASE("a CPU is divided into equal devices that work", "[device]") {
    const DeviceInfo whole = list_devices()[0];
    if (whole.platform.find("Portable") == std::string::npos || whole.compute_units < 2)
        return;  // no partition elsewhere
    DeviceFilter filter;
    filter.indices = {0};
    filter.sub_devices = 2;
    ContextOptions options;
    options.devices = filter;
    const Context context(options);
    REQUIRE(context.devices().size() == 2);
    for (std::uint32_t part = 0; part < 2; ++part) {
        CHECK(context.devices()[part].compute_units == whole.compute_units / 2);
        CHECK(context.devices()[part].sub_device == part);
        CHECK(context.devices()[part].sub_devices == 2);
        detail::Device& device = context.impl().open(part);
        const std::uint32_t sent = 42 + part;
        std::uint32_t received = 0;
        const detail::Buffer buffer = device.allocate(4, "a number");
        device.write(buffer, &sent, 4);
        device.read(buffer, &received, 4);
        CHECK(received == sent);
    }
    filter.sub_devices = whole.compute_units + 1;
    CHECK(code_of(filter) == ErrorCode::InvalidArgument);
}
