// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <tuple>

#include <silt/core/dyn_array.hpp>
#include <silt/core/threads.hpp>
#include <silt/coupling/drag/oriented.hpp>
#include <silt/coupling/particles_in_fluid.hpp>

/// Requirements of the drag law and the forces of a CoupledFlow.
namespace silt::inline SILT_TARGET::detail {

template <class F>
inline constexpr bool wants_strain = requires {
  requires F::needs_strain;
};
template <class F>
inline constexpr bool wants_mean_diameter = requires {
  requires F::needs_mean_diameter;
};
template <class F>
inline constexpr bool wants_forms = requires {
  requires F::sees_forms;
};
template <class F>
inline constexpr bool remembers = requires {
  requires F::has_history;
};
/// It uses the particles' rotation: it says so.
template <class F>
inline constexpr bool wants_rotation = requires {
  requires F::needs_spin;
};
/// It may read InFluid::angular_velocity: a force or a law of bodies that does not deny it.
template <class F>
inline constexpr bool reads_spin = [] {
  if constexpr (requires { bool(F::needs_spin); })
    return bool(F::needs_spin);
  else
    return true;
}();
template <class Drag>
inline constexpr bool drag_reads_spin = [] {
  if constexpr (OrientedDragLaw<Drag>)
    return reads_spin<Drag>;
  else
    return false;
}();

/// K [kg/s] of model A.
template <class Drag>
double drag_on(const Drag& drag, const InFluid& at, double Re) {
  if constexpr (OrientedDragLaw<Drag>)
    return 3 * std::numbers::pi * at.viscosity * at.diameter * at.voidage * drag.normalised(at, Re);
  else
    return drag_coefficient(drag, at.voidage, Re, at.diameter, at.viscosity);
}

/// Lets a law or a force refuse forms outside its range.
template <class Drag, class Forces>
void check_forms(const CoupledParticles& of, const Drag& drag, const Forces& forces) {
  for (const std::uint32_t form : of.shape.form)
    require(form < of.forms.size(), "CoupledParticles: form ", form, " of a body, but there are ",
            of.forms.size(), " forms; give a FormInFlow for each (form_in_flow)");
  const auto ask = [&](const auto& one) {
    if constexpr (requires { one.check_form(nullptr); }) {
      if (of.forms.empty()) one.check_form(nullptr);
      for (const auto& form : of.forms) one.check_form(&form);
    }
  };
  ask(drag);
  std::apply([&](const auto&... force) { (ask(force), ...); }, forces);
}

template <class Forces>
void remember_slips(Forces& forces, std::span<const ParticleId> id, std::span<const Vec3d> slip,
                    double dt, const Team& team) {
  const auto tell = [&](auto& force) {
    if constexpr (remembers<std::decay_t<decltype(force)>>) force.remember(id, slip, dt, team);
  };
  std::apply([&](auto&... force) { (tell(force), ...); }, forces);
}

template <class Forces, class Visit>
void visit_histories(Forces& forces, const Visit& visit) {
  const auto one = [&](auto& force) {
    if constexpr (remembers<std::decay_t<decltype(force)>>) {
      DynArray<double> state = force.state();
      visit(std::string("fluid.history"), state);
      force.restore(state);
    }
  };
  std::apply([&](auto&... force) { (one(force), ...); }, forces);
}

}  // namespace silt::detail
