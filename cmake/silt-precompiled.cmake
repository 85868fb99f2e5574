# silt_use_precompiled(TARGET...): links each TARGET to silt::precompiled, and precompiles silt's headers once for all of
# them, so that a change of a scene compiles in seconds (docs/building.md). Targets of one call need the same flags.
function(silt_use_precompiled first)
  if(NOT TARGET silt::precompiled)
    message(FATAL_ERROR "silt_use_precompiled(${first}): there is no silt::precompiled; configure silt "
      "with -DSILT_PRECOMPILED=ON")
  endif()
  # Several programs share the header of an empty library, so that none of them waits for another, or
  # fails with it.
  if(ARGN)
    set(owner silt_header_of_${first})
    set(empty ${CMAKE_CURRENT_BINARY_DIR}/${owner}.cpp)
    if(NOT EXISTS ${empty})
      file(WRITE ${empty} "")
    endif()
    add_library(${owner} OBJECT ${empty})
    target_compile_options(${owner} PRIVATE $<TARGET_PROPERTY:${first},COMPILE_OPTIONS>)
    target_compile_definitions(${owner} PRIVATE $<TARGET_PROPERTY:${first},COMPILE_DEFINITIONS>)
    silt_use_precompiled(${owner})
  endif()
  foreach(target ${first} ${ARGN})
    target_link_libraries(${target} PRIVATE silt::precompiled)
    # GCC forgets in precompiled headers that its intrinsics mean their "__m256d __Y = __Y".
    target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-init-self>)
    if(ARGN)
      target_precompile_headers(${target} REUSE_FROM ${owner})
    else()
      target_precompile_headers(${target} PRIVATE <silt/precompiled.hpp>)
    endif()
  endforeach()
endfunction()
