/// All of sdm::io: reading and writing files.
#pragma once

// IWYU pragma: begin_exports
#include <sdm/bake_files.h>
#include <sdm/map_files.h>
#include <sdm/mesh_files.h>
#include <sdm/points.h>
// IWYU pragma: end_exports
