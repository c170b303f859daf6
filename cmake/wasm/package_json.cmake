# Writes package.json with the version of the project, without what only its build needs. As text: CMake sorts keys, and the
# order of conditions in `exports` matters.
file(READ ${INPUT} text)
string(REGEX REPLACE "\"version\": \"[^\"]*\"" "\"version\": \"${VERSION}\"" text "${text}")
string(REGEX REPLACE ",\n  \"devDependencies\": {[^}]*}" "" text "${text}")
file(WRITE ${OUTPUT} "${text}")
string(JSON version GET "${text}" version)  # it is JSON
string(JSON unwanted ERROR_VARIABLE none GET "${text}" devDependencies)
if(NOT version STREQUAL VERSION OR unwanted)
  message(FATAL_ERROR "package.json was not written as expected")
endif()
