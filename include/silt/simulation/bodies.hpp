// silt - BSD-3-Clause, see LICENSE
#pragma once

// Parts of Simulation that are about rigid bodies.

#include <silt/simulation.hpp>

namespace silt::inline SILT_TARGET {

/// Takes in forms, but for those that are forms of the simulation already; returns the number of
/// each. Forms that come together are not compared with each other, so that the first ones keep the
/// numbers that add_form gave them.
template <class... Policies>
template <class Form>
std::vector<std::size_t> Simulation<Policies...>::add_forms(const std::vector<Form>& more) {
  auto& forms = engine_.mover.forms;
  const std::size_t before = forms.size();
  std::vector<std::size_t> numbers;
  for (const Form& form : more) {
    std::size_t k = 0;
    while (k < before && !forms[k].is(form)) ++k;
    if (k == before) k = forms.size(), forms.push_back(form);
    numbers.push_back(k);
  }
  return numbers;
}

/// Adds bodies, which check_new has seen. Their forms are numbered as those of the simulation, or
/// `numbers` has the number of each.
template <class... Policies>
template <class Particle>
void Simulation<Policies...>::add_bodies(std::span<const Particle> more,
                                         std::span<const std::size_t> numbers) {
  auto& mover = engine_.mover;
  std::uint32_t first = static_cast<std::uint32_t>(mover.rows.size());
  const std::size_t before = mover.bodies.size();
  for (const auto& p : more) {
    const auto number = static_cast<std::uint32_t>(numbers.empty() ? p.form : numbers[p.form]);
    const auto& form = mover.forms[number];
    const double scale = p.radius / form.radius, volume = form.mass.volume * scale * scale * scale;
    detail::Body b{};
    b.centre = p.position, b.velocity = p.velocity, b.radius = p.radius, b.scale = scale;
    b.lever = scale * form.lever;
    b.inv_m = p.fixed ? 0 : 1 / (p.density * volume);
    b.inertia = p.fixed ? Vec3d{1, 1, 1}
                        : p.density * scale * scale * scale * scale * scale * form.mass.inertia;
    b.orientation = p.orientation * form.mass.axes;
    const Vec3d w = rotate(conjugate(b.orientation), p.angular_velocity);
    b.momentum = {w.x * b.inertia.x, w.y * b.inertia.y, w.z * b.inertia.z};
    b.id = next_id_++, b.form = number;
    b.first = first;
    for (std::uint32_t local = 0; local < form.parts.size(); ++local) {
      const Vec3d c = b.centre + rotate(b.orientation, scale * form.parts[local].centre);
      const double r = scale * form.parts[local].radius;
      typename Engine::Motion m{};
      m.inv_m = b.inv_m;
      if constexpr (Engine::rotates) m.inv_r = 1 / r;
      mover.rows.push_back(static_cast<std::uint32_t>(engine_.particles.size()));
      engine_.particles.add({c.x, c.y, c.z, r}, m, next_part_++,
                            static_cast<std::uint16_t>(p.material));
      engine_.particles.part.push_back({static_cast<std::uint32_t>(mover.bodies.size()), local});
    }
    first += static_cast<std::uint32_t>(form.parts.size());
    mover.bodies.push_back(b);
    mover.fluid.add();
    mover.put_in_place(engine_.particles, b);
    if (kicked_) mover.synchronous.push_back({p.velocity, p.angular_velocity});
  }
  if constexpr (has_ledger)
    for (std::size_t k = before; k < mover.bodies.size() && !first_kick_; ++k)
      if (std::isfinite(mass(k))) book_.bring_in(kinetic(k).sum() + potential(k));
  engine_.particles.measure();
  engine_.lists.forget();
}

/// How fast the surface of particle k is at time().
template <class... Policies>
detail::SurfaceSpeed Simulation<Policies...>::surface_speed(std::size_t k) const {
  if constexpr (has_bodies) {
    const Vec3d w = rotate(conjugate(bodies()[k].orientation), angular_velocity(k));
    return {norm(velocity(k)), bodies()[k].tip_speed(w), norm(w), id(k)};
  } else {
    return {norm(velocity(k)), 0, 0, id(k)};
  }
}

/// The particle whose surface is the fastest at time(), for a sentence at this speed.
template <class... Policies>
std::string Simulation<Policies...>::tips_at(double speed) const {
  for (std::size_t k = 0; k < rows(); ++k)
    if (is_present(k))
      if (const auto s = surface_speed(k); s.sum() == speed) return s.words();
  return {};
}

}  // namespace silt
