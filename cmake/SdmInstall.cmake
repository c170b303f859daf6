# Install rules, and the package that find_package(sdm) finds. Component runtime: the command, and shared libraries;
# devel: what programs are built with. `cmake --install` without --component installs both.
include(CMakePackageConfigHelpers)

get_property(sdm_libraries GLOBAL PROPERTY SDM_LIBRARIES)
install(TARGETS ${sdm_libraries} EXPORT sdm-targets
  RUNTIME COMPONENT runtime
  LIBRARY COMPONENT runtime NAMELINK_COMPONENT devel
  ARCHIVE COMPONENT devel)
install(DIRECTORY include/sdm DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT devel)
install(FILES ${PROJECT_BINARY_DIR}/include/sdm/version.h
        DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/sdm COMPONENT devel)
install(EXPORT sdm-targets NAMESPACE sdm:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/sdm COMPONENT devel)

configure_package_config_file(cmake/sdm-config.cmake.in ${PROJECT_BINARY_DIR}/sdm-config.cmake
  INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/sdm)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/sdm-config-version.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/sdm-config.cmake ${PROJECT_BINARY_DIR}/sdm-config-version.cmake
  DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/sdm COMPONENT devel)

# pkg-config files: sdm, sdm-bodies, sdm-bake, and sdm-io for file input and output.
cmake_path(SET lib_folder NORMALIZE "/${CMAKE_INSTALL_LIBDIR}/pkgconfig")
cmake_path(RELATIVE_PATH lib_folder BASE_DIRECTORY / OUTPUT_VARIABLE lib_folder)
string(REGEX REPLACE "[^/]+" ".." SDM_PC_PREFIX "${lib_folder}")
set(SDM_PC_GL "")
if(SDM_BUILD_GL)
  set(SDM_PC_GL " epoxy")
endif()
set(SDM_PC_LIBS "${CMAKE_DL_LIBS}")
list(TRANSFORM SDM_PC_LIBS PREPEND "-l")
configure_file(cmake/sdm.pc.in ${PROJECT_BINARY_DIR}/sdm.pc @ONLY)
foreach(part bodies bake)
  configure_file(cmake/sdm-part.pc.in ${PROJECT_BINARY_DIR}/sdm-${part}.pc @ONLY)
endforeach()
install(FILES ${PROJECT_BINARY_DIR}/sdm.pc ${PROJECT_BINARY_DIR}/sdm-bodies.pc ${PROJECT_BINARY_DIR}/sdm-bake.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT devel)
if(SDM_BUILD_IO)
  set(SDM_PC_TINYGLTF "")
  if(TinyGLTF_FOUND)
    set(SDM_PC_TINYGLTF " tinygltf")
  endif()
  configure_file(cmake/sdm-io.pc.in ${PROJECT_BINARY_DIR}/sdm-io.pc @ONLY)
  install(FILES ${PROJECT_BINARY_DIR}/sdm-io.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT devel)
endif()
