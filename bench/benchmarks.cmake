# The benchmarks: one program, every *_bench.cpp of this folder in it.
find_package(benchmark REQUIRED)
file(GLOB_RECURSE clinch_bench_sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*_bench.cpp)
add_executable(clinch_bench ${clinch_bench_sources} broad_phase/plain_loop.cpp)
target_link_libraries(clinch_bench PRIVATE clinch clinch_scenes benchmark::benchmark)
target_compile_definitions(clinch_bench PRIVATE CLINCH_BENCH_DIR="${CMAKE_CURRENT_SOURCE_DIR}")
# The yardstick is compiled for this very machine, as whoever wrote it by hand would do.
set_source_files_properties(broad_phase/plain_loop.cpp PROPERTIES COMPILE_OPTIONS "-O3;-march=native")
clinch_warnings(clinch_bench)
