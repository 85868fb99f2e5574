// silt - BSD-3-Clause, see LICENSE
// Heat through random beds between a hot and a cold plate: steady temperatures against the contacts
// themselves, the effective conductivity against the mean-field formula.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <utility>
#include <vector>

#include <doctest/doctest.h>

#include <silt/contact/hertz_mindlin.hpp>
#include <silt/module/heat/conduction.hpp>
#include <silt/simulation.hpp>

#include "near.hpp"

namespace heat_bed_test {

using silt::Vec3d;

const double R = 1e-3, side = 0.012, k = 1.1, hot = 400, cold = 300;  // [m], [W/(m K)], [K]

/// What the middle half of a bed is like.
struct Bed {
  double fraction, contacts, circle;  // [-], [-] a sphere, [-] mean a/R
  double conductivity, bound;         // [W/(m K)] k_eff; the sum of H l_z^2 over the volume
  double unbalanced, of_walls;        // [-] heat that spheres keep; that the walls differ by
  double formula() const { return fraction * contacts * k * circle / std::numbers::pi; }
};

/// Equal spheres, pressed together by a plate that comes down to `height` [m], until they rest;
/// then heated. Their heat capacity is so small that temperatures are soon steady.
inline Bed pressed_bed(double friction, double height) {
  silt::Particles<silt::Sphere> p;
  p.fill({{0, 0, 0}, {side, side, 0.1}}, {.radius = R, .density = 2500, .count = 1000});
  const silt::HertzMindlin::Material soft{
      .youngs_modulus = 5e6, .poisson_ratio = 0.25, .restitution = 0.1, .friction = friction};
  silt::Simulation sim{std::move(p), silt::Contacts<silt::HertzMindlin>{soft},
                       silt::PeriodicBox{{{0, 0, -0.01}, {side, side, 0.11}}, {true, true, false}},
                       silt::HeatConduction{.conductivity = k,
                                            .heat_capacity = 840,
                                            .walls = {silt::held_at(cold), silt::held_at(hot)}}};
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, soft);
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, -1}}, soft, [height](double time) {
    silt::Pose pose;
    pose.translation.z = std::max(0.1 - 1.0 * time, height);
    return pose;
  });
  sim.time_step = 1e-5;
  sim.run(0.15);
  sim.module<silt::HeatConduction>().heat_capacity = 0.005;
  for (std::size_t i = 0; i < sim.rows(); ++i)
    sim.field<silt::Temperature>(i) = cold + (hot - cold) * sim.position(i).z / height;
  sim.run(0.2);

  Bed bed{};
  const double from = 0.25 * height, to = 0.75 * height, area = side * side;
  double n = 0, z1 = 0, T1 = 0, zz = 0, zT = 0;  // of a straight line
  std::vector<double> net(sim.rows(), 0);        // [W]
  for (std::size_t i = 0; i < sim.rows(); ++i) {
    const double z = sim.position(i).z, T = sim.field<silt::Temperature>(i);
    if (z < from || z > to) continue;
    n += 1, z1 += z, T1 += T, zz += z * z, zT += z * T;
  }
  double into[2] = {0, 0}, between = 0, ends = 0;  // [W], [-]
  sim.for_each_contact([&](const silt::ContactSeen& c) {
    const bool wall = c.wall != silt::no_wall;
    const double a = std::sqrt((wall ? R : 0.5 * R) * c.overlap), H = 2 * k * a;
    const double T = sim.field<silt::Temperature>(c.place_a);
    if (wall) {
      const double Q = H * ((c.wall == 0 ? cold : hot) - T);
      into[c.wall] += Q, net[c.place_a] += Q;
      return;
    }
    const double Q = H * (sim.field<silt::Temperature>(c.place_b) - T);
    net[c.place_a] += Q, net[c.place_b] -= Q;
    if (c.point.z > from && c.point.z < to) {
      bed.bound += H * c.branch.z * c.branch.z / (area * (to - from));
      between += 1, bed.circle += a / R;
    }
    for (const std::size_t i : {c.place_a, c.place_b})
      if (sim.position(i).z > from && sim.position(i).z < to) ends += 1;
  });
  bed.circle /= between, bed.contacts = ends / n;
  bed.fraction = n * 4.0 / 3 * std::numbers::pi * R * R * R / (area * (to - from));
  const double slope = (n * zT - z1 * T1) / (n * zz - z1 * z1);  // [K/m]
  bed.conductivity = 0.5 * (into[1] - into[0]) / area / slope;
  bed.of_walls = std::abs(into[0] + into[1]) / into[1];
  const double through = into[1] * 4 * R * R / area;  // [W] a sphere
  for (const double Q : net)
    bed.unbalanced += std::abs(Q) / through / static_cast<double>(net.size());
  MESSAGE("friction ", friction, ": solid fraction ", bed.fraction, ", contacts ", bed.contacts,
          ", a/R ", bed.circle, ", k_eff/k ", bed.conductivity / k, ", sum/k ", bed.bound / k,
          ", formula/k ", bed.formula() / k, ", unbalanced ", bed.unbalanced, " ", bed.of_walls);
  return bed;
}


// Catches a conductance that is wrong by a factor or an exponent, contacts that are left out or
// count twice, heat that stays in spheres. The sum over contacts takes temperatures for linear in
// z; the true ones dissipate least, so that it is an upper bound.
TEST_CASE("heat: random beds conduct 0.95 to 1 times what their mean field would") {
  const Bed smooth = pressed_bed(0, 0.0445), rough = pressed_bed(0.5, 0.0470);
  for (const Bed& bed : {smooth, rough}) {
    // Steady: spheres still move a little, and contacts with them.
    CHECK(bed.of_walls < 2e-3);
    CHECK(bed.unbalanced < 1e-3);
    CHECK(bed.conductivity < bed.bound);
    CHECK(bed.conductivity > 0.95 * bed.bound);
  }
  CHECK(smooth.contacts == near(6.9).epsilon(0.05));
  // The formula takes contacts for isotropic, as they are without friction. With it a bed that is
  // pressed from above alone conducts better along the pressure.
  CHECK(smooth.bound == near(smooth.formula()).epsilon(0.03));
  CHECK(rough.bound > 1.15 * rough.formula());
}

}  // namespace heat_bed_test
