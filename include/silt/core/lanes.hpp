// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <type_traits>

#if defined(__GNUC__) && !defined(__clang__)
// GCC bug 105593: its AVX-512 headers read undefined registers on purpose, and cause warnings.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wuninitialized"
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#include <xsimd/xsimd.hpp>
#pragma GCC diagnostic pop
#else
#include <xsimd/xsimd.hpp>
#endif

#include <silt/core/probe.hpp>
#include <silt/core/vec3.hpp>

/// For the few functions of a kernel that must be inlined into one loop body whatever their size.
#if defined(__GNUC__)
#define SILT_INLINE inline __attribute__((always_inline))
#else
#define SILT_INLINE inline
#endif

/// Before a loop over lanes or parts that fills or reads a small array: the array stays in
/// registers. g++ unrolls such loops by itself with -O3 only; left as loops they made a step with
/// -O2 twice as long.
#if defined(__GNUC__) && !defined(__clang__)
#define SILT_UNROLL _Pragma("GCC unroll 16")
#else
#define SILT_UNROLL
#endif

namespace silt::inline SILT_TARGET {

/// Architecture of one lane: kernels run on plain `double`. Laws may then work on double only.
struct OneLane {};

/// The same where no SIMD is available. Laws must still meet the requirements of packs; a law that
/// compiles here compiles everywhere.
struct NoLanes : OneLane {};

/// Architecture allowed by the compile flags. It is part of every type that depends on it; two
/// translation units with different flags can thus be in one program.
#if defined(SILT_NO_SIMD)
using DefaultArch = NoLanes;
#else
using DefaultArch = std::conditional_t<xsimd::has_simd_register<double, xsimd::default_arch>::value,
                                       xsimd::default_arch, NoLanes>;
#endif

/// Maps an architecture to the scalar-or-batch type of its kernels (`Real`) and its width.
template <class Arch, class Scalar = double>
struct Lanes {
  using Real = xsimd::batch<Scalar, Arch>;
  static constexpr std::size_t width = Real::size;
};
template <class Arch, class Scalar>
requires std::is_base_of_v<OneLane, Arch>
struct Lanes<Arch, Scalar> {
  using Real = Scalar;
  static constexpr std::size_t width = 1;
};

/// A pack of exactly `Width` scalars.
template <std::size_t Width, class Scalar = double>
struct PackOf {
  using type = xsimd::make_sized_batch_t<Scalar, Width>;
};
template <class Scalar>
struct PackOf<1, Scalar> {
  using type = Scalar;
};

/// True for a pack of lanes, false for one number.
template <class Real>
inline constexpr bool is_batch = !std::is_floating_point_v<Real>;

namespace detail {
template <class Real>
struct ScalarOfReal {
  using type = Real;
};
template <class Real>
requires is_batch<Real>
struct ScalarOfReal<Real> {
  using type = typename Real::value_type;
};
}  // namespace detail

/// Type of one lane of `Real`: float or double.
template <class Real>
using ScalarOf = typename detail::ScalarOfReal<Real>::type;

/// Smallest positive Real of full precision, to keep a divisor from zero.
template <class Real>
inline Real smallest() {
  return Real(std::numeric_limits<ScalarOf<Real>>::min());
}

/// Result of comparing two Reals: `bool`, or one truth value per lane.
template <class Real>
using Mask = decltype(std::declval<Real>() < std::declval<Real>());

/// @name Arithmetic with the same text for `double` and batches
/// Together with + - * / and comparisons this is all that a contact law needs.
/// @{
template <class Real>
inline Real sqrt(const Real& x) {
  if constexpr (is_batch<Real>) {
    using xsimd::sqrt;  // or that of the probe
    return sqrt(x);
  } else
    return std::sqrt(x);
}
template <class Real>
inline Real abs(const Real& x) {
  if constexpr (is_batch<Real>) {
    using xsimd::abs;  // or that of the probe
    return abs(x);
  } else
    return std::fabs(x);
}
template <class Real>
inline Real min(const Real& a, const std::type_identity_t<Real>& b) {
  if constexpr (is_batch<Real>) {
    using xsimd::min;  // or that of the probe
    return min(a, b);
  } else
    return b < a ? b : a;
}
template <class Real>
inline Real max(const Real& a, const std::type_identity_t<Real>& b) {
  if constexpr (is_batch<Real>) {
    using xsimd::max;  // or that of the probe
    return max(a, b);
  } else
    return a < b ? b : a;
}
/// `a` in the lanes where `mask` is true, `b` in the others. NaN in a lane that is not selected
/// does no harm.
template <class Real>
inline Real select(const Mask<Real>& mask, const Real& a, const std::type_identity_t<Real>& b) {
  if constexpr (is_batch<Real>) {
    using xsimd::select;  // or that of the probe
    return select(mask, a, b);
  } else
    return mask ? a : b;
}
template <class Real>
inline Vec3<Real> select(const Mask<Real>& mask, const Vec3<Real>& a, const Vec3<Real>& b) {
  return {select(mask, a.x, b.x), select(mask, a.y, b.y), select(mask, a.z, b.z)};
}
/// @}

/// True if `mask` is true in at least one lane.
template <class M>
inline bool any(const M& mask) {
  if constexpr (std::is_same_v<M, bool>)
    return mask;
  else {
    using xsimd::any;  // or that of the probe
    return any(mask);
  }
}

template <class Real>
inline Real load(const ScalarOf<Real>* aligned) {
  if constexpr (is_batch<Real>)
    return Real::load_aligned(aligned);
  else
    return *aligned;
}
/// Writes a pack, or one number, to aligned memory; as load().
template <class Real>
inline void store(ScalarOf<Real>* aligned, const Real& x) {
  if constexpr (is_batch<Real>)
    x.store_aligned(aligned);
  else
    *aligned = x;
}
/// One vector per lane, from three columns.
template <class Real>
inline Vec3<Real> load3(const ScalarOf<Real>* x, const ScalarOf<Real>* y, const ScalarOf<Real>* z) {
  return {load<Real>(x), load<Real>(y), load<Real>(z)};
}

/// Loads from any address.
template <class Real>
inline Real load_any(const ScalarOf<Real>* p) {
  if constexpr (is_batch<Real>)
    return Real::load_unaligned(p);
  else
    return *p;
}

/// Stores to any address.
template <class Real>
SILT_INLINE void store_any(ScalarOf<Real>* p, const Real& x) {
  if constexpr (is_batch<Real>)
    x.store_unaligned(p);
  else
    *p = x;
}

/// a b + c.
template <class Real>
SILT_INLINE Real multiply_add(const Real& a, const Real& b, const Real& c) {
  if constexpr (is_batch<Real>) {
    using xsimd::fma;  // or that of the probe
    return fma(a, b, c);
  } else
    return a * b + c;
}
/// Sum over the lanes, in their order.
template <class Real>
SILT_INLINE ScalarOf<Real> sum_of(const Real& a) {
  if constexpr (is_batch<Real>) {
    alignas(64) ScalarOf<Real> values[Real::size];
    store(values, a);
    ScalarOf<Real> sum = 0;
    for (const auto v : values) sum += v;
    return sum;
  } else {
    return a;
  }
}

/// Makes the compiler load the memory at p again. Compilers keep the indices of a pack in vector
/// registers from one use to the next, which takes longer than to load them again.
template <class T>
SILT_INLINE void read_anew([[maybe_unused]] const T*& p) {
#if defined(__GNUC__)
  asm volatile("" : "+r"(p));
#endif
}

/// One bit per lane, the first in the lowest place.
template <class M>
inline std::uint64_t lane_bits(const M& mask) {
  if constexpr (std::is_same_v<M, bool>) {
    return mask;
  } else {
#if defined(__AVX512F__)
    if constexpr (std::is_same_v<M, xsimd::batch_bool<double, xsimd::avx512bw>> ||
                  std::is_same_v<M, xsimd::batch_bool<double, xsimd::avx512dq>> ||
                  std::is_same_v<M, xsimd::batch_bool<double, xsimd::avx512f>>)
      return static_cast<__mmask8>(mask);
    if constexpr (std::is_same_v<M, xsimd::batch_bool<float, xsimd::avx512bw>> ||
                  std::is_same_v<M, xsimd::batch_bool<float, xsimd::avx512dq>> ||
                  std::is_same_v<M, xsimd::batch_bool<float, xsimd::avx512f>>)
      return static_cast<__mmask16>(mask);
#endif
    // clang converts masks of floats to those of doubles, which have other lanes.
    [[maybe_unused]] constexpr bool of_doubles =
        std::is_same_v<typename M::batch_type::value_type, double>;
    [[maybe_unused]] constexpr bool of_floats =
        std::is_same_v<typename M::batch_type::value_type, float>;
#if defined(__AVX__)
    if constexpr (of_floats && requires { _mm256_movemask_ps(mask); })
      return static_cast<std::uint64_t>(_mm256_movemask_ps(mask));
    if constexpr (of_doubles && requires { _mm256_movemask_pd(mask); })
      return static_cast<std::uint64_t>(_mm256_movemask_pd(mask));
#endif
#if defined(__SSE2__)
    if constexpr (of_floats && requires { _mm_movemask_ps(mask); })
      return static_cast<std::uint64_t>(_mm_movemask_ps(mask));
    if constexpr (of_doubles && requires { _mm_movemask_pd(mask); })
      return static_cast<std::uint64_t>(_mm_movemask_pd(mask));
#endif
    bool lane[M::size];
    mask.store_unaligned(lane);
    std::uint64_t all = 0;
    for (std::size_t k = 0; k < M::size; ++k) all |= std::uint64_t{lane[k]} << k;
    return all;
  }
}

}  // namespace silt
