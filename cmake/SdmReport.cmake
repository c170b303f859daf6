# The pages of report.html, of maps and of baking, and of player.html: report/ bundled by esbuild into one HTML file each, which the library embeds.
find_program(NPM npm)
find_program(NODE NAMES node nodejs)
if(NOT NODE)
  message(FATAL_ERROR "Node was not found: install nodejs (Debian), or build without report.html: -DSDM_BUILD_REPORT=OFF")
endif()
set(npm_command ${NPM})
if(NOT NPM)
  # Debian's npm comes with 350 packages. Its own archive has all that it needs.
  set(SDM_NPM_ARCHIVE https://registry.npmjs.org/npm/-/npm-10.9.9.tgz CACHE STRING "Where npm is downloaded from if it is not installed")
  mark_as_advanced(SDM_NPM_ARCHIVE)
  set(npm_folder ${PROJECT_BINARY_DIR}/npm)
  set(npm_command ${NODE} ${npm_folder}/package/bin/npm-cli.js)
  if(NOT EXISTS ${npm_folder}/package/bin/npm-cli.js)
    message(STATUS "Downloading npm")
    sdm_download(${SDM_NPM_ARCHIVE} ${npm_folder}/npm.tgz
      c80bd097147cce32e31010b791bab8c71a26a5e10668210ec9d2e7f4c7cea2a1 npm_reason)
    if(npm_reason)
      message(FATAL_ERROR "npm was not found, and ${npm_reason}; install npm (Debian), or build without report.html: -DSDM_BUILD_REPORT=OFF")
    endif()
    file(ARCHIVE_EXTRACT INPUT ${npm_folder}/npm.tgz DESTINATION ${npm_folder})
  endif()
endif()
set(SDM_REPORT_FOLDER ${PROJECT_BINARY_DIR}/report)
set(SDM_RULES ${PROJECT_SOURCE_DIR}/src/core/rules.h ${PROJECT_SOURCE_DIR}/include/sdm/summary.h ${PROJECT_SOURCE_DIR}/report/rules.cjs)

# sdm_npm_ci(<folder> <argument>...): installs the packages of report/package-lock.json into the folder, again only when
# that file changes.
function(sdm_npm_ci folder)
  set(files package.json package-lock.json .npmrc)
  list(TRANSFORM files PREPEND ${PROJECT_SOURCE_DIR}/report/)
  add_custom_command(OUTPUT ${folder}/packages
    COMMAND ${CMAKE_COMMAND} -E make_directory ${folder}
    COMMAND ${CMAKE_COMMAND} -E copy ${files} ${folder}
    COMMAND ${CMAKE_COMMAND} -E chdir ${folder} ${npm_command} ci --silent --ignore-scripts --no-audit --no-fund ${ARGN}
    COMMAND ${CMAKE_COMMAND} -E touch ${folder}/packages
    DEPENDS ${files}
    COMMENT "Installing the packages of report/"
    VERBATIM)
endfunction()

# All packages, those for tests and the documentation site included: the target sdm_dev_packages installs them.
set(SDM_DEV_PACKAGES ${PROJECT_BINARY_DIR}/dev_packages)
if(SDM_BUILD_TESTS OR SDM_BUILD_DOCS)
  sdm_npm_ci(${SDM_DEV_PACKAGES})
  add_custom_command(OUTPUT ${SDM_DEV_PACKAGES}/rules.d.ts
    COMMAND ${NODE} ${PROJECT_SOURCE_DIR}/report/rules.cjs ${SDM_DEV_PACKAGES}
    DEPENDS ${SDM_RULES} ${SDM_DEV_PACKAGES}/packages
    COMMENT "Translating src/core/rules.h"
    VERBATIM)
  add_custom_target(sdm_dev_packages DEPENDS ${SDM_DEV_PACKAGES}/packages ${SDM_DEV_PACKAGES}/rules.d.ts)
endif()

# sdm_embed_report(<target> <header>): builds the pages and embeds them (see sdm_embed_files).
function(sdm_embed_report target header)
  sdm_npm_ci(${SDM_REPORT_FOLDER} --omit=dev)
  file(GLOB sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/report/src/*)
  set(pages ${SDM_REPORT_FOLDER}/page.html ${SDM_REPORT_FOLDER}/player.html ${SDM_REPORT_FOLDER}/baked.html)
  add_custom_command(OUTPUT ${pages}
    COMMAND ${CMAKE_COMMAND} -E env NODE_PATH=${SDM_REPORT_FOLDER}/node_modules
      ${NODE} ${PROJECT_SOURCE_DIR}/report/build.cjs ${SDM_REPORT_FOLDER}
    DEPENDS ${sources} ${PROJECT_SOURCE_DIR}/report/build.cjs ${SDM_RULES} ${SDM_REPORT_FOLDER}/packages
    COMMENT "Bundling report/"
    VERBATIM)
  sdm_embed_files(${target}_objects HEADER ${header} NAMESPACE sdm::io FILES ${pages})
endfunction()
