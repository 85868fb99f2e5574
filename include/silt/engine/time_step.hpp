// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include <silt/boundary/wall.hpp>
#include <silt/contact/contacts.hpp>
#include <silt/contact/formulas.hpp>
#include <silt/core/box.hpp>
#include <silt/core/error.hpp>
#include <silt/engine/list_upkeep.hpp>

namespace silt::inline SILT_TARGET::detail {

/// The spheres that make the shortest contacts: linear springs those of the least mass, Hertz' law
/// those of the least m^2/R, which a large sphere of a light material may be.
struct LightestSpheres {
  struct One {
    double radius = std::numeric_limits<double>::infinity();  // [m]
    double mass = std::numeric_limits<double>::infinity();    // [kg]
  };
  One of_mass, of_hertz;

  void include(const One& s) {
    if (!std::isfinite(s.mass)) return;
    if (s.mass < of_mass.mass || (s.mass == of_mass.mass && s.radius > of_mass.radius)) of_mass = s;
    if (!any() || s.mass * s.mass * of_hertz.radius < of_hertz.mass * of_hertz.mass * s.radius)
      of_hertz = s;
  }
  bool any() const { return std::isfinite(of_hertz.mass); }
};

/// True if the law has a closed form of its contact time.
template <class Law>
concept HasContactTime = requires(const typename Law::template Coefficients<double>& p) {
  { Law::contact_time(p, 1.0, 1.0, 1.0) } -> std::same_as<double>;
}
|| requires(const typename Law::template Coefficients<double>& p) {
  { Law::contact_time(p, 1.0, 1.0, 1.0, 1.0) } -> std::same_as<double>;
};

/// The contact time [s] of the sphere with its like, with a wall, or with a very large one.
template <class Law>
double shortest_contact_of(const typename Law::template Coefficients<double>& p,
                           const LightestSpheres::One& s, double speed) {
  if constexpr (law_needs_radii<Law>)
    return std::min({Law::contact_time(p, s.radius, s.radius, s.mass / 2, speed),
                     Law::contact_time(p, s.radius, 0.0, s.mass, speed),
                     Law::contact_time(p, s.radius, 1e6 * s.radius, s.mass, speed)});
  else
    return std::min(Law::contact_time(p, s.radius / 2, s.mass / 2, speed),
                    Law::contact_time(p, s.radius, s.mass, speed));
}

/// The shortest contact [s] that impacts at `speed` [m/s] make: of the lightest spheres with one of
/// their kind and with a wall, over all pairs of materials of which spheres have at least one:
/// walls do not meet each other. `pairs` by rows of as many as there are materials.
template <class Law>
double shortest_contact(const std::vector<typename Law::template Coefficients<double>>& pairs,
                        const std::vector<bool>& of_spheres, const LightestSpheres& lightest,
                        double speed) {
  double shortest = std::numeric_limits<double>::infinity();
  const std::size_t n = of_spheres.size();
  for (std::size_t k = 0; k < pairs.size(); ++k)
    if (of_spheres[k / n] || of_spheres[k % n])
      for (const auto& s : {lightest.of_mass, lightest.of_hertz})
        shortest = std::min(shortest, shortest_contact_of<Law>(pairs[k], s, speed));
  return shortest;
}

/// A surface's bounds [m] where its wall is now. One that is infinite and turned: no bounds.
inline Box bounds_in_space(const Wall& wall, const Surface& surface) {
  const Box b = visit_surface(surface, [](const auto& s) { return s.bounds(); });
  if (!wall.moves()) return b;
  const Pose& pose = wall.pose;
  if (pose.rotation == Quaternion{}) return {b.min + pose.translation, b.max + pose.translation};
  Box turned;
  if (is_finite(b.min) && is_finite(b.max))
    for (int corner = 0; corner < 8; ++corner)
      turned.include(pose.to_space({corner & 1 ? b.max.x : b.min.x, corner & 2 ? b.max.y : b.min.y,
                                    corner & 4 ? b.max.z : b.min.z}));
  return turned;
}

/// The largest speed [m/s] that a wall now has where particles are. 0 where there are none.
inline double speed_near(const Wall& wall, const Box& particles, double time) {
  constexpr double moment = 1e-6;  // [s] short against any motion that a simulation can follow
  if (!wall.moves() || !(particles.min.x <= particles.max.x)) return 0;
  const double way = largest_displacement(wall.motion(time), wall.motion(time + moment), particles);
  return std::isfinite(way) ? way / moment : 0;  // else the run will say so
}

}  // namespace silt::detail
