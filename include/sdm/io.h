/// All of sdm::io: reading and writing files.
#pragma once

#include <sdm/bake_files.h>
#include <sdm/map_files.h>
#include <sdm/mesh_files.h>
#include <sdm/points.h>
