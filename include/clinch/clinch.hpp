// Everything but the interop headers.
#pragma once

#include "clinch/aabb.hpp"
#include "clinch/broad_phase.hpp"
#include "clinch/contact.hpp"
#include "clinch/context.hpp"
#include "clinch/device.hpp"
#include "clinch/error.hpp"
#include "clinch/narrow_phase.hpp"
#include "clinch/pipeline.hpp"
#include "clinch/pose.hpp"
#include "clinch/report.hpp"
#include "clinch/scene.hpp"
#include "clinch/shape.hpp"
#include "clinch/version.hpp"
#include "clinch/view.hpp"
#include "clinch/warm_start.hpp"
