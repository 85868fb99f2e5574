// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>

#include <silt/core/dyn_array.hpp>
#include <silt/core/names.hpp>
#include <silt/core/quaternion.hpp>
#include <silt/core/random.hpp>
#include <silt/engine/checks/time_step.hpp>
#include <silt/engine/population/cell_forms.hpp>
#include <silt/engine/population/openings.hpp>
#include <silt/engine/state/body.hpp>
#include <silt/fill/bodies.hpp>

namespace silt::inline SILT_TARGET::detail {

/// The form names of an engine after further ones are added; nothing else is changed yet.
struct NamesToCome {
  DynArray<std::string> of;

  /// Whether a new form with this name may be the same as form k: an unnamed form matches any name.
  bool may_be(std::size_t k, const std::string& name) const {
    return name.empty() || of[k].empty() || of[k] == name;
  }
  void give(std::size_t k, const std::string& name) {
    if (k == of.size()) of.emplace_back();
    if (name.empty() || !of[k].empty()) return;
    Names{"form", of.size(), [this](std::size_t f) -> const std::string& { return of[f]; },
          "add_form(shape, name)"}
        .check(name, k);
    of[k] = name;
  }
};

/// Adds forms of bodies, except those added before; returns the number of each. Forms added
/// together are not compared with each other, so that the first ones keep the numbers that add_form
/// returned; two forms with different names stay separate. Spheres have no forms. Throws
/// InputError, with nothing changed, if a name belongs to another form.
template <class Engine, class ParticlesType>
DynArray<std::size_t> take_in_forms(Engine& e, const ParticlesType& more) {
  DynArray<std::size_t> numbers;
  if constexpr (Engine::of_bodies) {
    auto& forms = e.mover.forms;
    const std::size_t known = added_forms(e.mover);
    NamesToCome names;
    for (std::size_t k = 0; k < known; ++k) names.of.push_back(forms[k].name);
    for (const auto& form : more.forms()) {
      const auto is_it = [&](std::size_t k) {
        return forms[k].is_copy_of(form) || (names.may_be(k, form.name) && forms[k].is(form));
      };
      std::size_t k = 0;
      while (k < known && !is_it(k)) ++k;
      if (k == known) k = names.of.size();
      names.give(k, form.name);
      numbers.push_back(k);
    }
    for (std::size_t f = 0; f < numbers.size(); ++f)
      if (numbers[f] == added_forms(e.mover)) add_form(e.mover, more.forms()[f]);
    for (std::size_t k = 0; k < names.of.size(); ++k) forms[k].name = names.of[k];
  }
  return numbers;
}

/// The next ids: of particles, and of the parts of bodies.
struct NextIds {
  ParticleId particle = 0, part = 0;
};

/// Calls visit(radius [m]) for each row that a particle will have: for a body, one per part.
template <class Engine, class Particle, class Visit>
void for_rows_to_come([[maybe_unused]] const Engine& e, const Particle& p,
                      [[maybe_unused]] std::span<const std::size_t> numbers, const Visit& visit) {
  if constexpr (Engine::of_bodies) {
    const auto& form = e.mover.forms[numbers.empty() ? p.form : numbers[p.form]];
    for (const auto& part : form.parts) visit(p.radius / form.radius * part.radius);
  } else {
    visit(p.radius);
  }
}

/// [kg] mass of a new particle, whose form has the engine's number.
template <class Engine, class Particle>
double mass_to_come([[maybe_unused]] const Engine& e, const Particle& p) {
  if constexpr (Engine::of_bodies) {
    const auto& form = e.mover.forms[p.form];
    const double scale = p.radius / form.radius;
    return p.density * form.mass.volume * scale * scale * scale;
  } else {
    return p.density * Engine::ShapeType::volume(p.radius);
  }
}

/// A new body of the engine's form `number`.
template <class Form, class Particle>
Body new_body(const Form& form, std::uint32_t number, const Particle& p) {
  const double scale = p.radius / form.radius, volume = form.mass.volume * scale * scale * scale;
  Body b{};
  b.centre = p.position, b.velocity = p.velocity, b.radius = p.radius, b.scale = scale;
  b.lever = scale * form.lever;
  b.inv_m = p.fixed ? 0 : 1 / (p.density * volume);
  b.inertia = p.fixed ? Vec3d{1, 1, 1}
                      : p.density * scale * scale * scale * scale * scale * form.mass.inertia;
  b.orientation = p.orientation * form.mass.axes;
  const Vec3d w = rotate(conjugate(b.orientation), p.angular_velocity);
  b.momentum = {w.x * b.inertia.x, w.y * b.inertia.y, w.z * b.inertia.z};
  b.form = number;
  return b;
}

/// Adds particles that have been checked behind all rows; `observed`: between kick and drift of a
/// step. Forms of bodies have the engine's numbers, or `numbers` gives the number of each.
template <class Engine, class Particle>
void take_in(Engine& e, std::span<const Particle> more,
             [[maybe_unused]] std::span<const std::size_t> numbers, bool observed, NextIds& next) {
  auto& mover = e.mover;
  const std::size_t first_row = e.particles.size();
  if constexpr (Engine::of_bodies) {
    auto first = static_cast<std::uint32_t>(mover.rows.size());
    for (const auto& p : more) {
      const auto number = static_cast<std::uint32_t>(numbers.empty() ? p.form : numbers[p.form]);
      const auto& form = mover.forms[number];
      Body b = new_body(form, number, p);
      b.id = next.particle++, b.first = first;
      for (std::uint32_t local = 0; local < form.parts.size(); ++local) {
        const Vec3d c = b.centre + rotate(b.orientation, b.scale * form.parts[local].centre);
        const double r = b.scale * form.parts[local].radius;
        typename Engine::ParticleMotion m{};
        m.inv_m = b.inv_m;
        if constexpr (Engine::rotates) m.inv_r = 1 / r;
        mover.rows.push_back(static_cast<std::uint32_t>(e.particles.size()));
        e.particles.add({c.x, c.y, c.z, r}, m, next.part++, static_cast<std::uint16_t>(p.material),
                        {static_cast<std::uint32_t>(mover.bodies.size()), local});
      }
      first += static_cast<std::uint32_t>(form.parts.size());
      mover.bodies.push_back(b);
      add_row(mover.fluid), add_row(mover.modules);
      mover.put_in_place(e.particles, b);
      if (observed) mover.synchronous.push_back({p.velocity, p.angular_velocity});
    }
  } else {
    for (const auto& p : more) {
      typename Engine::ParticleMotion m{};
      m.vx = p.velocity.x, m.vy = p.velocity.y, m.vz = p.velocity.z;
      m.inv_m = p.fixed ? 0 : 1 / (p.density * Engine::ShapeType::volume(p.radius));
      if constexpr (Engine::rotates) {
        const Vec3d spin = p.angular_velocity * p.radius;
        m.wx = spin.x, m.wy = spin.y, m.wz = spin.z, m.inv_r = 1 / p.radius;
      }
      if (observed) {
        typename Engine::Mover::Synchronous now{m.velocity(), {0, 0, 0}};
        if constexpr (Engine::rotates) now.spin_velocity = m.spin_velocity();
        mover.synchronous.push_back(now);
      }
      e.particles.add({p.position.x, p.position.y, p.position.z, p.radius}, m, next.particle++,
                      static_cast<std::uint16_t>(p.material));
    }
  }
  e.particles.measure_newcomers(first_row);
}

/// The same on several ranks: each takes its own particles, all count all of them. `takes(place,
/// k)`: whether particle k at this position [m] is this rank's.
template <class Engine, class Particle, class Domain, class Takes>
void take_in_own(Engine& e, std::span<const Particle> more, std::span<const std::size_t> numbers,
                 bool observed, NextIds& next, [[maybe_unused]] const Domain& domain,
                 const Takes& takes_one) {
  auto& p = e.particles;
  const std::size_t before = p.owned();
  // New rows are behind the ghosts for now, and so are their velocities.
  if constexpr (Engine::of_bodies)
    if (observed) e.mover.synchronous.resize(e.mover.bodies.size());
  // A rank without particles knows only the sizes that all ranks have agreed on; these are kept.
  const bool none = e.ranks.present() == 0;
  double largest = none ? 0 : p.largest_radius,
         smallest = none ? std::numeric_limits<double>::infinity() : p.smallest_radius;
  for (std::size_t k = 0; k < more.size(); ++k) {
    Vec3d place = more[k].position;
    if constexpr (Domain::periodic) place = domain.wrapped(place);
    const bool takes = takes_one(place, k);
    for_rows_to_come(e, more[k], numbers, [&](double radius) {
      largest = std::max(largest, radius), smallest = std::min(smallest, radius);
      if (Engine::of_bodies && !takes) ++next.part;
    });
    p.some_fixed |= more[k].fixed;
    if (takes)
      take_in(e, more.subspan(k, 1), numbers, observed, next);
    else
      ++next.particle;
  }
  if (!more.empty()) p.largest_radius = largest, p.smallest_radius = smallest;
  e.ranks.count(more.size());
  e.join_own(p.owned() - before);
}

/// The particles that an inlet creates at these places, with `velocity` [m/s] and its scatter;
/// bodies with random orientations.
template <class Particle>
DynArray<Particle> particles_at(const DynArray<PlacedSphere>& places,
                                const DynArray<std::size_t>& kinds, const InletFlow& flow,
                                const Vec3d& velocity, [[maybe_unused]] Random& random) {
  DynArray<Particle> more;
  for (std::size_t k = 0; k < places.size(); ++k) {
    const auto& s = places[k];
    const InletShare kind = flow.kind(kinds[k]);
    Particle p{};
    if constexpr (requires { p.orientation; })
      p.form = kind.form, p.orientation = random_orientation(random);
    p.position = s.position, p.radius = s.radius, p.density = kind.density;
    p.velocity = velocity, p.angular_velocity = flow.angular_velocity;
    if (const Vec3d& scatter = flow.scatter; norm(scatter) > 0) {
      const auto of = [&](double most) { return random.uniform(-most, most); };
      const double x = of(scatter.x), y = of(scatter.y), z = of(scatter.z);
      p.velocity += Vec3d{x, y, z};
    }
    p.material = kind.material;
    more.push_back(p);
  }
  return more;
}

/// What may meet: the present particles and those that inlets will still create; the walls that
/// have surfaces.
template <class Engine>
Meetings meetings_of(const Engine& e, const DynArray<Inlet>& inlets, std::size_t materials) {
  Meetings all{DynArray<LightestSpheres>(materials), DynArray<bool>(materials, false),
               DynArray<double>(materials, std::numeric_limits<double>::infinity())};
  for (std::size_t k = 0; k < e.owners(); ++k) {
    const auto p = e.owner(k);
    if (!p.is_there()) continue;
    auto& of_material = all.spheres[p.material()];
    if constexpr (Engine::of_bodies) {
      if (p.inverse_mass() > 0) {
        e.mover.forms[p.form()].include_lightest(of_material, p.scale(), p.mass());
        continue;
      }
    }
    of_material.include({p.radius(), p.mass()});
  }
  for (const auto& inlet : inlets) {
    const auto& flow = inlet.flow;
    if (flow.total > 0 && inlet.placed >= flow.total) continue;
    for (std::size_t k = 0; k < flow.kinds(); ++k) {
      const InletShare kind = flow.kind(k);
      for (const double r : {kind.radius.min(), kind.radius.max()}) {
        auto& of_material = all.spheres[kind.material];
        if constexpr (Engine::of_bodies) {
          const auto& form = e.mover.forms.at(kind.form);
          const double scale = r / form.radius;
          form.include_lightest(of_material, scale,
                                kind.density * form.mass.volume * scale * scale * scale);
        } else {
          of_material.include({r, kind.density * Engine::ShapeType::volume(r)});
        }
      }
    }
  }
  for (const Wall& wall : e.walls)
    if (!wall.surfaces.empty()) {
      all.walls[wall.material] = true;
      if (!is_free(wall.drive)) continue;
      auto& least = all.wall_mass[wall.material];
      least = std::min(least, least_mass_of(wall.drive, wall.state, reach_of(wall)));
    }
  return all;
}

/// Checks that the form of an inlet exists.
template <class Engine>
void check_form([[maybe_unused]] const Engine& e, const InletFlow& flow) {
  for (std::size_t k = 0; k < flow.kinds(); ++k) {
    const std::size_t form = flow.kind(k).form;
    const char* const of = k == 0 ? "InletFlow.form = " : "InletShare.form = ";
    if constexpr (Engine::of_bodies)
      require(form < added_forms(e.mover), of, form, " is none of the ", added_forms(e.mover),
              " forms of the simulation; make it with add_form before");
    else
      require(form == 0, of, form, ", but spheres have no form; leave it out");
  }
}
/// The flow with the sizes of the forms as they were made where it gives none.
template <class Engine>
InletFlow with_radii([[maybe_unused]] const Engine& e, InletFlow flow) {
  for (std::size_t k = 0; k < flow.kinds(); ++k) {
    SizeDistribution& radius = k == 0 ? flow.radius : flow.recipe[k - 1].radius;
    const char* const of = k == 0 ? "InletFlow" : "InletShare";
    if constexpr (Engine::of_bodies) {
      if (!radius.is_given()) radius = size_as_made(of, e.mover.forms.at(flow.kind(k).form));
    } else {
      require_radius(of, radius);
    }
  }
  return flow;
}
/// The flow with its mass rate converted to particles per second [1/s].
template <class Engine>
InletFlow with_number(const Engine& e, InletFlow flow) {
  if (flow.mass_rate == 0) return flow;
  require_positive("InletFlow.mass_rate", flow.mass_rate, "kg/s");
  require(flow.rate == 0, "InletFlow.rate = ", flow.rate,
          " [1/s] and InletFlow.mass_rate = ", flow.mass_rate,
          " [kg/s] are both given; give one of them");
  double mass = 0;  // [kg] mean
  for (std::size_t k = 0; k < flow.kinds(); ++k) {
    const InletShare kind = flow.kind(k);
    double fill;  // [-] volume relative to that of the bounding sphere
    if constexpr (Engine::of_bodies) {
      const auto& form = e.mover.forms.at(kind.form);
      fill = form.mass.volume / sphere_volume(form.radius);
    } else {
      fill = Engine::ShapeType::volume(1) / sphere_volume(1);
    }
    mass += kind.share * kind.density * fill * kind.radius.mean_volume();
  }
  require_positive("InletFlow: the mean mass of a particle", mass, "kg");
  flow.rate = flow.mass_rate / mass;
  return flow;
}

}  // namespace silt::detail
