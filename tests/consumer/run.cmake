# Script: builds and runs the project CONSUMER in the folder WORK.
#   KIND installed:    against this build (BUILD), installed below WORK
#   KIND subdirectory: with this project (SOURCE) as a part of its own, as a shared library; then
#                      against that shared library, installed
function(run)
    execute_process(COMMAND ${ARGN} RESULT_VARIABLE status)
    if(NOT status EQUAL 0)
        string(REPLACE ";" " " command "${ARGN}")
        message(FATAL_ERROR "failed with ${status}: ${command}")
    endif()
endfunction()

function(build_and_run folder)
    run(${CMAKE_COMMAND} -S ${CONSUMER} -B ${folder} -G ${GENERATOR} -DCMAKE_CXX_COMPILER=${CXX}
        -DCMAKE_BUILD_TYPE=${BUILD_TYPE} ${ARGN})
    run(${CMAKE_COMMAND} --build ${folder})
    run(${folder}/consumer)
endfunction()

# The old prefix must go: a file that is no longer installed would still be found in it.
file(REMOVE_RECURSE ${WORK}/prefix ${WORK}/against-prefix)
if(KIND STREQUAL "installed")
    run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${WORK}/prefix)
elseif(KIND STREQUAL "subdirectory")
    build_and_run(${WORK}/inside -DCLINCH_SOURCE=${SOURCE} -DBUILD_SHARED_LIBS=ON -DCLINCH_INSTALL=ON)
    run(${CMAKE_COMMAND} --install ${WORK}/inside --prefix ${WORK}/prefix)
else()
    message(FATAL_ERROR "unknown KIND ${KIND}")
endif()
build_and_run(${WORK}/against-prefix -DCMAKE_PREFIX_PATH=${WORK}/prefix)
