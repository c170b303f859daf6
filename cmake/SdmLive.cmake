# live.html: the live page, with the package for npm in it.
include(cmake/SdmReport.cmake)
sdm_npm_ci(${SDM_REPORT_FOLDER} --omit=dev)
set(package ${PROJECT_BINARY_DIR}/package)
file(GLOB sources CONFIGURE_DEPENDS report/src/*.* report/live/*.* report/*.cjs scenes/meshes/*.ply)
add_custom_command(OUTPUT ${PROJECT_BINARY_DIR}/live.html
  COMMAND ${CMAKE_COMMAND} -E env NODE_PATH=${SDM_REPORT_FOLDER}/node_modules
    ${NODE} ${PROJECT_SOURCE_DIR}/report/build_live.cjs ${package} ${PROJECT_BINARY_DIR}/live.html
  DEPENDS ${sources} ${SDM_RULES} ${SDM_REPORT_FOLDER}/packages sdm_npm_package ${package}/sdm_full.wasm ${package}/index.js ${package}/report_page.txt
  COMMENT "Bundling live.html"
  VERBATIM)
add_custom_target(sdm_live_page ALL DEPENDS ${PROJECT_BINARY_DIR}/live.html)
