// silt - BSD-3-Clause, see LICENSE
#pragma once

// Infinity stands for what has no limit (a fixed mass, a plane's radius), NaN for what went wrong.
#if defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__
#error "silt: -ffast-math and -Ofast compute as if no number were infinite or NaN; take -O3"
#endif
// Macros that other libraries define (X11: None), and that would replace words of silt.
#if defined(min) || defined(max)
#error "silt: min or max is a macro here; #undef both before the first header of silt"
#endif
#if defined(None)
#error "silt: None is a macro here, as of X11; include silt first, or #undef None before it"
#endif

/// Whether AVX-512 instructions are executed at their full width. Zen 4 executes each in two halves:
/// 16 floats take as long there as two times 8. It has CLZERO, as all processors of AMD, and lacks
/// AVX-VNNI, unlike Zen 5.
#if defined(__AVX512F__) && !(defined(__CLZERO__) && !defined(__AVXVNNI__))
#define SILT_FULL_AVX512 1
#else
#define SILT_FULL_AVX512 0
#endif

/// SILT_TARGET names the instruction set of the compile flags. All of silt is in an inline
/// namespace of this name, hence units with different flags in one program share no functions.
/// Otherwise the linker would keep one of several functions with the same name, possibly one that
/// the processor cannot run. If two sets of flags get the same name here, define SILT_TARGET
/// yourself.
///
/// Types of silt are therefore different types in units with different targets; types of the user
/// and of the standard library are the same. Of silt only the errors are the same in all units
/// (core/error_types.hpp). Functions of the standard library are shared: link the units with the
/// fewest instructions first. Test: tests/compile/units_apart.py.
#if !defined(SILT_TARGET)
#if SILT_FULL_AVX512
#define SILT_TARGET for_avx512
#elif defined(__AVX512F__)
#define SILT_TARGET for_avx512_halves
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

/// Text of a macro after expansion.
#define SILT_TEXT(macro) SILT_TEXT_AS_IT_IS(macro)
#define SILT_TEXT_AS_IT_IS(text) #text
