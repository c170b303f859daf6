# The pages of report.html and player.html: report/ bundled by esbuild into one HTML file each, which the library embeds.
find_program(NPM npm)
find_program(NODE NAMES node nodejs)
if(NOT NPM OR NOT NODE)
  message(FATAL_ERROR "npm was not found: install npm (Debian), or build without report.html: -DSDM_BUILD_REPORT=OFF")
endif()
set(SDM_REPORT_FOLDER ${PROJECT_BINARY_DIR}/report)

# sdm_npm_ci(<folder> <argument>...): installs the packages of report/package-lock.json into the folder, again only when
# that file changes.
function(sdm_npm_ci folder)
  set(files package.json package-lock.json .npmrc)
  list(TRANSFORM files PREPEND ${PROJECT_SOURCE_DIR}/report/)
  add_custom_command(OUTPUT ${folder}/packages
    COMMAND ${CMAKE_COMMAND} -E make_directory ${folder}
    COMMAND ${CMAKE_COMMAND} -E copy ${files} ${folder}
    COMMAND ${CMAKE_COMMAND} -E chdir ${folder} ${NPM} ci --silent --ignore-scripts --no-audit --no-fund ${ARGN}
    COMMAND ${CMAKE_COMMAND} -E touch ${folder}/packages
    DEPENDS ${files}
    COMMENT "Installing the packages of report/"
    VERBATIM)
endfunction()

# sdm_embed_report(<target> <header>): builds the pages and embeds them (see sdm_embed_files).
function(sdm_embed_report target header)
  sdm_npm_ci(${SDM_REPORT_FOLDER} --omit=dev)
  file(GLOB sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/report/src/*)
  add_custom_command(OUTPUT ${SDM_REPORT_FOLDER}/page.html ${SDM_REPORT_FOLDER}/player.html
    COMMAND ${CMAKE_COMMAND} -E env NODE_PATH=${SDM_REPORT_FOLDER}/node_modules
      ${NODE} ${PROJECT_SOURCE_DIR}/report/build.cjs ${SDM_REPORT_FOLDER}
    DEPENDS ${sources} ${PROJECT_SOURCE_DIR}/report/build.cjs ${SDM_REPORT_FOLDER}/packages
    COMMENT "Bundling report/"
    VERBATIM)
  sdm_embed_files(${target}_objects HEADER ${header} NAMESPACE sdm::io FILES ${SDM_REPORT_FOLDER}/page.html ${SDM_REPORT_FOLDER}/player.html)
endfunction()
