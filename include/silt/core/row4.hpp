// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cstddef>
#include <type_traits>

#include <silt/core/lanes.hpp>

namespace silt::inline SILT_TARGET {

/// Four scalars, as stored in rows of particles and loads: one register of four, two of two, or
/// four plain scalars, depending on the architecture.
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

// A register contains one, two or four rows of four: side_by_side() combines them and take_apart()
// separates them; turn() transposes the 4x4 block that four registers contain at each position.
#if defined(__SSE2__)
SILT_INLINE void turn(__m128 (&v)[4]) { _MM_TRANSPOSE4_PS(v[0], v[1], v[2], v[3]); }
#endif
#if defined(__AVX__)
SILT_INLINE void turn(__m256d (&v)[4]) {
  const __m256d even01 = _mm256_unpacklo_pd(v[0], v[1]), odd01 = _mm256_unpackhi_pd(v[0], v[1]);
  const __m256d even23 = _mm256_unpacklo_pd(v[2], v[3]), odd23 = _mm256_unpackhi_pd(v[2], v[3]);
  v[0] = _mm256_permute2f128_pd(even01, even23, 0x20);
  v[1] = _mm256_permute2f128_pd(odd01, odd23, 0x20);
  v[2] = _mm256_permute2f128_pd(even01, even23, 0x31);
  v[3] = _mm256_permute2f128_pd(odd01, odd23, 0x31);
}
SILT_INLINE void turn(__m256 (&v)[4]) {
  const __m256 a = _mm256_unpacklo_ps(v[0], v[1]), b = _mm256_unpackhi_ps(v[0], v[1]);
  const __m256 c = _mm256_unpacklo_ps(v[2], v[3]), d = _mm256_unpackhi_ps(v[2], v[3]);
  v[0] = _mm256_shuffle_ps(a, c, 0x44), v[1] = _mm256_shuffle_ps(a, c, 0xee);
  v[2] = _mm256_shuffle_ps(b, d, 0x44), v[3] = _mm256_shuffle_ps(b, d, 0xee);
}
SILT_INLINE __m256 side_by_side(__m128 a, __m128 b) {
  return _mm256_insertf128_ps(_mm256_castps128_ps256(a), b, 1);
}
SILT_INLINE void take_apart(__m256 v, auto& a, auto& b) {
  a = _mm256_castps256_ps128(v), b = _mm256_extractf128_ps(v, 1);
}
#endif
#if defined(__AVX512F__)
// _mm512_unpacklo_pd(a, b), which g++ 12.2 may compile as if b were a: its pattern for vunpcklpd
// has vmovddup as an alternative, which its register allocator takes if b is a known 0. It changed
// masses: tests/compile/same_motion.cpp.
SILT_INLINE __m512d even_of(__m512d a, __m512d b) { return _mm512_mask_movedup_pd(a, 0xaa, b); }
SILT_INLINE void turn(__m512d (&v)[4]) {
  const __m512i low = _mm512_setr_epi64(0, 1, 8, 9, 4, 5, 12, 13);
  const __m512i high = _mm512_setr_epi64(2, 3, 10, 11, 6, 7, 14, 15);
  const __m512d even01 = even_of(v[0], v[1]), odd01 = _mm512_unpackhi_pd(v[0], v[1]);
  const __m512d even23 = even_of(v[2], v[3]), odd23 = _mm512_unpackhi_pd(v[2], v[3]);
  v[0] = _mm512_permutex2var_pd(even01, low, even23);
  v[1] = _mm512_permutex2var_pd(odd01, low, odd23);
  v[2] = _mm512_permutex2var_pd(even01, high, even23);
  v[3] = _mm512_permutex2var_pd(odd01, high, odd23);
}
SILT_INLINE void turn(__m512 (&v)[4]) {
  const __m512 a = _mm512_unpacklo_ps(v[0], v[1]), b = _mm512_unpackhi_ps(v[0], v[1]);
  const __m512 c = _mm512_unpacklo_ps(v[2], v[3]), d = _mm512_unpackhi_ps(v[2], v[3]);
  v[0] = _mm512_shuffle_ps(a, c, 0x44), v[1] = _mm512_shuffle_ps(a, c, 0xee);
  v[2] = _mm512_shuffle_ps(b, d, 0x44), v[3] = _mm512_shuffle_ps(b, d, 0xee);
}
SILT_INLINE __m512d side_by_side(__m256d a, __m256d b) {
  return _mm512_insertf64x4(_mm512_castpd256_pd512(a), b, 1);
}
SILT_INLINE __m512 side_by_side(__m128 a, __m128 b, __m128 c, __m128 d) {
  const __m512 ab = _mm512_insertf32x4(_mm512_castps128_ps512(a), b, 1);
  return _mm512_insertf32x4(_mm512_insertf32x4(ab, c, 2), d, 3);
}
SILT_INLINE void take_apart(__m512d v, auto& a, auto& b) {
  a = _mm512_castpd512_pd256(v), b = _mm512_extractf64x4_pd(v, 1);
}
SILT_INLINE void take_apart(__m512 v, auto& a, auto& b, auto& c, auto& d) {
  a = _mm512_castps512_ps128(v), b = _mm512_extractf32x4_ps(v, 1);
  c = _mm512_extractf32x4_ps(v, 2), d = _mm512_extractf32x4_ps(v, 3);
}
#endif

template <std::size_t Width, class Row, class Register>
SILT_INLINE void turn_rows(const Row* rows, Register (&v)[4]) {
  for (int k = 0; k < 4; ++k) {
    if constexpr (Width == 4) v[k] = rows[k].pack[0];
    if constexpr (Width == 8) v[k] = side_by_side(rows[k].pack[0], rows[k + 4].pack[0]);
    if constexpr (Width == 16)
      v[k] = side_by_side(rows[k].pack[0], rows[k + 4].pack[0], rows[k + 8].pack[0],
                          rows[k + 12].pack[0]);
  }
  turn(v);
}
template <std::size_t Width, class Row, class Register>
SILT_INLINE void turn_back(Register (&v)[4], Row* rows) {
  turn(v);
  for (int k = 0; k < 4; ++k) {
    if constexpr (Width == 4) rows[k].pack[0] = v[k];
    if constexpr (Width == 8) take_apart(v[k], rows[k].pack[0], rows[k + 4].pack[0]);
    if constexpr (Width == 16)
      take_apart(v[k], rows[k].pack[0], rows[k + 4].pack[0], rows[k + 8].pack[0],
                 rows[k + 12].pack[0]);
  }
}

/// Packs that are transposed in registers; others go through memory.
template <class Real>
concept Turns = requires(typename Real::register_type (&v)[4]) {
  turn(v);
};

}  // namespace detail

/// Transposes one row per lane to four columns: lane l of columns[c] = element c of rows[l].
template <class Arch, class Scalar>
SILT_INLINE void rows_to_columns(const Row4<Arch, Scalar> (&rows)[Lanes<Arch, Scalar>::width],
                                 typename Lanes<Arch, Scalar>::Real (&columns)[4]) {
  constexpr std::size_t W = Lanes<Arch, Scalar>::width;
  using Real = typename Lanes<Arch, Scalar>::Real;
  if constexpr (W == 1) {
    for (std::size_t c = 0; c < 4; ++c) columns[c] = rows[0].pack[c];
  } else if constexpr (detail::Turns<Real>) {
    typename Real::register_type v[4];
    detail::turn_rows<W>(rows, v);
    for (std::size_t c = 0; c < 4; ++c) columns[c] = v[c];
  } else {
    alignas(Real) Scalar element[4][W];
    alignas(Real) Scalar row[4];
    for (std::size_t l = 0; l < W; ++l) {
      rows[l].store(row);
      for (std::size_t c = 0; c < 4; ++c) element[c][l] = row[c];
    }
    for (std::size_t c = 0; c < 4; ++c) columns[c] = silt::load<Real>(element[c]);
  }
}

/// The reverse: element c of rows[l] = lane l of columns[c].
template <class Arch, class Scalar>
SILT_INLINE void columns_to_rows(const typename Lanes<Arch, Scalar>::Real (&columns)[4],
                                 Row4<Arch, Scalar> (&rows)[Lanes<Arch, Scalar>::width]) {
  constexpr std::size_t W = Lanes<Arch, Scalar>::width;
  using Real = typename Lanes<Arch, Scalar>::Real;
  if constexpr (W == 1) {
    for (std::size_t c = 0; c < 4; ++c) rows[0].pack[c] = columns[c];
  } else if constexpr (detail::Turns<Real>) {
    typename Real::register_type v[4] = {columns[0], columns[1], columns[2], columns[3]};
    detail::turn_back<W>(v, rows);
  } else {
    alignas(Real) Scalar element[4][W];
    alignas(Real) Scalar row[4];
    for (std::size_t c = 0; c < 4; ++c) silt::store(element[c], columns[c]);
    for (std::size_t l = 0; l < W; ++l) {
      for (std::size_t c = 0; c < 4; ++c) row[c] = element[c][l];
      rows[l] = Row4<Arch, Scalar>::load(row);
    }
  }
}

/// Number of packs of doubles with as many lanes as one pack of floats.
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
