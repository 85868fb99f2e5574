// silt - BSD-3-Clause, see LICENSE

#include "two_polyhedra.hpp"

#include <silt/shape/narrow/thickness_overlap.hpp>

namespace overlap_laws_test {

using namespace shape_test;
using silt::OverlapMemory;
using silt::rotation_about;
using silt::thickness_contact;
using silt::thickness_overlap;
using silt::volume_contact;
using silt::volume_overlap;
using silt::VolumeScale;

TEST_CASE("both laws: blocks face to face; force and torque do not jump as they tilt and slide") {
  const auto lower = box({2, 2, 1}), upper = box({1, 1, 1});
  const PlacedPolyhedron j{&lower, {}};
  for (const bool by_thickness : {false, true}) {
    const auto wrench = [&](double tilt, double slide) {
      const PlacedPolyhedron i{&upper, {{slide, 0.13, 0.99}, rotation_about({0, 1, 0}, tilt)}};
      const auto c = by_thickness ? thickness_overlap(i, j, {0, 0, 1})
                                  : contact_of(volume_overlap(i, j, {0, 0, 1}), {1}, {0, 0, 1});
      const Vec3d force = c.overlap * c.gradient * c.normal;  // a linear law
      const Vec3d torque = cross(c.point - i.pose.position, force) + c.couple * force;
      return std::pair{force, torque};
    };
    const auto largest_jump = [&](auto&& at, double from, double to, double step) {
      double jump = 0;
      for (double x = from; x < to; x += step) {
        const auto [f, t] = at(x);
        const auto [g, u] = at(x + step);
        jump = std::max({jump, norm(g - f), norm(u - t)});
      }
      return jump;
    };
    const double flat = norm(wrench(0, 0).first);
    // Tilt from -0.04 to 0.04 through full contact (|tilt| < 0.02) and zero. Smooth: a tenth of the
    // step makes a tenth of the difference, and it stays small.
    const auto tilted = [&](double tilt) { return wrench(tilt, 0.1); };
    const double jump = largest_jump(tilted, -0.04, 0.04, 2e-4);
    CHECK(jump <= 0.05 * flat);
    CHECK(largest_jump(tilted, -0.04, 0.04, 2e-5) <= 0.15 * jump);
    // Over the rim at 0.5, tilted by 1e-3; there the volume law has at once a side force W' times
    // depth and width, d/L = 1 % of the normal one.
    const auto slid = [&](double slide) { return wrench(1e-3, slide); };
    CHECK(largest_jump(slid, -0.9, 0.9, 1e-3) <= 0.02 * flat);
  }
}

TEST_CASE("thickness: an edge on a plane counts 0.707 of its depth, 1e-3 to 1e-9 deep") {
  // Edges askew to the axes of the body: what is left of it is a sliver 1e9 times as long as thick.
  std::vector<Vec3d> corners;
  const Quaternion askew = rotation_about(normalised(Vec3d{1, 2, 3}), 0.7);
  for (int k = 0; k < 8; ++k)
    corners.push_back(rotate(askew, {k & 1 ? 1.0 : -1.0, k & 2 ? 1.0 : -1.0, k & 4 ? 1.0 : -1.0}));
  const auto cube = Polyhedron::from_points(corners);
  const Quaternion on_edge = rotation_about({1, 0, 0}, pi / 4) * conjugate(askew);
  for (const double spin : {0.0, 0.4, 1.1})
    for (double depth = 1e-3; depth > 0.5e-9; depth /= 10) {
      INFO("spin ", spin, ", depth ", depth);
      const PlacedPolyhedron i{
          &cube, {{0, 0, std::sqrt(2.0) - depth}, rotation_about({0, 0, 1}, spin) * on_edge}};
      const auto c = thickness_overlap(i, {0, 0, 0}, {0, 0, 1});
      // Corners are known to 2e-16, the depth with them.
      CHECK(std::abs(c.overlap / depth - std::sqrt(0.5)) < 1e-15 / depth + 1e-6);
      CHECK(std::abs(c.gradient - std::sqrt(0.5)) < 1e-5);
      CHECK(std::hypot(c.point.x, c.point.y) < 1e-6);
    }
}

namespace {

struct Outcome {
  double energy_error, energy_swing;  // relative: after the collision, largest during it
  Vec3d momentum, angular_momentum;   // changes
  bool touched;
};

/// Two random bodies thrown at each other, off centre and spinning.
/// `exponent` 0: by the thickness.
Outcome collide(unsigned seed, const TestLaw& law, double exponent, double h) {
  Random random(seed);
  Body a(random.hull(12)), b(random.hull(16));
  a.position = {0.75, 0.1, -0.05}, a.velocity = {-1, 0, 0};
  b.position = {-0.75, 0, 0}, b.velocity = {1, 0, 0};
  a.turn = random.turn(), b.turn = random.turn();
  a.spin = 0.01 * random.direction(), b.spin = 0.01 * random.direction();
  const auto momentum = [&] { return a.mass * a.velocity + b.mass * b.velocity; };
  const auto angular = [&] {
    Vec3d sum{0, 0, 0};
    for (const auto* p : {&a, &b})
      sum += cross(p->position, p->mass * p->velocity) + rotate(p->turn, p->spin);
    return sum;
  };
  const VolumeScale scale{silt::volume_scale_length(a.mass, b.mass), exponent};
  OverlapMemory memory;
  const double energy = a.kinetic_energy() + b.kinetic_energy();
  const Vec3d p0 = momentum(), l0 = angular();
  Outcome out{};
  for (double t = 0; t < 1.2; t += h) {
    a.kick(h / 2), b.kick(h / 2), a.drift(h), b.drift(h);
    const auto c = exponent == 0 ? thickness_contact(a.placed(), b.placed(), memory)
                                 : volume_contact(a.placed(), b.placed(), scale, memory);
    const Vec3d f = act(c, law, a.velocity - b.velocity, {0, 0, 0});
    a.force = f, b.force = -f;
    a.torque = cross(c.point - a.position, f) + c.couple * f;
    b.torque = -(cross(c.point - b.position, f) + c.couple * f);
    a.kick(h / 2), b.kick(h / 2);
    const double now = a.kinetic_energy() + b.kinetic_energy() + law.energy(c.overlap);
    out.energy_swing = std::max(out.energy_swing, std::abs(now / energy - 1));
    out.touched |= c.overlap > 0;
  }
  out.energy_error = std::abs((a.kinetic_energy() + b.kinetic_energy()) / energy - 1);
  out.momentum = momentum() - p0, out.angular_momentum = angular() - l0;
  return out;
}

}  // namespace

TEST_CASE(
    "both laws: collisions of random polyhedra conserve energy, with the square of the step") {
  // Linear, Hertz; volume with exponents 2/3, 3/(2 q), p q = 2; thickness.
  for (const auto& [power, exponent] :
       {std::pair{1.0, 2.0 / 3}, {1.5, 2.0 / 3}, {1.0, 0.75}, {1.5, 0.8}, {1.0, 0.0}, {1.5, 0.0}}) {
    const TestLaw law{power == 1 ? 400.0 : 1500.0, power};
    double coarse = 0, fine = 0, momentum = 0;
    for (unsigned seed = 1; seed <= 12; ++seed) {
      const auto one = collide(seed, law, exponent, 1e-3),
                 other = collide(seed, law, exponent, 2.5e-4);
      CHECK(one.touched);
      coarse += one.energy_swing, fine += other.energy_swing;
      momentum = std::max({momentum, norm(one.momentum), norm(one.angular_momentum)});
    }
    const double order = std::log(coarse / fine) / std::log(4.0);
    MESSAGE("power ", power, ", exponent ", exponent, ": mean largest energy error ", coarse / 12,
            " at step 1e-3, ", fine / 12, " at 2.5e-4: order ", order);
    CHECK(momentum <= 1e-13);
    CHECK(fine / 12 <= 1e-3);
    CHECK(order >= 1.6);  // second order, less what the first touch has of its singular force
  }
}

namespace {

struct Rest {
  double height_error, tilt, kinetic_energy, aside, farthest;  // farthest: largest height error
};

/// A cube of edge 1 on a plane, for 40 time units; m g = 10. Faces are linear springs (of the
/// volume: p q = 2), so that it sinks in by m g/k.
Rest settle(double dropped, double tilt, double stiffness, bool by_thickness) {
  const double g = 10, h = 5e-4;
  Body cube(box({1, 1, 1}));
  const TestLaw law{stiffness, 1, 0.5 * std::sqrt(stiffness)};
  const double rest = cube.mass * g / stiffness;
  cube.position = {0, 0, 0.5 - rest + dropped};
  cube.turn = rotation_about(normalised(Vec3d{1, 0.3, 0}), tilt);
  Rest out{};
  for (int step = 0; step < 80000; ++step) {
    cube.kick(h / 2), cube.drift(h);
    const PlacedPolyhedron body = cube.placed();
    const Vec3d at{0, 0, 0}, up{0, 0, 1};
    const auto c = by_thickness ? thickness_overlap(body, at, up)
                                : contact_of(volume_overlap(body, at, up), {1, 1}, up);
    const Vec3d arm = c.point - cube.position;
    const Vec3d f = act(c, law, cube.velocity + cross(cube.rate(), arm), cube.rate());
    cube.force = f + Vec3d{0, 0, -cube.mass * g};
    cube.torque = cross(arm, f) + c.couple * f;
    if (c.overlap > 0) cube.torque -= 2.0 * cube.rate();  // rolling resistance
    cube.kick(h / 2);
    out.farthest = std::max(out.farthest, std::abs(cube.position.z - 0.5 + rest));
    out.aside = std::max(out.aside, std::abs(cube.position.x) + std::abs(cube.position.y));
  }
  out.height_error = std::abs(cube.position.z - 0.5 + rest);
  out.tilt = norm(rotate(cube.turn, {0, 0, 1}) - Vec3d{0, 0, 1});
  out.kinetic_energy = cube.kinetic_energy();
  return out;
}

}  // namespace

TEST_CASE("volume law: a cube on a plane stays; dropped on an edge it comes near to upright") {
  const auto placed = settle(0, 0, 2000, false);
  CHECK(placed.farthest <= 1e-13);
  CHECK(placed.aside <= 1e-13);
  CHECK(placed.kinetic_energy <= 1e-25);
  const double depth = 10.0 / 2000;
  const auto dropped = settle(0.02, 0.03, 2000, false);
  MESSAGE("depth ", depth, ": rests with tilt ", dropped.tilt, ", height off by ",
          dropped.height_error, ", kinetic energy ", dropped.kinetic_energy);
  // The pressure W' is the same all over the contact: upright is no stable place until an edge
  // lifts, at 2 d/L (see volume_overlap.hpp).
  CHECK(dropped.tilt <= 2.5 * depth);
  CHECK(dropped.tilt >= 0.5 * depth);
  CHECK(dropped.height_error <= 0.1 * depth);
  CHECK(dropped.aside <= 1e-12);  // no friction, no side force
  CHECK(dropped.kinetic_energy <= 1e-9);
}

TEST_CASE("thickness law: a cube on a plane stays; dropped on an edge it stands up") {
  const double depth = 10.0 / 2000;
  const auto placed = settle(0, 0, 2000, true);
  const auto dropped = settle(0.02, 0.03, 2000, true);
  MESSAGE("depth ", depth, ": rests with tilt ", dropped.tilt, ", height off by ",
          dropped.height_error, ", kinetic energy ", dropped.kinetic_energy);
  // U' |grad delta| = k d (1 - 4 d^2/L^2): it sinks in by 4 d^3/L^2 more.
  CHECK(placed.farthest <= 8 * depth * depth * depth);  // and swings as far beyond
  CHECK(placed.aside <= 1e-12);
  CHECK(dropped.height_error <= 5 * depth * depth * depth);
  CHECK(dropped.tilt <= 1e-9);
  CHECK(dropped.aside <= 1e-12);
  CHECK(dropped.kinetic_energy <= 1e-12);
}

}  // namespace overlap_laws_test
