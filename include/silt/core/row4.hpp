// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cstddef>

#include <silt/core/lanes.hpp>

namespace silt {

/// Four doubles side by side, as rows of particles and loads keep them: one register of four, two
/// of two, or four plain doubles, by the architecture.
template <class Arch>
struct Row4 {
  static constexpr std::size_t width = std::min<std::size_t>(Lanes<Arch>::width, 4);
  using Pack = typename PackOf<width>::type;
  static constexpr std::size_t packs = 4 / width;
  Pack pack[packs];

  static SILT_INLINE Row4 load(const double* aligned) {
    Row4 out;
    for (std::size_t p = 0; p < packs; ++p) out.pack[p] = silt::load<Pack>(aligned + p * width);
    return out;
  }
  static SILT_INLINE Row4 all(double value) {
    Row4 out;
    for (auto& p : out.pack) p = Pack(value);
    return out;
  }
  static SILT_INLINE Row4 of(double x, double y, double z, double w) {
    alignas(Pack) const double values[4] = {x, y, z, w};
    return load(values);
  }
  SILT_INLINE void store(double* aligned) const {
    for (std::size_t p = 0; p < packs; ++p) silt::store(aligned + p * width, pack[p]);
  }
  friend SILT_INLINE Row4 operator+(Row4 a, const Row4& b) {
    for (std::size_t p = 0; p < packs; ++p) a.pack[p] = a.pack[p] + b.pack[p];
    return a;
  }
  friend SILT_INLINE Row4 operator-(Row4 a, const Row4& b) {
    for (std::size_t p = 0; p < packs; ++p) a.pack[p] = a.pack[p] - b.pack[p];
    return a;
  }
  friend SILT_INLINE Row4 operator*(Row4 a, const Row4& b) {
    for (std::size_t p = 0; p < packs; ++p) a.pack[p] = a.pack[p] * b.pack[p];
    return a;
  }
};

namespace detail {

#if defined(__AVX512F__)
/// Two rows of four registers each of two halves: within each half, columns of the 2x(4x4) block.
SILT_INLINE void turn_halves(__m512d (&v)[4]) {
  const __m512i low = _mm512_setr_epi64(0, 1, 8, 9, 4, 5, 12, 13);
  const __m512i high = _mm512_setr_epi64(2, 3, 10, 11, 6, 7, 14, 15);
  const __m512d even01 = _mm512_unpacklo_pd(v[0], v[1]), odd01 = _mm512_unpackhi_pd(v[0], v[1]);
  const __m512d even23 = _mm512_unpacklo_pd(v[2], v[3]), odd23 = _mm512_unpackhi_pd(v[2], v[3]);
  v[0] = _mm512_permutex2var_pd(even01, low, even23);
  v[1] = _mm512_permutex2var_pd(odd01, low, odd23);
  v[2] = _mm512_permutex2var_pd(even01, high, even23);
  v[3] = _mm512_permutex2var_pd(odd01, high, odd23);
}
#endif
#if defined(__AVX__)
SILT_INLINE void turn_square(__m256d (&v)[4]) {
  const __m256d even01 = _mm256_unpacklo_pd(v[0], v[1]), odd01 = _mm256_unpackhi_pd(v[0], v[1]);
  const __m256d even23 = _mm256_unpacklo_pd(v[2], v[3]), odd23 = _mm256_unpackhi_pd(v[2], v[3]);
  v[0] = _mm256_permute2f128_pd(even01, even23, 0x20);
  v[1] = _mm256_permute2f128_pd(odd01, odd23, 0x20);
  v[2] = _mm256_permute2f128_pd(even01, even23, 0x31);
  v[3] = _mm256_permute2f128_pd(odd01, odd23, 0x31);
}
#endif

}  // namespace detail

/// Turns one row a lane into four columns: lane l of columns[c] = element c of rows[l].
template <class Arch>
SILT_INLINE void rows_to_columns(const Row4<Arch> (&rows)[Lanes<Arch>::width],
                                 typename Lanes<Arch>::Real (&columns)[4]) {
  constexpr std::size_t W = Lanes<Arch>::width;
  if constexpr (W == 1) {
    for (std::size_t c = 0; c < 4; ++c) columns[c] = rows[0].pack[c];
    return;
  }
#if defined(__AVX512F__)
  if constexpr (W == 8) {
    __m512d v[4];
    for (int k = 0; k < 4; ++k)
      v[k] = _mm512_insertf64x4(_mm512_castpd256_pd512(rows[k].pack[0]), rows[k + 4].pack[0], 1);
    detail::turn_halves(v);
    for (int c = 0; c < 4; ++c) columns[c] = v[c];
    return;
  }
#endif
#if defined(__AVX__)
  if constexpr (W == 4) {
    __m256d v[4] = {rows[0].pack[0], rows[1].pack[0], rows[2].pack[0], rows[3].pack[0]};
    detail::turn_square(v);
    for (int c = 0; c < 4; ++c) columns[c] = v[c];
    return;
  }
#endif
  if constexpr (W > 1) {
    using Real = typename Lanes<Arch>::Real;
    alignas(Real) double element[4][W];
    alignas(Real) double row[4];
    for (std::size_t l = 0; l < W; ++l) {
      rows[l].store(row);
      for (std::size_t c = 0; c < 4; ++c) element[c][l] = row[c];
    }
    for (std::size_t c = 0; c < 4; ++c) columns[c] = silt::load<Real>(element[c]);
  }
}

/// The way back: element c of rows[l] = lane l of columns[c].
template <class Arch>
SILT_INLINE void columns_to_rows(const typename Lanes<Arch>::Real (&columns)[4],
                                 Row4<Arch> (&rows)[Lanes<Arch>::width]) {
  constexpr std::size_t W = Lanes<Arch>::width;
  if constexpr (W == 1) {
    for (std::size_t c = 0; c < 4; ++c) rows[0].pack[c] = columns[c];
    return;
  }
#if defined(__AVX512F__)
  if constexpr (W == 8) {
    __m512d v[4] = {columns[0], columns[1], columns[2], columns[3]};
    detail::turn_halves(v);
    for (int k = 0; k < 4; ++k) {
      rows[k].pack[0] = _mm512_castpd512_pd256(v[k]);
      rows[k + 4].pack[0] = _mm512_extractf64x4_pd(v[k], 1);
    }
    return;
  }
#endif
#if defined(__AVX__)
  if constexpr (W == 4) {
    __m256d v[4] = {columns[0], columns[1], columns[2], columns[3]};
    detail::turn_square(v);
    for (int k = 0; k < 4; ++k) rows[k].pack[0] = v[k];
    return;
  }
#endif
  if constexpr (W > 1) {
    using Real = typename Lanes<Arch>::Real;
    alignas(Real) double element[4][W];
    alignas(Real) double row[4];
    for (std::size_t c = 0; c < 4; ++c) silt::store(element[c], columns[c]);
    for (std::size_t l = 0; l < W; ++l) {
      for (std::size_t c = 0; c < 4; ++c) row[c] = element[c][l];
      rows[l] = Row4<Arch>::load(row);
    }
  }
}

}  // namespace silt
