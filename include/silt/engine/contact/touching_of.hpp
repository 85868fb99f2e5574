// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <concepts>
#include <cstddef>

#include <silt/core/lanes.hpp>
#include <silt/core/vec3.hpp>
#include <silt/module/concept.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Whether a contact law reports how much softer than its solids a contact is (Softened).
template <class Law>
concept SaysSoftness = requires(const typename Law::template Coefficients<double>& p) {
  { Law::factor(p, 1.0, 1.0) } -> std::convertible_to<double>;
};

/// A pack of contacts as a module sees it; loads have overwritten the velocities.
template <class ContactsType, bool AtWall, class Real, class Scalar, class Block, class LawLanes>
inline Touching<Real> touching_of(const Block& block, std::size_t k, const Scalar* growth,
                                  [[maybe_unused]] const LawLanes& law) {
  const auto kin = block.template get<Real>(k);
  const auto loads = block.template get_load<Real>(k);
  Real softness(1);
  if constexpr (SaysSoftness<typename ContactsType::Law>) {
    const auto radii = block.template get_radii<Real>(k);
    softness = ContactsType::Law::factor(law(), radii.i, radii.j);
  }
  return {kin.normal,
          loads.force,
          dot(loads.force, kin.normal),
          kin.overlap,
          kin.R_eff,
          kin.m_eff,
          softness,
          growth == nullptr ? Real(0) : load<Real>(growth + k),
          AtWall};
}

}  // namespace silt::detail
