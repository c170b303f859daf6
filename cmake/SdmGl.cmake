# What the gl engine needs: libepoxy, and its shaders, validated and embedded.
set(gl_advice "install libepoxy-dev and glslang-tools (Debian), or build without the gl engine: -DSDM_BUILD_GL=OFF")
find_package(PkgConfig)
if(PkgConfig_FOUND)
  pkg_check_modules(EPOXY IMPORTED_TARGET epoxy)
endif()
if(NOT EPOXY_FOUND)
  message(FATAL_ERROR "libepoxy was not found: ${gl_advice}")
endif()
find_program(GLSLANG_VALIDATOR glslangValidator)
if(NOT GLSLANG_VALIDATOR)
  message(FATAL_ERROR "glslangValidator was not found: ${gl_advice}")
endif()

# sdm_embed_shaders(<library> <header> <file>...): compiles the files of shaders/ into the library, as constants of a
# header in the folder of the build that mirrors this one: site_polygon.vert becomes kSitePolygonVert. Vertex and
# fragment shaders of one name are checked to fit. A shader that does not compile fails the build.
function(sdm_embed_shaders target header)
  set(shaders ${ARGN})
  list(TRANSFORM shaders PREPEND ${PROJECT_SOURCE_DIR}/shaders/)
  set(programs ${shaders})
  list(TRANSFORM programs REPLACE "\\.[a-z]+$" "")
  list(REMOVE_DUPLICATES programs)
  set(validations)
  foreach(program ${programs})
    list(APPEND validations COMMAND ${GLSLANG_VALIDATOR} --quiet -l ${program}.vert ${program}.frag)
  endforeach()

  set(script ${PROJECT_SOURCE_DIR}/cmake/SdmEmbedShaders.cmake)
  set(output ${CMAKE_CURRENT_BINARY_DIR}/${header})
  add_custom_command(OUTPUT ${output}
    ${validations}
    COMMAND ${CMAKE_COMMAND} -DHEADER=${output} "-DSHADERS=${shaders}" -P ${script}
    DEPENDS ${shaders} ${script}
    COMMENT "Validating and embedding the shaders"
    VERBATIM)
  target_sources(${target}_objects PRIVATE ${output})
endfunction()
