# Meshes of tests come from Debian's packages: CGAL's, unpacked into the folder SDM_TEST_MESHES, and glmark2's.
set(SDM_CGAL_DATA /usr/share/doc/libcgal-dev/data.tar.gz)
set(SDM_TEST_MESHES ${PROJECT_BINARY_DIR}/meshes)
if(NOT EXISTS ${SDM_TEST_MESHES}/data/meshes/armadillo.off)
  file(ARCHIVE_EXTRACT INPUT ${SDM_CGAL_DATA} DESTINATION ${SDM_TEST_MESHES} PATTERNS data/meshes)
endif()
file(COPY /usr/share/glmark2/models/bunny.obj /usr/share/glmark2/models/horse.3ds DESTINATION ${SDM_TEST_MESHES}/data/meshes)
