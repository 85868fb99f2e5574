// silt - BSD-3-Clause, see LICENSE
#include <algorithm>
#include <cmath>

#include <silt/contact/hertz_mindlin.hpp>

#include "physics/support.hpp"

namespace friction_test {

// A sphere and a rough plane: closed forms of rigid bodies with Coulomb friction (V2, V3).

namespace {

using namespace silt;
using namespace physics_test;

constexpr double radius = 1e-3, density = 2500;  // [m], [kg/m3]
using ByDisplacement = BasicHertzMindlin<DampingEnd::ZeroForce, TangentialMemory::Displacement>;

/// A sphere on the plane z = 0, as deep in it as `weight` [m/s2] along -z presses it at rest.
template <class Law>
class OnPlane {
 public:
  OnPlane(const typename Law::Material& material, const Vec3d& velocity, const Vec3d& gravity,
          double gap = 0)
      : sim_{sphere(material, velocity, gravity, gap), Contacts<Law>{material}} {
    sim_.add_wall(Plane{{0, 0, 0}, {0, 0, 1}}, material);
    sim_.gravity = gravity;
    sim_.threads = 1;
    sim_.time_step =
        Law::contact_time(sim_.contacts().coefficients(0, 0), radius, mass_of(radius, density), 2) /
        100;
  }
  /// [m] at rest
  static double depth(const typename Law::Material& m, const Vec3d& gravity) {
    const double E =
        effective_modulus(m.youngs_modulus, m.poisson_ratio, m.youngs_modulus, m.poisson_ratio);
    const double weight = mass_of(radius, density) * std::max(-gravity.z, 0.0);
    return std::pow(weight / hertz_stiffness(E, radius), 2.0 / 3.0);
  }
  auto& sim() { return sim_; }
  struct Accelerations {
    double x, spin;  // [m/s2] of the centre; of the surface by rotation about y
  };
  /// Over the second 0.02 s, when the tangential spring has long taken up its load.
  Accelerations accelerations() {
    sim_.run(0.02);
    const double time = sim_.time(), x = velocity().x, spin = surface_speed().y;
    sim_.run(0.02);
    const double span = sim_.time() - time;
    return {(velocity().x - x) / span, (surface_speed().y - spin) / span};
  }
  /// The lever arm of friction is R less the overlap: a share of this is the closed forms' error.
  double lever_error() const { return depth(sim_.contacts().material(0), sim_.gravity) / radius; }
  Vec3d velocity() const { return sim_.velocity(0); }
  Vec3d surface_speed() const { return sim_.angular_velocity(0) * radius; }  // [m/s]

 private:
  static Particles<Sphere> sphere(const typename Law::Material& material, const Vec3d& velocity,
                                  const Vec3d& gravity, double gap) {
    Particles<Sphere> out;
    out.add({.position = {0, 0, radius - depth(material, gravity) + gap},
             .radius = radius,
             .density = density,
             .velocity = velocity});
    return out;
  }
  Simulation<Particles<Sphere>, Contacts<Law>> sim_;
};

HertzMindlin::Material material(double modulus, double restitution, double friction) {
  return {.youngs_modulus = modulus,
          .poisson_ratio = 0.25,
          .restitution = restitution,
          .friction = friction};
}

/// Gravity seen by a plane that is tilted so that +x leads down.
Vec3d down_slope(double tangent) {
  const double angle = std::atan(tangent);
  return {g * std::sin(angle), 0, -g * std::cos(angle)};
}

/// Kinetic energy after an oblique impact over that before it.
template <class Law>
double energy_ratio(double degrees, double restitution, double friction) {
  const double angle = degrees * pi / 180, speed = 1;
  const Vec3d v{speed * std::sin(angle), 0, -speed * std::cos(angle)};
  const double way = -1e-6 * v.z;  // [m] to the plane
  const typename Law::Material m{.youngs_modulus = 1e9,
                                 .poisson_ratio = 0.25,
                                 .restitution = restitution,
                                 .friction = friction};
  OnPlane<Law> scene(m, v, {0, 0, 0}, way);
  const double before = kinetic_energy(scene.sim());
  scene.sim().run(1e-4);
  REQUIRE(scene.velocity().z > 0);
  return kinetic_energy(scene.sim()) / before;
}

}  // namespace

TEST_CASE(
    "friction: an oblique impact that slides throughout loses mu (1 + e) v_n, gains 2.5 times that "
    "in spin") {
  const double mu = 0.2, vn = 1;  // [-], [m/s]
  for (const double e : {0.9, 0.5})
    for (const double over : {1.02, 1.5, 4.0}) {
      const double vt = over * 3.5 * mu * (1 + e) * vn;
      OnPlane<HertzMindlin> scene(material(1e9, e, mu), {vt, 0, -vn}, {0, 0, 0}, 1e-5);
      scene.sim().run(1e-4);
      const double lost = vt - scene.velocity().x, normal = vn + scene.velocity().z;
      CAPTURE(e);
      CAPTURE(over);
      // Coulomb's limit holds in every step: to round-off of some hundred steps.
      CHECK(near_relative(lost, mu * normal, 1e-12));
      // 100 steps a contact: restitution to 2 pi zeta/100 (tests/physics/impact.cpp), zeta(.5) =
      // .26.
      CHECK(near_relative(lost, mu * (1 + e) * vn, 0.008));
      // The lever arm is R less the overlap, which at its largest is peak_overlap R.
      const double spin = scene.surface_speed().y, rigid = 2.5 * mu * normal;
      CHECK(spin < rigid);
      CHECK(spin > rigid * (1 - scene.sim().peak_overlap()));
      CHECK(scene.sim().peak_overlap() < 0.015);
      CHECK(scene.velocity().y == 0);
    }
}

TEST_CASE("friction: no oblique impact from 0 to 89 degrees gains energy") {
  // Elastic, so that nothing hides a gain: what remains is leapfrog's error of the restitution at
  // 100 steps a contact or more, squared velocities: 2 x 1e-5 (tests/physics/impact.cpp).
  for (double degrees = 0; degrees < 89.5; degrees += 1) {
    CAPTURE(degrees);
    CHECK(energy_ratio<HertzMindlin>(degrees, 1, 0.3) < 1 + 2e-5);
    CHECK(energy_ratio<HertzMindlin>(degrees, 0.5, 0.3) < 1);
    CHECK(energy_ratio<ByDisplacement>(degrees, 1, 0.3) < 1 + 2e-5);
    CHECK(energy_ratio<ByDisplacement>(degrees, 0.5, 0.3) < 1);
  }
}

TEST_CASE("friction: on a slope of tangent up to 3.5 mu a sphere rolls with 5/7 g sin") {
  const double mu = 0.1;  // [-]
  for (const double share : {0.3, 0.9, 0.98}) {
    const Vec3d gravity = down_slope(share * 3.5 * mu);
    OnPlane<HertzMindlin> scene(material(1e8, 0.5, mu), {0, 0, 0}, gravity);
    const auto a = scene.accelerations();
    CAPTURE(share);
    CHECK(near_relative(a.x, 5.0 / 7.0 * gravity.x, scene.lever_error()));
    CHECK(near_relative(a.spin, a.x, 2 * scene.lever_error()));
  }
}

TEST_CASE(
    "friction: on a steeper slope it slides with g (sin - mu cos) and spins with 2.5 mu g cos") {
  const double mu = 0.1;  // [-]
  for (const double share : {1.02, 1.1, 3.0}) {
    const Vec3d gravity = down_slope(share * 3.5 * mu);
    OnPlane<HertzMindlin> scene(material(1e8, 0.5, mu), {0, 0, 0}, gravity);
    const auto a = scene.accelerations();
    CAPTURE(share);
    // Coulomb's limit holds in every step: to round-off of 1e4 steps.
    CHECK(near_relative(a.x, gravity.x + mu * gravity.z, 1e-9));
    CHECK(near_relative(a.spin, -2.5 * mu * gravity.z, 2 * scene.lever_error()));
  }
}

TEST_CASE("friction: a sliding sphere rolls after 2 u0/(7 mu g), at 5/7 of its speed") {
  const double mu = 0.3, u0 = 0.1;  // [-], [m/s]
  OnPlane<HertzMindlin> scene(material(1e8, 0.5, mu), {u0, 0, 0}, {0, 0, -g});
  const double rolling = 2 * u0 / (7 * mu * g);  // [s]
  double slips_until = 0, error = 0;
  scene.sim().run(2 * rolling, [&](const auto& s) {
    const double slip = s.velocity(0).x - s.angular_velocity(0).y * radius;
    if (slip > 0.01 * u0) slips_until = s.time();
    if (s.time() < 0.999 * rolling)
      error = std::max(error, std::abs(s.velocity(0).x - (u0 - mu * g * s.time())));
  });
  // Coulomb's limit holds in each of some 1e5 steps; in the first three the spring comes up to it.
  const double late = 3 * scene.sim().step_length();  // [s]
  CHECK(error < mu * g * late);
  // The slip falls in proportion to time, so that 1 % of it is left at 99 %. (The last of it goes
  // into a vibration of the tangential spring.)
  CHECK(std::abs(slips_until - 0.99 * rolling) < late + scene.lever_error() * rolling);
  CHECK(near_relative(scene.velocity().x, 5.0 / 7.0 * u0, scene.lever_error()));
  CHECK(near_relative(scene.surface_speed().y, 5.0 / 7.0 * u0, 2 * scene.lever_error()));
}

}  // namespace friction_test
