# Downloads the crate that carries Highway to FILE, an absolute path.
include(${CMAKE_CURRENT_LIST_DIR}/../SdmDownload.cmake)
sdm_download(https://static.crates.io/crates/jpegxl-src/jpegxl-src-0.12.0.crate ${FILE}
  06f56a51e36f688517deebb0b7c10a11c598476936838938495c93764696180a reason)
if(reason)
  message(FATAL_ERROR "build-wasm: ${reason}")
endif()
