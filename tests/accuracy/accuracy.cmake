# A short run of clinch_accuracy: no promise is broken, and its JSON has every cell.
clinch_test(NAME accuracy LABEL host
    COMMAND ${CMAKE_COMMAND} -DPROGRAM=$<TARGET_FILE:clinch_accuracy> -DJSON=${CMAKE_CURRENT_BINARY_DIR}/accuracy.json
            -P ${CMAKE_CURRENT_LIST_DIR}/check.cmake
    ENVIRONMENT OCL_ICD_VENDORS=/nonexistent)
