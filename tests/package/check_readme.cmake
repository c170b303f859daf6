# The program that the README shows is examples/first_map.cpp, which the package test compiles and runs.
file(READ ${SOURCE_DIR}/README.md readme)
file(READ ${SOURCE_DIR}/examples/first_map.cpp program)
string(FIND "${readme}" "```cpp\n${program}```" place)
if(place EQUAL -1)
  message(FATAL_ERROR "README.md does not contain examples/first_map.cpp word for word.")
endif()

# Files that the README and the guide link to exist.
file(GLOB pages ${SOURCE_DIR}/*.md ${SOURCE_DIR}/docs/*.md ${SOURCE_DIR}/docs/*/*.md)
foreach(page ${pages})
  file(READ ${page} text)
  get_filename_component(folder ${page} DIRECTORY)
  # CMake takes brackets in a list for its own.
  string(REPLACE "[" "<" text "${text}")
  string(REPLACE "]" "|" text "${text}")
  string(REGEX MATCHALL "\\|\\([^):#]+\\)" links "${text}")
  foreach(link ${links})
    string(REGEX REPLACE "^\\|\\((.*)\\)$" "\\1" target "${link}")
    if(NOT EXISTS ${folder}/${target})
      message(SEND_ERROR "${page} links to ${target}, which does not exist.")
    endif()
  endforeach()
endforeach()
