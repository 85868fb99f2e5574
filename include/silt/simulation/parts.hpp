// silt - BSD-3-Clause, see LICENSE
#pragma once

// Parts of Simulation that are not the loop: taking in particles, beginning a run, its limits.

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
  wall.pose = wall.last_pose = wall.pose_at(time_);
  wall.reference = detail::turns_about(wall.motion, setup.drive);
  engine_.walls.push_back(std::move(wall));
  if (is_driven) this->release(k, std::move(setup.drive));
  engine_.lists.forget();
  scene_changed_ = true, scene_step_ = step_;
  return k;
}

template <class... Policies>
detail::StepTimes Simulation<Policies...>::times_of_step(bool observed) const {
  detail::StepTimes t{.step = dt_,
                      .worked = first_kick_ ? 0 : dt_,
                      .ask = observed || first_kick_ || step_ % detail::ledger_asks_every == 0,
                      .lag = Integrator::lag,
                      .now = time_,
                      .renew_areas = step_ % detail::StepTimes::areas_every == 0};
  if constexpr (has_breakage)
    t.parting = this->breakage().rules.separation_speed, t.weak_from = breaks_.weak_from;
  if constexpr (has_events) {
    // Contacts come to rest in steps in which those at rest are looked at, so that no step counts
    // twice.
    constexpr auto every = detail::StepTimes::look_at_rest_every;
    const std::int64_t looked = step_ - 1 - (step_ + every - 1) % every;
    t.watched = engine_.events.wanted, t.look_at_rest = step_ % every == 0;
    t.at_rest_from = time_at(looked - detail::StepTimes::at_rest_after);
  }
  return t;
}

template <class... Policies>
EnergyBalance Simulation<Policies...>::balance() const {
  static_assert(has_ledger,
                "energy() reads the books of a policy that is missing: give the simulation "
                "silt::EnergyLedger{} among its policies");
  require(step_ > 0 || kicked_,
          "Simulation::energy: run() first, if only for 0 s: the forces at the "
          "start are not known yet");
  double translation = 0, rotation = 0, potentials = 0, walls = 0;
  for (const Wall& wall : engine_.walls) walls += detail::energy_of(wall, gravity_booked_).sum();
  for (std::size_t k = 0; k < rows(); ++k) {
    if (!is_present(k) || !std::isfinite(mass(k))) continue;
    const auto part = kinetic(k);
    translation += part.translation, rotation += part.rotation, potentials += potential(k);
  }
  EnergyBalance balance{};
  if constexpr (has_ledger)
    balance = book_.balance(translation, rotation, potentials, walls, this->rank() == 0);
  if constexpr (has_ledger && has_bonds) balance.bonds = this->own_bond_energy();
  if constexpr (has_ledger && has_breakage) balance.parting = breaks_.parted;
  if constexpr (has_ledger && detail::deforms<Domain>) balance.box = domain_.work();
  if constexpr (has_ranks) {
    auto numbers = std::bit_cast<std::array<double, sizeof balance / sizeof(double)>>(balance);
    this->sum_over_ranks(std::span<double>(numbers));
    balance = std::bit_cast<EnergyBalance>(numbers);
  }
  return balance;
}

template <class... Policies>
typename Simulation<Policies...>::Kinetic Simulation<Policies...>::kinetic(std::size_t k) const {
  return {this->translational_energy(k), this->rotational_energy(k)};
}

/// Refuses particles that do not fit into the scene. `check` is that of the shape.
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
        require(!domain_.repeats(d) || domain_.length(d) >= 6 * p.radius, Domain::policy_name,
                ": its length ", domain_.length(d),
                " [m] must be at least 3 diameters of particle ", k, " of radius ", p.radius, " m");
    require(p.material < contacts_.materials() || !ContactsType::several_materials, "particle ", k,
            ": material ", p.material, " is not in the table of ", contacts_.materials(),
            " materials; add it to the contacts first");
    if (!ContactsType::several_materials && p.material != 0)
      throw InputError(text("particle ", k, ": ", contacts_.material_name(p.material),
                            " needs Contacts<Law, SeveralMaterials>; without it all particles are "
                            "of the first material"));
  }
}

template <class... Policies>
std::vector<std::size_t> Simulation<Policies...>::add(const ParticlesType& more) {
  using Particle = typename ParticlesType::Particle;
  check_new(std::span<const Particle>(more.all()),  // before anything changes
            [&](const Particle& p, std::size_t k) { more.check(p, k); });
  const auto numbers = detail::take_in_forms(engine_, more);
  take_in(std::span<const Particle>(more.all()), numbers);
  scene_changed_ = true, scene_step_ = step_;
  return numbers;
}

/// Adds particles that have been checked; `numbers` of their forms, if they are not the engine's.
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

/// The same without books of mass and energy. `own`: on many ranks which of them are this rank's,
/// if that is not for the decomposition to say.
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

template <class... Policies>
double Simulation<Policies...>::insert(const std::vector<PlacedSphere>& spheres,
                                       const std::vector<std::size_t>& kinds, const InletFlow& flow,
                                       Random& random) {
  if (spheres.empty()) return 0;
  using Particle = typename ParticlesType::Particle;
  // The velocity is that of this instant; rows hold that of half a step ago.
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
    // ... and the ledger wants that of this instant.
    for (std::size_t k = before; k < rows() && !first_kick_; ++k)
      book_.bring_in(0.5 * mass(k) *
                     (dot(flow.velocity, flow.velocity) - dot(staggered, staggered)));
  }
  double brought = 0;  // [kg]
  if constexpr (has_ranks)
    for (const Particle& p : more) brought += detail::mass_to_come(engine_, p);
  else
    for (std::size_t k = before; k < rows(); ++k) brought += mass(k);
  return brought;
}

template <class... Policies>
void Simulation<Policies...>::book_step([[maybe_unused]] const detail::StepTimes& times,
                                        [[maybe_unused]] double bond_power) {
  if constexpr (has_ledger) {
    double start = 0;
    if (first_kick_) {
      for (std::size_t k = 0; k < rows(); ++k)
        if (is_present(k) && std::isfinite(mass(k))) start += kinetic(k).sum() + potential(k);
      if constexpr (has_bonds) start += this->own_bond_energy();
    }
    if constexpr (has_bonds) book_.bonds_damped(bond_power, times.worked);
    engine_.contact_energy.worked(0.5 * times.worked);
    book_.book(engine_.contact_energy, engine_.walls, dt_,
               engine_.power_on_fixed() - detail::power_of_belts(engine_.walls),
               first_kick_ ? &start : nullptr, times.ask,
               [this](std::span<double> numbers) { this->sum_over_ranks(numbers); });
  }
}

template <class... Policies>
void Simulation<Policies...>::book_leaving([[maybe_unused]] std::size_t k) {
  if constexpr (has_breakage) this->note_leaving(k);
  if constexpr (has_ledger) {
    if (first_kick_ || !std::isfinite(mass(k))) return;
    // Unless it is observed, rows hold the velocity of half a step ago; it falls freely.
    const double ago = !kicked_ && Integrator::first_kick == 0.5 ? 0.5 * dt_ : 0;  // [s]
    const Vec3d v = velocity(k), now = v + ago * gravity;
    book_.bring_in(0.5 * mass(k) * (dot(v, v) - dot(now, now)) - kinetic(k).sum() - potential(k));
  }
}

template <class... Policies>
void Simulation<Policies...>::prepare() {
  if constexpr (has_ranks) {
    this->share_edits("the start of a run", [this] { check_start(), modules_.check(*this); });
    share_scene();
    if constexpr (has_bonds) this->share_bonds();
    engine_.ranks.together("the time step of a run", [this] { begin_run(); });
  } else {
    check_start();
    modules_.check(*this);
    begin_run();
  }
}

/// What a run is given.
template <class... Policies>
void Simulation<Policies...>::check_start() {
  require_positive("Guard.max_overlap", guard.max_overlap, "-");
  require_positive("Guard.max_time_step", guard.max_time_step, "-");
  require_positive("Guard.max_travel", guard.max_travel, "-");
  require_positive("Guard.max_rate", guard.max_rate, "-");
  // A mesh is hard from both sides: how deep a particle is in it is known up to its radius.
  for (const Wall& wall : engine_.walls)
    for (const auto& surface : wall.surfaces) {
      const double overlap = overlap_limits_.most(wall.material, guard.max_overlap);
      require(
          guard.through_meshes || overlap + guard.max_travel < 1 || !detail::is_mesh(surface),
          overlap > guard.max_overlap ? "the limit of set_max_overlap = " : "Guard.max_overlap = ",
          overlap, " and Guard.max_travel = ", guard.max_travel,
          " [-] must be less than 1 together where there are meshes: a "
          "particle could come out behind one unseen (guard.through_meshes = true lets them)");
    }
  this->check_inlets();
  if constexpr (detail::deforms<Domain>) {
    detail::refuse_tension<typename ContactsType::Law>(domain_.deformation());
    require(!engine_.particles.some_fixed,
            "DeformingBox: a fixed particle cannot follow it; leave Particle.fixed out");
    require(!has_ledger || dot(gravity, gravity) == 0,
            "EnergyLedger in a DeformingBox needs Simulation::gravity = 0: what returns on the "
            "other side has fallen without a floor");
  }
  require(is_finite(gravity), "Simulation::gravity = ", gravity, " [m/s2] must be finite");
  if constexpr (has_ledger) {
    double change = 0;
    for (std::size_t k = 0; k < rows() && !first_kick_; ++k)
      if (is_present(k) && std::isfinite(mass(k)))
        change -= mass(k) * dot(gravity - gravity_booked_, position(k));
    book_.change_gravity(change);
    gravity_booked_ = gravity;
  }
  detail::check_inertia<ShapeType>();
  if (step_ > 0 || kicked_) detail::check_given(engine_, gravity, step_, time_);
  prepare_fluid();
  engine_.set_threads(threads);
}

/// What follows from the scene, on many ranks from that of all.
template <class... Policies>
void Simulation<Policies...>::begin_run() {
  this->check_pairs();
  engine_.set_coefficients(contacts_);
  engine_.set_flux_coefficients(modules_, contacts_);
  if constexpr (has_breakage) this->prepare_breakage();
  modules_.look_near(engine_, domain_, time_, true, true);
  if (dt_ == 0 || (time_step && *time_step != dt_) || (scene_changed_ && is_step_too_long()) ||
      (laws_changed_ && is_longer_than_own()))
    change_step(chosen_time_step());
  if (scene_changed_) checked_speed_ = 0;
  scene_changed_ = laws_changed_ = false;
  if (guard.domain) detail::check_inside(engine_, *guard.domain, step_, time_);
}

/// Takes out the bonds that this step has overloaded: their particles may touch from now on. And
/// those of particles that broke before it.
template <class... Policies>
void Simulation<Policies...>::break_bonds() {
  if constexpr (has_bonds) {
    bonds_broken_ = bonds_.take_broken(time_);
    if (bonds_broken_.empty()) return;
    std::vector<IndexPair> pairs;
    for (const BondBreak& bond : bonds_broken_) {
      if constexpr (has_ledger) book_.bond_broken(bond.energy);
      auto& held = engine_.particles.bonds;
      const bool has_both = !has_breakage || (find(bond.a) < rows() &&
                                              (bond.b == no_particle || find(bond.b) < rows()));
      if (bond.b == no_particle) {
        if (!held.holds(bond.a, held.id_of_wall(bond.wall)) ||
            bonds_.at_walls.exclude(bond.a, bond.wall))
          continue;
        held.remove(bond.a, held.id_of_wall(bond.wall));
        if (!has_both) continue;
        engine_.lists.forget();
        held.freed_at_walls.push_back({bond.a, bond.wall});
        continue;
      }
      held.remove(bond.a, bond.b);
      if (!has_both) continue;
      pairs.push_back({static_cast<std::uint32_t>(engine_.find(bond.a)),
                       static_cast<std::uint32_t>(engine_.find(bond.b))});
    }
    engine_.join_pairs(domain_, dt_, pairs);
  }
}

/// The same on many ranks, after the step in which any of them has overloaded bonds: all take out
/// what they have of them (collective).
template <class... Policies>
void Simulation<Policies...>::break_bonds_of_ranks() {
  if constexpr (has_bonds && has_ranks) {
    bonds_broken_.clear();
    if (!engine_.bonds_break) return;
    auto& held = engine_.particles.bonds;
    std::vector<IndexPair> pairs;
    bool freed = false;
    bonds_broken_ = bonds_.take_broken(engine_, time_, [&](const auto& bond) {
      if (bond.b == no_particle) {
        if (!held.holds(bond.a, held.id_of_wall(bond.wall)) ||
            bonds_.at_walls.exclude(bond.a, bond.wall))
          return;
        held.remove(bond.a, held.id_of_wall(bond.wall));
        held.freed_at_walls.push_back({bond.a, bond.wall}), freed = true;
        return;
      }
      if (!held.holds(bond.a, bond.b)) return;  // of other ranks
      held.remove(bond.a, bond.b);
      const auto row_of = [&](ParticleId which) {
        return static_cast<std::uint32_t>(engine_.row_of(which));
      };
      pairs.push_back({row_of(bond.a), row_of(bond.b)});
    });
    for ([[maybe_unused]] const BondBreak& bond : bonds_broken_)
      if constexpr (has_ledger) book_.bond_broken(bond.energy);
    engine_.join_pairs(domain_, dt_, pairs);
    if (engine_.ranks.any(freed)) engine_.lists.forget();
  }
}

template <class... Policies>
void Simulation<Policies...>::check_walls() const {
  for (std::size_t w = 0; w < engine_.walls.size(); ++w)
    if (engine_.walls[w].moves()) detail::check_pose(engine_.walls, w, step_, time_);
}

template <class... Policies>
void Simulation<Policies...>::keep_limits() {
  peak_overlap_ = std::max(peak_overlap_, engine_.largest_overlap);
  const bool lets_pass = detail::lets_long_steps_pass(guard);
  if (!engine_.finite) detail::throw_not_finite(engine_, step_, time_, lets_pass);
  if (kicked_) detail::check_spins(engine_, step_, time_, lets_pass);
  // Unless observers look at this step, the particles have moved on from where forces acted.
  const double back = kicked_ ? 0 : dt_;
  if (engine_.largest_overlap > overlap_limits_.least(guard.max_overlap))
    detail::check_overlaps(
        engine_, domain_, step_, time_, back, guard.max_overlap, overlap_limits_,
        detail::OverlapWords{
            step_ <= scene_step_ + (scene_step_ > 0), [this] { return is_longer_than_chosen(); },
            [this](std::size_t k) { return detail::name_of_material(contacts_, k); },
            [this](const Vec3d& p) { return openings_.inlet_at(p); },
            [this](ParticleId which) { return this->resized_by(which, step_); }});
  detail::check_crowded(engine_, step_, time_, back);
  if constexpr (Modules::flux)
    if (engine_.fluxes().measured()) {
      check_module_rates();
      if constexpr (!has_ranks) choose_flux_steps();  // on ranks when all have come so far
    }
  if constexpr (Modules::in_pairs && !Modules::flux)
    if (modules_.near.measured()) check_module_rates();
  const double way = detail::wall_travel(engine_), dt = coming_step();
  const double wall_way = way * (dt / dt_), speed = std::max(engine_.largest_speed, way / dt_);
  if (speed > 1.05 * checked_speed_) {
    checked_speed_ = speed;
    const auto shortest = shortest_contact(checked_speed_);
    if (shortest && dt > guard.max_time_step * shortest->time) {
      const auto fastest = detail::fastest_particle(engine_).speed;
      throw SimulationError(
          text("step ", step_, ", t = ", time_, " s: the time step ", dt, " s is above its limit ",
               guard.max_time_step * shortest->time, " s at the largest speed ", checked_speed_,
               " m/s",
               speed > engine_.largest_speed
                   ? text(" (of ",
                          detail::name_of_wall(engine_.walls, detail::fastest_wall(engine_)),
                          ", which was slower where the step was chosen)")
               : fastest.is_of_tips() ? fastest.words()
                                      : text(" (of particle ", fastest.id, ')'),
               ", guard.max_time_step of the shortest contact that can happen: that ",
               detail::describe(*shortest, contacts_), step_advice()),
          step_, {}, {});
    }
  }
  detail::check_travel(engine_, wall_way, step_, time_, dt, guard.max_travel);
  keep_rates(back);
  if (guard.domain && engine_.lists.upkeep.pruned_at == step_)
    detail::check_inside(engine_, *guard.domain, step_, time_);
}

/// What to do about a time step above its limit, for a sentence.
template <class... Policies>
std::string Simulation<Policies...>::step_advice() const {
  std::string advice = "; ";
  if (!time_step) {
    advice += "silt chose the time step, for slower or heavier ones: ";
    if constexpr (has_breakage)
      if (!this->follows_sizes())
        advice += "take BreakageRules.step = BreakStep::SmallestLiving, which follows them, or ";
  }
  return advice + "set a smaller Simulation::time_step or a softer material";
}

/// How fast the surface of particle k is at time().
template <class... Policies>
detail::SurfaceSpeed Simulation<Policies...>::surface_speed(std::size_t k) const {
  if constexpr (rotates) {
    const Vec3d w = angular_velocity(k);
    const double tips = engine_.owner(k).tip_speed(w);
    return {norm(velocity(k)), tips, of_bodies ? norm(w) : 0, id(k)};
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

/// Looks at all contacts, which takes as long as a few steps: now and then, and where the largest
/// overlap has grown by a quarter.
template <class... Policies>
void Simulation<Policies...>::keep_rates(double back) {
  if (engine_.largest_overlap > 1.25 * checked_overlap_)
    checked_overlap_ = engine_.largest_overlap;
  else if (step_ % detail::looks_at_rates_every != 0)
    return;
  check_module_rates();
  const double dt = coming_step();
  if constexpr (!has_ranks) detail::check_free_walls(engine_, step_, time_, dt, guard.max_rate);
  if (engine_.largest_overlap > 0)
    detail::ContactRates<Engine, Domain>(engine_, domain_, back, dt)
        .check(step_, time_, guard.max_rate);
}

/// The same of free walls on many ranks (collective).
template <class... Policies>
void Simulation<Policies...>::keep_rates_of_walls() {
  if constexpr (has_ranks) {
    const double overlap = engine_.largest_overlap;
    double& checked = ranks_scene_.checked_overlap;
    if (overlap > 1.25 * checked)
      checked = overlap;
    else if (step_ % detail::looks_at_rates_every != 0)
      return;
    if (std::any_of(engine_.walls.begin(), engine_.walls.end(),
                    [](const Wall& wall) { return detail::is_free(wall.drive); }))
      detail::check_free_walls_together(engine_, step_, time_, coming_step(), guard.max_rate);
  }
}

}  // namespace silt
