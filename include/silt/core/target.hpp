// silt - BSD-3-Clause, see LICENSE
#pragma once

/// SILT_TARGET names the instruction set of the compile flags. All of silt stands in an inline
/// namespace of this name, so that units with other flags in one program share no function: the
/// linker keeps one of those with the same name, and that may be the one that the machine at hand
/// cannot run. For flags that differ but make the same name here, set a name of your own.
///
/// A silt type of one unit is hence not that of another; a type of yours, or of the standard
/// library, is. Errors alone are the same in all units (core/error_types.hpp). Functions of the
/// standard library are shared: link the units with the fewest instructions first. Test:
/// tests/compile/units_apart.py.
#if !defined(SILT_TARGET)
#if defined(__AVX512F__)
#define SILT_TARGET for_avx512
#elif defined(__AVX2__) && defined(__FMA__)
#define SILT_TARGET for_avx2_fma
#elif defined(__AVX2__)
#define SILT_TARGET for_avx2
#elif defined(__AVX__)
#define SILT_TARGET for_avx
#elif defined(__SSE4_2__)
#define SILT_TARGET for_sse4_2
#elif defined(__SSE4_1__)
#define SILT_TARGET for_sse4_1
#elif defined(__SSSE3__)
#define SILT_TARGET for_ssse3
#elif defined(__SSE2__)
#define SILT_TARGET for_sse2
#elif defined(__ARM_NEON)
#define SILT_TARGET for_neon
#else
#define SILT_TARGET for_any
#endif
#endif

/// The text of what a macro stands for.
#define SILT_TEXT(macro) SILT_TEXT_AS_IT_IS(macro)
#define SILT_TEXT_AS_IT_IS(text) #text
