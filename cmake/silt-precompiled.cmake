# silt_use_precompiled(TARGET...): links each TARGET to silt::precompiled, and precompiles silt's headers once for all of
# them, so that a change of a scene compiles in seconds (docs/building.md). Targets of one call need the same flags.
function(silt_use_precompiled first)
  if(NOT TARGET silt::precompiled)
    message(FATAL_ERROR "silt_use_precompiled(${first}): there is no silt::precompiled; configure silt "
      "with -DSILT_PRECOMPILED=ON")
  endif()
  foreach(target ${first} ${ARGN})
    target_link_libraries(${target} PRIVATE silt::precompiled)
    # GCC forgets in precompiled headers that its intrinsics mean their "__m256d __Y = __Y".
    target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-init-self>)
    if(target STREQUAL first)
      target_precompile_headers(${target} PRIVATE <silt/precompiled.hpp>)
    else()
      target_precompile_headers(${target} REUSE_FROM ${first})
    endif()
  endforeach()
endfunction()
