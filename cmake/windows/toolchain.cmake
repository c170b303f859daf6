# Compiles for Windows with GCC and the C library of MinGW-w64, which Debian has. Programs contain the libraries of GCC, so that they
# need none beside those of Windows, and run in Wine. ./build-windows installs what that needs.
set(CMAKE_SYSTEM_NAME Windows)
set(CMAKE_SYSTEM_PROCESSOR x86_64)
set(SDM_CROSS_TOOLS ${CMAKE_CURRENT_LIST_DIR}/../../build/cross-tools CACHE PATH "Where ./build-windows has installed Highway")
list(APPEND CMAKE_TRY_COMPILE_PLATFORM_VARIABLES SDM_CROSS_TOOLS)
set(CMAKE_C_COMPILER x86_64-w64-mingw32-gcc-posix)
set(CMAKE_CXX_COMPILER x86_64-w64-mingw32-g++-posix)
set(CMAKE_RC_COMPILER x86_64-w64-mingw32-windres)
# GCC aligns no more than 16 bytes on the stack of Windows, but moves vectors of 32 and 64 bytes as if they were aligned (its bug
# 54412): the assembler takes the instructions for unaligned ones instead. Objects have more sections than the usual format holds.
set(CMAKE_CXX_FLAGS_INIT "-Wa,-muse-unaligned-vector-move,-mbig-obj")
set(CMAKE_EXE_LINKER_FLAGS_INIT -static)
cmake_path(ABSOLUTE_PATH CMAKE_CURRENT_LIST_DIR NORMALIZE OUTPUT_VARIABLE sdm_windows)
set(CMAKE_CROSSCOMPILING_EMULATOR ${sdm_windows}/wine)

# Nothing of the system but headers (cmake/cross/SdmSources.cmake).
set(CMAKE_FIND_ROOT_PATH /usr/x86_64-w64-mingw32)
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
