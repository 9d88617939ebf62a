# Settings shared by the project's targets.

# Warnings, and sanitizers when asked for.
function(clinch_warnings target)
    target_compile_options(${target} PRIVATE -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wsign-conversion)
    if(CLINCH_WARNINGS_AS_ERRORS)
        target_compile_options(${target} PRIVATE -Werror)
    endif()
    if(CLINCH_SANITIZE)
        target_compile_options(${target} PRIVATE -fsanitize=${CLINCH_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer
            -Wno-maybe-uninitialized)  # which GCC reports falsely under sanitizers
        target_link_options(${target} PUBLIC -fsanitize=${CLINCH_SANITIZE})
    endif()
endfunction()

# Writes `output`, a C++ file that holds the text of each of `files` (paths below `root`).
function(clinch_embed_kernels root output files)
    list(TRANSFORM files PREPEND ${root}/ OUTPUT_VARIABLE paths)
    add_custom_command(
        OUTPUT ${output}
        COMMAND ${CMAKE_COMMAND} -DROOT=${root} -DOUTPUT=${output} "-DFILES=${files}"
                -P ${CMAKE_CURRENT_SOURCE_DIR}/cmake/embed_kernels.cmake
        DEPENDS ${paths} ${CMAKE_CURRENT_SOURCE_DIR}/cmake/embed_kernels.cmake
        VERBATIM)
endfunction()
