# Makes the target `target`, which is silt::silt with MPI and, where it is found, Zoltan: for
# silt/mpi.hpp. Where MPI is missing there is no target, and SILT_MPI_MISSING says what to install.
function(silt_use_mpi target)
  # Where Open MPI is installed without its headers, as by programs that use it, find_package would end
  # the configuration although it is QUIET.
  find_program(SILT_MPICXX NAMES mpicxx mpic++)
  mark_as_advanced(SILT_MPICXX)
  set(status 0)
  if(SILT_MPICXX)
    execute_process(COMMAND ${SILT_MPICXX} -show RESULT_VARIABLE status OUTPUT_QUIET ERROR_QUIET)
  endif()
  if(status EQUAL 0 AND NOT CMAKE_CROSSCOMPILING)
    set(MPI_CXX_SKIP_MPICXX ON)
    find_package(MPI QUIET COMPONENTS CXX)
  endif()
  if(NOT MPI_CXX_FOUND)
    string(CONCAT missing "silt/mpi.hpp, for many processes, needs MPI (Debian: apt-get install "
      "libopenmpi-dev openmpi-bin)")
    set(SILT_MPI_MISSING ${missing} PARENT_SCOPE)
    return()
  endif()
  set(SILT_MPIRUN ${MPIEXEC_EXECUTABLE} PARENT_SCOPE)
  add_library(${target} INTERFACE ${ARGN})
  target_link_libraries(${target} INTERFACE silt::silt MPI::MPI_CXX)
  # Zoltan's decompositions: silt/mpi.hpp has them where the compiler finds zoltan.h.
  find_path(SILT_ZOLTAN_INCLUDE_DIR zoltan.h PATH_SUFFIXES trilinos)
  find_library(SILT_ZOLTAN_LIBRARY NAMES trilinos_zoltan zoltan)
  mark_as_advanced(SILT_ZOLTAN_INCLUDE_DIR SILT_ZOLTAN_LIBRARY)
  if(SILT_ZOLTAN_INCLUDE_DIR AND SILT_ZOLTAN_LIBRARY)
    target_include_directories(${target} SYSTEM INTERFACE ${SILT_ZOLTAN_INCLUDE_DIR})
    target_link_libraries(${target} INTERFACE ${SILT_ZOLTAN_LIBRARY})
  endif()
endfunction()
