# Debian packages by CPack: sdm, the command, and libsdm-dev, the library. They depend on what dpkg-shlibdeps finds, and on
# what programs that link the static libraries need; see docs/packaging.md.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME sdm)
set(CPACK_PACKAGE_VENDOR "The sdm developers")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_DESCRIPTION}")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_ALL runtime devel)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)

set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(SDM_DEBIAN_MAINTAINER "The sdm developers <sdm@example.org>" CACHE STRING "The maintainer whom Debian packages name")
mark_as_advanced(SDM_DEBIAN_MAINTAINER)
set(CPACK_DEBIAN_PACKAGE_MAINTAINER "${SDM_DEBIAN_MAINTAINER}")
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)

set(CPACK_DEBIAN_RUNTIME_PACKAGE_NAME sdm)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_SECTION science)
set(CPACK_COMPONENT_RUNTIME_DESCRIPTION
"The command sdm computes the distance from every point of the surface of one
triangle mesh to another, with the direction and the closest vertex, edge or
face. It inspects scans against their parts, and computes Hausdorff distances,
separation, penetration depth and distance fields.")
set(CPACK_DEBIAN_RUNTIME_PACKAGE_SHLIBDEPS ON)
# Loaded when they are needed: OpenGL for --engine gl, and a software renderer for it.
set(CPACK_DEBIAN_RUNTIME_PACKAGE_RECOMMENDS "libegl1, libgl1, libgl1-mesa-dri")

set(sdm_devel_depends libtbb-dev libhwy-dev libmeshoptimizer-dev)
if(SDM_BUILD_GL)
  list(APPEND sdm_devel_depends libepoxy-dev)
endif()
list(APPEND sdm_devel_depends libopenexr-dev libpng-dev libjpeg62-turbo-dev libwebp-dev libisal-dev liblzf-dev libcairo2-dev libfreetype-dev libfmt-dev libtinygltf-dev)
list(JOIN sdm_devel_depends ", " CPACK_DEBIAN_DEVEL_PACKAGE_DEPENDS)
set(CPACK_DEBIAN_DEVEL_PACKAGE_NAME libsdm-dev)
set(CPACK_DEBIAN_DEVEL_PACKAGE_SECTION libdevel)
set(CPACK_COMPONENT_DEVEL_DESCRIPTION
"Headers, static libraries, and files for CMake and pkg-config to build programs
that compute surface distance maps and exact proximity of triangle meshes.")
# CMake programs find the dependencies through pkg-config.
set(CPACK_DEBIAN_DEVEL_PACKAGE_RECOMMENDS "pkg-config")

# What Debian expects of every package besides: its licences, its changes and compressed manual pages.
set(CPACK_PRE_BUILD_SCRIPTS ${PROJECT_SOURCE_DIR}/packaging/debian/complete.cmake)
set(CPACK_SDM_SOURCE_DIR ${PROJECT_SOURCE_DIR})
set(CPACK_SDM_VERSION ${PROJECT_VERSION})

include(CPack)
