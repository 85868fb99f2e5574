// silt - BSD-3-Clause, see LICENSE
#pragma once

// Parts of BreakAccess: positions and velocities of the fragments of a particle.

#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include <silt/breakage/placement.hpp>
#include <silt/core/dyn_array.hpp>
#include <silt/simulation/break_access.hpp>

namespace silt::inline SILT_TARGET::detail {

template <class Sim>
template <class Owner, class Particles>
void BreakAccess<Sim>::add_spheres(const Owner& p, const FragmentSizes& sizes, double density,
                                   Random& random, Particles& all) const {
  DynArray<double> radii;
  double whole = 0;
  for (const double m : sizes.masses)
    radii.push_back(0.5 * equal_volume_diameter(m / density)), whole += m;
  const auto places = place_fragments(radii, sizes.masses, p.radius(), random);
  Vec3d w{0, 0, 0};
  if constexpr (Sim::rotates)
    if (!radii.empty()) w = shared_rotation(p, places, radii, sizes.masses, whole / p.mass());
  for (std::size_t k = 0; k < radii.size(); ++k) {
    typename Particles::Particle one{};
    one.position = p.centre() + places[k], one.radius = radii[k], one.density = density;
    one.velocity = p.velocity() + cross(w, places[k]), one.angular_velocity = w;
    one.material = p.material();
    all.add(one);
  }
}

/// Cuts a polyhedron: the cells fill it and move as it did. One of them is the dust, which also
/// gets the mass that rounding leaves over.
template <class Sim>
template <class Owner, class Particles>
void BreakAccess<Sim>::add_cells(const Owner& p, FragmentSizes& sizes, double density,
                                 Random& random, Particles& all) const {
  if (sizes.masses.empty()) return;
  const auto& form = sim().engine_.mover.forms[p.form()];
  const auto body = form.shape.scaled(p.scale());
  DynArray<double> shares;
  for (const double m : sizes.masses) shares.push_back(m / p.mass());
  if (sizes.dust > 1e-8 * p.mass())
    shares.push_back(sizes.dust / p.mass());
  else
    shares.front() += sizes.dust / p.mass();
  static_assert(
      requires { laguerre_cells(body, std::span<const double>(shares), random); },
      "polyhedra that break are cut into cells: include "
      "<silt/shape/laguerre_cells.hpp> before <silt/simulation.hpp>");
  const auto cells = shares.size() == 1
                         ? std::vector{body.made_anew()}
                         : laguerre_cells(body, std::span<const double>(shares), random);
  const Quaternion q = p.principal_axes() * conjugate(form.mass.axes);
  const Vec3d centroid = p.scale() * form.mass.centroid;
  double left = p.mass();
  for (std::size_t k = 0; k < sizes.masses.size(); ++k) {
    typename Particles::Particle one{};
    one.form = all.add_form(cells[k]);
    const MassProperties& mass = all.forms()[one.form].mass;
    const Vec3d apart = rotate(q, mass.centroid - centroid);
    one.position = p.centre() + apart, one.orientation = q, one.density = density;
    one.velocity = p.velocity() + cross(p.angular_velocity(), apart);
    one.angular_velocity = p.angular_velocity(), one.material = p.material();
    all.add(one);
    sizes.masses[k] = density * mass.volume, left -= sizes.masses[k];
  }
  sizes.dust = shares.size() > sizes.masses.size() ? std::max(left, 0.0) : 0;
}

/// Angular velocity of fragments that keep their share of the angular momentum. If dust takes the
/// rest of it, the share is limited such that the fragments have at most their share of the energy.
template <class Sim>
template <class Owner>
Vec3d BreakAccess<Sim>::shared_rotation(const Owner& p, std::span<const Vec3d> places,
                                        std::span<const double> radii,
                                        std::span<const double> masses, double share) {
  constexpr double factor = Sim::ShapeType::inertia_factor();
  const Vec3d L = (share * factor * p.mass() * p.radius() * p.radius()) * p.angular_velocity();
  const Vec3d w = rotation_of_fragments(places, radii, masses, factor, L);
  const double energy = dot(L, w), most = dot(L, p.angular_velocity());
  return share < 1 - 1e-9 && energy > most ? std::sqrt(most / energy) * w : w;
}

}  // namespace silt::detail
