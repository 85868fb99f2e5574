// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <bit>
#include <type_traits>

#include <silt/core/lanes.hpp>

namespace silt::inline SILT_TARGET {

/// Logarithm and power in lanes, one text for double, float and packs of them, on every instruction
/// set. (Those of xsimd 8 do not compile for AVX-512 without optimisation. The names differ from
/// xsimd's, which would be found first.)
/// Valid:  x > 0 normal and finite; results in the range of normal numbers.
/// Errors: of double: exact_log2 2e-16 absolute and relative, exact_exp2 5e-16 (two ulp) relative;
///         the rough ones 2e-7 absolute and relative, at half the work. Of float: 2e-7.
/// Tests:  tests/core/powers.cpp.
namespace detail {

/// Memory layout of float and double.
template <class Scalar>
struct FloatLayout;
template <>
struct FloatLayout<double> {
  using Bits = std::uint64_t;
  static constexpr int fraction = 52, bias = 1023;
  static constexpr Bits one = 0x3FF0000000000000, root_half = 0x3FE6A09E667F3BCD,
                        exponent = 0xFFF0000000000000, unit = 0x4330000000000000;
};
template <>
struct FloatLayout<float> {
  using Bits = std::uint32_t;
  static constexpr int fraction = 23, bias = 127;
  static constexpr Bits one = 0x3F800000, root_half = 0x3F3504F3, exponent = 0xFF800000,
                        unit = 0x4B000000;
};

/// Bits of the lanes of a Real, as integers that can be shifted lane by lane.
template <class Real>
struct BitsOf {
  using type = typename FloatLayout<Real>::Bits;
};
template <class Real>
requires is_batch<Real>
struct BitsOf<Real> {
  typedef typename FloatLayout<ScalarOf<Real>>::Bits type
      __attribute__((vector_size(sizeof(Real))));
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
  using S = FloatLayout<ScalarOf<Real>>;
  constexpr auto two_to_fraction = static_cast<ScalarOf<Real>>(typename S::Bits{1} << S::fraction);
  const auto bits = bits_of(x);
  const auto shifted = bits + (S::one - S::root_half);
  m = from_bits<Real>(bits - (shifted & S::exponent) + S::one);
  k = from_bits<Real>((shifted >> S::fraction) | S::unit) - Real(two_to_fraction + S::bias);
}

/// y = k + f with |f| <= 1/2; returns 2^k.
template <class Real>
SILT_INLINE Real split_power(const Real& y, Real& f) {
  using S = FloatLayout<ScalarOf<Real>>;
  // The sum with y has round(y) in its lowest bits.
  constexpr auto magic = static_cast<ScalarOf<Real>>(typename S::Bits{3} << (S::fraction - 1));
  const Real sum = y + Real(magic);
  f = y - (sum - Real(magic));
  return from_bits<Real>((bits_of(sum) + S::bias) << S::fraction);
}

/// c[0] + c[1] x + ... by Horner's rule.
template <class Real, std::size_t N>
SILT_INLINE Real horner(const double (&c)[N], const Real& x) {
  using Scalar = ScalarOf<Real>;
  Real sum(static_cast<Scalar>(c[N - 1]));
  for (std::size_t k = N - 1; k-- > 0;) sum = sum * x + Real(static_cast<Scalar>(c[k]));
  return sum;
}

}  // namespace detail

/// log2(x): twice the series of artanh of (m - 1)/(m + 1). Summed in pairs: in a single chain each
/// of the ten products would wait for the previous one.
template <class Real>
SILT_INLINE Real exact_log2(const Real& x) {
  constexpr double c = 2.8853900817779268;  // 2 / ln 2
  const auto term = [](int n) { return Real(static_cast<ScalarOf<Real>>(c / n)); };
  Real k, m;
  detail::split(x, k, m);
  const Real s = (m - Real(1)) / (m + Real(1)), z = s * s, z2 = z * z, z4 = z2 * z2;
  const Real low = (term(1) + term(3) * z) + (term(5) + term(7) * z) * z2;
  const Real high = (term(9) + term(11) * z) + (term(13) + term(15) * z) * z2;
  return k + s * (low + z4 * (high + z4 * (term(17) + term(19) * z)));
}

namespace detail {
/// Series of 2^f in f^2: even powers above 1, and odd ones.
inline constexpr double exp2_even[]{0.24022650695910072,    0.009618129107628477,
                                    0.00015403530393381608, 1.3215486790144308e-06,
                                    7.054911620801123e-09,  2.5678435993488206e-11};
inline constexpr double exp2_odd[]{0.6931471805599453,     0.05550410866482158,
                                   0.0013333558146428443,  1.5252733804059841e-05,
                                   1.0178086009239699e-07, 4.4455382718708117e-10};
}  // namespace detail

/// 2^y for |y| < 1022 (float: 126): the series of exp(f ln 2).
template <class Real>
SILT_INLINE Real exact_exp2(const Real& y) {
  Real f;
  const Real power = detail::split_power(y, f), f2 = f * f;
  const Real even = Real(1) + f2 * detail::horner(detail::exp2_even, f2);
  return power * (even + f * detail::horner(detail::exp2_odd, f2));
}

/// 2^y - 1, to a few ulp also for small y.
template <class Real>
SILT_INLINE Real exact_exp2_minus_1(const Real& y) {
  Real f;
  const Real power = detail::split_power(y, f), f2 = f * f;
  const Real part =
      f2 * detail::horner(detail::exp2_even, f2) + f * detail::horner(detail::exp2_odd, f2);
  return power * part + (power - Real(1));
}

/// Largest |y| allowed in exact_exp2.
template <class Real>
inline constexpr ScalarOf<Real> largest_power_of_two =
    static_cast<ScalarOf<Real>>(detail::FloatLayout<ScalarOf<Real>>::bias - 1);

/// x^y for x > 0; the relative error is that of the exponent, 2e-16 |y log2 x| and two ulp.
template <class Real>
SILT_INLINE Real power(const Real& x, const std::type_identity_t<Real>& y) {
  return exact_exp2(y * exact_log2(x));
}

/// e^x, limited below to 2^-1022 (float: 2^-126); relative error 2e-16 |x| and two ulp.
template <class Real>
SILT_INLINE Real exponential(const Real& x) {
  constexpr auto most = largest_power_of_two<Real>;
  return exact_exp2(
      max(min(x * Real(ScalarOf<Real>(1.4426950408889634)), Real(most)), Real(-most)));
}

/// 1 - e^-x for x >= 0, to a few ulp also for small x.
template <class Real>
SILT_INLINE Real one_minus_exponential(const Real& x) {
  constexpr auto most = largest_power_of_two<Real>;
  return -exact_exp2_minus_1(max(x * Real(ScalarOf<Real>(-1.4426950408889634)), Real(-most)));
}

/// ln x.
template <class Real>
SILT_INLINE Real natural_log(const Real& x) {
  return exact_log2(x) * Real(ScalarOf<Real>(0.6931471805599453));
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
