#include "src/device/crew.hpp"

#include <algorithm>
#include <system_error>
#include <thread>
#include <utility>

#include "clinch/error.hpp"

namespace clinch::detail {
namespace {

// Joins what was started, also when a thread cannot be.
class Threads {
public:
    ~Threads() {
        for (std::thread& thread : threads_) thread.join();
    }
    template <class Work>
    void start(Work&& work) {
        threads_.emplace_back(std::forward<Work>(work));
    }

private:
    std::vector<std::thread> threads_;
};

}  // namespace

std::vector<std::exception_ptr> run_crew(std::size_t count, const std::function<void(std::size_t)>& work,
                                         const std::function<void(std::size_t)>& without) {
    std::vector<std::exception_ptr> thrown(count);
    if (count == 0) return thrown;
    const auto run = [&](std::size_t k) {
        try {
            work(k);
        } catch (...) {
            thrown[k] = std::current_exception();
        }
    };
    {
        Threads others;
        for (std::size_t k = 1; k < count; ++k) {
            try {
                others.start([&run, k] { run(k); });
            } catch (const std::system_error& error) {
                thrown[k] = std::make_exception_ptr(
                    Error(ErrorCode::DeviceFailed, std::string("a host thread could not be started: ") + error.what()));
                if (without) without(k);
            }
        }
        run(0);
    }
    return thrown;
}

bool is_device_fault(const std::exception_ptr& thrown) {
    try {
        std::rethrow_exception(thrown);
    } catch (const Error& error) {
        // What a device cannot do by its kind is no failure of an OpenCL call.
        return error.opencl_status() != 0 || error.code() == ErrorCode::OutOfMemory;
    } catch (...) {
        return false;
    }
}

std::exception_ptr cause_of(const std::exception_ptr& thrown) {
    try {
        std::rethrow_exception(thrown);
    } catch (const DeviceFault& fault) {
        return fault.why;
    } catch (...) {
        return thrown;
    }
}

double guessed_speed(const DeviceInfo& device) noexcept {
    const double lanes = device.type == DeviceType::Gpu ? 64.0 : device.lanes;
    return std::max(1.0, device.compute_units * lanes);
}

std::string message_of(const std::exception_ptr& thrown) {
    try {
        std::rethrow_exception(thrown);
    } catch (const std::exception& error) {
        return error.what();
    } catch (...) {
        return "an unknown exception";
    }
}

}  // namespace clinch::detail
