# MikkTSpace, the C source of tangents: Cargo downloads the crate that carries it into the build folder, once, and compares it
# with the checksum in mikktspace/Cargo.lock. SDM_MIKKTSPACE_SOURCE names a folder that has mikktspace.c instead.
set(SDM_TANGENTS AUTO CACHE STRING "Tangents by MikkTSpace: ON (needs Cargo), OFF, or AUTO: ON if its source is there or Cargo downloads it")
set_property(CACHE SDM_TANGENTS PROPERTY STRINGS AUTO ON OFF)
set(SDM_MIKKTSPACE_SOURCE "" CACHE PATH "A folder with mikktspace.c and mikktspace.h, in place of the one that Cargo downloads")
mark_as_advanced(SDM_MIKKTSPACE_SOURCE)
set(SDM_HAS_TANGENTS OFF)
if(NOT SDM_TANGENTS)
  return()
endif()

set(SDM_MIKKTSPACE_FOLDER ${SDM_MIKKTSPACE_SOURCE})
set(sdm_reason "")
if(NOT SDM_MIKKTSPACE_FOLDER)
  set(SDM_MIKKTSPACE_FOLDER ${PROJECT_BINARY_DIR}/mikktspace/crates/mikktspace-sys-0.1.1/c_code)
  find_program(CARGO cargo)
  mark_as_advanced(CARGO)
  if(NOT EXISTS ${SDM_MIKKTSPACE_FOLDER}/mikktspace.c AND CARGO)
    message(STATUS "Downloading MikkTSpace")
    # Copied, as Cargo may write beside its manifest.
    file(COPY ${CMAKE_CURRENT_LIST_DIR}/mikktspace/ DESTINATION ${PROJECT_BINARY_DIR}/mikktspace/manifest)
    execute_process(
      COMMAND ${CARGO} vendor --quiet --locked --versioned-dirs
              --manifest-path ${PROJECT_BINARY_DIR}/mikktspace/manifest/Cargo.toml
              ${PROJECT_BINARY_DIR}/mikktspace/crates
      WORKING_DIRECTORY ${PROJECT_BINARY_DIR} TIMEOUT 120 OUTPUT_QUIET ERROR_VARIABLE sdm_reason)
  elseif(NOT CARGO)
    set(sdm_reason "Cargo was not found")
  endif()
endif()
if(EXISTS ${SDM_MIKKTSPACE_FOLDER}/mikktspace.c)
  set(SDM_HAS_TANGENTS ON)
elseif(SDM_TANGENTS STREQUAL "AUTO")
  message(STATUS "Without tangents: the source of MikkTSpace is not there (install cargo, or set SDM_MIKKTSPACE_SOURCE)")
else()
  message(FATAL_ERROR "The source of MikkTSpace is not there (${sdm_reason}): install cargo (Debian), or build without tangents: -DSDM_TANGENTS=OFF")
endif()
