// silt - BSD-3-Clause, see LICENSE
// Modules that act between pairs within a reach: against brute force at every step, in periodic and
// shearing boxes, through births, removals and sorting, for spheres and bodies; the same bits on
// any number of threads and from a checkpoint; what one gets the other loses; refusals.
#include <array>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <doctest/doctest.h>

#include <silt/boundary/deforming_box.hpp>
#include <silt/contact/hertz_mindlin.hpp>
#include <silt/core/random.hpp>
#include <silt/io/checkpoint.hpp>
#include <silt/io/observers.hpp>
#include <silt/shape/multi_sphere.hpp>
#include <silt/simulation.hpp>

#include "near.hpp"
#include "refusal.hpp"

namespace near_pairs_test {

using silt_test::refusal;

using silt::Seen;
using silt::Vec3d;

const double R = 1e-3, far = 5e-3, gap = 1.5e-3;  // [m]
const silt::HertzMindlin::Material near_rubber{
    .youngs_modulus = 1e5, .poisson_ratio = 0.3, .restitution = 0.9, .friction = 0.3};

/// Repels the more the larger both particles' own numbers are, to 0 at its reach between centres;
/// not along the line of centres alone.
struct Repulsion {
  double length = far;
  struct Fields {
    double strength = 1;
  };
  static constexpr std::array names{"strength"};
  Fields start(const Seen& p) const { return {1 + 0.1 * static_cast<double>(p.id % 7)}; }
  double reach() const { return length; }
  Vec3d pair_force(const silt::Apart& d, const Seen&, const Fields& a, const Seen&,
                   const Fields& b) const {
    const Vec3d aside = silt::cross(d.from_other, Vec3d{0, 0, 1});
    return 1e-4 * a.strength * b.strength * (1 - d.distance / length) *
           ((1 / d.distance) * d.from_other + 0.1 * (1 / length) * aside);
  }
};
/// Flows between what is near by its surfaces; no contacts have a part in it.
struct Scent {
  struct Fields {
    double scent = 0, got = 0;
  };
  static constexpr std::array names{"scent", "got"};
  Fields start(const Seen& p) const { return {static_cast<double>(p.id % 5), 0}; }
  double gap_reach() const { return gap; }
  double pair_flux(const silt::Apart& d, const Seen& a, const Fields& of_a, const Seen& b,
                   const Fields& of_b) const {
    return 1e3 * (1 - (d.distance - a.radius - b.radius) / gap) * (of_b.scent - of_a.scent);
  }
  void update(const Seen&, Fields& f, double received, double dt) const {
    f.scent += received * dt, f.got = received;
  }
};

inline silt::Particles<silt::Sphere> gas(std::size_t count, double edge) {
  silt::Particles<silt::Sphere> p;
  p.fill({{0, 0, 0}, {edge, edge, edge}},
         {.radius = silt::uniform(0.6 * R, R), .density = 1000, .count = count});
  return p;
}
template <class Sim>
void stir(Sim& sim, double speed) {
  silt::Random random(7);
  const auto any = [&] { return speed * random.uniform(-1, 1); };
  for (silt::ParticleId id = 0; id < sim.size(); ++id) sim.set_velocity(id, {any(), any(), any()});
}
/// Compares what each particle has been given with the sum over all others; returns pairs in reach.
template <class Sim>
std::size_t check_forces(const Sim& sim) {
  const auto& module = sim.template module<Repulsion>();
  std::size_t near_by = 0;
  double worst = 0, largest = 0;
  for (std::size_t k = 0; k < sim.rows(); ++k) {
    if (!sim.is_present(k)) continue;
    Vec3d sum{0, 0, 0};
    for (std::size_t j = 0; j < sim.rows(); ++j) {
      if (j == k || !sim.is_present(j)) continue;
      Vec3d d = sim.position(k) - sim.position(j);
      if constexpr (Sim::Domain::periodic) d = sim.domain().shortest(d);
      if (!(silt::norm(d) < far)) continue;
      ++near_by;
      sum += module.pair_force({d, silt::norm(d)}, {}, sim.template field<Repulsion>(k), {},
                               sim.template field<Repulsion>(j));
    }
    worst = std::max(worst, silt::norm(sum - sim.module_force(k)));
    largest = std::max(largest, silt::norm(sum));
  }
  // Sums in another order: rounding. A pair too many or too few at the rim of the reach, where the
  // force goes to 0, is seen only if lists err by more than a hair; inside it is 1e-4 and more.
  CHECK(worst <= 1e-13 * largest);
  return near_by / 2;
}
template <class Sim>
double scent_of(const Sim& sim) {
  double sum = 0;
  for (std::size_t k = 0; k < sim.rows(); ++k)
    if (sim.is_present(k)) sum += sim.template field<Scent>(k).scent;
  return sum;
}
/// Two simulations have the same bits.
template <class A, class B>
void check_same(const A& a, const B& b) {
  REQUIRE(a.rows() == b.rows());
  std::size_t same = 0;
  for (std::size_t k = 0; k < a.rows(); ++k)
    same += a.id(k) == b.id(k) && a.position(k) == b.position(k) &&
            a.velocity(k) == b.velocity(k) &&
            a.template field<Scent>(k).scent == b.template field<Scent>(k).scent;
  CHECK(same == a.rows());
}

inline auto in_box(double edge = 0.02) {
  silt::Simulation sim{gas(300, edge), silt::Contacts<silt::HertzMindlin>{near_rubber},
                       silt::PeriodicBox{{{0, 0, 0}, {edge, edge, edge}}, {true, true, true}},
                       Repulsion{}, Scent{}};
  sim.time_step = 2e-5, sim.guard.max_overlap = 1;
  stir(sim, 0.5);
  return sim;
}
/// With a floor, an inlet above and an outlet at one side.
inline auto with_openings() {
  silt::Simulation sim{gas(60, 0.014), silt::Contacts<silt::HertzMindlin>{near_rubber}, Repulsion{},
                       Scent{}};
  stir(sim, 0.3);
  sim.gravity = {1, 0, -9.81};
  sim.time_step = 2e-5, sim.guard.max_overlap = 1;
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, near_rubber);
  sim.add_outlet({{0.016, -1, -1}, {0.1, 1, 1}});
  sim.add_inlet(silt::Box{{0, 0, 0.016}, {0.014, 0.014, 0.02}},
                {.radius = R, .density = 1000, .rate = 2000, .velocity = {0, 0, -0.5}});
  return sim;
}

}  // namespace near_pairs_test

using namespace near_pairs_test;

// Catches pairs through faces that are missed or found twice, lists that are renewed too late or do
// not follow the sorting of places, forces that are not opposite, a flux that one end alone gets.
TEST_CASE("near_pairs: forces in a periodic box are those of brute force at every step") {
  auto sim = in_box();
  std::size_t pairs = 0, steps = 0;
  const double before = scent_of(sim);
  std::vector<Vec3d> start(300);
  for (std::size_t k = 0; k < 300; ++k) start[sim.id(k)] = sim.position(k);
  sim.run(0.01, [&](const auto& s) { pairs += check_forces(s), ++steps; });
  CHECK(steps == 501);
  CHECK(pairs > 500 * 2000);
  // They have gone as far as several skins.
  double way = 0;
  for (std::size_t k = 0; k < 300; ++k)
    way = std::max(way, silt::norm(sim.domain().shortest(sim.position(k) - start[sim.id(k)])));
  CHECK(way > 4 * 0.1 * far);
  // To rounding of 500 steps, though scents have evened out by much.
  CHECK(scent_of(sim) == near(before).epsilon(1e-12));
  double spread = 0;
  for (std::size_t k = 0; k < 300; ++k) spread += std::abs(sim.field<Scent>(k).scent - 2);
  CHECK(spread / 300 < 0.6);  // 1.2 at the start
}

TEST_CASE("near_pairs: the flux is that of brute force, by gaps between surfaces") {
  auto sim = in_box();
  sim.run(0.002);
  std::vector<double> sums(sim.rows(), 0.0);
  for (std::size_t k = 0; k < sim.rows(); ++k)
    for (std::size_t j = 0; j < sim.rows(); ++j) {
      const double d = silt::norm(sim.domain().shortest(sim.position(k) - sim.position(j)));
      if (j == k || d >= sim.radius(k) + sim.radius(j) + gap) continue;
      Seen a{}, b{};
      a.radius = sim.radius(k), b.radius = sim.radius(j);
      sums[sim.id(k)] += Scent{}.pair_flux({{}, d}, a, sim.field<Scent>(k), b, sim.field<Scent>(j));
    }
  sim.run(2e-5);  // `got` is of the step that began above
  double worst = 0, largest = 0;
  for (std::size_t k = 0; k < sim.rows(); ++k)
    worst = std::max(worst, std::abs(sim.field<Scent>(k).got - sums[sim.id(k)])),
    largest = std::max(largest, std::abs(sums[sim.id(k)]));
  CHECK(largest > 100);
  CHECK(worst < 1e-12 * largest);
}

// Catches places that hold another particle than the list thinks, and newcomers without neighbours.
TEST_CASE("near_pairs: births, outlets and removals are followed at once") {
  auto sim = with_openings();
  std::size_t steps = 0, pairs = 0;
  for (int part = 0; part < 4; ++part) {
    sim.run(0.01, [&](const auto& s) { pairs += check_forces(s), ++steps; });
    std::size_t k = 3;
    while (!sim.is_present(k)) ++k;
    sim.remove(sim.id(k));
  }
  CHECK(steps > 2000);
  CHECK(pairs > 100 * 1000);
  CHECK(sim.inlet(0).placed > 50);
  CHECK(sim.outlet(0).count > 10);
}

TEST_CASE("near_pairs: the same bits on two threads and from a checkpoint") {
  auto one = with_openings(), two = with_openings();
  one.threads = 1, two.threads = 2;
  one.run(0.02), two.run(0.01);
  const auto file = (std::filesystem::temp_directory_path() / "silt_near_pairs.silt").string();
  silt::save_checkpoint(two, file);
  auto again = with_openings();
  silt::load_checkpoint(again, file);
  std::filesystem::remove(file);
  again.threads = 2;
  two.run(0.01), again.run(0.01);
  check_same(one, two);
  check_same(two, again);
}

// Catches images that move with the shear.
TEST_CASE("near_pairs: forces in a shearing box are those of brute force") {
  silt::Simulation sim{gas(150, 0.02), silt::Contacts<silt::HertzMindlin>{near_rubber},
                       silt::DeformingBox{{{0, 0, 0}, {0.02, 0.02, 0.02}}}, Repulsion{}, Scent{}};
  sim.time_step = 2e-5, sim.guard.max_overlap = 1;
  stir(sim, 0.3);
  sim.deform({.xz = {.rate = 50}});
  std::size_t pairs = 0;
  sim.run(0.01, [&](const auto& s) { pairs += check_forces(s); });
  CHECK(pairs > 500 * 500);
}

// Catches bodies that act by their parts, or by the places of these.
TEST_CASE("near_pairs: bodies act as a whole, at their centres of mass") {
  silt::Particles<silt::MultiSphere> p;
  p.add_form({.balls = {{{-0.4 * R, 0, 0}, 0.8 * R}, {{0.4 * R, 0, 0}, 0.8 * R}}});
  p.fill({{0, 0, 0}, {0.02, 0.02, 0.02}}, {.radius = R, .density = 1000, .count = 150});
  silt::Simulation sim{std::move(p), silt::Contacts<silt::HertzMindlin>{near_rubber},
                       silt::PeriodicBox{{{0, 0, 0}, {0.02, 0.02, 0.02}}, {true, true, false}},
                       Repulsion{}, Scent{}};
  sim.time_step = 2e-5, sim.guard.max_overlap = 1;
  stir(sim, 0.3);
  std::size_t pairs = 0;
  const double before = scent_of(sim);
  sim.run(0.01, [&](const auto& s) { pairs += check_forces(s); });
  CHECK(pairs > 500 * 500);
  CHECK(scent_of(sim) == near(before).epsilon(1e-12));
}

/// A spring between two, of a module without Fields.
struct PairSpring {
  double stiffness, length;  // [N/m], [m]
  double reach() const { return 2 * length; }
  Vec3d pair_force(const silt::Apart& d, const Seen&, const Seen&) const {
    return (stiffness * (length - d.distance) / d.distance) * d.from_other;
  }
  double pair_stiffness(const silt::Apart&, const Seen&, const Seen&) const { return stiffness; }
};

// Catches a pair_stiffness() without fields that is not asked: the step is then that of contacts.
TEST_CASE("near_pairs: a module without fields; its stiffness chooses the step, 40 a swing") {
  const double K = 100, length = 3e-3, speed = 0.1;  // [N/m], [m], [m/s]
  silt::Particles<silt::Sphere> p;
  for (const double side : {-1.0, 1.0})
    p.add({.position = {0.5 * side * length, 0, 0},
           .radius = R,
           .density = 1000,
           .velocity = {side * speed, 0, 0}});
  silt::Simulation sim{std::move(p), silt::Contacts<silt::HertzMindlin>{near_rubber},
                       PairSpring{K, length}};
  sim.threads = 1;
  const double w = std::sqrt(2 * K / (1000 * silt::Sphere::volume(R)));  // [1/s]
  sim.run(2 * std::numbers::pi / w);
  CHECK(sim.step() == 40);
  CHECK(sim.step_length() == near(std::numbers::pi / (20 * w)).epsilon(1e-12));
  // Leapfrog is ahead by (w dt)^2/24 of the phase 2 pi: 6.5e-3.
  const double apart = silt::norm(sim.position(1) - sim.position(0)) - length;
  CHECK(std::abs(apart) < 7e-3 * 2 * speed / w);
  CHECK(sim.velocity(1).x == near(speed).epsilon(1e-3));
}

TEST_CASE("near_pairs: refusals") {
  auto sim = in_box();
  sim.module<Repulsion>().length = 0;
  CHECK(refusal([&] { sim.run(1e-3); }).find("Repulsion::reach() = 0 [m] must be") !=
        std::string::npos);
  auto short_box = in_box();
  short_box.module<Repulsion>().length = 0.0101;
  CHECK(refusal([&] {
          short_box.run(1e-3);
        }).find("must be at least 0.0202 m, twice the reach of the module Repulsion") !=
        std::string::npos);
}
