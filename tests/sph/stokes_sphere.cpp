// silt - BSD-3-Clause, see LICENSE
#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include <silt/sph/sph.hpp>

#include "near.hpp"

namespace sph_stokes_sphere_test {

using namespace silt;

namespace {

/// A sphere of radius 1 in a box that repeats after six radii, at a Reynolds number of 1/4 by the
/// radius: a simple cubic array in slow flow. Gravity drives the liquid alone; in the steady state
/// the sphere bears rho g (L^3 - V). With U, the mean velocity past the sphere over the whole box,
///
///   F = 6 pi mu R U K,  1/K = 1 - 1.7601 c^(1/3) + c - 1.5593 c^2,  c = V/L^3
///
/// is the drag by a gradient of the pressure, which acts on the sphere's volume too: F (1 - c) is
/// that of the liquid's motion alone.
/// Source: H. Hasimoto, J. Fluid Mech. 5 (1959) 317 (recalled). The first coefficient by an Ewald
///   sum of our own too: 2.837297 R/L, as I.-C. Yeh and G. Hummer, J. Phys. Chem. B 108 (2004)
///   15873 print it.
class Array {
 public:
  /// `n` spacings a radius. `falls`: what gravity, upwards, gives the liquid pushes the sphere
  /// down.
  Array(int n, bool falls)
      : falls_(falls),
        water_(Liquid{.density = rho, .sound_speed = 20 * U},
               {.spacing = R / n,
                .region = {{0, 0, 0}, {L, L, L}},
                .smoothing = 0.9,
                .periodic = {true, true, true},
                .gravity = {0, 0, falls ? -gravity() : gravity()}},
               LaminarViscosity{.kinematic = nu, .alpha = 0}) {
    if (falls) v_[0].z = U * (1 - c);
    // Under a pressure above all suction, which is 1.5 mu U/R = 6 rho U^2.
    water_.fill([](const Vec3d&) { return true; },
                [=](const Vec3d&) {
                  return Vec3d{0, 0, falls ? -c * U : U};
                },
                [](const Vec3d&) { return 10 * rho * U * U; });
  }
  /// Goes on to `end` L^2/nu; drag, the mean since the last call, over that of Hasimoto.
  double drag(double end) {
    const double dt = 0.15 * water_.setup().h() / water_.liquid().sound_speed;
    double sum = 0, steps = 0;
    for (; time_ < end * L * L / nu; time_ += dt, ++steps) {
      CoupledParticles of{};
      of.shape.position = x_, of.shape.radius = radius_, of.velocity = v_, of.volume = volume_;
      of.mass = mass_, of.angular_velocity = w_;
      water_.advance(of, dt, force_, {2}, torque_);
      sum += force_[0].z;
      if (!falls_) continue;
      v_[0].z += dt * (force_[0].z + gravity() * water_.mass()) / mass_[0];
      x_[0].z += dt * v_[0].z;
      if (x_[0].z >= L) x_[0].z -= L;
    }
    return std::abs(sum / steps) / ((1 - c) * 6 * pi * rho * nu * R * velocity() * K());
  }
  double velocity() const {  // [m/s] U
    return (1 - c) * std::abs(water_.momentum().z / water_.mass() - v_[0].z);
  }

 private:
  static constexpr double pi = std::numbers::pi, R = 1, U = 1, L = 6 * R, rho = 1000, nu = 4,
                          V = 4 * pi / 3, c = V / (L * L * L);
  static double K() { return 1 / (1 - 1.7601 * std::cbrt(c) + c - 1.5593 * c * c); }
  /// [m/s2] with which U is 1 m/s.
  static double gravity() { return 6 * pi * nu * R * U * K() / (L * L * L); }

  bool falls_;
  double time_ = 0;
  Sph<LaminarViscosity> water_;
  std::vector<Vec3d> x_{{L / 2, L / 2, L / 2}}, v_{{0, 0, 0}}, w_ = v_, force_ = v_, torque_ = v_;
  std::vector<double> radius_{R}, volume_{V}, mass_{2 * rho * V};
};

}  // namespace

// What it would catch: liquid that slips (2/3 of the drag at large distances), a sphere that is a
// spacing too small or too large (its drag by a quarter or more), a force without friction or
// without pressure (a third, two thirds).
TEST_CASE("SPH: slow flow past an array of spheres has Hasimoto's drag, from below") {
  Array coarse(3, false), fine(4, false);
  coarse.drag(0.1), fine.drag(0.1);
  const double of_coarse = coarse.drag(0.15), of_fine = fine.drag(0.15);
  // 13 and 6 % too little: as of spheres smaller by 0.23 and 0.14 spacings.
  CHECK(of_coarse == near(0.867).epsilon(0.02));
  CHECK(of_fine == near(0.938).epsilon(0.02));
  CHECK(fine.velocity() == near(1).epsilon(0.06));
}

TEST_CASE("SPH: a sphere that falls through a liquid at rest has the drag of one that is held") {
  // It goes by some spacings; what depends on where it is among particles is averaged.
  Array held(3, false), falling(3, true);
  held.drag(0.1), falling.drag(0.1);
  CHECK(falling.drag(0.15) == near(held.drag(0.15)).epsilon(0.03));
}

}  // namespace sph_stokes_sphere_test
