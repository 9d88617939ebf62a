# The tests of src/schedule under ThreadSanitizer, in a program of their own: no OpenCL driver takes part, whose threads
# are not instrumented. Not beside other sanitizers, which exclude this one.
if(CLINCH_SANITIZE)
    return()
endif()
file(GLOB clinch_schedule_sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_LIST_DIR}/*_test.cpp
    ${PROJECT_SOURCE_DIR}/src/schedule/*.cpp ${PROJECT_SOURCE_DIR}/bench/machines/*.cpp)
add_executable(clinch_schedule_threads ${CMAKE_CURRENT_LIST_DIR}/threads_main.cpp ${clinch_schedule_sources}
    ${PROJECT_SOURCE_DIR}/src/device/error.cpp)
target_include_directories(clinch_schedule_threads PRIVATE ${PROJECT_SOURCE_DIR} ${PROJECT_SOURCE_DIR}/include)
target_compile_features(clinch_schedule_threads PRIVATE cxx_std_17)
target_compile_definitions(clinch_schedule_threads PRIVATE CL_TARGET_OPENCL_VERSION=120)
target_compile_options(clinch_schedule_threads PRIVATE -ffp-contract=off -O1 -g -fsanitize=thread)
target_link_options(clinch_schedule_threads PRIVATE -fsanitize=thread)
target_link_libraries(clinch_schedule_threads PRIVATE Catch2::Catch2 Boost::headers Threads::Threads)
clinch_warnings(clinch_schedule_threads)
clinch_test(NAME threads LABEL host COMMAND clinch_schedule_threads "[schedule]"
    ENVIRONMENT TSAN_OPTIONS=halt_on_error=1:exitcode=66)
