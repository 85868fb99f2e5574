// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>
#include <type_traits>
#include <utility>

#include <silt/contact/concept.hpp>
#include <silt/core/dyn_array.hpp>
#include <silt/core/error.hpp>
#include <silt/io/scene_look.hpp>
#include <silt/io/setup_warnings.hpp>
#include <silt/io/warning_limits.hpp>
#include <silt/module/heat/temperature.hpp>

namespace silt::inline SILT_TARGET {

/// Warnings of scenes that run but are probably mistakes: numbers in other units, gravity with the
/// wrong sign, missing walls, outlets that no particle reaches. Each is a sentence that says what,
/// where, and what to change. None stops a run.
///
///   for (const auto& sentence : silt::scene_warnings(sim)) std::puts(sentence.c_str());
///
/// progress() prints them at the start of a run; on_warnings(callback) passes them on
/// (io/progress.hpp). They are computed only on request, in O(particles + walls). What each checks
/// and what it does not: docs/tutorial.md, Warnings.
/// Tests: tests/io/scene_warnings.cpp (each fires; near misses and legitimate scenes do not).

namespace detail {

/// Whether gravity is Earth's in m/s2, or with `unit` 100 or 1000 in cm/s2 or mm/s2.
inline bool is_earths(const Vec3d& gravity, double unit) {
  const double g = norm(gravity) / unit;
  return g >= WarningLimits::least_g && g <= WarningLimits::most_g;
}
/// Scenes with such a gravity are not in reduced units, as simulations without a scale are.
inline bool has_scale(const Vec3d& gravity) {
  return is_earths(gravity, 1) || is_earths(gravity, 100) || is_earths(gravity, 1000);
}

inline std::string name_of(std::size_t outlet, const Box& region) {
  return text("outlet ", outlet, " from ", region.min, " to ", region.max, " m ");
}

/// Largest distance [m] of a particle between two checks of the outlets (Outlet, ListUpkeep).
template <class Sim>
double way_between_looks(const Sim& sim, const SceneLook& look) {
  const double step = look.fastest * sim.step_length();
  if constexpr (requires { sim.search().skin; }) {
    if (sim.search().skin) return step + *sim.search().skin / 10;
    return std::isfinite(look.list_diameter) ? step + 0.25 * look.list_diameter : step;
  } else {
    return step;
  }
}

/// A direction in which the scene has no extent beside the outlet, as in a flat scene, does not
/// count.
template <class Sim>
void warn_of_thin(const Sim& sim, const SceneLook& look, std::size_t outlet,
                  DynArray<std::string>& out) {
  const Box& region = sim.outlet(outlet).region;
  const double way = way_between_looks(sim, look);
  const auto of = [](const Vec3d& v) { return std::array{v.x, v.y, v.z}; };
  const auto min = of(region.min), max = of(region.max);
  const auto low = of(look.centres.min), high = of(look.centres.max);
  for (std::size_t d = 0; d < 3; ++d) {
    if (max[d] - min[d] >= way || (low[d] >= min[d] && high[d] <= max[d])) continue;
    out.push_back(text(name_of(outlet, region), "is ", about(max[d] - min[d]), " m thick along ",
                       "xyz"[d], ", and a particle may move by ", about(way),
                       " m between two checks of the outlet: some may pass through it; make it "
                       "thicker, best by a diameter"));
    return;
  }
}

/// The walls that separate an outlet from the particles as "wall 1 and wall 3", if none can reach
/// it. A wall that may be a lid or a mould, to be removed later, does not count: without it another
/// wall must still separate them, or there must be no other wall at all.
template <class Sim>
std::string walls_before(const Sim& sim, const Box& region) {
  std::string names;
  std::size_t count = 0, parts = 0, others = 0;
  for (std::size_t w = 0; w < sim.walls(); ++w) {
    const Wall& wall = sim.wall(w);
    if (!is_behind(region, wall)) {
      others += !wall.surfaces.empty();
      continue;
    }
    names += text(count++ > 0 ? " and " : "", sim.wall_name(w));
    parts += wall.surfaces.size();
  }
  constexpr bool repeats = Sim::Domain::periodic;  // then a single plane may be the lid of a column
  const bool sure = count > 1 || (count == 1 && others == 0 && (parts > 1 || !repeats));
  return sure ? names : std::string();
}

template <class Sim>
bool is_far_off(const Sim& sim, const SceneLook& look, const Box& region) {
  const double g = norm(sim.gravity);
  if (Sim::Fluid::active || Sim::Domain::periodic || look.walls_move || look.is_empty() ||
      look.particles < WarningLimits::few || !(g > 0))
    return false;
  const Vec3d down = sim.gravity * (1 / g);
  if (reach_along(region, down) > reach_along(look.all, down)) return false;  // they may fall there
  const double throw_width = look.fastest * look.fastest / g;
  return gap_between(region, look.all) >
         WarningLimits::far_off * (norm(look.all.extent()) + throw_width);
}

/// Warns of an outlet that no particle can reach; false if it is in order.
template <class Sim>
bool warn_of_outside(const Sim& sim, const SceneLook& look, std::size_t outlet,
                     DynArray<std::string>& out) {
  const Box& region = sim.outlet(outlet).region;
  const auto say = [&](const auto&... words) {
    out.push_back(name_of(outlet, region) + text(words...));
    return true;
  };
  // Particles are checked only at intervals and may be outside for a moment, by less than a
  // diameter.
  const double late = look.is_empty() ? 0 : 2 * look.largest_radius;
  if constexpr (Sim::Domain::periodic) {
    const auto& domain = sim.domain();
    const auto of = [](const Vec3d& v) { return std::array{v.x, v.y, v.z}; };
    const auto min = of(region.min), max = of(region.max), low = of(domain.box().min);
    for (int d = 0; d < 3; ++d) {
      const auto k = static_cast<std::size_t>(d);
      if (!domain.repeats(d)) continue;
      const double high = low[k] + domain.length(d);
      if (min[k] > high + late || max[k] < low[k] - late)
        return say("is outside the periodic box, which is periodic along ", "xyz"[d], " from ",
                   about(low[k]), " to ", about(high),
                   " m: a particle that leaves there re-enters at the other side; move the "
                   "outlet into the box, or make the box not periodic along ",
                   "xyz"[d]);
    }
  }
  if (const auto& domain = sim.guard.domain; domain && gap_between(region, *domain) > late)
    return say("lies outside guard.domain from ", domain->min, " to ", domain->max,
               " m: a particle on its way there stops the run; enlarge guard.domain, or move the "
               "outlet into it");
  if (const auto walls = walls_before(sim, region); !walls.empty())
    return say("is behind ", walls,
               ", and no particle can reach it (a plane is infinite); move it to the side "
               "where particles are, or leave an opening in the wall");
  if (is_far_off(sim, look, region))
    return say("is ", about(gap_between(region, look.all)),
               " m away from all that is in the scene, whose size is ",
               about(norm(look.all.extent())),
               " m, and gravity does not pull particles there; give positions in m, and put the "
               "outlet where particles leave");
  return false;
}

/// Particles that attract each other and walls may hang.
template <class ContactsType>
inline constexpr bool is_sticky = ActsAtDistance<typename ContactsType::Law> ||
                                  requires(const typename ContactsType::Material& material) {
  material.cohesion;
};

template <class Sim>
void warn_of_gravity(const Sim& sim, const SceneLook& look, DynArray<std::string>& out) {
  const Vec3d g = sim.gravity;
  const std::string name = text("gravity = ", g, " [m/s2] ");
  if (is_earths(g, 1000))
    out.push_back(name + "is the earth's in mm/s2; give it in m/s2, as 9.81, and all lengths in m");
  if (!(norm(g) > 0)) return;
  const Vec3d down = g * (1 / norm(g));
  bool falls_forever = !Sim::Fluid::active && !look.some_fixed && sim.outlets() == 0 &&
                       look.particles >= WarningLimits::few;
  if constexpr (Sim::Domain::periodic) {
    const double along[3] = {down.x, down.y, down.z};
    for (int d = 0; d < 3; ++d) falls_forever &= !sim.domain().repeats(d) || !(along[d] != 0);
  }
  if (falls_forever && sim.walls() == 0) {
    out.push_back(text("no walls: ", look.particles, " particles fall freely by ", name,
                       "and nothing will hold them; add walls (Simulation::add_wall) or an outlet "
                       "before the run, or leave gravity out"));
    return;
  }
  const bool held = walls_may_hold(sim, look, down);
  if (falls_forever && look.wall_parts > 0 && !held && !is_sticky<typename Sim::ContactsType>) {
    out.push_back(name +
                  text("has no wall in its way: ", look.particles,
                       " particles will fall out of the scene; reverse its sign, or close the "
                       "scene on that side, by a wall or an outlet"));
    return;
  }
  // In a closed box: gravity along z that pulls particles off a floor to its lid; down should be
  // -z.
  if (!(g.x == 0 && g.y == 0 && g.z > 0) || !has_scale(g) || sim.step() > 0 || !held) return;
  for (std::size_t w = 0; w < sim.walls(); ++w)
    for (const Surface& surface : sim.wall(w).surfaces)
      if (const auto* plane = std::get_if<Plane>(&surface);
          plane != nullptr && plane->unit().normal.z > 0.999 && !sim.wall(w).moves()) {
        out.push_back(name + text("pulls particles up, off the floor at z = ", plane->point.z,
                                  " m (", sim.wall_name(w),
                                  "); use a negative z if it should point down"));
        return;
      }
}

template <class Sim>
void warn_of_units(const Sim& sim, const SceneLook& look, DynArray<std::string>& out) {
  if (look.is_empty() || !has_scale(sim.gravity)) return;
  const double lightest =
      Sim::Fluid::active ? WarningLimits::lightest_bubble : WarningLimits::lightest_solid;
  if (look.largest_density > 0 && look.largest_density < lightest)
    out.push_back(text("the densest particle has ", about(look.largest_density),
                       " kg/m3, less than any ", Sim::Fluid::active ? "gas" : "solid",
                       "; give densities in kg/m3: 1 g/cm3 is 1000 kg/m3, 1 t/mm3 is 1e12 kg/m3"));
  if (!Sim::Fluid::active && look.particles >= WarningLimits::few &&
      2 * look.smallest_radius >= WarningLimits::largest_grain * (1 - 1e-9))
    out.push_back(text("the smallest particle is ", about(2 * look.smallest_radius),
                       " m across; give radii and all lengths in m: 1 mm is 0.001 m"));
}

/// Young's modulus [Pa] of a material, also of one that others are built on; else 0.
template <class Material>
double youngs_modulus_of(const Material& m) {
  if constexpr (requires { m.youngs_modulus; })
    return m.youngs_modulus;
  else if constexpr (requires { m.body; })
    return youngs_modulus_of(m.body);
  else
    return 0;
}

/// Moduli in GPa, or with too many zeros.
template <class Sim>
void warn_of_stiffness(const Sim& sim, const SceneLook& look, DynArray<std::string>& out) {
  if (look.is_empty() || !has_scale(sim.gravity)) return;
  for (std::size_t a = 0; a < sim.contacts().materials(); ++a) {
    const double E = youngs_modulus_of(sim.contacts().material(a));
    const bool soft = E > 0 && E < WarningLimits::softest;
    if (!soft && !(E > WarningLimits::stiffest)) continue;
    out.push_back(text("youngs_modulus = ", about(E), " Pa of ", sim.contacts().material_name(a),
                       " is ", soft ? "less than that of a gel" : "more than that of diamond",
                       "; give it in Pa: 1 GPa is 1e9 Pa, 1 MPa is 1e6 Pa"));
  }
}

/// Particles and walls so cold that degrees Celsius may have been given for K.
template <class Sim>
void warn_of_temperatures(const Sim& sim, DynArray<std::string>& out) {
  const auto is_odd = [](double T) { return T < WarningLimits::coldest; };
  const auto say = [&](const std::string& what, double T) {
    out.push_back(text(what, " has ", about(T),
                       " K, which may be degrees Celsius; give temperatures "
                       "in K: ",
                       about(T), " C is ", text(std::round(100 * (T + 273.15)) / 100), " K"));
  };
  if (!has_scale(sim.gravity)) return;
  Sim::Modules::for_each_type([&]<class M>(std::type_identity<M>) {
    if constexpr (std::is_same_v<FieldsOf<M>, HeatFields>) {
      double coldest = WarningLimits::coldest;
      for (std::size_t k = 0; k < sim.rows(); ++k)
        if (sim.is_present(k)) coldest = std::min(coldest, sim.template field<M>(k).temperature);
      coldest = -sim.largest_over_ranks(-coldest);
      if (is_odd(coldest)) say("the coldest particle", coldest);
      if constexpr (requires(const M& m) { m.walls.entries(); })
        for (const auto& entry : sim.template module<M>().walls.entries()) {
          const auto T = entry.value.value(WallHeat::Kind::HeldAt, sim.time());
          if (T && is_odd(*T))
            say(entry.by_name ? text("wall '", entry.name, "'") : sim.wall_name(entry.number), *T);
        }
    }
  });
}

/// Particles outside the grid of the flow, where no fluid force acts.
template <class Sim>
void warn_of_grid(const Sim& sim, DynArray<std::string>& out) {
  if constexpr (requires { sim.fluid().flow().grid().box(); }) {
    const auto& grid = sim.fluid().flow().grid();
    const Box& box = grid.box();
    Box inside = box;
    constexpr double far = std::numeric_limits<double>::infinity();
    if (grid.periodic(0)) inside.min.x = -far, inside.max.x = far;
    if (grid.periodic(1)) inside.min.y = -far, inside.max.y = far;
    if (grid.periodic(2)) inside.min.z = -far, inside.max.z = far;
    std::size_t all = 0, beyond = 0;
    for (std::size_t k = 0; k < sim.rows(); ++k)
      if (sim.is_present(k)) ++all, beyond += !inside.contains(sim.position(k));
    if (beyond > 0)
      out.push_back(text(beyond, " of ", all, " particles lie outside of the flow's grid from ",
                         box.min, " to ", box.max,
                         " m, where no fluid acts on them; enlarge or move the grid, or the "
                         "particles"));
  }
}

}  // namespace detail

/// Warnings of a scene before it runs: outlets, gravity, units, temperatures, the flow's grid, and
/// single settings (setup_warnings.hpp).
/// Empty if there are none. On many ranks equal on each, and collective (RankAccess).
template <class Sim>
[[gnu::cold]] DynArray<std::string> scene_warnings(const Sim& sim) {
  DynArray<std::string> out;
  const detail::SceneLook look = detail::look_at(sim);
  for (std::size_t k = 0; k < sim.outlets(); ++k)
    if (!detail::warn_of_outside(sim, look, k, out) && !detail::warn_of_emptying(sim, look, k, out))
      detail::warn_of_thin(sim, look, k, out);
  detail::warn_of_gravity(sim, look, out);
  detail::warn_of_units(sim, look, out);
  detail::warn_of_temperatures(sim, out);
  detail::warn_of_grid(sim, out);
  detail::warn_of_friction(sim, out), detail::warn_of_stiffness(sim, look, out);
  detail::warn_of_meshes(sim, look, out);
  detail::warn_of_belts(sim, out), detail::warn_of_late_motions(sim, out);
  detail::warn_of_inlets(sim, out), detail::warn_of_centres(sim, out);
  return out;
}

}  // namespace silt
