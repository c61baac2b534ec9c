# find_package(dseam) after cmake --install: tests/install has the consumer that proves it.
include(CMakePackageConfigHelpers)

get_property(installed GLOBAL PROPERTY DSEAM_INSTALLED_TARGETS)
install(TARGETS ${installed} EXPORT dseam_targets
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} FILE_SET HEADERS)
install(EXPORT dseam_targets FILE dseam-targets.cmake NAMESPACE dseam:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/dseam)
configure_package_config_file(cmake/dseam-config.cmake.in ${CMAKE_CURRENT_BINARY_DIR}/dseam-config.cmake
  INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/dseam)
write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/dseam-config-version.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/dseam-config.cmake
  ${CMAKE_CURRENT_BINARY_DIR}/dseam-config-version.cmake
  DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/dseam)
if(TARGET dseam)
  install(TARGETS dseam)
endif()
install(FILES docs/weld-link.dbc DESTINATION ${CMAKE_INSTALL_DATADIR}/dseam)
