// silt - BSD-3-Clause, see LICENSE
// Impacts of spinning spheres on a plane and on each other: Chung and Ooi's tests 6, 7 and 8.

#include <string>

#include "verification/oblique.hpp"

namespace verification {
namespace spinning_impacts_cases {

// Chung and Ooi 2011; each value read in the set-ups of these tests in Kratos, PySPH and a
// collection of Yade scripts.
constexpr Solid aluminium_alloy{7.0e10, 0.33, 2700}, nylon{2.5e9, 0.40, 1000};
constexpr Solid copper{1.2e11, 0.35, 8900};
constexpr double radius = 0.1, speed = 0.2;          // [m], [m/s] of approach
constexpr double restitution = 0.5, friction = 0.4;  // [-]

/// A spinning ball that moves down onto a partner at rest.
void spinning_ball(Gallery& gallery, const std::string& name, const Impact& kind) {
  auto table = gallery.table(
      name, {"incidence [-]", "recoil [-]", "3.5 mu (1 + e) v_n over v_s [-]", "beta [-]",
             "recoil by the law [-]", "beta by the law [-]", "recoil rigid [-]", "beta rigid [-]"});
  ObliqueChecks checks(name);
  for (double angle = 2.5; angle < 86; angle += gallery.quick ? 10 : 2.5) {
    Impact impact = kind;
    const double vs = speed * std::tan(angle * degree);
    impact.ball.spin = {0, -vs / radius, 0};
    const ObliqueImpact hit(impact);
    checks.compare(hit);
    const double law = hit.law_after(), rigid = hit.rigid_after(), rebounds = restitution * speed;
    table.add_row({vs / speed, hit.after() / hit.normal_after(), hit.lost_by_sliding() / vs,
                   -hit.after() / vs, law / rebounds, -law / vs, rigid / rebounds, -rigid / vs});
  }
  checks.write(gallery);
}

/// Two equal balls that spin so that their surfaces have no relative velocity at the contact: no
/// slip.
void opposite_spins(Gallery& gallery, const std::string& name, const Solid& solid) {
  auto table =
      gallery.table(name, {"angular velocity before [rad/s]", "tangential velocity after [m/s]",
                           "angular velocity after [rad/s]"});
  Worst worst;
  for (double angle = 5; angle < 86; angle += 5) {
    const double spin = speed / radius * std::tan(angle * degree);  // [rad/s]
    auto impact = on_plane(solid, radius, speed, 0);
    impact.ball.spin = {0, spin, 0};
    impact.other = impact.ball;
    impact.other->velocity.z = speed, impact.other->spin.y = -spin;
    impact.restitution = restitution, impact.friction = friction;
    const auto found = strike<silt::HertzMindlin>(impact);
    worst.compare(found.spin.y / spin, 1, 1e-12);
    worst.compare(found.other_spin.y / spin, -1, 1e-12);
    worst.compare(found.velocity.x / speed, 0, 1e-12);
    table.add_row({spin, found.velocity.x, found.spin.y});
  }
  gallery.check(name + "_nothing_changes", worst, "the surfaces do not slip: rounding");
}

}  // namespace spinning_impacts_cases

void spinning_impacts_of_chung_and_ooi(Gallery& gallery) {
  using namespace spinning_impacts_cases;
  for (const auto& [solid, word] :
       {std::pair{aluminium_alloy, "aluminium_alloy"}, std::pair{nylon, "nylon"}}) {
    auto impact = on_plane(solid, radius, speed, 0);
    impact.restitution = restitution, impact.friction = friction;
    spinning_ball(gallery, std::string("chung_ooi_6_") + word, impact);
    // Five times as large, 1000 times as dense; in case A 1000 times as stiff too.
    Solid heavy = solid;
    heavy.density *= 1000;
    impact.other = Ball{.solid = rigid(heavy), .radius = 5 * radius};
    spinning_ball(gallery, std::string("chung_ooi_8_case_a_") + word, impact);
    impact.other->solid = heavy;
    spinning_ball(gallery, std::string("chung_ooi_8_case_b_") + word, impact);
  }
  opposite_spins(gallery, "chung_ooi_7_aluminium_alloy", aluminium_alloy);
  opposite_spins(gallery, "chung_ooi_7_copper", copper);
}

}  // namespace verification
