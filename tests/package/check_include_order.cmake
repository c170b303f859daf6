cmake_minimum_required(VERSION 3.23)

# A folder of src/ includes only itself and the folders before it, so that the graph of includes has neither a
# circle nor an arrow that points up; and only the table of engines includes the gl and the gpu engine. Prints the graph: for
# each folder the folders that it includes.
set(order
  core/numbers
  core
  core/arrays
  core/lazy
  core/parallel
  geometry
  geometry/lanes
  tree
  search
  mesh
  mesh/crossings
  atlas/charts
  atlas/packing
  atlas
  surface
  surface/sampling_bound
  sites
  closest
  closest/facing
  closest/reference
  closest/cpu
  rays
  inside/angles
  inside
  bodies/pairs
  bodies/convex
  bodies/shape
  gl/device
  gl/polygons
  gl
  gpu/device
  gpu
  closest/engines
  map/statistics
  map/places
  map/transfer
  map
  baking
  registration
  certify/hausdorff
  certify/metrics
  certify/depth
  certify
  simplify
  volume
  bodies/contacts
  bodies/solids
  bodies/pair
  bodies/separate
  bodies/motion
  bodies/many
  bodies
  map/measures
  baking/geometry/mikktspace
  baking/geometry
  summary/verdict
  summary
  io/file
  io/json
  io/shape
  io/image/textures
  io/mesh/polygons
  io/mesh
  io/mesh/frames
  io/mesh/gltf/document
  io/mesh/gltf
  io/mesh/cad
  io/mesh/cad/opencascade
  io/image/pictures
  io/mesh/model
  io/image/views
  io/image
  io/mesh/vertices
  io/fields
  io/points/text
  io/points
  io/page/report
  io/page/baked
  io/page/player
  io/page)

# Another engine is before the table of engines.
file(GLOB engines LIST_DIRECTORIES true RELATIVE ${SOURCE_DIR}/src ${SOURCE_DIR}/src/closest/*)
foreach(engine ${engines})
  if(IS_DIRECTORY ${SOURCE_DIR}/src/${engine} AND NOT engine IN_LIST order)
    list(FIND order closest/engines place)
    list(INSERT order ${place} ${engine})
  endif()
endforeach()

file(GLOB_RECURSE files RELATIVE ${SOURCE_DIR}/src ${SOURCE_DIR}/src/*.h ${SOURCE_DIR}/src/*.cpp)
foreach(file ${files})
  get_filename_component(folder ${file} DIRECTORY)
  list(FIND order "${folder}" place)
  if(place EQUAL -1)
    message(SEND_ERROR "src/${folder} has no place in the order of dependence: ${order}")
    continue()
  endif()
  file(STRINGS ${SOURCE_DIR}/src/${file} includes REGEX "^ *# *include \"")
  foreach(include ${includes})
    string(REGEX REPLACE "^[^\"]*\"([^\"]+)\".*" "\\1" included "${include}")
    get_filename_component(included "${included}" DIRECTORY)
    if(included STREQUAL "")
      message(SEND_ERROR "src/${file}: ${include} does not name the folder of the file")
      continue()
    endif()
    list(FIND order "${included}" included_place)
    if(included_place EQUAL -1 OR included_place GREATER place)
      message(SEND_ERROR "src/${file} may not have ${include}: ${included} is not before ${folder}")
    endif()
    if("${included}" MATCHES "^gl(/|$)" AND NOT "${folder}" MATCHES "^(gl(/|$)|closest/engines$)")
      message(SEND_ERROR "src/${file} may not have ${include}: only the table of engines includes the gl engine")
    endif()
    if("${included}" MATCHES "^gpu(/|$)" AND NOT "${folder}" MATCHES "^(gpu(/|$)|closest/engines$)")
      message(SEND_ERROR "src/${file} may not have ${include}: only the table of engines includes the gpu engine")
    endif()
    if("${included}" MATCHES "^io/mesh/cad/" AND NOT "${folder}" MATCHES "^io/mesh/cad/")
      message(SEND_ERROR "src/${file} may not have ${include}: only the module includes OpenCASCADE")
    endif()
    if(NOT included STREQUAL folder)
      string(MAKE_C_IDENTIFIER "${folder}" key)
      list(APPEND arrows_${key} "${included}")
    endif()
  endforeach()
endforeach()

# A verdict is formed in one place, by the rules and the names of src/core/rules.h.
file(GLOB_RECURSE sources RELATIVE ${SOURCE_DIR} ${SOURCE_DIR}/src/*.cpp ${SOURCE_DIR}/src/*.h ${SOURCE_DIR}/cli/*.cpp
     ${SOURCE_DIR}/cli/*.h ${SOURCE_DIR}/python/src/*.cpp)
list(FILTER sources EXCLUDE REGEX "^src/(summary/|core/rules\\.h)")
foreach(file ${sources})
  file(STRINGS ${SOURCE_DIR}/${file} formed REGEX "[.>]verdict = |\"NOT DECIDED\"")
  if(formed AND NOT file STREQUAL "cli/sequence_distances.cpp")  # copies it
    message(SEND_ERROR "${file}: a verdict is formed in src/summary only: ${formed}")
  endif()
endforeach()

# Searches are policies of tree/visit.h and tree/visit_pairs.h. Only these files outside of tree/ read the nodes of
# a tree by themselves.
set(readers_of_nodes
  certify/depth/leaving.cpp            # the children of a node are parts of its branch and bound
  closest/descent.cpp            # appends all leaves within reach to a list, by vector instructions
  bodies/motion/parts.h             # nodes are divided into faces too, by time
  map/measures/self_measure.cpp  # marks the nodes whose faces are all excluded
  map/measures/thickness_measure.cpp  # bounds the normals below each child of a node
  gpu/packed_sites.cpp           # copies the boxes of all nodes
  gpu/sites_on_device.cpp        # copies and compares the children of all nodes
  inside/angles/expansions.cpp  # computes an expansion for each child of a node
  inside/angles/far_field-inl.h  # one search for several points, eight children at a time
  inside/angles/solid_angles.cpp  # nodes whose errors are too large are opened again
  inside/solid_boundary.cpp      # faces are divided further, nearest first
  bodies/pairs/near_faces.cpp           # bounds the children of a pair, and marks those below a node
  bodies/pairs/pair_search.cpp          # bounds the children of a pair
  bodies/pairs/separating_axis.cpp      # the boxes below the root
  rays/parallel_rays.cpp         # rays from many points have no order of nodes
  rays/trace.cpp                 # segments in a box begin at the nodes that meet it
  bodies/shape/body.cpp                 # the boxes below the root
  bodies/shape/wall_thickness.cpp       # keeps a bound for each node, found on first use
  sites/check_regions.cpp              # compares its leaves with those of regions
  sites/bounding_cylinders.cpp)        # computes a cylinder for each node
foreach(file ${files})
  file(STRINGS ${SOURCE_DIR}/src/${file} reads REGEX "(tree|wide)_?(\\.|->)nodes\\[")
  if(reads AND NOT file MATCHES "^tree/" AND NOT file IN_LIST readers_of_nodes)
    message(SEND_ERROR "src/${file} reads the nodes of a tree: ${reads}. Make its search a policy of tree/visit.h")
  endif()
endforeach()

foreach(folder ${order})
  string(MAKE_C_IDENTIFIER "${folder}" key)
  list(REMOVE_DUPLICATES arrows_${key})
  string(REPLACE ";" " " text "${arrows_${key}}")
  message(STATUS "${folder}: ${text}")
endforeach()
