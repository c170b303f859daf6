# Run by CPack on the files of each package before they are packed: adds the licences and the changes, and compresses these
# and manual pages.
find_program(GZIP gzip REQUIRED)
string(TIMESTAMP date "%a, %d %b %Y %H:%M:%S +0000" UTC)
foreach(component ${CPACK_COMPONENTS_ALL})
  string(TOUPPER ${component} upper)
  set(package ${CPACK_DEBIAN_${upper}_PACKAGE_NAME})
  set(root ${CPACK_TEMPORARY_INSTALL_DIRECTORY}/${component}/usr)
  set(doc ${root}/share/doc/${package})
  file(COPY ${CPACK_SDM_SOURCE_DIR}/packaging/debian/copyright DESTINATION ${doc})
  configure_file(${CPACK_SDM_SOURCE_DIR}/CHANGELOG.md ${doc}/changelog COPYONLY)
  file(WRITE ${doc}/changelog.Debian
"sdm (${CPACK_SDM_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE}) unstable; urgency=medium

  * Version ${CPACK_SDM_VERSION}; changelog.gz lists what has changed.

 -- ${CPACK_DEBIAN_PACKAGE_MAINTAINER}  ${date}
")
  file(GLOB manual_pages ${root}/share/man/*/*.1)
  execute_process(
    COMMAND ${GZIP} -9nf ${doc}/changelog ${doc}/changelog.Debian ${manual_pages} COMMAND_ERROR_IS_FATAL ANY)
endforeach()
