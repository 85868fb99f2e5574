// silt - BSD-3-Clause, see LICENSE
// What flows between particles in contact: closed forms of two, conservation in beds of spheres and
// of bodies, walls of every kind of pipeline, the same bits on any number of threads and from a
// checkpoint.
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>

#include <engine/support.hpp>

#include <silt/contact/hertz_mindlin.hpp>
#include <silt/contact/linear_spring.hpp>
#include <silt/io/checkpoint.hpp>
#include <silt/module/field.hpp>
#include <silt/shape/multi_sphere.hpp>
#include <silt/shape/super_ellipsoid.hpp>

#include "near.hpp"

namespace module_fluxes_test {

using namespace engine_test;
using silt::Seen;
using silt::Vec3d;

/// Heat that flows through the circle in which the surfaces cut each other: 2 k sqrt(R* d) of
/// Batchelor and O'Brien.
struct Conduction {
  double conductivity;  // [W/(m K)]
  double capacity;      // [J/(kg K)]
  struct Fields {
    double temperature = 300;  // [K]
  };
  static constexpr std::array names{"temperature [K]"};
  static constexpr auto exchanged = &Fields::temperature;
  template <class Real>
  Real flux(const silt::Touching<Real>& c, const Real& a, const Real& b) const {
    using Scalar = silt::ScalarOf<Real>;
    return Real(static_cast<Scalar>(2 * conductivity)) * sqrt(c.R_eff * c.overlap) * (b - a);
  }
  void update(const Seen& p, Fields& f, double received, double dt) const {
    f.temperature += received * dt / (p.mass * capacity);
  }
};
/// The same with walls of 400 K.
struct HeatedWalls : Conduction {
  double at_wall(std::size_t, double) const { return 400; }
};
const Conduction heat{.conductivity = 50, .capacity = 1000};
const silt::HertzMindlin::Material rock{
    .youngs_modulus = 1e6, .poisson_ratio = 0.3, .restitution = 0.5, .friction = 0.4};

/// [J] that particles hold.
template <class Sim>
double heat_of(const Sim& sim) {
  double sum = 0;
  for (std::size_t k = 0; k < sim.rows(); ++k)
    sum += sim.mass(k) * 1000 * sim.template field<Conduction>(k).temperature;
  return sum;
}
/// Those of even ids are hot.
template <class Sim>
void heat_up(Sim& sim) {
  for (std::size_t k = 0; k < sim.rows(); ++k)
    sim.template field<Conduction>(k).temperature = sim.id(k) % 2 == 0 ? 500 : 300;
}
template <class Shape, class Forms, class... Policies>
auto bed(std::size_t count, const Forms& add_form, const Policies&... policies) {
  silt::Particles<Shape> p;
  add_form(p);
  p.fill({{0, 0, 0}, {0.02, 0.02, 0.03}},
         {.radius = silt::uniform(1.2e-3, 1.6e-3), .density = 2500, .count = count});
  silt::Simulation sim{std::move(p), silt::Contacts<silt::HertzMindlin>{rock}, heat, policies...};
  sim.gravity = {0, 0, -9.81};
  sim.add_wall(silt::box({0, 0, 0}, {0.02, 0.02, 0.05}), rock);
  heat_up(sim);
  return sim;
}
/// Nothing is lost, much has flowed.
template <class Sim>
void check_conserves(Sim sim, double rounding) {
  const double before = heat_of(sim);
  sim.run(0.1);
  CHECK(sim.touching_pairs() > 20);
  CHECK(std::abs(heat_of(sim) / before - 1) < rounding);
  double exchanged = 0;
  for (std::size_t k = 0; k < sim.rows(); ++k)
    exchanged = std::max(exchanged, std::abs(sim.template field<Conduction>(k).temperature -
                                             (sim.id(k) % 2 == 0 ? 500 : 300)));
  CHECK(exchanged > 1);
}

TEST_CASE("module fluxes: a flux that is no number is named, not the update that received it") {
  silt::Particles<Sphere> p;
  for (const double x : {0.0, 1.99e-3})
    p.add({.position = {x, 0, 0}, .radius = 1e-3, .density = 2500});
  Conduction wrong = heat;
  wrong.conductivity = NAN;
  silt::Simulation sim{std::move(p), silt::Contacts<silt::HertzMindlin>{rock}, wrong};
  sim.time_step = 1e-6;
  CHECK(has_words(refusal<silt::SimulationError>([&] { sim.run(1e-4); }),
                  {"'temperature [K]' of the module Conduction became nan", "received nan",
                   "mend the module's flux() or at_wall()"}));
}

}  // namespace module_fluxes_test

using namespace module_fluxes_test;

// Catches a flux with the wrong sign, twice, of one end alone, or of a pair that fills a pack up.
TEST_CASE("module fluxes: two spheres come to one temperature as the closed form says") {
  silt::Particles<silt::Sphere> p;
  const double R = 1e-3, d = 0.1e-3;  // [m]
  p.add({.position = {0, 0, 0}, .radius = R, .density = 1000});
  p.add({.position = {2 * R - d, 0, 0}, .radius = R, .density = 2000});
  const silt::LinearSpring::Material spring{.stiffness = 1e-12};  // stays as it is
  silt::Simulation sim{std::move(p), silt::Contacts<silt::LinearSpring>{spring}, heat};
  sim.time_step = 1e-4;
  heat_up(sim);
  const double total = heat_of(sim);
  sim.run(0.1);
  const double H = 2 * 50 * std::sqrt(0.5 * R * d);
  const double rate = H * (1 / (sim.mass(0) * 1000) + 1 / (sim.mass(1) * 1000));  // [1/s]
  const double difference = sim.field<Conduction>(sim.find(0)).temperature -
                            sim.field<Conduction>(sim.find(1)).temperature;
  // Euler's steps of the exponential, exactly.
  CHECK(difference == near(200 * std::pow(1 - rate * 1e-4, 1000)).epsilon(1e-9));
  CHECK(difference < 150);
  CHECK(heat_of(sim) == near(total).epsilon(1e-13));
}

// Catches heat that one end of a contact gets and the other does not lose, for each pipeline of
// pairs, and lanes that differ from one lane.
TEST_CASE("module fluxes: beds keep their heat, spheres and bodies, in every precision") {
  const auto none = [](auto&) {};
  check_conserves(bed<silt::Sphere>(300, none), 1e-12);
  check_conserves(bed<silt::Sphere>(300, none, silt::Mixed{}), 1e-12);
  check_conserves(
      bed<silt::MultiSphere>(100,
                             [](auto& p) {
                               p.add_form({.balls = {{{-1e-3, 0, 0}, 1e-3}, {{1e-3, 0, 0}, 1e-3}}});
                             }),
      1e-12);
  check_conserves(
      bed<silt::SuperEllipsoid>(150,
                                [](auto& p) {
                                  p.add_form(silt::SuperEllipsoid{2e-3, 2e-3, 1e-3, 6, 2});
                                }),
      1e-12);

  const auto warmest = [](auto sim) {
    sim.time_step = 2e-5;
    sim.run(0.02);
    double sum = 0;
    for (std::size_t k = 0; k < sim.rows(); ++k)
      sum += std::pow(sim.template field<Conduction>(k).temperature - 400, 2);
    return sum;
  };
  const double lanes = warmest(bed<silt::Sphere>(300, none));
  CHECK(warmest(bed<silt::Sphere>(300, none, silt::KernelsFor<silt::OneLane>{})) ==
        near(lanes).epsilon(1e-7));
  CHECK(warmest(bed<silt::Sphere>(300, none, silt::Mixed{})) == near(lanes).epsilon(1e-3));
}

// Catches walls that give nothing, or too often, in any of the pipelines: planes at rest, others,
// those of bodies.
TEST_CASE("module fluxes: walls that heat") {
  const double R = 1e-3, d = 0.05e-3;
  const auto warmed = [d, R](auto p, const auto& wall) {
    silt::Simulation sim{
        std::move(p),
        silt::Contacts<silt::HertzMindlin>{{.youngs_modulus = 1e-3, .poisson_ratio = 0.3}},
        HeatedWalls{heat}};
    sim.add_wall(wall, {.youngs_modulus = 1e-3, .poisson_ratio = 0.3});
    sim.time_step = 1e-5;
    sim.run(1e-3);
    const double rate = 2 * 50 * std::sqrt(R * d) / (sim.mass(0) * 1000);
    const double got = sim.template field<HeatedWalls>(0).temperature;
    CHECK(400 - got == near(100 * std::pow(1 - rate * 1e-5, 100)).epsilon(1e-4));
    CHECK(got > 300.5);
  };
  const auto sphere = [R](double x) {
    silt::Particles<silt::Sphere> p;
    p.add({.position = {x, 0, R - 0.05e-3}, .radius = R, .density = 1000});
    return p;
  };
  silt::Particles<silt::SuperEllipsoid> ball;
  ball.add_form(silt::SuperEllipsoid{.a = R, .b = R, .c = R});
  ball.add({.position = {0, 0, R - d}, .radius = R, .density = 1000});
  warmed(sphere(0), silt::Plane{{0, 0, 0}, {0, 0, 1}});
  warmed(std::move(ball), silt::Plane{{0, 0, 0}, {0, 0, 1}});
  warmed(sphere(0), silt::TriangleMesh({{Vec3d{-1, -1, 0}, Vec3d{1, -1, 0}, Vec3d{0, 1, 0}}}));
}

// Catches sums that threads add in another order, and a checkpoint between a step's contacts and
// its update that loses what has flowed.
TEST_CASE("module fluxes: the same bits on any number of threads and from a checkpoint") {
  const auto make = [](int threads) {
    auto sim = bed<silt::Sphere>(350, [](auto&) {});
    sim.threads = threads;
    return sim;
  };
  auto one = make(1), three = make(3), half = make(2), again = make(1);
  one.run(0.06), three.run(0.06), half.run(0.03);
  const auto path = (std::filesystem::temp_directory_path() / "silt_module_fluxes").string();
  silt::save_checkpoint(half, path);
  silt::load_checkpoint(again, path);
  std::filesystem::remove(path);
  again.run(0.03), half.run(0.03);  // which ends a step later than one run of both spans may
  for (std::size_t k = 0; k < one.rows(); ++k) {
    const double of_one = one.field<Conduction>(k).temperature;
    CHECK(three.field<Conduction>(three.find(one.id(k))).temperature == of_one);
    const double of_half = half.field<Conduction>(half.find(one.id(k))).temperature;
    CHECK(again.field<Conduction>(again.find(one.id(k))).temperature == of_half);
  }
}
