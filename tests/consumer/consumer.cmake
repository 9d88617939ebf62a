# What users do with the library: link the installed one, or add this folder to their project.
set(consumer_environment)
if("pocl" IN_LIST CLINCH_TEST_IMPLEMENTATIONS)
    set(consumer_environment ${only_pocl})
endif()
foreach(kind installed subdirectory)
    clinch_test(NAME consumer-${kind} LABEL consumer
        COMMAND ${CMAKE_COMMAND} -DKIND=${kind} -DSOURCE=${PROJECT_SOURCE_DIR} -DBUILD=${PROJECT_BINARY_DIR}
                -DCONSUMER=${CMAKE_CURRENT_LIST_DIR} -DWORK=${CMAKE_CURRENT_BINARY_DIR}/consumer-${kind}
                -DGENERATOR=${CMAKE_GENERATOR} -DCXX=${CMAKE_CXX_COMPILER} -DBUILD_TYPE=$<CONFIG>
                -P ${CMAKE_CURRENT_LIST_DIR}/run.cmake
        ENVIRONMENT ${consumer_environment})
endforeach()
