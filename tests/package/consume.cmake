# cmake -DHOW=find_package|add_subdirectory -DSOURCE=... -DBUILD=... -DWORK=... -DGENERATOR=... [-DOPTIONS=...]
#       -DLONG=ON|OFF -P consume.cmake
# Builds and runs a user's project against silt: installed to a folder of its own, or as a subfolder, which is only
# configured unless LONG is ON.
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
  foreach(file bin/silt share/silt/python/silt/__init__.py share/silt/python/silt/drawing/canvas.py)
    if(NOT EXISTS ${WORK}/prefix/${file})
      message(FATAL_ERROR "${file} of the Python package is not installed")
    endif()
  endforeach()
  # Moved after the installation: nothing may point to where it was.
  file(RENAME ${WORK}/prefix ${WORK}/moved)
  set(where -DCMAKE_PREFIX_PATH=${WORK}/moved)
  # The command finds its package where both are now: it says what is wrong with a file, or lacks numpy.
  execute_process(COMMAND ${WORK}/moved/bin/silt info nothing.pvd RESULT_VARIABLE status ERROR_VARIABLE said)
  if(NOT status EQUAL 2 OR NOT said MATCHES "^silt: ")
    message(FATAL_ERROR "bin/silt ended with ${status}: ${said}")
  endif()
else()
  set(where -DSILT_SOURCE_DIR=${SOURCE})
endif()
run(${CMAKE_COMMAND} -G ${GENERATOR} -S ${SOURCE}/tests/package -B ${WORK}/build -DCMAKE_BUILD_TYPE=Debug ${where} ${OPTIONS})
if(LONG OR HOW STREQUAL "find_package")
  run(${CMAKE_COMMAND} --build ${WORK}/build)
  run(${WORK}/build/consumer)
endif()
file(REMOVE_RECURSE ${WORK})
