# Writes package.json with the version of the project, without what only its build needs.
file(READ ${INPUT} text)
string(JSON text SET "${text}" version "\"${VERSION}\"")
string(JSON text REMOVE "${text}" devDependencies)
file(WRITE ${OUTPUT} "${text}\n")
