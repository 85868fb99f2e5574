// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cstddef>
#include <cstring>
#include <type_traits>
#include <utility>

#include <silt/core/lanes.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Makes an aggregate of Reals from value(number of the member). Member by member: a cast from an
/// array would go through memory.
template <class Aggregate, class Real, class Value>
SILT_INLINE Aggregate members_of(const Value& value) {
  static_assert(std::is_trivially_copyable_v<Aggregate>);
  Aggregate out;
  const auto set = [&](auto c) {
    const Real member = value(c);
    std::memcpy(reinterpret_cast<std::byte*>(&out) + c * sizeof(Real), &member, sizeof(Real));
  };
  [&]<std::size_t... C>(std::index_sequence<C...>) {
    (set(std::integral_constant<std::size_t, C>{}), ...);
  }
  (std::make_index_sequence<sizeof(Aggregate) / sizeof(Real)>{});
  return out;
}
/// The reverse: to(number, member) for each member.
template <class Real, class Aggregate, class To>
SILT_INLINE void for_each_member(const Aggregate& of, const To& to) {
  const auto get = [&](auto c) {
    Real member;
    std::memcpy(&member, reinterpret_cast<const std::byte*>(&of) + c * sizeof(Real), sizeof(Real));
    to(c, member);
  };
  [&]<std::size_t... C>(std::index_sequence<C...>) {
    (get(std::integral_constant<std::size_t, C>{}), ...);
  }
  (std::make_index_sequence<sizeof(Aggregate) / sizeof(Real)>{});
}

/// A pack of doubles from memory in which they are stored as `Stored`.
template <class Real, class Stored>
SILT_INLINE Real load_wide(const Stored* from) {
  if constexpr (std::is_same_v<Stored, double>) {
    return silt::load<Real>(from);
  } else {
#if defined(__AVX512F__)
    if constexpr (sizeof(Real) == 64) return Real(_mm512_cvtps_pd(_mm256_load_ps(from)));
#endif
#if defined(__AVX__)
    if constexpr (sizeof(Real) == 32) return Real(_mm256_cvtps_pd(_mm_load_ps(from)));
#endif
    constexpr std::size_t W = sizeof(Real) / sizeof(double);
    alignas(64) double wide[W];
    for (std::size_t lane = 0; lane < W; ++lane) wide[lane] = from[lane];
    return silt::load<Real>(wide);
  }
}

}  // namespace silt::detail
