/// All of sdm except reading and writing files, which is in <sdm/io.h>.
#pragma once

// IWYU pragma: begin_exports
#include <sdm/align.h>
#include <sdm/bake.h>
#include <sdm/bounds.h>
#include <sdm/closest_points.h>
#include <sdm/doubts.h>
#include <sdm/engine.h>
#include <sdm/error.h>
#include <sdm/execution.h>
#include <sdm/gl.h>
#include <sdm/gpu.h>
#include <sdm/hausdorff.h>
#include <sdm/map.h>
#include <sdm/match.h>
#include <sdm/measure.h>
#include <sdm/mesh.h>
#include <sdm/mesh_attributes.h>
#include <sdm/mesh_edit.h>
#include <sdm/metrics.h>
#include <sdm/multi_body_query.h>
#include <sdm/names.h>
#include <sdm/options.h>
#include <sdm/places.h>
#include <sdm/proximity_query.h>
#include <sdm/rays.h>
#include <sdm/sampling_bound.h>
#include <sdm/self_proximity_query.h>
#include <sdm/shape.h>
#include <sdm/simplify.h>
#include <sdm/sites.h>
#include <sdm/statistics.h>
#include <sdm/summary.h>
#include <sdm/surface.h>
#include <sdm/tolerance.h>
#include <sdm/types.h>
#include <sdm/verdict.h>
#include <sdm/version.h>
#include <sdm/volume.h>
// IWYU pragma: end_exports
