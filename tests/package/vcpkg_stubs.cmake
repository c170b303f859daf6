# cmake -DPORT_DIR=... -DPACKAGES_DIR=... [-DFEATURES=gl] -P vcpkg_stubs.cmake: runs the port's portfile with stand-ins for
# the functions of vcpkg. Configuring is real, so that unknown options and missing dependencies show; nothing is built.
set(PORT sdm)
set(CURRENT_PACKAGES_DIR ${PACKAGES_DIR})

function(vcpkg_check_features)
  cmake_parse_arguments(PARSE_ARGV 0 ARG "" "OUT_FEATURE_OPTIONS" "FEATURES")
  set(options)
  while(ARG_FEATURES)
    list(POP_FRONT ARG_FEATURES feature option)
    list(FIND FEATURES ${feature} place)
    if(place EQUAL -1)
      list(APPEND options -D${option}=OFF)
    else()
      list(APPEND options -D${option}=ON)
    endif()
  endwhile()
  set(${ARG_OUT_FEATURE_OPTIONS} ${options} PARENT_SCOPE)
endfunction()

function(vcpkg_cmake_configure)
  cmake_parse_arguments(PARSE_ARGV 0 ARG "" "SOURCE_PATH" "OPTIONS")
  execute_process(
    COMMAND ${CMAKE_COMMAND} -S ${ARG_SOURCE_PATH} -B ${PACKAGES_DIR}/build ${ARG_OPTIONS}
    COMMAND_ERROR_IS_FATAL ANY OUTPUT_QUIET ERROR_VARIABLE warnings)
  if(warnings MATCHES "not used by the project")
    message(FATAL_ERROR "${warnings}")
  endif()
endfunction()

function(vcpkg_cmake_install)
endfunction()

function(vcpkg_cmake_config_fixup)
  cmake_parse_arguments(PARSE_ARGV 0 ARG "" "CONFIG_PATH" "")
  file(READ ${PACKAGES_DIR}/build/cmake_install.cmake rules)
  string(FIND "${rules}" "/${ARG_CONFIG_PATH}" place)
  if(place EQUAL -1)
    message(FATAL_ERROR "nothing is installed into ${ARG_CONFIG_PATH}")
  endif()
endfunction()

function(vcpkg_fixup_pkgconfig)
endfunction()

function(vcpkg_install_copyright)
  cmake_parse_arguments(PARSE_ARGV 0 ARG "" "" "FILE_LIST")
  file(INSTALL ${ARG_FILE_LIST} DESTINATION ${PACKAGES_DIR}/share/sdm RENAME copyright)
endfunction()

include(${PORT_DIR}/portfile.cmake)
foreach(file copyright usage)
  if(NOT EXISTS ${PACKAGES_DIR}/share/sdm/${file})
    message(FATAL_ERROR "the port does not install ${file}")
  endif()
endforeach()
