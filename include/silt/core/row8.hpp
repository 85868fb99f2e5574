// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cstddef>

#include <silt/core/row4.hpp>

namespace silt::inline SILT_TARGET {

/// Whether an architecture has registers of eight such scalars whose rows it can transpose.
template <class Arch, class Scalar>
inline constexpr bool has_row8 =
#if defined(__AVX512F__)
    Lanes<Arch>::width == 8 ||
#endif
#if defined(__AVX__)
    (Lanes<Arch>::width == 4 && std::is_same_v<Scalar, float>) ||
#endif
    false;

/// Eight scalars in one register: a row of motion or of loads.
template <class Arch, class Scalar>
struct Row8 {
  static_assert(has_row8<Arch, Scalar>);
  using Pack = typename PackOf<8, Scalar>::type;
  Pack pack;

  static SILT_INLINE Row8 load(const Scalar* aligned) { return {silt::load<Pack>(aligned)}; }
  /// Three entries `low` and their last one, three `high` and their last one.
  static SILT_INLINE Row8 of(Scalar low, Scalar low_last, Scalar high, Scalar high_last) {
    alignas(64) const Scalar values[8] = {low, low, low, low_last, high, high, high, high_last};
    return load(values);
  }
#if defined(__AVX__)
  /// Two rows of four, the first one low.
  static SILT_INLINE Row8 of(const Row4<Arch, Scalar>& low, const Row4<Arch, Scalar>& high) {
    return {detail::side_by_side(low.pack[0], high.pack[0])};
  }
#endif
  SILT_INLINE void store(Scalar* aligned) const { silt::store(aligned, pack); }
  friend SILT_INLINE Row8 operator+(const Row8& a, const Row8& b) { return {a.pack + b.pack}; }
  friend SILT_INLINE Row8 operator*(const Row8& a, const Row8& b) { return {a.pack * b.pack}; }
};

/// Transposes one row per lane to eight columns: element c of rows[l] = lane l of low[c] or high[c
/// - 4].
template <class Arch, class Scalar>
SILT_INLINE void rows_to_columns(
    [[maybe_unused]] const Row8<Arch, Scalar> (&rows)[Lanes<Arch, Scalar>::width],
    [[maybe_unused]] typename Lanes<Arch, Scalar>::Real (&low)[4],
    [[maybe_unused]] typename Lanes<Arch, Scalar>::Real (&high)[4]) {
#if defined(__AVX512F__)
  if constexpr (Lanes<Arch>::width == 8 && std::is_same_v<Scalar, double>) {
    __m512d v[2][4];
    for (int g = 0; g < 2; ++g) {
      for (int k = 0; k < 4; ++k) v[g][k] = rows[4 * g + k].pack;
      detail::turn(v[g]);
    }
    for (int c = 0; c < 4; ++c) {
      low[c] = _mm512_shuffle_f64x2(v[0][c], v[1][c], 0x44);
      high[c] = _mm512_shuffle_f64x2(v[0][c], v[1][c], 0xee);
    }
  } else if constexpr (Lanes<Arch>::width == 8) {
    __m512 v[2][4];  // two rows in each
    for (int g = 0; g < 2; ++g) {
      for (int k = 0; k < 4; ++k)
        v[g][k] = _mm512_castpd_ps(
            _mm512_insertf64x4(_mm512_castps_pd(_mm512_castps256_ps512(rows[8 * g + k].pack)),
                               _mm256_castps_pd(rows[8 * g + k + 4].pack), 1));
      detail::turn(v[g]);
    }
    for (int c = 0; c < 4; ++c) {
      low[c] = _mm512_shuffle_f32x4(v[0][c], v[1][c], 0x88);
      high[c] = _mm512_shuffle_f32x4(v[0][c], v[1][c], 0xdd);
    }
  }
#endif
#if defined(__AVX__)
  if constexpr (Lanes<Arch>::width == 4) {
    __m256 l[4], h[4];
    for (int k = 0; k < 4; ++k) {
      l[k] = _mm256_permute2f128_ps(rows[k].pack, rows[k + 4].pack, 0x20);
      h[k] = _mm256_permute2f128_ps(rows[k].pack, rows[k + 4].pack, 0x31);
    }
    detail::turn(l), detail::turn(h);
    for (int c = 0; c < 4; ++c) low[c] = l[c], high[c] = h[c];
  }
#endif
}

/// The reverse.
template <class Arch, class Scalar>
SILT_INLINE void columns_to_rows(
    [[maybe_unused]] const typename Lanes<Arch, Scalar>::Real (&low)[4],
    [[maybe_unused]] const typename Lanes<Arch, Scalar>::Real (&high)[4],
    [[maybe_unused]] Row8<Arch, Scalar> (&rows)[Lanes<Arch, Scalar>::width]) {
#if defined(__AVX512F__)
  if constexpr (Lanes<Arch>::width == 8 && std::is_same_v<Scalar, double>) {
    for (int g = 0; g < 2; ++g) {
      __m512d v[4];
      for (int c = 0; c < 4; ++c)
        v[c] = g == 0 ? _mm512_shuffle_f64x2(low[c], high[c], 0x44)
                      : _mm512_shuffle_f64x2(low[c], high[c], 0xee);
      detail::turn(v);
      for (int k = 0; k < 4; ++k) rows[4 * g + k].pack = v[k];
    }
  } else if constexpr (Lanes<Arch>::width == 8) {
    const __m512i first = _mm512_setr_epi32(0, 1, 2, 3, 16, 17, 18, 19, 4, 5, 6, 7, 20, 21, 22, 23);
    const __m512i last =
        _mm512_setr_epi32(8, 9, 10, 11, 24, 25, 26, 27, 12, 13, 14, 15, 28, 29, 30, 31);
    for (int g = 0; g < 2; ++g) {
      __m512 v[4];
      for (int c = 0; c < 4; ++c)
        v[c] = _mm512_permutex2var_ps(low[c], g == 0 ? first : last, high[c]);
      detail::turn(v);
      for (int k = 0; k < 4; ++k) {
        rows[8 * g + k].pack = _mm512_castps512_ps256(v[k]);
        rows[8 * g + k + 4].pack =
            _mm256_castpd_ps(_mm512_extractf64x4_pd(_mm512_castps_pd(v[k]), 1));
      }
    }
  }
#endif
#if defined(__AVX__)
  if constexpr (Lanes<Arch>::width == 4) {
    __m256 l[4] = {low[0], low[1], low[2], low[3]}, h[4] = {high[0], high[1], high[2], high[3]};
    detail::turn(l), detail::turn(h);
    for (int k = 0; k < 4; ++k) {
      rows[k].pack = _mm256_permute2f128_ps(l[k], h[k], 0x20);
      rows[k + 4].pack = _mm256_permute2f128_ps(l[k], h[k], 0x31);
    }
  }
#endif
}

}  // namespace silt
