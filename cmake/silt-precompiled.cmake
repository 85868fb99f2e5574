# silt_use_precompiled(TARGET): links TARGET to silt::precompiled, and precompiles silt's headers for it
# once, so that a change of a scene compiles in seconds (docs/building.md).
function(silt_use_precompiled target)
  if(NOT TARGET silt::precompiled)
    message(FATAL_ERROR "silt_use_precompiled(${target}): there is no silt::precompiled; configure silt "
      "with -DSILT_PRECOMPILED=ON")
  endif()
  target_link_libraries(${target} PRIVATE silt::precompiled)
  target_precompile_headers(${target} PRIVATE <silt/precompiled.hpp>)
  # GCC forgets in precompiled headers that its intrinsics mean their "__m256d __Y = __Y".
  target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-init-self>)
endfunction()
