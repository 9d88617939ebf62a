# The C++ example of README.md is compiled and run, and must print what README.md says it prints.
set(readme_source ${CMAKE_CURRENT_BINARY_DIR}/readme/example.cpp)
set(readme_output ${CMAKE_CURRENT_BINARY_DIR}/readme/expected.txt)
add_custom_command(
    OUTPUT ${readme_source} ${readme_output}
    COMMAND ${CMAKE_COMMAND} -DREADME=${PROJECT_SOURCE_DIR}/README.md -DSOURCE=${readme_source} -DOUTPUT=${readme_output}
            -P ${CMAKE_CURRENT_LIST_DIR}/extract.cmake
    DEPENDS ${PROJECT_SOURCE_DIR}/README.md ${CMAKE_CURRENT_LIST_DIR}/extract.cmake
    VERBATIM)
add_executable(clinch_readme_example ${readme_source} ${readme_output})
target_link_libraries(clinch_readme_example PRIVATE clinch)
clinch_warnings(clinch_readme_example)
set(readme_environment)
if("pocl" IN_LIST CLINCH_TEST_IMPLEMENTATIONS)
    set(readme_environment ${only_pocl})
endif()
clinch_test(NAME readme LABEL readme
    COMMAND ${CMAKE_COMMAND} -DPROGRAM=$<TARGET_FILE:clinch_readme_example> -DEXPECTED=${readme_output}
            -P ${CMAKE_CURRENT_LIST_DIR}/compare.cmake
    ENVIRONMENT ${readme_environment})
