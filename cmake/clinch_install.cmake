# Installing, and what find_package(clinch) reads.
include(CMakePackageConfigHelpers)

install(TARGETS clinch EXPORT clinch_export
    ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(DIRECTORY include/clinch DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(EXPORT clinch_export NAMESPACE clinch:: FILE clinchTargets.cmake
    DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/clinch)
configure_package_config_file(cmake/clinchConfig.cmake.in ${CMAKE_CURRENT_BINARY_DIR}/clinchConfig.cmake
    INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/clinch)
write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/clinchConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/clinchConfig.cmake ${CMAKE_CURRENT_BINARY_DIR}/clinchConfigVersion.cmake
    DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/clinch)
