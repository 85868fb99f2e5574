# Gives `target` the headers of xsimd. Only the folder is taken from xsimd's package: some
# distributions' targets name libraries to link that headers alone do not need.
function(silt_use_xsimd target)
  find_path(SILT_XSIMD_INCLUDE_DIR xsimd/xsimd.hpp)
  mark_as_advanced(SILT_XSIMD_INCLUDE_DIR)
  if(NOT SILT_XSIMD_INCLUDE_DIR)
    message(FATAL_ERROR "silt needs the headers of xsimd 8 or later "
      "(Debian: apt-get install libxsimd-dev; elsewhere: https://github.com/xtensor-stack/xsimd), "
      "or their folder in SILT_XSIMD_INCLUDE_DIR")
  endif()
  target_include_directories(${target} SYSTEM INTERFACE
    $<BUILD_INTERFACE:${SILT_XSIMD_INCLUDE_DIR}>)
endfunction()
