// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <vector>

// Parts of Simulation: adding walls and particles.

#include <silt/core/dyn_array.hpp>
#include <silt/simulation.hpp>

namespace silt::inline SILT_TARGET {

template <class... Policies>
std::size_t Simulation<Policies...>::add_wall(Surfaces surfaces,
                                              const typename ContactsType::Material& solid,
                                              WallSetup setup) {
  detail::refuse_in_deforming_box<Domain>("a wall");
  for (const auto& part : surfaces.parts)
    detail::visit_surface(part, [](const auto& s) {
      if constexpr (requires { s.check(); }) s.check();
    });
  require(!surfaces.parts.empty(), "add_wall: there are no surfaces; give at least one");
  const std::size_t k = engine_.walls.size();
  Wall wall;
  wall.surfaces = std::move(surfaces.parts), wall.extent = detail::extent_of(wall.surfaces);
  if (!setup.name.empty()) detail::check_wall_name(engine_.walls, setup.name, k);
  wall.name = std::move(setup.name), wall.motion = std::move(setup.motion);
  setup.surface_velocity.check();
  wall.belt = setup.surface_velocity;
  const bool is_driven = setup.drive.index() != 0;
  require(!is_driven || !wall.motion,
          "add_wall: a wall has either a motion or a drive (servo, slide, hinge, free body), not "
          "both; leave one of them out");
  detail::check_drive(setup.drive);
  detail::check_fits(setup.drive, wall.extent);
  wall.material = contacts_.add(solid, std::move(setup.material));
  wall.pose = wall.last_pose = wall.pose_at(time_), wall.added = time_;
  wall.reference = detail::turns_about(wall.motion, setup.drive);
  engine_.walls.push_back(std::move(wall));
  if (is_driven) this->release(k, std::move(setup.drive));
  // In an observer; otherwise they are computed as a run begins.
  if (running_ && engine_.walls[k].material >= engine_.coefficients.materials)
    engine_.set_coefficients(contacts_), engine_.set_flux_coefficients(modules_, contacts_);
  engine_.lists.forget();
  scene_changed_ = true, scene_step_ = step_;
  return k;
}

template <class... Policies>
std::vector<std::size_t> Simulation<Policies...>::add(const ParticlesType& more) {
  using Particle = typename ParticlesType::Particle;
  check_new(std::span<const Particle>(more.all()),  // before anything is changed
            [&](const Particle& p, std::size_t k) { more.check(p, k); });
  const auto numbers = detail::take_in_forms(engine_, more);
  take_in(std::span<const Particle>(more.all()), numbers);
  scene_changed_ = true, scene_step_ = step_;
  return numbers;
}

template <class... Policies>
double Simulation<Policies...>::insert(const DynArray<PlacedSphere>& spheres,
                                       const DynArray<std::size_t>& kinds, const InletFlow& flow,
                                       Random& random) {
  if (spheres.empty()) return 0;
  using Particle = typename ParticlesType::Particle;
  // The given velocity is that of this instant; rows hold that of half a step ago.
  const double ago = first_kick_ || Integrator::first_kick != 0.5 ? 0 : 0.5 * dt_;  // [s]
  const Vec3d staggered = flow.velocity - ago * gravity;
  const std::size_t before = rows();
  const auto more = detail::particles_at<Particle>(spheres, kinds, flow, staggered, random);
  check_new(std::span<const Particle>(more), [&](const Particle& p, std::size_t k) {
    if constexpr (requires { engine_.mover.forms; })
      ParticlesType::check(p, k, engine_.mover.forms);
    else
      ParticlesType::check(p, k);
  });
  take_in(std::span<const Particle>(more), {});
  if constexpr (has_ledger) {
    // The ledger needs that of this instant.
    for (std::size_t k = before; k < rows() && !first_kick_; ++k) {
      const Vec3d row = engine_.owner(k).velocity(), now = row + ago * gravity;
      book_.bring_in(0.5 * mass(k) * (dot(now, now) - dot(row, row)));
    }
  }
  double brought = 0;  // [kg]
  if constexpr (has_ranks)
    for (const Particle& p : more) brought += detail::mass_to_come(engine_, p);
  else
    for (std::size_t k = before; k < rows(); ++k) brought += mass(k);
  return brought;
}

/// Refuses particles that do not fit into the scene; check(particle, number) checks the shape.
template <class... Policies>
template <class Particle, class Check>
void Simulation<Policies...>::check_new(std::span<const Particle> more, const Check& check) const {
  for (std::size_t k = 0; k < more.size(); ++k) {
    const auto& p = more[k];
    check(p, k);
    require(p.radius > 0, "particle ", k, ": radius = 0 [m] must be greater than 0");
    if (guard.domain)
      require(guard.domain->contains(p.position), "particle ", k, " at ", p.position,
              " m is outside guard.domain from ", guard.domain->min, " to ", guard.domain->max,
              " m");
    if constexpr (Domain::periodic)
      for (int d = 0; d < 3; ++d)
        if (domain_.repeats(d) && domain_.length(d) < 6 * p.radius)
          throw InputError(text(Domain::policy_name, ": its length ",
                                detail::sentence(domain_.length(d)),
                                " [m] must be at least 3 diameters of particle ", k, " of radius ",
                                p.radius, " m: ", detail::sentence(6 * p.radius), " m"));
    require(p.material < contacts_.materials() || !ContactsType::several_materials, "particle ", k,
            ": material ", p.material, " is not in the table of ", contacts_.materials(),
            " materials; add it to the contacts first");
    if (!ContactsType::several_materials && p.material != 0)
      throw InputError(text("particle ", k, ": ", contacts_.material_name(p.material),
                            " needs Contacts<Law, SeveralMaterials>; without it all particles are "
                            "of the first material"));
  }
}

/// Adds particles that have been checked. `numbers`: of their forms, unless these are the engine's.
template <class... Policies>
template <class Particle>
void Simulation<Policies...>::take_in(std::span<const Particle> more,
                                      std::span<const std::size_t> numbers) {
  const std::size_t before = rows();
  join(more, numbers);
  if constexpr (has_ledger)
    for (std::size_t k = before; k < rows() && !first_kick_; ++k)
      if (std::isfinite(mass(k))) book_.bring_in(kinetic(k).sum() + potential(k));
  if constexpr (has_breakage)
    detail::on_all_ranks(*this, "the strengths of particles", [&] { this->feed(before); });
}

/// The same without booking mass and energy. `own`: with several ranks, which of them this rank
/// owns; if empty, the decomposition decides.
template <class... Policies>
template <class Particle>
void Simulation<Policies...>::join(std::span<const Particle> more,
                                   std::span<const std::size_t> numbers,
                                   [[maybe_unused]] std::span<const char> own) {
  const std::size_t before = rows(), first_row = engine_.particles.size();
  if constexpr (has_ranks) {
    detail::take_in_own(engine_, more, numbers, kicked_, next_, domain_,
                        [&](const Vec3d& place, std::size_t k) {
                          return own.empty() ? engine_.ranks.takes(place, k, more.size()) : own[k];
                        });
    if (kicked_) engine_.start_prediction(before, gravity, dt_);
  } else {
    detail::take_in(engine_, more, numbers, kicked_, next_);
    if (kicked_) engine_.start_prediction(first_row, gravity, dt_);
    engine_.join_lists(domain_, dt_, first_row);
  }
  start_fields(before);
}

}  // namespace silt
