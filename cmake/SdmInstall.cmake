# Install rules, and the package that find_package(sdm) finds.
include(CMakePackageConfigHelpers)

get_property(sdm_libraries GLOBAL PROPERTY SDM_LIBRARIES)
install(TARGETS ${sdm_libraries} EXPORT sdm-targets)
install(DIRECTORY include/sdm DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(FILES ${PROJECT_BINARY_DIR}/include/sdm/version.h
        DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/sdm)
install(EXPORT sdm-targets NAMESPACE sdm:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/sdm)

configure_package_config_file(cmake/sdm-config.cmake.in ${PROJECT_BINARY_DIR}/sdm-config.cmake
  INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/sdm)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/sdm-config-version.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/sdm-config.cmake ${PROJECT_BINARY_DIR}/sdm-config-version.cmake
  DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/sdm)

# pkg-config files: sdm, and sdm-io for file input and output.
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
install(FILES ${PROJECT_BINARY_DIR}/sdm.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
if(SDM_BUILD_IO)
  configure_file(cmake/sdm-io.pc.in ${PROJECT_BINARY_DIR}/sdm-io.pc @ONLY)
  install(FILES ${PROJECT_BINARY_DIR}/sdm-io.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
endif()
