# sdm_python_environment(<variable>): sets the variable to the interpreter of a virtual environment in the build folder with
# the packages of requirements.txt. It sees the packages of the system, so that pip installs only what Debian lacks, and is
# made again when requirements.txt changes.
function(sdm_python_environment variable)
  find_program(SDM_PYTHON python3 PATHS /usr/bin NO_DEFAULT_PATH DOC "The interpreter that the Python package is built for")
  find_program(SDM_PYTHON python3 REQUIRED)
  set(environment ${CMAKE_CURRENT_BINARY_DIR}/environment)
  set(requirements ${CMAKE_CURRENT_SOURCE_DIR}/requirements.txt)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${requirements})
  file(SHA256 ${requirements} wanted)
  set(wanted "${wanted} ${SDM_PYTHON}")
  set(present "")
  if(EXISTS ${environment}/made_from)
    file(READ ${environment}/made_from present)
  endif()
  if(NOT present STREQUAL wanted)
    message(STATUS "Installing Python packages into ${environment}")
    execute_process(COMMAND ${SDM_PYTHON} -m venv --clear --system-site-packages ${environment} COMMAND_ERROR_IS_FATAL ANY)
    execute_process(
      COMMAND ${environment}/bin/python -m pip install --quiet --disable-pip-version-check -r ${requirements}
      COMMAND_ERROR_IS_FATAL ANY)
    file(WRITE ${environment}/made_from "${wanted}")
  endif()
  set(${variable} ${environment}/bin/python PARENT_SCOPE)
endfunction()
