// Entry point of clinch_schedule_threads: the tests of src/schedule alone, without OpenCL.
#define CATCH_CONFIG_MAIN
#include <catch2/catch.hpp>
