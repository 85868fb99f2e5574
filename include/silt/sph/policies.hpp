// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <concepts>
#include <type_traits>
#include <utility>

#include <silt/core/ledger.hpp>
#include <silt/core/precision.hpp>
#include <silt/sph/kernels.hpp>
#include <silt/sph/terms.hpp>
#include <silt/sph/volume.hpp>

namespace silt::inline SILT_TARGET {

namespace detail {

/// Policies of an axis of Sph, by P::sph_axis.
template <class P, SphAxis axis>
concept SphPolicyOf = requires {
  requires P::sph_axis == axis;
};
template <class P>
concept SphPolicy = requires {
  { P::sph_axis } -> std::convertible_to<SphAxis>;
};
/// Precisions are shared with Simulation (core/precision.hpp) and have no sph_axis.
template <class P>
concept SphPrecision = requires {
  typename P::PairScalar;
};

template <class P>
concept SphLedger = requires {
  requires P::is_ledger;
};

/// Policies of an Sph by axis: the given one, or the default.
template <class... Ps>
struct SphPolicies {
  static_assert(
      ((SphPolicy<Ps> || SphPrecision<Ps> || SphLedger<Ps>)&&...),
      "Sph: a policy is not one of those for SPH: a kernel (WendlandC2, CubicSpline), a "
      "viscosity (ArtificialViscosity, LaminarViscosity, SpsTurbulence, HerschelBulkley, "
      "Inviscid), a diffusion "
      "(Fourtakas, MolteniColagrossi, NoDiffusion), Shifting, ShiftingByFastest or NoShifting, "
      "LeapfrogTime, SymplecticTime or VerletTime, MirroredWalls or DynamicWalls, Double or Mixed, "
      "UnresolvedGrains, RestoredVolume or DriftingVolume, EnergyLedger");
  template <SphAxis axis>
  static constexpr int count = (0 + ... + int{SphPolicyOf<Ps, axis>});
  static_assert(count<SphAxis::Kernel> <= 1, "Sph: two kernels are given; give one");
  static_assert(count<SphAxis::Viscosity> <= 1, "Sph: two viscosities are given; give one");
  static_assert(count<SphAxis::Diffusion> <= 1, "Sph: two diffusions are given; give one");
  static_assert(count<SphAxis::Shifting> <= 1, "Sph: two ways of shifting are given; give one");
  static_assert(count<SphAxis::Time> <= 1, "Sph: two time integrations are given; give one");
  static_assert(count<SphAxis::Walls> <= 1, "Sph: two kinds of walls are given; give one");
  static_assert(count<SphAxis::Grains> <= 1,
                "Sph: UnresolvedGrains is given twice; give it only once");
  static_assert(count<SphAxis::Volume> <= 1, "Sph: two ways of keeping volume are given; give one");
  static_assert((0 + ... + int{SphPrecision<Ps>}) <= 1, "Sph: two precisions are given; give one");
  static_assert((0 + ... + int{SphLedger<Ps>}) <= 1,
                "Sph: EnergyLedger is given twice; give it only once");
  static constexpr bool ledger = (false || ... || SphLedger<Ps>);

  /// The policy of an axis among those given.
  template <SphAxis axis, class Default, class First, class... Rest>
  static auto one_of(const Default& otherwise, const First& first, const Rest&... rest) {
    if constexpr (SphPolicyOf<First, axis>)
      return first;
    else
      return one_of<axis>(otherwise, rest...);
  }
  template <SphAxis, class Default>
  static auto one_of(const Default& otherwise) {
    return otherwise;
  }
  static auto kernel(const Ps&... all) { return one_of<SphAxis::Kernel>(WendlandC2{}, all...); }
  static auto viscosity(const Ps&... all) {
    return one_of<SphAxis::Viscosity>(ArtificialViscosity{}, all...);
  }
  static auto diffusion(const Ps&... all) {
    return one_of<SphAxis::Diffusion>(Fourtakas{}, all...);
  }
  static auto shifting(const Ps&... all) { return one_of<SphAxis::Shifting>(Shifting{}, all...); }
  static auto time(const Ps&... all) { return one_of<SphAxis::Time>(LeapfrogTime{}, all...); }
  static auto walls(const Ps&... all) { return one_of<SphAxis::Walls>(MirroredWalls{}, all...); }
  static auto grains(const Ps&... all) { return one_of<SphAxis::Grains>(ResolvedGrains{}, all...); }
  /// RestoredVolume by default where shifting computes what it needs.
  static auto volume(const Ps&... all) {
    constexpr bool restores =
        decltype(shifting(all...))::shifts && !decltype(grains(all...))::averaged;
    return one_of<SphAxis::Volume>(std::conditional_t<restores, RestoredVolume, DriftingVolume>{},
                                   all...);
  }
  using Kernel = decltype(kernel(std::declval<const Ps&>()...));
  using Viscosity = decltype(viscosity(std::declval<const Ps&>()...));
  using Diffusion = decltype(diffusion(std::declval<const Ps&>()...));
  using Shift = decltype(shifting(std::declval<const Ps&>()...));
  using Time = decltype(time(std::declval<const Ps&>()...));
  using Walls = decltype(walls(std::declval<const Ps&>()...));
  using Grains = decltype(grains(std::declval<const Ps&>()...));
  using Volume = decltype(volume(std::declval<const Ps&>()...));
  static_assert(!Grains::averaged || Time::two_stages,
                "Sph: UnresolvedGrains needs LeapfrogTime or SymplecticTime; leave out VerletTime");
  static_assert(
      !Grains::averaged || !Volume::restores,
      "Sph: UnresolvedGrains conserves volume by the void fraction; leave out RestoredVolume");
  /// float with Mixed.
  using PairScalar = std::conditional_t<(false || ... || std::is_same_v<Ps, Mixed>), float, double>;
};

}  // namespace detail

}  // namespace silt
