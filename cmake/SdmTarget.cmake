# sdm_omit_instructions(<file>...): of what Highway compiles once for each set of instructions, omits those that are not worth
# the time of compiling them (docs/design/cpu.md). A definition of the files, not of their target: it would be part of the
# precompiled header, and then of every file.
set(SDM_OMIT_INSTRUCTIONS "HWY_SSSE3|HWY_SSE4" CACHE STRING "Sets of instructions that are not compiled for, as HWY_DISABLED_TARGETS")
mark_as_advanced(SDM_OMIT_INSTRUCTIONS)
function(sdm_omit_instructions)
  set_property(SOURCE ${ARGN} APPEND PROPERTY COMPILE_DEFINITIONS
    "HWY_DISABLED_TARGETS=(${SDM_OMIT_INSTRUCTIONS}$<$<BOOL:$<TARGET_PROPERTY:SDM_SANITIZED>>:|HWY_AVX3>)")
endfunction()

# sdm_divide_sources(<target> <file>...): with SDM_UNITE_FOLDERS, compiles the sources of a folder of src/ as one, with those
# of its subfolders, which takes about half the time, as they share most of their headers. Names in unnamed namespaces are
# unique in such a folder. io has one for each of its folders; those of images and pages have one for each subfolder.
# What is compiled for each set of instructions stays on its own.
function(sdm_divide_sources target)
  if(SDM_UNITE_FOLDERS)
    set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
    # Sources that are included are taken for headers, whose classes should not use unnamed namespaces.
    target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
  endif()
  foreach(source ${ARGN})
    file(STRINGS ${source} includes_itself REGEX "^#define HWY_TARGET_INCLUDE")
    if(includes_itself)
      sdm_omit_instructions(${source})
      set_source_files_properties(${source} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
    else()
      get_filename_component(folder ${source} DIRECTORY)
      if(NOT folder MATCHES "^(io/(image|page)|bodies)")
        string(REGEX REPLACE "^((io/)?[^/]+)/.*" "\\1" folder "${folder}/")
      endif()
      string(MAKE_C_IDENTIFIER "folder_${folder}" group)
      set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${group})
    endif()
  endforeach()
endfunction()

# sdm_object_properties(<objects>): of objects that are part of a library.
function(sdm_object_properties objects)
  set_target_properties(${objects} PROPERTIES POSITION_INDEPENDENT_CODE ON)
  if(NOT BUILD_SHARED_LIBS)
    set_target_properties(${objects} PROPERTIES CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
  endif()
endfunction()

# sdm_add_library(<name> SOURCES <file>... [LINK <target>...] [LINK_PRIVATE <target>...])
# Adds the exported library sdm::<name without sdm_>, static or shared as set by BUILD_SHARED_LIBS, from the object
# library <name>_objects. Internal headers are on no user's include path: tests and benchmarks of internals link
# <name>_internals, which adds it. A shared library exports its internals, too, as the other libraries of the project use them; a
# program that contains a static one exports what is SDM_API only.
function(sdm_add_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINK;LINK_PRIVATE" ${ARGN})
  set(internal_folders ${PROJECT_SOURCE_DIR}/src ${PROJECT_BINARY_DIR}/src)
  add_library(${name}_objects OBJECT ${ARG_SOURCES})
  sdm_divide_sources(${name}_objects ${ARG_SOURCES})
  target_include_directories(${name}_objects
    PUBLIC ${PROJECT_SOURCE_DIR}/include ${PROJECT_BINARY_DIR}/include
    PRIVATE ${internal_folders})
  sdm_object_properties(${name}_objects)
  target_link_libraries(${name}_objects PRIVATE ${ARG_LINK} ${ARG_LINK_PRIVATE})
  sdm_compile_options(${name}_objects)

  add_library(${name} $<TARGET_OBJECTS:${name}_objects>)
  string(REGEX REPLACE "^sdm_" "" short ${name})
  add_library(sdm::${short} ALIAS ${name})
  set_target_properties(${name} PROPERTIES
    EXPORT_NAME ${short} LINKER_LANGUAGE CXX VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
  target_include_directories(${name} PUBLIC
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include>
    $<BUILD_INTERFACE:${PROJECT_BINARY_DIR}/include>
    $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  target_compile_features(${name} PUBLIC cxx_std_20)
  target_link_libraries(${name} PUBLIC ${ARG_LINK} PRIVATE ${ARG_LINK_PRIVATE})

  add_library(${name}_internals INTERFACE)
  target_include_directories(${name}_internals INTERFACE ${internal_folders})
  target_link_libraries(${name}_internals INTERFACE ${name})
  set_property(GLOBAL APPEND PROPERTY SDM_LIBRARIES ${name})
endfunction()

# sdm_add_sanitized(<objects>): with SDM_ALL_TESTS, adds <objects>_sanitized, which has the sources and the properties
# of the object library, with AddressSanitizer and UndefinedBehaviorSanitizer and for fewer instruction sets. Call it in the
# folder of the object library, after all is set.
set(SDM_SANITIZERS -fsanitize=address,undefined -fno-sanitize=null,alignment,object-size -fno-sanitize-recover=all
  -fno-omit-frame-pointer)
function(sdm_add_sanitized objects)
  if(NOT SDM_ALL_TESTS)
    return()
  endif()
  if(BUILD_SHARED_LIBS)
    message(FATAL_ERROR "SDM_ALL_TESTS needs static libraries: BUILD_SHARED_LIBS must be OFF")
  endif()
  set(name ${objects}_sanitized)
  get_target_property(sources ${objects} SOURCES)
  add_library(${name} OBJECT ${sources})
  foreach(property INCLUDE_DIRECTORIES LINK_LIBRARIES COMPILE_DEFINITIONS COMPILE_FEATURES COMPILE_OPTIONS PRECOMPILE_HEADERS
      UNITY_BUILD UNITY_BUILD_MODE POSITION_INDEPENDENT_CODE CXX_VISIBILITY_PRESET VISIBILITY_INLINES_HIDDEN)
    get_target_property(value ${objects} ${property})
    if(NOT value STREQUAL "value-NOTFOUND")
      set_target_properties(${name} PROPERTIES ${property} "${value}")
    endif()
  endforeach()
  set_target_properties(${name} PROPERTIES SDM_SANITIZED ON)
  target_compile_options(${name} PRIVATE ${SDM_SANITIZERS} -O1 -g1)
  add_dependencies(${name} ${objects})  # for the headers that the build makes
endfunction()

# sdm_link_private(<name> <target>...): links further private dependencies to a library of sdm_add_library.
function(sdm_link_private name)
  target_link_libraries(${name}_objects PRIVATE ${ARGN})
  target_link_libraries(${name} PRIVATE ${ARGN})
endfunction()

# Sets strict warnings and C++20 for a target of the project.
function(sdm_compile_options name)
  target_compile_features(${name} PUBLIC cxx_std_20)
  if(SDM_WARNINGS)
    target_compile_options(${name} PRIVATE -Wall -Wextra -Wshadow -Wconversion -Wno-sign-conversion
      $<$<BOOL:${SDM_WARNINGS_AS_ERRORS}>:-Werror>)
  endif()
  # GCC looks for unused memory whenever it has taken this many KiB: from 128 MiB on by default, a tenth of its time.
  target_compile_options(${name} PRIVATE $<$<CXX_COMPILER_ID:GNU>:--param=ggc-min-heapsize=524288>)
endfunction()

# For the targets of a folder that have precompiled headers: ccache keeps their objects only with this setting.
macro(sdm_cache_precompiled_headers)
  if(CMAKE_CXX_COMPILER_LAUNCHER MATCHES "ccache$")
    set(CMAKE_CXX_COMPILER_LAUNCHER
      ${CMAKE_COMMAND} -E env CCACHE_SLOPPINESS=pch_defines,time_macros ${CMAKE_CXX_COMPILER_LAUNCHER})
  endif()
endmacro()

# Lets JSON end the program by std::terminate() where it finds itself half-made, as where memory ends while an object is made,
# instead of reading on: the command then removes its files (cli/main.cpp).
function(sdm_check_json name)
  target_compile_options(${name} PRIVATE "-DJSON_ASSERT(x)=((x)?static_cast<void>(0):std::terminate())")
endfunction()
