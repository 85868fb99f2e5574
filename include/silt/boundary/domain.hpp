// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <array>
#include <cmath>

#include <silt/core/box.hpp>
#include <silt/core/error.hpp>
#include <silt/core/lanes.hpp>

namespace silt::inline SILT_TARGET {

/// Open space without periodic directions (default); no cost.
/// Source: none.
/// Valid:  every scene.
/// Units:  [m].
/// Errors: none.
/// Tests:  tests/search/searches.cpp.
struct OpenDomain {
  static constexpr bool is_domain = true;
  static constexpr bool periodic = false;
};

/// Box that is periodic in the given directions: what leaves on one side enters on the other.
///   silt::PeriodicBox{{.min = {0, 0, 0}, .max = {0.1, 0.1, 1}}, {true, true, false}}
/// In a direction that is not periodic, `box` sets no limit. Walls repeat with the box, except
/// planes and, across their axis, cylinders and cones around the particles
/// (engine/lists/wall_images.hpp).
///
/// Source: none: the nearest image.
/// Valid:  length of at least three diameters of the largest particle in each periodic direction.
/// Units:  [m].
/// Errors: InputError for a box without a periodic direction, or a length that is not positive or
///         is too short for a particle.
/// Tests:  tests/search/searches.cpp, tests/engine/wall_images.cpp.
class PeriodicBox {
 public:
  static constexpr bool is_domain = true;
  static constexpr bool periodic = true;
  static constexpr const char* policy_name = "PeriodicBox";

  PeriodicBox(const Box& box, std::array<bool, 3> repeats) : box_(box), repeats_(repeats) {
    const auto e = box.extent();
    const double length[3] = {e.x, e.y, e.z};
    static constexpr const char* name[3] = {"x", "y", "z"};
    require(repeats[0] || repeats[1] || repeats[2],
            "PeriodicBox: no direction is periodic; name at least one, or leave out the policy");
    for (int d = 0; d < 3; ++d) {
      if (!repeats[d]) continue;
      require(std::isfinite(length[d]) && length[d] > 0, "PeriodicBox: the length in ", name[d],
              " = ", length[d], " [m] must be finite and greater than 0");
      length_[d] = length[d], inverse_[d] = 1 / length[d];
    }
  }

  const Box& box() const { return box_; }
  bool repeats(int direction) const { return repeats_[direction]; }
  double length(int direction) const { return length_[direction]; }  // [m], 0 if not repeating

  /// Shortest image of a distance vector.
  template <class Real>
  Vec3<Real> shortest(const Vec3<Real>& d) const {
    return {shortest(d.x, 0), shortest(d.y, 1), shortest(d.z, 2)};
  }
  /// Image of a point inside the box.
  Vec3d wrapped(Vec3d p) const {
    p.x -= length_[0] * std::floor((p.x - box_.min.x) * inverse_[0]);
    p.y -= length_[1] * std::floor((p.y - box_.min.y) * inverse_[1]);
    p.z -= length_[2] * std::floor((p.z - box_.min.z) * inverse_[2]);
    return p;
  }

 private:
  template <class Real>
  Real shortest(const Real& d, int direction) const {
    // Adding and subtracting 1.5 * 2^52 rounds to the nearest integer, in any lane width.
    const Real big(6755399441055744.0);
    const Real turns = (d * Real(inverse_[direction]) + big) - big;
    return d - turns * Real(length_[direction]);
  }

  Box box_;
  std::array<bool, 3> repeats_;
  double length_[3] = {0, 0, 0};
  double inverse_[3] = {0, 0, 0};
};

}  // namespace silt
