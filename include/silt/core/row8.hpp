// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cstddef>

#include <silt/core/row4.hpp>

namespace silt::inline SILT_TARGET {

/// Eight floats side by side: a row of motion or of loads in single precision. One register where
/// there is one of 256 bits, else two rows of four.
template <class Arch>
struct Row8 {
#if defined(__AVX__)
  static constexpr bool whole = Row4<Arch>::packs == 1;  // and so one register of eight floats
#else
  static constexpr bool whole = false;
#endif
  using Half = Row4<Arch, float>;
  using Pack = std::conditional_t<whole, typename PackOf<whole ? 8 : 1, float>::type, Half>;
  static constexpr std::size_t packs = whole ? 1 : 2;
  Pack pack[packs];

  static SILT_INLINE Row8 load(const float* aligned) {
    Row8 out;
    for (std::size_t p = 0; p < packs; ++p)
      if constexpr (whole)
        out.pack[p] = silt::load<Pack>(aligned);
      else
        out.pack[p] = Half::load(aligned + 4 * p);
    return out;
  }
  /// The first four entries `low`, the others `high`; or three of each and one of their own.
  static SILT_INLINE Row8 of(float low, float low_last, float high, float high_last) {
    alignas(64) const float values[8] = {low, low, low, low_last, high, high, high, high_last};
    return load(values);
  }
  SILT_INLINE void store(float* aligned) const {
    for (std::size_t p = 0; p < packs; ++p)
      if constexpr (whole)
        silt::store(aligned, pack[p]);
      else
        pack[p].store(aligned + 4 * p);
  }
  friend SILT_INLINE Row8 operator+(Row8 a, const Row8& b) {
    for (std::size_t p = 0; p < packs; ++p) a.pack[p] = a.pack[p] + b.pack[p];
    return a;
  }
  friend SILT_INLINE Row8 operator*(Row8 a, const Row8& b) {
    for (std::size_t p = 0; p < packs; ++p) a.pack[p] = a.pack[p] * b.pack[p];
    return a;
  }
};

/// Turns one row a lane into eight columns: element c of rows[l] = lane l of low[c] or high[c - 4].
template <class Arch>
SILT_INLINE void rows_to_columns(const Row8<Arch> (&rows)[Lanes<Arch, float>::width],
                                 typename Lanes<Arch, float>::Real (&low)[4],
                                 typename Lanes<Arch, float>::Real (&high)[4]) {
  constexpr std::size_t W = Lanes<Arch, float>::width;
  if constexpr (!Row8<Arch>::whole) {
    Row4<Arch, float> half[W];
    for (std::size_t l = 0; l < W; ++l) half[l] = rows[l].pack[0];
    rows_to_columns<Arch>(half, low);
    for (std::size_t l = 0; l < W; ++l) half[l] = rows[l].pack[1];
    rows_to_columns<Arch>(half, high);
    return;
  }
#if defined(__AVX512F__)
  if constexpr (Row8<Arch>::whole && W == 16) {
    __m512 v[2][4];  // two rows in each
    for (int g = 0; g < 2; ++g) {
      for (int k = 0; k < 4; ++k)
        v[g][k] = _mm512_castpd_ps(
            _mm512_insertf64x4(_mm512_castps_pd(_mm512_castps256_ps512(rows[8 * g + k].pack[0])),
                               _mm256_castps_pd(rows[8 * g + k + 4].pack[0]), 1));
      detail::turn(v[g]);
    }
    for (int c = 0; c < 4; ++c) {
      low[c] = _mm512_shuffle_f32x4(v[0][c], v[1][c], 0x88);
      high[c] = _mm512_shuffle_f32x4(v[0][c], v[1][c], 0xdd);
    }
    return;
  }
#endif
#if defined(__AVX__)
  if constexpr (Row8<Arch>::whole && W == 8) {
    __m256 l[4], h[4];
    for (int k = 0; k < 4; ++k) {
      l[k] = _mm256_permute2f128_ps(rows[k].pack[0], rows[k + 4].pack[0], 0x20);
      h[k] = _mm256_permute2f128_ps(rows[k].pack[0], rows[k + 4].pack[0], 0x31);
    }
    detail::turn(l), detail::turn(h);
    for (int c = 0; c < 4; ++c) low[c] = l[c], high[c] = h[c];
  }
#endif
}

/// The way back.
template <class Arch>
SILT_INLINE void columns_to_rows(const typename Lanes<Arch, float>::Real (&low)[4],
                                 const typename Lanes<Arch, float>::Real (&high)[4],
                                 Row8<Arch> (&rows)[Lanes<Arch, float>::width]) {
  constexpr std::size_t W = Lanes<Arch, float>::width;
  if constexpr (!Row8<Arch>::whole) {
    Row4<Arch, float> half[W];
    columns_to_rows<Arch, float>(low, half);
    for (std::size_t l = 0; l < W; ++l) rows[l].pack[0] = half[l];
    columns_to_rows<Arch, float>(high, half);
    for (std::size_t l = 0; l < W; ++l) rows[l].pack[1] = half[l];
    return;
  }
#if defined(__AVX512F__)
  if constexpr (Row8<Arch>::whole && W == 16) {
    const __m512i first = _mm512_setr_epi32(0, 1, 2, 3, 16, 17, 18, 19, 4, 5, 6, 7, 20, 21, 22, 23);
    const __m512i last =
        _mm512_setr_epi32(8, 9, 10, 11, 24, 25, 26, 27, 12, 13, 14, 15, 28, 29, 30, 31);
    for (int g = 0; g < 2; ++g) {
      __m512 v[4];
      for (int c = 0; c < 4; ++c)
        v[c] = _mm512_permutex2var_ps(low[c], g == 0 ? first : last, high[c]);
      detail::turn(v);
      for (int k = 0; k < 4; ++k) {
        rows[8 * g + k].pack[0] = _mm512_castps512_ps256(v[k]);
        rows[8 * g + k + 4].pack[0] =
            _mm256_castpd_ps(_mm512_extractf64x4_pd(_mm512_castps_pd(v[k]), 1));
      }
    }
    return;
  }
#endif
#if defined(__AVX__)
  if constexpr (Row8<Arch>::whole && W == 8) {
    __m256 l[4] = {low[0], low[1], low[2], low[3]}, h[4] = {high[0], high[1], high[2], high[3]};
    detail::turn(l), detail::turn(h);
    for (int k = 0; k < 4; ++k) {
      rows[k].pack[0] = _mm256_permute2f128_ps(l[k], h[k], 0x20);
      rows[k + 4].pack[0] = _mm256_permute2f128_ps(l[k], h[k], 0x31);
    }
  }
#endif
}

}  // namespace silt
