// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include <silt/core/error.hpp>
#include <silt/core/vec3.hpp>
#include <silt/sph/row.hpp>

namespace silt::inline SILT_TARGET::detail {

/// At the first step: checks that the sound speed suits a fall through the height of the liquid and
/// the present motion of walls, which in 2D stay in the liquid's plane. The later flow is not known
/// here.
template <class Core>
void sph_check_sound(const Core& core) {
  constexpr double least = 5;  // [-]; 10 are advised
  const double c = core.liquid.sound_speed;
  const auto check = [&](double speed, const auto&... of) {
    if (c >= least * speed) return;
    throw InputError(sentence(
        "Sph: Liquid.sound_speed = ", c, " m/s is ", c / speed, " times the speed of ", of..., ", ",
        speed, " m/s; the liquid would be compressed by ", 100 * speed * speed / (c * c),
        " %; use ten times that speed, ", 10 * speed, " m/s"));
  };
  constexpr double far = std::numeric_limits<double>::infinity();
  Vec3d low{far, far, far}, high{-far, -far, -far};
  const auto& of = core.columns;
  for (std::size_t k = 0; k < of.size(); ++k) {
    if (!of.is_liquid(k)) continue;
    const Vec3d x = of.rows[k].position();
    low = {std::min(low.x, x.x), std::min(low.y, x.y), std::min(low.z, x.z)};
    high = {std::max(high.x, x.x), std::max(high.y, x.y), std::max(high.z, x.z)};
  }
  const std::array<double, 3> g{core.weight().x, core.weight().y, core.weight().z},
      height{high.x - low.x, high.y - low.y, high.z - low.z};
  for (std::size_t d = 0; d < 3; ++d)
    if (height[d] > 0)
      check(std::sqrt(2 * std::abs(g[d]) * height[d]), "a fall through the liquid's height of ",
            height[d], " m");
  const auto& walls = core.solids.walls;
  double fastest = 0;
  std::size_t of_wall = 0;
  for (std::size_t k = 0; k < walls.size(); ++k) {
    if (const double speed = norm(core.solids.velocity(k)); speed > fastest)
      fastest = speed, of_wall = walls.wall_of(k);
    const Vec3d v = walls.velocity(k);
    require(core.setup.dimensions == 3 || std::abs(v.y) <= 1e-6 * norm(v) + 1e-9 * c, "Sph: wall ",
            walls.called(walls.wall_of(k)), " has a velocity of ", v,
            " m/s, with a part along y, but in 2D the liquid lies in x and z; move the wall in x "
            "and z, and turn it about y");
  }
  if (fastest > 0) check(fastest, "wall ", walls.called(of_wall));
}

}  // namespace silt::detail
