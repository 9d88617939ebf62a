# Installing, and what find_package(clinch) reads. Off by itself where clinch is a part of another project.
option(CLINCH_INSTALL "Add clinch to what `cmake --install` installs" ${PROJECT_IS_TOP_LEVEL})
if(NOT CLINCH_INSTALL)
    return()
endif()
include(CMakePackageConfigHelpers)

if(BUILD_SHARED_LIBS)
    set(CLINCH_STATIC OFF)
else()
    set(CLINCH_STATIC ON)
endif()
set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/clinch)
install(TARGETS clinch EXPORT clinch_export
    ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(DIRECTORY include/clinch DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(EXPORT clinch_export NAMESPACE clinch:: FILE clinchTargets.cmake DESTINATION ${package_folder})
configure_package_config_file(cmake/clinchConfig.cmake.in ${CMAKE_CURRENT_BINARY_DIR}/clinchConfig.cmake
    INSTALL_DESTINATION ${package_folder})
write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/clinchConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/clinchConfig.cmake ${CMAKE_CURRENT_BINARY_DIR}/clinchConfigVersion.cmake
    DESTINATION ${package_folder})
if(TARGET clinch_program)  # finds a shared library that is installed beside it
    set_target_properties(clinch_program PROPERTIES INSTALL_RPATH "$ORIGIN/../${CMAKE_INSTALL_LIBDIR}")
endif()
