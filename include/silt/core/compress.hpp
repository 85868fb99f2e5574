// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>

#include <silt/core/lanes.hpp>
#include <silt/core/position_row.hpp>

// Compaction: writes the selected lanes of a pack one after the other, without branches.

namespace silt::inline SILT_TARGET::detail {

/// Writes {a, b[lane]} for every lane whose bit is set; returns the end of the output. The output
/// needs space for `Width` pairs, and b must have `Width` entries, for any bits.
template <std::size_t Width>
SILT_INLINE IndexPair* put_pairs(std::uint32_t a, const std::uint32_t* b, std::uint64_t bits,
                                 IndexPair* out) {
#if defined(__AVX512F__)
  if constexpr (Width == 8) {  // without unpredictable branches on the bits
    const __m512i second = _mm512_slli_epi64(
        _mm512_cvtepu32_epi64(_mm256_loadu_si256(reinterpret_cast<const __m256i*>(b))), 32);
    const __m512i pairs = _mm512_or_si512(second, _mm512_set1_epi64(a));
    _mm512_storeu_si512(out, _mm512_maskz_compress_epi64(static_cast<__mmask8>(bits), pairs));
    return out + std::popcount(bits);
  }
#endif
  for (; bits != 0; bits &= bits - 1)
    *out++ = {a, b[static_cast<std::size_t>(std::countr_zero(bits))]};
  return out;
}

/// Writes k + lane for every lane whose bit is set; returns the end of the output.
template <std::size_t Width>
SILT_INLINE std::uint32_t* put_places(std::size_t k, std::uint64_t bits, std::uint32_t* out) {
  const auto first = static_cast<std::uint32_t>(k);
#if defined(__AVX512F__)
  if constexpr (Width == 8) {
    const __m512i places =
        _mm512_add_epi32(_mm512_set1_epi32(static_cast<int>(first)),
                         _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 0, 0, 0, 0, 0, 0, 0, 0));
    _mm256_storeu_si256(
        reinterpret_cast<__m256i*>(out),
        _mm512_castsi512_si256(_mm512_maskz_compress_epi32(static_cast<__mmask16>(bits), places)));
    return out + std::popcount(bits);
  }
  if constexpr (Width == 16) {
    const __m512i places =
        _mm512_add_epi32(_mm512_set1_epi32(static_cast<int>(first)),
                         _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15));
    _mm512_storeu_si512(out, _mm512_maskz_compress_epi32(static_cast<__mmask16>(bits), places));
    return out + std::popcount(bits);
  }
#endif
  for (std::uint32_t lane = 0; lane < Width; ++lane) {
    *out = first + lane;
    out += bits >> lane & 1;
  }
  return out;
}

}  // namespace silt::detail
