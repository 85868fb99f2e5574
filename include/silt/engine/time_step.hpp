// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <vector>

#include <silt/contact/contacts.hpp>
#include <silt/contact/formulas.hpp>
#include <silt/core/error.hpp>

namespace silt::inline SILT_TARGET::detail {

/// The sphere that makes the shortest contacts.
struct LightestSphere {
  double radius;  // [m]
  double mass;    // [kg]
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
                           const LightestSphere& s, double speed) {
  if constexpr (law_needs_radii<Law>)
    return std::min({Law::contact_time(p, s.radius, s.radius, s.mass / 2, speed),
                     Law::contact_time(p, s.radius, 0.0, s.mass, speed),
                     Law::contact_time(p, s.radius, 1e6 * s.radius, s.mass, speed)});
  else
    return std::min(Law::contact_time(p, s.radius / 2, s.mass / 2, speed),
                    Law::contact_time(p, s.radius, s.mass, speed));
}

/// The shortest contact [s] that impacts at `speed` [m/s] make: of the lightest sphere with one of
/// its kind and with a wall, over all pairs of materials of which spheres have at least one: walls
/// do not meet each other. `pairs` by rows of as many as there are materials.
template <class Law>
double shortest_contact(const std::vector<typename Law::template Coefficients<double>>& pairs,
                        const std::vector<bool>& of_spheres, const LightestSphere& s,
                        double speed) {
  double shortest = std::numeric_limits<double>::infinity();
  const std::size_t n = of_spheres.size();
  for (std::size_t k = 0; k < pairs.size(); ++k)
    if (of_spheres[k / n] || of_spheres[k % n])
      shortest = std::min(shortest, shortest_contact_of<Law>(pairs[k], s, speed));
  return shortest;
}

}  // namespace silt::detail
