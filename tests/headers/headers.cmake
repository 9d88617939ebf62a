# Each public header must compile alone, twice, and bring in no library that it may not.
file(GLOB_RECURSE public_headers CONFIGURE_DEPENDS RELATIVE ${PROJECT_SOURCE_DIR}/include
    ${PROJECT_SOURCE_DIR}/include/clinch/*.hpp)
set(header_sources)
foreach(header IN LISTS public_headers)
    string(MAKE_C_IDENTIFIER ${header} identifier)
    string(TOUPPER ${identifier} allowed)
    set(source ${CMAKE_CURRENT_BINARY_DIR}/headers/${identifier}.cpp)
    configure_file(${CMAKE_CURRENT_LIST_DIR}/alone.cpp.in ${source} @ONLY)
    list(APPEND header_sources ${source})
endforeach()
add_library(clinch_headers OBJECT EXCLUDE_FROM_ALL ${header_sources})
target_link_libraries(clinch_headers PRIVATE clinch Eigen3::Eigen)
clinch_warnings(clinch_headers)
clinch_test(NAME headers LABEL headers
    COMMAND ${CMAKE_COMMAND} --build ${CMAKE_BINARY_DIR} --target clinch_headers)
