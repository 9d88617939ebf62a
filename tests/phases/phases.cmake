# A short run of clinch_phases and of the script that reads what it writes; the script's part needs Python.
find_program(CLINCH_PYTHON NAMES python3)
mark_as_advanced(CLINCH_PYTHON)
clinch_test(NAME phases LABEL pocl
    COMMAND ${CMAKE_COMMAND} -DPROGRAM=$<TARGET_FILE:clinch_phases> -DJSON=${CMAKE_CURRENT_BINARY_DIR}/phases.json
        -DSCRIPT=${PROJECT_SOURCE_DIR}/bench/plot_phases.py "-DPYTHON=$<$<BOOL:${CLINCH_PYTHON}>:${CLINCH_PYTHON}>"
        -P ${CMAKE_CURRENT_LIST_DIR}/check.cmake
    ENVIRONMENT ${only_pocl})
