// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cstddef>
#include <cstdint>

#include <silt/core/dyn_array.hpp>
#include <silt/core/quaternion.hpp>
#include <silt/core/vec3.hpp>
#include <silt/sph/body_points.hpp>
#include <silt/sph/wall_particles.hpp>

namespace silt::inline SILT_TARGET::detail {

/// x -> rotation x + shift, as three rows: common to all particles of a solid.
struct AffineMap {
  Vec3d x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1}, shift{0, 0, 0};

  Vec3d operator()(const Vec3d& of) const {
    return {dot(x, of) + shift.x, dot(y, of) + shift.y, dot(z, of) + shift.z};
  }
  /// From a function that is such a map.
  template <class F>
  static AffineMap of(const F& f) {
    const Vec3d zero = f(Vec3d{0, 0, 0}), a = f(Vec3d{1, 0, 0}) - zero,
                b = f(Vec3d{0, 1, 0}) - zero, c = f(Vec3d{0, 0, 1}) - zero;
    return {{a.x, b.x, c.x}, {a.y, b.y, c.y}, {a.z, b.z, c.z}, zero};
  }
};

/// Positions and velocities of particles of walls and bodies in space, by one map per solid instead
/// of a rotation per particle. The particles' own coordinates are stored in the order of the rows.
class SolidFrames {
 public:
  static constexpr std::uint32_t none = ~std::uint32_t{0};
  struct alignas(64) Own {
    Vec3d at{0, 0, 0}, middle{0, 0, 0};  // [m] of the row; halfway between a particle and its image
    std::uint32_t frame = none;          // none: stored with the particle
    std::uint32_t wall_row = none;       // of an image: the row of its particle
    double share = 1;                    // [-] of a particle's volume
  };
  DynArray<Own> rows;  // from the first row of walls on

  void set(const WallParticles& walls, const BodyPoints& bodies) {
    place_.resize(walls.walls() + bodies.bodies.size()), velocity_.resize(place_.size());
    for (std::size_t w = 0; w < walls.walls(); ++w) {
      place_[w] = AffineMap::of([&](const Vec3d& x) { return walls.to_space(w, x); });
      velocity_[w] = AffineMap::of([&](const Vec3d& x) { return walls.velocity_of(w, x); });
    }
    for (std::size_t b = 0; b < bodies.bodies.size(); ++b) {
      const BodyPoints::Body& body = bodies.bodies[b];
      AffineMap turn;
      if (body.form != BodyPoints::sphere)
        turn = AffineMap::of([&](const Vec3d& x) { return rotate(body.axes, x); });
      place_[walls.walls() + b] = {turn.x, turn.y, turn.z, body.centre};
      velocity_[walls.walls() + b] = AffineMap::of(
          [&](const Vec3d& x) { return body.velocity + cross(body.spin, rotate(body.axes, x)); });
    }
  }
  Vec3d place(const Own& of) const { return place_[of.frame](of.at); }
  Vec3d velocity(const Own& of) const { return velocity_[of.frame](of.middle); }

 private:
  DynArray<AffineMap> place_, velocity_;
};

}  // namespace silt::detail
