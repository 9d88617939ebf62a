// Loops over host threads that let exceptions through: one that leaves an OpenMP region by itself
// would end the program.
#pragma once

#include <cstddef>
#include <cstdint>
#include <exception>

namespace clinch::detail {

/// Calls body(i) for each i < count, spread over the host's threads if `parallel`, in any order. The
/// first exception is thrown again when all threads are done; bodies not yet begun are then left out.
template <class Body>
void parallel_for(std::size_t count, bool parallel, const Body& body) {
    std::exception_ptr failure;
    bool failed = false;
    const auto end = static_cast<std::int64_t>(count);
#pragma omp parallel for schedule(dynamic) if (parallel)
    for (std::int64_t i = 0; i < end; ++i) {
        bool skip = false;
#pragma omp atomic read
        skip = failed;
        if (skip) continue;
        try {
            body(static_cast<std::size_t>(i));
        } catch (...) {
#pragma omp critical(clinch_parallel_for)
            if (!failure) failure = std::current_exception();
#pragma omp atomic write
            failed = true;
        }
    }
    if (failure) std::rethrow_exception(failure);
}

}  // namespace clinch::detail
