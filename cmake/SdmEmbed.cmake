# sdm_embed_files(<target> HEADER <header> NAMESPACE <namespace> FILES <file>... [CHECK <command line>...])
# Embeds files into the target as EmbeddedFile constants of a generated header: site_polygon.vert becomes
# kSitePolygonVert. The header is in the build folder that mirrors the calling folder. Paths are relative to the calling
# folder. CHECK: "COMMAND ..." lines that run first; if one fails, so does the build.
function(sdm_embed_files target)
  cmake_parse_arguments(ARG "" "HEADER;NAMESPACE" "FILES;CHECK" ${ARGN})
  set(files)
  foreach(file ${ARG_FILES})
    cmake_path(ABSOLUTE_PATH file NORMALIZE)
    list(APPEND files ${file})
  endforeach()
  set(script ${PROJECT_SOURCE_DIR}/cmake/SdmEmbedFiles.cmake)
  set(output ${CMAKE_CURRENT_BINARY_DIR}/${ARG_HEADER})
  add_custom_command(OUTPUT ${output}
    ${ARG_CHECK}
    COMMAND ${CMAKE_COMMAND} -DHEADER=${output} -DNAMESPACE=${ARG_NAMESPACE} "-DFILES=${files}" -P ${script}
    DEPENDS ${files} ${script}
    COMMENT "Embedding ${ARG_FILES}"
    VERBATIM)
  target_sources(${target} PRIVATE ${output})
  # Of its own, so that it can be built without what the target depends on (./tidy: sdm_embedded).
  cmake_path(GET ARG_HEADER STEM header)
  add_custom_target(${target}_${header} DEPENDS ${output})
  add_dependencies(${target} ${target}_${header})
  if(NOT TARGET sdm_embedded)
    add_custom_target(sdm_embedded)
  endif()
  add_dependencies(sdm_embedded ${target}_${header})
endfunction()
