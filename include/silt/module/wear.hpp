// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cmath>
#include <concepts>
#include <cstddef>
#include <string>
#include <utility>

#include <silt/boundary/wall.hpp>
#include <silt/core/dyn_array.hpp>
#include <silt/core/error.hpp>
#include <silt/module/concept.hpp>

namespace silt::inline SILT_TARGET {

/// Wear by sliding:  V = k F_n s/H.
///
/// s is the sliding distance of the particle's surface along the wall, including its rotation. In
/// sticking contacts the motion that loads the tangential spring also counts (its sum is small).
/// Source: J.F. Archard, J. Appl. Phys. 24 (1953) 981, recalled; k is the dimensionless
///         coefficient, with the hardness as a separate factor.
/// Valid:  steady sliding of rough surfaces; k is measured, 1e-8 to 1e-2.
/// Tests:  tests/physics/wear.cpp (a sphere that slides, exact).
/// Units:  SI.
/// Errors: InputError naming field, value, unit and allowed range.
struct Archard {
  double coefficient = 0;  // [-] k > 0
  double hardness = 0;     // [Pa] H > 0 of the softer surface, the wall
  double volume(const WallRub& c) const {
    return coefficient * c.normal_force * c.slip * c.duration / hardness;
  }
  void check(const std::string& of) const {
    require_positive(of + "Archard.coefficient", coefficient, "-");
    require_positive(of + "Archard.hardness", hardness, "Pa");
  }
};

/// Wear of ductile walls by cutting impacts:  V = c m u^2 f(alpha)/(p psi K),
///
///   f = sin 2 alpha - (6/K) sin^2 alpha   where tan alpha <= K/6
///       (K/6) cos^2 alpha                 else
///
/// once per impact, with speed u and angle alpha (0: along the wall) of the particle's surface at
/// first touch. Sliding after the impact adds no wear; add Wear<Archard> to the simulation for it.
/// Source: I. Finnie, Wear 3 (1960) 87, recalled; f with K = 2 compared with the source of LIGGGHTS
///         (fix mesh/surface/stress, wear finnie), which also has it. LIGGGHTS integrates 2 k |F|
///         |u| f(alpha) over the approach of each contact instead; its result depends on the
///         contact law.
/// Valid:  hard sharp particles on ductile metals, alpha < 45 degrees. At 90 degrees the formula
///         gives no wear, while the wear of metals is a third of its maximum.
/// Tests:  tests/physics/wear.cpp (V at angles on both sides of the border).
/// Units:  SI.
/// Errors: InputError naming field, value, unit and allowed range.
struct Finnie {
  double flow_stress = 0;    // [Pa] p > 0
  double share_cutting = 1;  // [-] c share of particles that cut; 0.5 is usual for many
  double depth_ratio = 2;    // [-] psi: length of a cut over its depth
  double force_ratio = 2;    // [-] K: vertical over horizontal force
  double volume(const WallRub& c) const {
    if (!c.begins || !(c.approach > 0)) return 0;
    // u^2 f(alpha) from the components of the velocity
    const double n = c.approach, t = c.slip, K = force_ratio;
    const double f = 6 * n <= K * t ? 2 * n * t - 6 / K * n * n : K / 6 * t * t;
    return share_cutting * c.mass * f / (flow_stress * depth_ratio * K);
  }
  void check(const std::string& of) const {
    require_positive(of + "Finnie.flow_stress", flow_stress, "Pa");
    require_in(of + "Finnie.share_cutting", share_cutting, "-", 0, 1);
    require_positive(of + "Finnie.depth_ratio", depth_ratio, "-");
    require_positive(of + "Finnie.force_ratio", force_ratio, "-");
  }
};

/// Law of wear: `double volume(const WallRub&) const` [m3], for one contact in one step.
template <class L>
concept WearLaw = std::copyable<L> && requires(const L& law, const WallRub& c) {
  { law.volume(c) } -> std::convertible_to<double>;
};

/// Module: wear of walls that are triangle meshes by particles, for each facet. The walls keep
/// their shape.
///
///   silt::Simulation sim{grains, silt::Contacts<silt::HertzMindlin>{steel},
///                        silt::Wear<silt::Archard>{{.coefficient = 1e-4, .hardness = 2e9}}};
///   silt::worn_volumes<silt::Wear<silt::Archard>>(sim, "chute");   // [m3] of each facet
///   silt::write_wear<silt::Wear<silt::Archard>>("chute.vtp", sim, "chute");
///
/// A user-defined law has `double volume(const WallRub&) const` [m3], for one contact and one step,
/// and optionally check(words).
/// Errors: InputError naming the value; where no wall is a mesh.
/// Tests:  tests/physics/wear.cpp
/// Source: as its law.
/// Valid:  walls that are triangle meshes and keep their shape.
/// Units:  [m3].
template <WearLaw Law>
struct Wear {
  Law law{};                    // of all walls except
  DynArray<Law> first_walls{};  // ... of wall 0, 1, ..., as far as given

  double worn(const WallRub& c, std::size_t wall) const {
    return (wall < first_walls.size() ? first_walls[wall] : law).volume(c);
  }
  template <class Sim>
  void check(const Sim& sim) const {
    bool meshes = false;
    for (std::size_t w = 0; w < sim.walls(); ++w) {
      meshes |= sim.wall(w).is_removed();  // may have been one
      for (const auto& surface : sim.wall(w).surfaces) meshes |= detail::is_mesh(surface);
    }
    require(meshes,
            "Wear: no wall of this simulation is a triangle mesh, and wear is counted for their "
            "facets only; use a TriangleMesh or stl_wall()");
    require(first_walls.size() <= sim.walls(), "Wear.first_walls has ", first_walls.size(),
            " entries, but the simulation has ", sim.walls(), " walls");
    check_law(law, "Wear.law: ");
    for (std::size_t w = 0; w < first_walls.size(); ++w)
      check_law(first_walls[w], text("Wear.first_walls[", w, "]: "));
  }

 private:
  static void check_law(const Law& law, const std::string& of) {
    if constexpr (requires { law.check(of); }) law.check(of);
  }
};

}  // namespace silt
