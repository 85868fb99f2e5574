// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "verification/gallery.hpp"
#include "verification/planar_impact.hpp"
#include "verification/strike.hpp"

namespace verification {

inline constexpr double degree = std::numbers::pi / 180;

/// An oblique impact and the predictions of its references for the surface velocity v_s [m/s],
/// along x, of the ball relative to its partner. The partner is initially at rest.
class ObliqueImpact {
 public:
  explicit ObliqueImpact(const Impact& impact)
      : impact_(impact), found_(strike<silt::HertzMindlin>(impact)) {}

  const Impact& impact() const { return impact_; }
  const Rebound& found() const { return found_; }
  double overlap() const { return found_.largest_overlap / impact_.ball.radius; }  // [-]

  double before() const { return surface_of(impact_.ball.velocity, impact_.ball.spin); }
  double after() const {
    const double other =
        impact_.other ? found_.other_velocity.x + found_.other_spin.y * impact_.other->radius : 0;
    return surface_of(found_.velocity, found_.spin) - other;
  }
  double normal_after() const { return found_.velocity.z - found_.other_velocity.z; }  // [m/s]

  /// Loss of surface velocity [m/s] of rigid bodies with Coulomb friction while they slide.
  double lost_by_sliding() const {
    return 3.5 * impact_.friction * (1 + impact_.restitution) * impact_.normal_speed();
  }
  bool slides() const { return before() >= lost_by_sliding(); }
  /// v_s' of rigid bodies that slide throughout, or roll at the end.
  double rigid_after() const { return std::max(before() - lost_by_sliding(), 0.0); }
  /// v_s' by the law's own equations.
  double law_after() const { return planar_surface_speed_after(impact_, before()); }

 private:
  double surface_of(const Vec3d& velocity, const Vec3d& spin) const {
    return velocity.x - spin.y * impact_.ball.radius;
  }
  Impact impact_;
  Rebound found_;
};

/// Checks common to all oblique impacts.
class ObliqueChecks {
 public:
  explicit ObliqueChecks(std::string name) : name_(std::move(name)) {}

  void compare(const ObliqueImpact& hit) {
    const Impact& given = hit.impact();
    const double zeta = silt::damping_ratio(given.restitution, silt::DampingEnd::ZeroForce);
    const double error = step_error(zeta, given.steps) + hit.overlap();
    const double scale = hit.lost_by_sliding();
    law_.compare(hit.after() / scale, hit.law_after() / scale, 3 * error);
    if (!hit.slides()) return;
    sliding_.compare((hit.before() - hit.after()) / scale, 1, error);
    // The normal of two balls rotates during contact, by the displacement of one past the other.
    const Rebound& found = hit.found();
    const double turn = given.other ? std::abs(found.velocity.x) * found.duration /
                                          (given.ball.radius + given.other->radius)
                                    : 0;
    const double lost = given.ball.velocity.x - found.velocity.x;
    const double normal = found.velocity.z - given.ball.velocity.z;
    coulomb_.compare(lost / (given.friction * normal), 1,
                     1e-10 + turn * (given.friction + 1 / given.friction));
  }
  /// Deviation of the law from Maw, Barber and Fawcett: the remaining slip velocity, over mu v_n.
  void compare_elastic(const ObliqueImpact& hit, double elastic) {
    const double scale = hit.impact().friction * hit.impact().normal_speed();
    from_elastic_ = std::max(from_elastic_, std::abs(hit.after() - elastic) / scale);
  }
  void write(Gallery& gallery) const {
    gallery.check(name_ + "_coulomb", coulomb_,
                  "where it slides, friction is mu times the normal force in each step: rounding; "
                  "the normal of two balls turns a little");
    gallery.check(name_ + "_sliding", sliding_,
                  "surface speed lost over that of rigid bodies: 2 pi zeta/n of the time step; the "
                  "lever arm is R less the overlap");
    gallery.check(name_ + "_law", law_,
                  "surface speed left over the most that sliding takes; three times the same, as "
                  "the tangential spring swings up to 1.7 times in a contact that sticks");
    if (from_elastic_ > 0)
      gallery.summary.result(name_ + "_largest_distance_from_mbf", from_elastic_);
  }

 private:
  std::string name_;
  Worst coulomb_, sliding_, law_;
  double from_elastic_ = 0;  // [-]
};

/// A ball that hits a rigid plane.
inline Impact on_plane(const Solid& solid, double radius, double normal, double tangential) {
  Impact impact{.ball = {.solid = solid, .radius = radius, .velocity = {tangential, 0, -normal}}};
  impact.plane = rigid(solid);
  return impact;
}

}  // namespace verification
