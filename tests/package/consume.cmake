# cmake -DHOW=find_package|add_subdirectory -DSOURCE=... -DBUILD=... -DWORK=... -DGENERATOR=... [-DOPTIONS=...]
#       -P consume.cmake
# Builds and runs a user's project against silt: installed to a folder of its own, or as a subfolder.
function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE status OUTPUT_VARIABLE out ERROR_VARIABLE out)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "${ARGN} ended with ${status}:\n${out}")
  endif()
endfunction()

file(REMOVE_RECURSE ${WORK})
if(HOW STREQUAL "find_package")
  run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${WORK}/prefix)
  if(NOT EXISTS ${WORK}/prefix/share/licenses/silt/LICENSE)
    message(FATAL_ERROR "the licence is not installed")
  endif()
  # Moved after the installation: nothing may point to where it was.
  file(RENAME ${WORK}/prefix ${WORK}/moved)
  set(where -DCMAKE_PREFIX_PATH=${WORK}/moved)
else()
  set(where -DSILT_SOURCE_DIR=${SOURCE})
endif()
run(${CMAKE_COMMAND} -G ${GENERATOR} -S ${SOURCE}/tests/package -B ${WORK}/build -DCMAKE_BUILD_TYPE=Debug ${where} ${OPTIONS})
run(${CMAKE_COMMAND} --build ${WORK}/build)
run(${WORK}/build/consumer)
file(REMOVE_RECURSE ${WORK})
