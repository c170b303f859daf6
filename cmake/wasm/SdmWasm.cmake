# What the library needs, for WebAssembly: Highway from its sources, as Debian's has no double precision there, and headers.
set(highway ${SDM_WASM_TOOLS}/highway)
add_library(hwy STATIC ${highway}/hwy/aligned_allocator.cc ${highway}/hwy/per_target.cc ${highway}/hwy/targets.cc ${highway}/hwy/abort.cc)
target_include_directories(hwy SYSTEM PUBLIC ${highway})
target_compile_features(hwy PUBLIC cxx_std_17)
add_library(hwy::hwy ALIAS hwy)

# By links, as /usr/include has the C library of the system besides.
set(headers ${PROJECT_BINARY_DIR}/headers)
file(MAKE_DIRECTORY ${headers})
foreach(header boost eigen3/Eigen fmt nlohmann xxhash.h)
  get_filename_component(name ${header} NAME)
  if(NOT EXISTS /usr/include/${header})
    message(FATAL_ERROR "/usr/include/${header} was not found: run ./setup")
  endif()
  file(CREATE_LINK /usr/include/${header} ${headers}/${name} SYMBOLIC)
endforeach()
add_library(sdm_headers INTERFACE)
target_include_directories(sdm_headers SYSTEM INTERFACE ${headers})
# libc++ has removed a base class that Boost 1.74 uses.
target_compile_definitions(sdm_headers INTERFACE _LIBCPP_ENABLE_CXX17_REMOVED_UNARY_BINARY_FUNCTION)
add_library(Boost::headers ALIAS sdm_headers)
add_library(Eigen3::Eigen ALIAS sdm_headers)
