// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <bit>

#include <silt/core/lanes.hpp>

namespace silt::inline SILT_TARGET {

/// Logarithm and power of two in lanes, one text for double and packs of double, on every
/// instruction set. (Those of xsimd 8 do not compile for AVX-512 without optimisation.)
/// Valid:  x > 0 normal and finite; results in the range of normal numbers.
/// Errors: exact_log2 2e-16 absolute and relative, exact_exp2 5e-16 (two ulp) relative; the rough
/// ones 2e-7
///         absolute and relative, at half the work.
/// Tests:  tests/core/powers.cpp.
namespace detail {

/// The bits of the lanes of a Real of doubles, as integers that can be shifted lane by lane.
template <class Real>
struct BitsOf {
  using type = std::uint64_t;
};
template <class Real>
requires is_batch<Real>
struct BitsOf<Real> {
  typedef std::uint64_t type __attribute__((vector_size(sizeof(Real))));
};

template <class Real>
SILT_INLINE auto bits_of(const Real& x) {
  return std::bit_cast<typename BitsOf<Real>::type>(x);
}
template <class Real>
SILT_INLINE Real from_bits(const typename BitsOf<Real>::type& bits) {
  return std::bit_cast<Real>(bits);
}

/// x = 2^k m with m in [sqrt(1/2), sqrt(2)).
template <class Real>
SILT_INLINE void split(const Real& x, Real& k, Real& m) {
  constexpr std::uint64_t one = 0x3FF0000000000000, root_half = 0x3FE6A09E667F3BCD;
  const auto bits = bits_of(x);
  const auto shifted = bits + (one - root_half);
  m = from_bits<Real>(bits - (shifted & 0xFFF0000000000000) + one);
  k = from_bits<Real>((shifted >> 52) | 0x4330000000000000) - Real(4503599627370496.0 + 1023);
}

/// y = k + f with |f| <= 1/2; returns 2^k.
template <class Real>
SILT_INLINE Real split_power(const Real& y, Real& f) {
  constexpr double magic = 6755399441055744.0;  // 1.5 2^52: its sum with y has round(y) lowest
  const Real sum = y + Real(magic);
  f = y - (sum - Real(magic));
  return from_bits<Real>((bits_of(sum) + 1023) << 52);
}

/// c[0] + c[1] x + ... by Horner's rule.
template <class Real, std::size_t N>
SILT_INLINE Real horner(const double (&c)[N], const Real& x) {
  Real sum(c[N - 1]);
  for (std::size_t k = N - 1; k-- > 0;) sum = sum * x + Real(c[k]);
  return sum;
}

}  // namespace detail

/// log2(x): twice the series of artanh of (m - 1)/(m + 1). Summed in pairs, as one chain of ten
/// products would wait for each of them.
template <class Real>
SILT_INLINE Real exact_log2(const Real& x) {
  constexpr double c = 2.8853900817779268;  // 2 / ln 2
  const auto term = [](int n) { return Real(c / n); };
  Real k, m;
  detail::split(x, k, m);
  const Real s = (m - Real(1)) / (m + Real(1)), z = s * s, z2 = z * z, z4 = z2 * z2;
  const Real low = (term(1) + term(3) * z) + (term(5) + term(7) * z) * z2;
  const Real high = (term(9) + term(11) * z) + (term(13) + term(15) * z) * z2;
  return k + s * (low + z4 * (high + z4 * (term(17) + term(19) * z)));
}

/// 2^y for |y| < 1022: the series of exp(f ln 2).
template <class Real>
SILT_INLINE Real exact_exp2(const Real& y) {
  static constexpr double even[]{1.0,
                                 0.24022650695910072,
                                 0.009618129107628477,
                                 0.00015403530393381608,
                                 1.3215486790144308e-06,
                                 7.054911620801123e-09,
                                 2.5678435993488206e-11};
  static constexpr double odd[]{0.6931471805599453,     0.05550410866482158,
                                0.0013333558146428443,  1.5252733804059841e-05,
                                1.0178086009239699e-07, 4.4455382718708117e-10};
  Real f;
  const Real power = detail::split_power(y, f), f2 = f * f;
  return power * (detail::horner(even, f2) + f * detail::horner(odd, f2));
}

/// log2(x) to 2e-7.
template <class Real>
SILT_INLINE Real rough_log2(const Real& x) {
  constexpr double c = 2.8853900817779268;
  static constexpr double series[]{c, c / 3, c / 5, c / 7};
  Real k, m;
  detail::split(x, k, m);
  const Real s = (m - Real(1)) / (m + Real(1));
  return k + s * detail::horner(series, s * s);
}

/// 2^y to 2e-7, for |y| < 1022.
template <class Real>
SILT_INLINE Real rough_exp2(const Real& y) {
  static constexpr double series[]{1.0,
                                   0.6931471805599453,
                                   0.24022650695910072,
                                   0.05550410866482158,
                                   0.009618129107628477,
                                   0.0013333558146428443,
                                   0.00015403530393381608};
  Real f;
  const Real power = detail::split_power(y, f);
  return power * detail::horner(series, f);
}

}  // namespace silt
