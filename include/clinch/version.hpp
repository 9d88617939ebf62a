// The version of these headers; follows semantic versioning.
#pragma once

#define CLINCH_VERSION_MAJOR 0
#define CLINCH_VERSION_MINOR 1
#define CLINCH_VERSION_PATCH 0
#define CLINCH_VERSION "0.1.0"
