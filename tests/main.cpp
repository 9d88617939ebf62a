// Entry point of clinch_tests. Makes sure that the tests run on the OpenCL implementation they were
// started for, and on no other that happens to be installed.
#define CATCH_CONFIG_RUNNER
#include <catch2/catch.hpp>

#include <cstdlib>
#include <exception>
#include <iostream>
#include <string>

#include "clinch/device.hpp"

namespace {

// Empty when every device's platform holds the text of CLINCH_TEST_EXPECT and at least
// CLINCH_TEST_EXPECT_DEVICES of them are there; else what is wrong, as one sentence.
std::string wrong_devices() {
    const char* const expected = std::getenv("CLINCH_TEST_EXPECT");
    if (expected == nullptr) return {};
    const char* const count_text = std::getenv("CLINCH_TEST_EXPECT_DEVICES");
    const std::size_t count = count_text == nullptr ? 1 : std::stoul(count_text);
    const auto devices = clinch::list_devices();
    std::string found;
    bool right = devices.size() >= count;
    for (const clinch::DeviceInfo& device : devices) {
        if (device.platform.find(expected) == std::string::npos) right = false;
        found += "\n  " + device.platform + ": " + device.name;
    }
    if (right) return {};
    return "these tests want at least " + std::to_string(count) + " device(s) and only devices of the platform \"" +
           expected + "\", found:" + (found.empty() ? " none" : found);
}

int run(int argc, char** argv) {
    // A developer's own choice of devices or kernels must not reach the tests.
    unsetenv("CLINCH_DEVICES");
    unsetenv("CLINCH_KERNEL_DIR");
    const std::string wrong = wrong_devices();
    if (!wrong.empty()) {
        std::cerr << "clinch_tests: " << wrong << '\n';
        return 3;
    }
    return Catch::Session().run(argc, argv);
}

}  // namespace

int main(int argc, char** argv) {
    try {
        return run(argc, argv);
    } catch (const std::exception& error) {
        std::cerr << "clinch_tests: " << error.what() << '\n';
        return 3;
    }
}
