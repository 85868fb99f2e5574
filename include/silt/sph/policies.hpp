// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <utility>

#include <silt/core/precision.hpp>
#include <silt/sph/kernels.hpp>
#include <silt/sph/terms.hpp>

namespace silt::inline SILT_TARGET {

namespace detail {

template <class P>
concept IsSphKernel = requires {
  requires P::is_sph_kernel;
};
template <class P>
concept IsSphViscosity = requires {
  requires P::is_sph_viscosity;
};
template <class P>
concept IsSphDiffusion = requires {
  requires P::is_sph_diffusion;
};
template <class P>
concept IsSphShifting = requires {
  requires P::is_sph_shifting;
};
template <class P>
concept IsSphTime = requires {
  requires P::is_sph_time;
};
template <class P>
concept IsSphPrecision = requires {
  typename P::PairScalar;
};
template <class P>
concept SphPolicy = IsSphKernel<P> || IsSphViscosity<P> || IsSphDiffusion<P> || IsSphShifting<P> ||
    IsSphTime<P> || IsSphPrecision<P>;

/// The policies of an Sph by axis: what was given, or the default.
template <class... Ps>
struct SphPolicies {
  static_assert((SphPolicy<Ps> && ...),
                "Sph: a policy is none of those for SPH: a kernel (WendlandC2, CubicSpline), a "
                "viscosity (ArtificialViscosity, LaminarViscosity, Inviscid), a diffusion "
                "(Fourtakas, MolteniColagrossi, NoDiffusion), Shifting or NoShifting, "
                "SymplecticTime or VerletTime, Double or Mixed");
  static constexpr int kernels = (0 + ... + int{IsSphKernel<Ps>}),
                       viscosities = (0 + ... + int{IsSphViscosity<Ps>}),
                       diffusions = (0 + ... + int{IsSphDiffusion<Ps>}),
                       shiftings = (0 + ... + int{IsSphShifting<Ps>}),
                       times = (0 + ... + int{IsSphTime<Ps>}),
                       precisions = (0 + ... + int{IsSphPrecision<Ps>});
  static_assert(kernels <= 1, "Sph: two kernels are given; give one");
  static_assert(viscosities <= 1, "Sph: two viscosities are given; give one");
  static_assert(diffusions <= 1, "Sph: two diffusions are given; give one");
  static_assert(shiftings <= 1, "Sph: two ways of shifting are given; give one");
  static_assert(times <= 1, "Sph: two time integrations are given; give one");
  static_assert(precisions <= 1, "Sph: two precisions are given; give one");

  template <class Default, class First, class... Rest>
  static auto first_of(const Default& otherwise, auto is, const First& first, const Rest&... rest) {
    if constexpr (decltype(is)::template value<First>)
      return first;
    else
      return first_of(otherwise, is, rest...);
  }
  template <class Default>
  static auto first_of(const Default& otherwise, auto) {
    return otherwise;
  }
  struct Kernels {
    template <class P>
    static constexpr bool value = IsSphKernel<P>;
  };
  struct Viscosities {
    template <class P>
    static constexpr bool value = IsSphViscosity<P>;
  };
  struct Diffusions {
    template <class P>
    static constexpr bool value = IsSphDiffusion<P>;
  };
  struct Shiftings {
    template <class P>
    static constexpr bool value = IsSphShifting<P>;
  };
  struct Precisions {
    template <class P>
    static constexpr bool value = IsSphPrecision<P>;
  };
  struct Times {
    template <class P>
    static constexpr bool value = IsSphTime<P>;
  };
  static auto kernel(const Ps&... all) { return first_of(WendlandC2{}, Kernels{}, all...); }
  static auto viscosity(const Ps&... all) {
    return first_of(ArtificialViscosity{}, Viscosities{}, all...);
  }
  static auto diffusion(const Ps&... all) { return first_of(Fourtakas{}, Diffusions{}, all...); }
  static auto shifting(const Ps&... all) { return first_of(Shifting{}, Shiftings{}, all...); }
  static auto time(const Ps&... all) { return first_of(SymplecticTime{}, Times{}, all...); }
  static auto precision(const Ps&... all) { return first_of(Double{}, Precisions{}, all...); }
  using Kernel = decltype(kernel(std::declval<const Ps&>()...));
  using Viscosity = decltype(viscosity(std::declval<const Ps&>()...));
  using Diffusion = decltype(diffusion(std::declval<const Ps&>()...));
  using Shift = decltype(shifting(std::declval<const Ps&>()...));
  using Time = decltype(time(std::declval<const Ps&>()...));
  using Precision = decltype(precision(std::declval<const Ps&>()...));
};

}  // namespace detail

}  // namespace silt
