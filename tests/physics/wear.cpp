// silt - BSD-3-Clause, see LICENSE
// Wear of mesh walls against closed forms: a sphere that slides with a constant force, impacts at
// angles, a sphere that rolls; the same bits on any number of threads and from a checkpoint.
#include <array>
#include <cmath>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include <doctest/doctest.h>

#include <silt/contact/linear_spring.hpp>
#include <silt/io/checkpoint.hpp>
#include <silt/measure/wall_wear.hpp>
#include <silt/module/wear.hpp>
#include <silt/shape/super_ellipsoid.hpp>
#include <silt/simulation.hpp>

#include "near.hpp"
#include "refusal.hpp"

namespace wear_test {

using silt_test::has, silt_test::refusal;

using silt::Vec3d;
using Sliding = silt::Wear<silt::Archard>;
using Cutting = silt::Wear<silt::Finnie>;

const double R = 1e-3, density = 2500, g = 9.81;
const double mass = 4.0 / 3 * 3.14159265358979323846 * R * R * R * density;  // [kg]
const silt::LinearSpringFriction::Material smooth{.stiffness = 1e3},
    rough{.stiffness = 1e3, .restitution = 0.5, .friction = 0.5};
const silt::Archard steel{.coefficient = 1e-4, .hardness = 2e9};
const silt::Finnie ductile{
    .flow_stress = 1e9, .share_cutting = 0.5, .depth_ratio = 2, .force_ratio = 2};

/// A plate z = 0 of two triangles that meet in x = 0.
inline silt::TriangleMesh plate() {
  return silt::TriangleMesh({{Vec3d{-1, -1, 0}, Vec3d{0, -1, 0}, Vec3d{0, 1, 0}},
                             {Vec3d{0, -1, 0}, Vec3d{1, 1, 0}, Vec3d{0, 1, 0}}});
}
template <class Shape>
auto scene(const typename silt::Particles<Shape>::Particle& one,
           const silt::LinearSpringFriction::Material& material, silt::WallSetup setup = {}) {
  silt::Particles<Shape> p;
  if constexpr (!std::is_same_v<Shape, silt::Sphere>) p.add_form(Shape{.a = R, .b = R, .c = R});
  p.add(one);
  silt::Simulation sim{std::move(p), silt::Contacts<silt::LinearSpringFriction>{material},
                       Sliding{steel}, Cutting{ductile}};
  sim.add_wall(plate(), material, std::move(setup));
  sim.time_step = 1e-5;
  return sim;
}
/// At rest on the plate, as gravity presses it.
inline Vec3d resting(double x) { return {x, 0, R - mass * g / 1e3}; }

// Catches the way of twice a step or of one step too many, the force with its tangential part, a
// contact that counts for both facets or for the wrong one, the number of the module.
TEST_CASE("wear: a sphere that slides wears k F s/H, each facet in proportion to the way on it") {
  auto sim = scene<silt::Sphere>(
      {.position = resting(-0.004), .radius = R, .density = density, .velocity = {0.1, 0, 0}},
      smooth);
  sim.gravity = {0, 0, -g};
  sim.run(0.1);
  const double per_way = 1e-4 * mass * g / 2e9;  // [m2]
  const auto worn = silt::worn_volumes<Sliding>(sim, 0);
  CHECK(worn[0] + worn[1] == near(per_way * 0.01).epsilon(1e-9));
  CHECK(worn[0] == near(per_way * 0.004).epsilon(3e-3));  // within a step and the view from above
  CHECK(silt::worn_volume<Sliding>(sim, 0) == near(worn[0] + worn[1]));
  CHECK(silt::worn_volume<Cutting>(sim, 0) == 0);  // it rests on the plate: no impact
}

// Catches the velocity of the sphere alone, and that of the wall alone.
TEST_CASE("wear: a plate that moves under a sphere, and one that goes with it") {
  const auto worn = [](double of_plate, double of_sphere) {
    auto sim = scene<silt::Sphere>(
        {.position = resting(0.1), .radius = R, .density = density, .velocity = {of_sphere, 0, 0}},
        smooth, {.motion = silt::translation({of_plate, 0, 0})});
    sim.gravity = {0, 0, -g};
    sim.run(0.01);
    return silt::worn_volume<Sliding>(sim, 0);
  };
  const double per_way = 1e-4 * mass * g / 2e9;
  CHECK(worn(0.2, 0) == near(per_way * 0.002).epsilon(1e-6));
  CHECK(worn(0.2, 0.2) < 1e-6 * per_way * 0.002);
}

// Catches the turning left out, or with the wrong sign: 2 v for 0.
TEST_CASE("wear: a sphere that rolls wears nothing, one that spins on the spot does") {
  const auto worn = [](double speed, double spin) {
    auto sim = scene<silt::Sphere>({.position = resting(0.1),
                                    .radius = R,
                                    .density = density,
                                    .velocity = {speed, 0, 0},
                                    .angular_velocity = {0, spin, 0}},
                                   smooth);
    sim.gravity = {0, 0, -g};
    sim.run(0.01);
    return silt::worn_volume<Sliding>(sim, 0);
  };
  const double per_way = 1e-4 * mass * g / 2e9, arm = R - mass * g / 1e3;
  CHECK(worn(0.1, 0.1 / arm) < 1e-9 * per_way * 0.001);
  CHECK(worn(0, 100) == near(per_way * 100 * arm * 0.01).epsilon(1e-9));
}

// Catches wear at each step of the contact, the wrong branch of f, a factor K, sine for cosine.
TEST_CASE("wear: an impact wears as Finnie says at angles on both sides of tan alpha = K/6") {
  const double degree = 3.14159265358979323846 / 180, speed = 1;  // [m/s]
  for (const double alpha : {5 * degree, 15 * degree, 30 * degree, 80 * degree}) {
    auto sim =
        scene<silt::Sphere>({.position = {0.1, 0, R + 1e-4},
                             .radius = R,
                             .density = density,
                             .velocity = {speed * std::cos(alpha), 0, -speed * std::sin(alpha)}},
                            smooth);
    sim.run(0.01);
    CHECK(sim.velocity(0).z > 0);  // it has left the plate
    const double f = std::tan(alpha) <= 2.0 / 6
                         ? std::sin(2 * alpha) - 3 * std::pow(std::sin(alpha), 2)
                         : std::pow(std::cos(alpha), 2) / 3;
    const double V = 0.5 * mass * speed * speed * f / (1e9 * 2 * 2);
    CHECK(silt::worn_volume<Cutting>(sim, 0) == near(V).epsilon(1e-9));
    CHECK(silt::worn_volume<Sliding>(sim, 0) > 0);
  }
}

// Catches normals of floats, with which wear in mixed precision did not compile.
TEST_CASE("wear: in mixed precision a sphere wears as in double to 1e-6") {
  const auto bed = [](auto... precision) {
    silt::Particles<silt::Sphere> p;
    p.add({.position = resting(-0.004), .radius = R, .density = density, .velocity = {0.1, 0, 0}});
    p.add({.position = {0.1, 0, R + 1e-4},
           .radius = R,
           .density = density,
           .velocity = {0.3, 0, -1}});
    silt::Simulation sim{std::move(p), silt::Contacts<silt::LinearSpringFriction>{smooth},
                         Sliding{steel}, Cutting{ductile}, precision...};
    sim.add_wall(plate(), smooth);
    sim.gravity = {0, 0, -g};
    sim.time_step = 1e-5;
    sim.run(0.02);
    return std::array{silt::worn_volume<Sliding>(sim, 0), silt::worn_volume<Cutting>(sim, 0)};
  };
  const auto exact = bed(), mixed = bed(silt::Mixed{});
  for (std::size_t k = 0; k < 2; ++k) {
    CHECK(exact[k] > 0);
    CHECK(mixed[k] == near(exact[k]).epsilon(1e-6));
  }
}

// Catches bodies' contacts that are not asked, or with another velocity.
TEST_CASE("wear: a super-ellipsoid that is a sphere wears as the sphere does") {
  auto sim = scene<silt::SuperEllipsoid>(
      {.position = resting(0.1), .radius = R, .density = density, .velocity = {0.1, 0, 0}}, smooth);
  sim.gravity = {0, 0, -g};
  sim.run(0.01);
  // Its moments are integrated: mass and effective radius have some 1e-4.
  CHECK(silt::worn_volume<Sliding>(sim, 0) ==
        near(1e-4 * sim.mass(0) * g / 2e9 * 0.001).epsilon(1e-3));
}

// Catches sums that threads add in another order, and what a checkpoint forgets.
TEST_CASE("wear: the same bits on any number of threads and from a checkpoint") {
  const auto make = [](int threads) {
    silt::Particles<silt::Sphere> p;
    p.fill({{-0.01, -0.01, 0.001}, {0.01, 0.01, 0.03}},
           {.radius = silt::uniform(0.8e-3, 1e-3), .density = density, .count = 400});
    silt::Simulation sim{std::move(p), silt::Contacts<silt::LinearSpringFriction>{rough},
                         Sliding{steel, {steel, {.coefficient = 2e-4, .hardness = 2e9}}},
                         Cutting{ductile}};
    sim.gravity = {5, 0, -g};
    sim.add_wall(plate(), rough);
    sim.add_wall(silt::TriangleMesh({{Vec3d{0.01, -1, -1}, Vec3d{0.01, 1, -1}, Vec3d{0.01, 0, 1}}}),
                 rough);
    sim.add_wall(silt::box({-0.01, -0.01, -0.01}, {0.02, 0.01, 0.1}), rough);
    sim.threads = threads;
    return sim;
  };
  auto one = make(1), three = make(3), half = make(2), again = make(1);
  one.run(0.06), three.run(0.06), half.run(0.03);
  const auto path = (std::filesystem::temp_directory_path() / "silt_wear").string();
  silt::save_checkpoint(half, path);
  silt::load_checkpoint(again, path);
  std::filesystem::remove(path);
  CHECK(silt::worn_volumes<Cutting>(again, 0) == silt::worn_volumes<Cutting>(half, 0));
  again.run(0.03), half.run(0.03);
  for (std::size_t w = 0; w < 2; ++w) {
    CHECK(silt::worn_volume<Sliding>(one, w) > 0);
    CHECK(silt::worn_volume<Cutting>(one, w) > 0);
    CHECK(silt::worn_volumes<Sliding>(one, w) == silt::worn_volumes<Sliding>(three, w));
    CHECK(silt::worn_volumes<Cutting>(one, w) == silt::worn_volumes<Cutting>(three, w));
    CHECK(silt::worn_volumes<Sliding>(again, w) == silt::worn_volumes<Sliding>(half, w));
  }
}

TEST_CASE("wear: what makes no sense is refused") {
  const silt::Particles<silt::Sphere>::Particle one{
      .position = resting(0.1), .radius = R, .density = density};
  const auto with = [&](const Sliding& sliding, const Cutting& cutting) {
    auto sim = scene<silt::Sphere>(one, smooth);
    sim.module<Sliding>() = sliding, sim.module<Cutting>() = cutting;
    return refusal([&] { sim.run(1e-4); });
  };
  CHECK(has(with({{.coefficient = 0, .hardness = 1}}, {ductile}), "Archard.coefficient"));
  CHECK(has(with({{.coefficient = 1}}, {ductile}), "Wear.law: Archard.hardness"));
  CHECK(has(with({steel, {steel, steel}}, {ductile}), "Wear.first_walls has 2 entries"));
  CHECK(has(with({steel, {{.coefficient = -1}}}, {ductile}),
            "Wear.first_walls[0]: Archard.coefficient"));
  CHECK(has(with({steel}, {}), "Finnie.flow_stress"));
  CHECK(has(with({steel}, {{.flow_stress = 1, .share_cutting = 2}}), "Finnie.share_cutting"));
  silt::Particles<silt::Sphere> p;
  p.add(one);
  silt::Simulation sim{std::move(p), silt::Contacts<silt::LinearSpringFriction>{smooth},
                       Sliding{steel}, Cutting{ductile}};
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, smooth);
  CHECK(has(refusal([&] { sim.run(1e-4); }), "no wall of this simulation is a triangle mesh"));
  CHECK(has(refusal([&] { silt::worn_volume<Sliding>(sim, 0); }), "is not a triangle mesh"));
}

// Catches a message that says of a removed wall that it was no mesh.
TEST_CASE("wear: a run goes on after its only mesh was removed, whose wear is no longer there") {
  auto sim = scene<silt::Sphere>(
      {.position = resting(0.1), .radius = R, .density = density, .velocity = {0.1, 0, 0}}, smooth,
      {.name = "chute"});
  sim.gravity = {0, 0, -g};
  sim.run(1e-3);
  sim.remove_wall("chute");
  CHECK_NOTHROW(sim.run(1e-3));
  CHECK(has(refusal([&] { silt::worn_volume<Sliding>(sim, "chute"); }),
            "wall 0 'chute' was removed, and its facets with it; read its wear before"));
}

}  // namespace wear_test
