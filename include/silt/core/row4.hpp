// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cstddef>
#include <type_traits>

#include <silt/core/lanes.hpp>

namespace silt::inline SILT_TARGET {

/// Four scalars side by side, as rows of particles and loads keep them: one register of four, two
/// of two, or four plain scalars, by the architecture.
template <class Arch, class Scalar = double>
struct Row4 {
  static constexpr std::size_t width = std::min<std::size_t>(Lanes<Arch, Scalar>::width, 4);
  using Pack = typename PackOf<width, Scalar>::type;
  static constexpr std::size_t packs = 4 / width;
  Pack pack[packs];

  static SILT_INLINE Row4 load(const Scalar* aligned) {
    Row4 out;
    for (std::size_t p = 0; p < packs; ++p) out.pack[p] = silt::load<Pack>(aligned + p * width);
    return out;
  }
  static SILT_INLINE Row4 all(Scalar value) {
    Row4 out;
    for (auto& p : out.pack) p = Pack(value);
    return out;
  }
  static SILT_INLINE Row4 of(Scalar x, Scalar y, Scalar z, Scalar w) {
    alignas(Pack) const Scalar values[4] = {x, y, z, w};
    return load(values);
  }
  SILT_INLINE void store(Scalar* aligned) const {
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

/// The same row in another precision.
template <class To, class Arch, class From>
SILT_INLINE Row4<Arch, To> convert(const Row4<Arch, From>& row) {
  if constexpr (std::is_same_v<To, From>) {
    return row;
  } else {
#if defined(__AVX__)
    if constexpr (Row4<Arch>::packs == 1) {
      if constexpr (std::is_same_v<To, float>)
        return {{_mm256_cvtpd_ps(row.pack[0])}};
      else
        return {{_mm256_cvtps_pd(row.pack[0])}};
    }
#endif
#if defined(__SSE2__)
    if constexpr (Row4<Arch>::packs == 2) {
      if constexpr (std::is_same_v<To, float>) {
        return {{_mm_movelh_ps(_mm_cvtpd_ps(row.pack[0]), _mm_cvtpd_ps(row.pack[1]))}};
      } else {
        const __m128 low = row.pack[0];
        return {{_mm_cvtps_pd(low), _mm_cvtps_pd(_mm_movehl_ps(low, low))}};
      }
    }
#endif
    alignas(64) From from[4];
    alignas(64) To to[4];
    row.store(from);
    for (int k = 0; k < 4; ++k) to[k] = static_cast<To>(from[k]);
    return Row4<Arch, To>::load(to);
  }
}

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
#if defined(__SSE2__)
/// Columns of a 4x4 block of floats, within each part of 128 bits.
SILT_INLINE void turn_quarters(__m128 (&v)[4]) { _MM_TRANSPOSE4_PS(v[0], v[1], v[2], v[3]); }
#endif
#if defined(__AVX__)
SILT_INLINE void turn_quarters(__m256 (&v)[4]) {
  const __m256 a = _mm256_unpacklo_ps(v[0], v[1]), b = _mm256_unpackhi_ps(v[0], v[1]);
  const __m256 c = _mm256_unpacklo_ps(v[2], v[3]), d = _mm256_unpackhi_ps(v[2], v[3]);
  v[0] = _mm256_shuffle_ps(a, c, 0x44), v[1] = _mm256_shuffle_ps(a, c, 0xee);
  v[2] = _mm256_shuffle_ps(b, d, 0x44), v[3] = _mm256_shuffle_ps(b, d, 0xee);
}
#endif
#if defined(__AVX512F__)
SILT_INLINE void turn_quarters(__m512 (&v)[4]) {
  const __m512 a = _mm512_unpacklo_ps(v[0], v[1]), b = _mm512_unpackhi_ps(v[0], v[1]);
  const __m512 c = _mm512_unpacklo_ps(v[2], v[3]), d = _mm512_unpackhi_ps(v[2], v[3]);
  v[0] = _mm512_shuffle_ps(a, c, 0x44), v[1] = _mm512_shuffle_ps(a, c, 0xee);
  v[2] = _mm512_shuffle_ps(b, d, 0x44), v[3] = _mm512_shuffle_ps(b, d, 0xee);
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
template <class Arch, class Scalar>
SILT_INLINE void rows_to_columns(const Row4<Arch, Scalar> (&rows)[Lanes<Arch, Scalar>::width],
                                 typename Lanes<Arch, Scalar>::Real (&columns)[4]) {
  constexpr std::size_t W = Lanes<Arch, Scalar>::width;
  [[maybe_unused]] constexpr bool single = std::is_same_v<Scalar, float>;
  if constexpr (W == 1) {
    for (std::size_t c = 0; c < 4; ++c) columns[c] = rows[0].pack[c];
    return;
  }
#if defined(__AVX512F__)
  if constexpr (!single && W == 8) {
    __m512d v[4];
    for (int k = 0; k < 4; ++k)
      v[k] = _mm512_insertf64x4(_mm512_castpd256_pd512(rows[k].pack[0]), rows[k + 4].pack[0], 1);
    detail::turn_halves(v);
    for (int c = 0; c < 4; ++c) columns[c] = v[c];
    return;
  }
  if constexpr (single && W == 16) {
    __m512 v[4];
    for (int k = 0; k < 4; ++k) {
      v[k] = _mm512_castps128_ps512(rows[k].pack[0]);
      v[k] = _mm512_insertf32x4(v[k], rows[k + 4].pack[0], 1);
      v[k] = _mm512_insertf32x4(v[k], rows[k + 8].pack[0], 2);
      v[k] = _mm512_insertf32x4(v[k], rows[k + 12].pack[0], 3);
    }
    detail::turn_quarters(v);
    for (int c = 0; c < 4; ++c) columns[c] = v[c];
    return;
  }
#endif
#if defined(__AVX__)
  if constexpr (!single && W == 4) {
    __m256d v[4] = {rows[0].pack[0], rows[1].pack[0], rows[2].pack[0], rows[3].pack[0]};
    detail::turn_square(v);
    for (int c = 0; c < 4; ++c) columns[c] = v[c];
    return;
  }
  if constexpr (single && W == 8) {
    __m256 v[4];
    for (int k = 0; k < 4; ++k)
      v[k] = _mm256_insertf128_ps(_mm256_castps128_ps256(rows[k].pack[0]), rows[k + 4].pack[0], 1);
    detail::turn_quarters(v);
    for (int c = 0; c < 4; ++c) columns[c] = v[c];
    return;
  }
#endif
#if defined(__SSE2__)
  if constexpr (single && W == 4) {
    __m128 v[4] = {rows[0].pack[0], rows[1].pack[0], rows[2].pack[0], rows[3].pack[0]};
    detail::turn_quarters(v);
    for (int c = 0; c < 4; ++c) columns[c] = v[c];
    return;
  }
#endif
  if constexpr (W > 1) {
    using Real = typename Lanes<Arch, Scalar>::Real;
    alignas(Real) Scalar element[4][W];
    alignas(Real) Scalar row[4];
    for (std::size_t l = 0; l < W; ++l) {
      rows[l].store(row);
      for (std::size_t c = 0; c < 4; ++c) element[c][l] = row[c];
    }
    for (std::size_t c = 0; c < 4; ++c) columns[c] = silt::load<Real>(element[c]);
  }
}

/// The way back: element c of rows[l] = lane l of columns[c].
template <class Arch, class Scalar>
SILT_INLINE void columns_to_rows(const typename Lanes<Arch, Scalar>::Real (&columns)[4],
                                 Row4<Arch, Scalar> (&rows)[Lanes<Arch, Scalar>::width]) {
  constexpr std::size_t W = Lanes<Arch, Scalar>::width;
  [[maybe_unused]] constexpr bool single = std::is_same_v<Scalar, float>;
  if constexpr (W == 1) {
    for (std::size_t c = 0; c < 4; ++c) rows[0].pack[c] = columns[c];
    return;
  }
#if defined(__AVX512F__)
  if constexpr (!single && W == 8) {
    __m512d v[4] = {columns[0], columns[1], columns[2], columns[3]};
    detail::turn_halves(v);
    for (int k = 0; k < 4; ++k) {
      rows[k].pack[0] = _mm512_castpd512_pd256(v[k]);
      rows[k + 4].pack[0] = _mm512_extractf64x4_pd(v[k], 1);
    }
    return;
  }
  if constexpr (single && W == 16) {
    __m512 v[4] = {columns[0], columns[1], columns[2], columns[3]};
    detail::turn_quarters(v);
    for (int k = 0; k < 4; ++k) {
      rows[k].pack[0] = _mm512_castps512_ps128(v[k]);
      rows[k + 4].pack[0] = _mm512_extractf32x4_ps(v[k], 1);
      rows[k + 8].pack[0] = _mm512_extractf32x4_ps(v[k], 2);
      rows[k + 12].pack[0] = _mm512_extractf32x4_ps(v[k], 3);
    }
    return;
  }
#endif
#if defined(__AVX__)
  if constexpr (!single && W == 4) {
    __m256d v[4] = {columns[0], columns[1], columns[2], columns[3]};
    detail::turn_square(v);
    for (int k = 0; k < 4; ++k) rows[k].pack[0] = v[k];
    return;
  }
  if constexpr (single && W == 8) {
    __m256 v[4] = {columns[0], columns[1], columns[2], columns[3]};
    detail::turn_quarters(v);
    for (int k = 0; k < 4; ++k) {
      rows[k].pack[0] = _mm256_castps256_ps128(v[k]);
      rows[k + 4].pack[0] = _mm256_extractf128_ps(v[k], 1);
    }
    return;
  }
#endif
#if defined(__SSE2__)
  if constexpr (single && W == 4) {
    __m128 v[4] = {columns[0], columns[1], columns[2], columns[3]};
    detail::turn_quarters(v);
    for (int k = 0; k < 4; ++k) rows[k].pack[0] = v[k];
    return;
  }
#endif
  if constexpr (W > 1) {
    using Real = typename Lanes<Arch, Scalar>::Real;
    alignas(Real) Scalar element[4][W];
    alignas(Real) Scalar row[4];
    for (std::size_t c = 0; c < 4; ++c) silt::store(element[c], columns[c]);
    for (std::size_t l = 0; l < W; ++l) {
      for (std::size_t c = 0; c < 4; ++c) row[c] = element[c][l];
      rows[l] = Row4<Arch, Scalar>::load(row);
    }
  }
}

/// Packs of doubles as one pack of floats, which has as many lanes as they have together.
template <class Arch>
inline constexpr std::size_t packs_a_float_pack =
    Lanes<Arch, float>::width / Lanes<Arch, double>::width;
template <class Arch>
SILT_INLINE typename Lanes<Arch, float>::Real narrow(
    const typename Lanes<Arch>::Real (&packs)[packs_a_float_pack<Arch>]) {
  constexpr std::size_t W = Lanes<Arch>::width, N = packs_a_float_pack<Arch>;
  using Real = typename Lanes<Arch, float>::Real;
#if defined(__AVX512F__)
  if constexpr (W == 8 && N == 2)
    return Real(_mm512_castpd_ps(
        _mm512_insertf64x4(_mm512_castpd256_pd512(_mm256_castps_pd(_mm512_cvtpd_ps(packs[0]))),
                           _mm256_castps_pd(_mm512_cvtpd_ps(packs[1])), 1)));
#endif
#if defined(__AVX__)
  if constexpr (W == 4 && N == 2)
    return Real(_mm256_insertf128_ps(_mm256_castps128_ps256(_mm256_cvtpd_ps(packs[0])),
                                     _mm256_cvtpd_ps(packs[1]), 1));
#endif
#if defined(__SSE2__)
  if constexpr (W == 2 && N == 2)
    return Real(_mm_movelh_ps(_mm_cvtpd_ps(packs[0]), _mm_cvtpd_ps(packs[1])));
#endif
  alignas(64) double from[W * N];
  alignas(64) float to[W * N];
  for (std::size_t k = 0; k < N; ++k) silt::store(from + k * W, packs[k]);
  for (std::size_t k = 0; k < W * N; ++k) to[k] = static_cast<float>(from[k]);
  return silt::load<Real>(to);
}

}  // namespace silt
