# sdm_add_library(<name> SOURCES <file>... [LINK <target>...] [LINK_PRIVATE <target>...])
# One static library for one folder of src/: C++20, strict warnings, public headers from include/,
# private headers as "folder/file.h" from src/.
function(sdm_add_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINK;LINK_PRIVATE" ${ARGN})
  add_library(${name} STATIC ${ARG_SOURCES})
  string(REPLACE "sdm_" "" short ${name})
  add_library(sdm::${short} ALIAS ${name})
  set_target_properties(${name} PROPERTIES EXPORT_NAME ${short} POSITION_INDEPENDENT_CODE ON)
  target_include_directories(${name} PUBLIC
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include>
    $<BUILD_INTERFACE:${PROJECT_BINARY_DIR}/include>
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/src>
    $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  target_link_libraries(${name} PUBLIC ${ARG_LINK} PRIVATE ${ARG_LINK_PRIVATE})
  sdm_compile_options(${name})
  set_property(GLOBAL APPEND PROPERTY SDM_LIBRARIES ${name})
endfunction()

# Strict warnings and C++20 for any of the project's targets.
function(sdm_compile_options name)
  target_compile_features(${name} PUBLIC cxx_std_20)
  target_compile_options(${name} PRIVATE -Wall -Wextra -Wshadow -Wconversion -Wno-sign-conversion
    $<$<BOOL:${SDM_WARNINGS_AS_ERRORS}>:-Werror>)
endfunction()
