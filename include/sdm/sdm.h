/// All of sdm but the reading and writing of files, which is <sdm/io.h>.
#pragma once

#include <sdm/bodies.h>
#include <sdm/error.h>
#include <sdm/error_bound.h>
#include <sdm/map.h>
#include <sdm/mesh.h>
#include <sdm/progress.h>
#include <sdm/proximity.h>
#include <sdm/raster.h>
#include <sdm/self.h>
#include <sdm/sites.h>
#include <sdm/statistics.h>
#include <sdm/surface.h>
#include <sdm/temporal.h>
#include <sdm/threads.h>
#include <sdm/transform.h>
#include <sdm/types.h>
#include <sdm/version.h>
