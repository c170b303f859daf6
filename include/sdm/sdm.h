/// All of sdm except reading and writing files, which is in <sdm/io.h>.
#pragma once

#include <sdm/api.h>
#include <sdm/atlas.h>
#include <sdm/closest_points.h>
#include <sdm/engine.h>
#include <sdm/error.h>
#include <sdm/gl.h>
#include <sdm/map.h>
#include <sdm/mesh.h>
#include <sdm/multi_body_query.h>
#include <sdm/progress.h>
#include <sdm/proximity_query.h>
#include <sdm/sampling_bound.h>
#include <sdm/self_proximity_query.h>
#include <sdm/sign.h>
#include <sdm/sites.h>
#include <sdm/statistics.h>
#include <sdm/surface.h>
#include <sdm/temporal_maps.h>
#include <sdm/threads.h>
#include <sdm/tolerance.h>
#include <sdm/transform.h>
#include <sdm/types.h>
#include <sdm/version.h>
#include <sdm/vertex_distances.h>
