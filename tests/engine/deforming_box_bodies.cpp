// silt - BSD-3-Clause, see LICENSE
// Bodies of every shape in a box that deforms: no place of it differs from another, its stress is
// that of the contacts between the centres of mass, and its work is all that the bodies gain.
#include <engine/deforming_box.hpp>

#include <filesystem>
#include <type_traits>

#include <silt/io/checkpoint.hpp>
#include <silt/io/observers.hpp>
#include <silt/measure/stress.hpp>
#include <silt/search/nbs.hpp>
#include <silt/shape/mix.hpp>
#include <silt/shape/multi_sphere.hpp>
#include <silt/shape/super_ellipsoid.hpp>

#include "engine/stones.hpp"

namespace deforming_box_bodies_test {

using namespace deforming_box_test;
using silt::MultiSphere;
using silt::Quaternion;
using silt::SuperEllipsoid;

namespace {

/// Grains of this form in the order of ids, displaced and turned at random from a grid.
template <class Shapes>
Shapes cloud_of(Shapes forms, int n, double spacing, double speed, const Vec3d& shift = {0, 0, 0}) {
  silt::Random random(11);
  const auto any = [&] { return 2 * random.uniform() - 1; };
  const std::size_t kinds = forms.forms().size();
  for (int k = 0; k < n * n * n; ++k) {
    const Vec3d cell{k % n + 0.5, k / n % n + 0.5, k / (n * n) + 0.5};
    const double x = any(), y = any(), z = any(), u = any(), v = any(), w = any();
    const double p = any(), q = any(), r = any(), s = any();
    const double size = std::sqrt(p * p + q * q + r * r + s * s);
    forms.add({.form = static_cast<std::size_t>(k) % kinds,
               .position = spacing * cell + 0.03 * spacing * Vec3d{x, y, z} + shift,
               .orientation = Quaternion{p / size, q / size, r / size, s / size},
               .density = 2500,
               .velocity = speed * Vec3d{u, v, w}});
  }
  return forms;
}
template <class Shape, class... Forms>
auto forms_of(const Forms&... forms) {
  silt::Particles<Shape> all;
  (all.add_form(forms), ...);
  return all;
}
// All within 1.3 mm across; their parts lie up to 0.35 mm beside their centres of mass.
const MultiSphere rod{.balls = {{{-0.35e-3, 0, 0}, 0.3e-3}, {{0.3e-3, 0, 0}, 0.35e-3}}};
const SuperEllipsoid pill{.a = 0.6e-3, .b = 0.45e-3, .c = 0.4e-3};
const SuperEllipsoid box_like{.a = 0.5e-3, .b = 0.4e-3, .c = 0.4e-3, .s1 = 5, .s2 = 4};

/// Calls visit(particles without any, name) for each shape.
template <class Visit>
void for_all_shapes(const Visit& visit) {
  visit(forms_of<MultiSphere>(rod), "rods of balls");
  visit(forms_of<SuperEllipsoid>(pill), "ellipsoids");
  visit(forms_of<SuperEllipsoid>(box_like, pill), "super-ellipsoids");
  visit(forms_of<silt::Polyhedron>(block(0.45e-3, 0.4e-3, 0.35e-3)), "blocks");
}

template <class Shapes, class... More>
auto sheared_bodies(const Shapes& of, const DeformingBox& box, const More&... more) {
  silt::Simulation sim{of, silt::Contacts<HertzMindlin>{rubber}, box, silt::EnergyLedger{},
                       more...};
  sim.time_step = 4e-6, sim.threads = 1;
  return sim;
}
/// Velocity relative to the flow [m/s] and angular velocity [rad/s], over the usual ones.
template <class Sim>
std::vector<double> own_motion(const Sim& sim) {
  std::vector<double> all;
  for (silt::ParticleId id = 0; id < sim.rows(); ++id) {
    const std::size_t k = sim.find(id);
    const Vec3d v = sim.velocity(k) - sim.domain().flow_at(sim.position(k)),
                w = sim.angular_velocity(k);
    for (const double one : {v.x, v.y, v.z}) all.push_back(one / 0.1);
    for (const double one : {w.x, w.y, w.z}) all.push_back(one / 100);
  }
  return all;
}
double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  REQUIRE(a.size() == b.size());
  double most = 0;
  for (std::size_t k = 0; k < a.size(); ++k) most = std::max(most, std::abs(a[k] - b[k]));
  return most;
}
double largest_difference(const silt::BoxStress& a, const silt::BoxStress& b) {
  return largest_difference(std::vector<double>{a.x, a.y, a.z, a.xy, a.xz, a.yz},
                            std::vector<double>{b.x, b.y, b.z, b.xy, b.xz, b.yz});
}
const Deformation all_ways{.x = {.rate = -80},
                           .z = {.rate = -20},
                           .xy = {.rate = 60},
                           .xz = {.rate = -15},
                           .yz = {.rate = 25}};

}  // namespace

TEST_CASE("deforming_box: bodies of a single ball do as spheres, and bear their stress") {
  // Without the flow in their velocities, or with that of a wrong place, all would be others.
  auto spheres = sheared(cloud(5, 1.05e-3, 0.1), cube(5.25e-3, all_ways), silt::EnergyLedger{});
  const MultiSphere ball{.balls = {{{0, 0, 0}, 0.5e-3}}};
  silt::Particles<MultiSphere> balls;
  balls.add_form(ball);
  for (const auto& p : cloud(5, 1.05e-3, 0.1))
    balls.add({.position = p.position, .density = p.density, .velocity = p.velocity});
  auto bodies = sheared_bodies(balls, cube(5.25e-3, all_ways));
  spheres.time_step = 4e-6, spheres.threads = 1;
  spheres.run(4e-3), bodies.run(4e-3);
  CHECK(bodies.touching_pairs() > 80);
  CHECK(bodies.touching_pairs() == spheres.touching_pairs());
  CHECK(largest_difference(own_motion(bodies), own_motion(spheres)) < 1e-7);
  const auto &s = bodies.domain().stress(), &t = spheres.domain().stress();
  CHECK(t.pressure() > 40);
  CHECK(largest_difference(s, t) < 1e-7 * t.pressure());
  CHECK(bodies.domain().work() == doctest::Approx(spheres.domain().work()).epsilon(1e-8));
  CHECK(bodies.energy().residual() == doctest::Approx(spheres.energy().residual()).epsilon(1e-4));
}

TEST_CASE("deforming_box: a crowd of bodies that is moved as a whole does the same, to 1e-7") {
  // Images pass each other by a fifth of a length. A wrong velocity or place of an image of a
  // part at one face would give differences of order 1.
  for_all_shapes([](const auto& forms, const char* name) {
    CAPTURE(name);
    std::vector<double> first;
    silt::BoxStress stress;
    double work = 0;
    for (const Vec3d& shift : {Vec3d{0, 0, 0}, Vec3d{1.3e-3, 2.9e-3, -2.2e-3}}) {
      auto sim = sheared_bodies(cloud_of(forms, 5, 1.3e-3, 0.1, shift), cube(6.5e-3, all_ways));
      sim.run(4e-3);
      if (first.empty()) {
        CHECK(sim.touching_pairs() > 5);
        first = own_motion(sim), stress = sim.domain().stress(), work = sim.domain().work();
        continue;
      }
      CHECK(largest_difference(own_motion(sim), first) < 1e-7);
      CHECK(largest_difference(sim.domain().stress(), stress) < 1e-7 * stress.pressure());
      CHECK(sim.domain().work() == doctest::Approx(work).epsilon(1e-8));
    }
  });
}

TEST_CASE(
    "deforming_box: the stress of bodies is that of their contacts' forces and of their centres' "
    "velocities, and its work is all they gain, to 1 %") {
  for_all_shapes([](const auto& forms, const char* name) {
    CAPTURE(name);
    auto sim = sheared_bodies(cloud_of(forms, 5, 1.3e-3, 0.1), cube(6.5e-3, all_ways));
    silt::Upper3 sum;
    sim.run(2e-3, silt::at(silt::every(2e-3), [&](const auto& s) {
              sum = {};
              s.for_each_contact([&](const silt::ContactSeen& c) {
                sum = sum + silt::upper_outer(c.force, c.branch);
              });
              for (std::size_t k = 0; k < s.rows(); ++k) {
                const Vec3d v = s.velocity(k) - s.domain().flow_at(s.position(k));
                sum = sum + s.mass(k) * silt::upper_outer(v, v);
              }
            }));
    const auto& box = sim.domain();
    const silt::Upper3 p = (1 / box.volume()) * sum;
    // The kinetic part of the box is that of half a step ago.
    const double most = 1e-2 * box.stress().pressure();
    CHECK(box.stress().pressure() > 5);
    const silt::BoxStress seen{p.xx, p.yy, p.zz, -p.xy, -p.xz, -p.yz};
    CHECK(largest_difference(box.stress(), seen) < most);
    const auto e = sim.energy();
    CHECK(e.box > 0.2 * e.kinetic());
    CHECK(std::abs(e.residual()) < 1e-2 * std::abs(e.box));
  });
}

TEST_CASE("deforming_box: bodies do the same with lists and with a search at every step") {
  for_all_shapes([](const auto& forms, const char* name) {
    CAPTURE(name);
    const auto of = cloud_of(forms, 5, 1.3e-3, 0.1);
    auto lists = sheared_bodies(of, cube(6.5e-3, all_ways));
    auto each = sheared_bodies(of, cube(6.5e-3, all_ways), silt::Nbs{});
    lists.run(4e-3), each.run(4e-3);
    // Sums in another order differ by rounding, which the iterations of narrow phases enlarge; a
    // missed contact gives 0.1 or more.
    CHECK(largest_difference(own_motion(lists), own_motion(each)) < 1e-5);
  });
}

TEST_CASE("deforming_box: bodies have the same bits with any threads and after a restart") {
  const auto dir = std::filesystem::temp_directory_path() / "silt_deforming_bodies";
  const std::string file = dir.string() + ".silt";
  const Deformation how{.x = {.stress = 400, .most_rate = 10}, .xy = {.rate = 50}};
  for_all_shapes([&](const auto& forms, const char* name) {
    CAPTURE(name);
    const auto begin = [&](int threads) {
      auto sim = sheared_bodies(cloud_of(forms, 6, 1.3e-3, 0.1), cube(7.8e-3, how));
      sim.threads = threads;
      return sim;
    };
    auto one = begin(1);
    one.run(1e-3);
    silt::save_checkpoint(one, file);
    const double step = one.step_length();
    one.run(step);
    // How far the lists are used up: with velocities that contain the flow they would be renewed
    // sooner after a restart.
    const double used = one.engine().lists.upkeep.used;
    one.run(1e-3);
    auto two = begin(2);
    two.run(1e-3), two.run(step), two.run(1e-3);
    CHECK(bits(two) == bits(one));
    auto again = begin(2);
    silt::load_checkpoint(again, file);
    again.run(step);
    CHECK(again.engine().lists.upkeep.used == used);
    again.run(1e-3);
    CHECK(bits(again) == bits(one));
    CHECK(again.domain().state() == one.domain().state());
  });
  std::filesystem::remove(file);
}

TEST_CASE("deforming_box: two shapes together, and bodies that come and leave, are moved alike") {
  using Two = silt::Mix<MultiSphere, silt::Polyhedron>;
  std::vector<double> first;
  for (const Vec3d& shift : {Vec3d{0, 0, 0}, Vec3d{-0.7e-3, 1.9e-3, 3.1e-3}}) {
    auto forms = forms_of<Two>(rod, block(0.45e-3, 0.4e-3, 0.35e-3));
    auto sim = sheared_bodies(cloud_of(forms, 5, 1.3e-3, 0.1, shift), cube(6.5e-3, all_ways));
    sim.run(1e-3);
    sim.remove(5), sim.remove(40);
    sim.run(1e-3);
    std::vector<double> all;
    for (silt::ParticleId id = 0; id < 125; ++id) {
      const std::size_t k = sim.find(id);
      if (k == sim.rows()) continue;
      const Vec3d v = sim.velocity(k) - sim.domain().flow_at(sim.position(k));
      for (const double one : {v.x, v.y, v.z}) all.push_back(one / 0.1);
    }
    CHECK(all.size() == 123 * 3);
    if (first.empty()) first = all;
    CHECK(largest_difference(all, first) < 1e-7);
  }
}

TEST_CASE("deforming_box: a body longer than the box, and a fixed one, are refused") {
  const MultiSphere long_rod{.balls = {{{-2e-3, 0, 0}, 0.3e-3}, {{2e-3, 0, 0}, 0.3e-3}}};
  const auto one_long = cloud_of(forms_of<MultiSphere>(long_rod), 1, 3e-3, 0);
  CHECK(has_words(refusal<silt::InputError>([&] { sheared_bodies(one_long, cube(13e-3)); }),
                  {"DeformingBox: its length 0.013 [m] must be", "3 diameters of particle 0"}));
  // The box shrinks until the rod would meet itself.
  auto sim = sheared_bodies(one_long, cube(14e-3, {.y = {.rate = -200}}));
  sim.time_step = 2e-6;
  CHECK(has_words(refusal<silt::InputError>([&] { sim.run(1e-2); }),
                  {"DeformingBox: its length 0.00", "in y must be at least 0.0046 m"}));
  auto one = cloud_of(forms_of<MultiSphere>(rod), 3, 2e-3, 0);
  one[3].fixed = true;
  auto held = sheared_bodies(one, cube(6e-3));
  CHECK(has_words(refusal<silt::InputError>([&] { held.run(1e-5); }), {"a fixed particle"}));
}

}  // namespace deforming_box_bodies_test
