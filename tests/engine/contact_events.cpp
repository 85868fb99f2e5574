// silt - BSD-3-Clause, see LICENSE
// Contacts from their begin to their end: against closed forms of impacts, and what all of them
// lose against the energy of all particles.
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <numbers>

#include <engine/support.hpp>

#include <silt/boundary/finite_walls.hpp>
#include <silt/contact/hertz_mindlin.hpp>
#include <silt/contact/linear_spring.hpp>
#include <silt/io/checkpoint.hpp>
#include <silt/io/contact_observers.hpp>
#include <silt/search/nbs.hpp>

#include "near.hpp"

namespace contact_events_test {

using namespace engine_test;
using silt::ContactEvent;
using silt::Vec3d;
using Events = std::vector<ContactEvent>;

/// Kinetic energy of all particles, rotation included [J]; of spheres.
template <class Sim>
double energy_of(const Sim& sim) {
  double sum = 0;
  for (std::size_t k = 0; k < sim.rows(); ++k) {
    if (!sim.is_present(k)) continue;
    const double m = sim.mass(k), r = sim.radius(k);
    sum += 0.5 * m * dot(sim.velocity(k), sim.velocity(k));
    if constexpr (Sim::rotates)
      sum += 0.2 * m * r * r * dot(sim.angular_velocity(k), sim.angular_velocity(k));
  }
  return sum;
}

template <class Sim>
Events ended(Sim& sim, double duration) {
  Events all;
  sim.run(duration, silt::on_contact_end([&](const ContactEvent& c) { all.push_back(c); }));
  return all;
}

/// Two spheres of 1 mm, 2500 kg/m3, on their way to each other at `speed`, `offset` [m] apart
/// across.
silt::Particles<Sphere> two(double speed, double offset = 0) {
  silt::Particles<Sphere> p;
  p.add({.position = {-1.2e-3, 0, 0},
         .radius = 1e-3,
         .density = 2500,
         .velocity = {speed / 2, 0, 0}});
  p.add({.position = {1.2e-3, offset, 0},
         .radius = 1e-3,
         .density = 2500,
         .velocity = {-speed / 2, 0, 0}});
  return p;
}
const double mass = 2500 * silt::sphere_volume(1e-3);

TEST_CASE("two spheres: Hertz's impact") {
  // Without losses: largest overlap d = (15 m* v^2/(16 E* sqrt(R*)))^(2/5), force 4/3 E* sqrt(R*)
  // d^(3/2), duration 2.9432 d/v (docs/contact_laws.md; K. L. Johnson, Contact Mechanics, 11.4).
  const double v = 0.8, E = 1e7 / (2 * (1 - 0.0625)), R = 0.5e-3, m = mass / 2;
  silt::Simulation sim{
      two(v),
      silt::Contacts<HertzMindlin>{
          {.youngs_modulus = 1e7, .poisson_ratio = 0.25, .restitution = 1, .friction = 0}},
      silt::ContactEvents{}};
  const double d = std::pow(15 * m * v * v / (16 * E * std::sqrt(R)), 0.4);
  sim.time_step = 2.9432 * d / v / 200;
  Events begun;
  Events all;
  sim.run(2e-3, silt::on_contact_begin([&](const ContactEvent& c) { begun.push_back(c); }),
          silt::on_contact_end([&](const ContactEvent& c) { all.push_back(c); }));
  REQUIRE(all.size() == 1);
  REQUIRE(begun.size() == 1);
  const ContactEvent& c = all[0];
  CHECK(c.a == 0);
  CHECK(c.b == 1);
  CHECK(c.wall == silt::no_wall);
  CHECK(c.normal_speed == near(v).epsilon(1e-12));
  CHECK(std::abs(c.tangential_speed) < 1e-12);
  CHECK(c.normal.x == near(-1).epsilon(1e-12));  // from 1 to 0
  // They touch between two steps; the force is seen at 200 points of its course.
  CHECK(c.begin == near(0.4e-3 / v).epsilon(*sim.time_step / (0.4e-3 / v)));
  CHECK(c.duration() == near(2.9432 * d / v).epsilon(1.5 / 200));
  CHECK(c.largest_force == near(4.0 / 3 * E * std::sqrt(R) * std::pow(d, 1.5)).epsilon(1e-3));
  // What the leapfrog's steps leave of the energy, second order in them: 0.4 % of the whole at 20.
  CHECK(std::abs(c.lost_energy) < 1e-4 * 0.5 * m * v * v);
  CHECK(norm(c.point) < 1e-5);  // midway, where they part
  CHECK(begun[0].begin == c.begin);
  CHECK(begun[0].normal_speed == c.normal_speed);
  CHECK(begun[0].largest_force == 0);
}

TEST_CASE("two spheres, oblique, with losses: the energy that they have no longer") {
  // The books are those of the leapfrog: what the forces took is the difference of the kinetic
  // energies, but for the lever arm, which is that of the step's end (1e-5 of it here).
  const auto lost = [](const auto&... more) {
    silt::Simulation sim{two(1.0, 1e-3), silt::Contacts<HertzMindlin>{rubber}, more...,
                         silt::ContactEvents{}};
    sim.time_step = 1e-6;  // in which the normal turns by 5e-4
    const double before = energy_of(sim);
    const Events all = ended(sim, 3e-3);
    REQUIRE(all.size() == 1);
    // The centres are 1 mm off: sin = 1/2 at touch.
    CHECK(all[0].normal_speed == near(std::sqrt(0.75)).epsilon(1e-3));
    CHECK(all[0].tangential_speed == near(0.5).epsilon(1e-3));
    CHECK(all[0].lost_energy == near(before - energy_of(sim)).epsilon(1e-4));
    return all[0].lost_energy;
  };
  const double in_double = lost();
  CHECK(in_double > 0.1 * 0.25 * mass);
  CHECK(lost(silt::Mixed{}) == near(in_double).epsilon(1e-5));
  CHECK(lost(silt::KernelsFor<silt::OneLane>{}) == near(in_double).epsilon(1e-12));
  CHECK(lost(silt::EnergyLedger{}) == in_double);
}

// A search that keeps no list finds overlapping particles only. A contact that has just ended
// overlaps no longer: its end, and the books of its last step, were lost.
TEST_CASE("searches without a list see the end of each contact, and book the same") {
  const HertzMindlin::Material soft{
      .youngs_modulus = 1e8, .poisson_ratio = 0.3, .restitution = 0.5};
  const auto impacts = [&](const auto& search) {
    auto pair = two(2);
    for (int k = 0; k < 3; ++k)  // at walls: at rest, rising, coming from aside
      pair.add({.position = {0, 0.01 * (k + 1), 1.5e-3},
                .radius = 1e-3,
                .density = 2500,
                .velocity = {0.1, 0, -1}});
    silt::Simulation sim{std::move(pair), silt::Contacts<HertzMindlin>{soft}, search,
                         silt::ContactEvents{}, silt::EnergyLedger{}};
    sim.threads = 1, sim.time_step = 2e-6;
    sim.add_wall(silt::rectangle({-5e-3, 5e-3, 0}, {1e-2, 0, 0}, {0, 1e-2, 0}), soft);
    sim.add_wall(silt::rectangle({-5e-3, 1.5e-2, 0}, {1e-2, 0, 0}, {0, 1e-2, 0}), soft,
                 silt::translation({0, 0, 0.5}));
    sim.add_wall(silt::rectangle({-5e-3, 2.85e-2, -5e-3}, {1e-2, 0, 0}, {0, 0, 1e-2}), soft,
                 silt::translation({0, 0.8, 0}));
    const Events all = ended(sim, 3e-3);
    return std::tuple(all, sim.energy());
  };
  const auto [all, books] = impacts(silt::VerletList<>{});
  CHECK(all.size() == 4);
  const auto same = [&](const auto& search) {
    const auto [others, e] = impacts(search);
    REQUIRE(others.size() == all.size());
    for (std::size_t k = 0; k < all.size(); ++k) {
      CHECK(others[k].lost_energy == near(all[k].lost_energy).epsilon(1e-9));
      CHECK(others[k].duration() == near(all[k].duration()).epsilon(1e-9));
    }
    CHECK(e.normal_damping == near(books.normal_damping).epsilon(1e-9));
    CHECK(e.residual() == near(books.residual()).epsilon(1e-6));
  };
  same(silt::Nbs{}), same(silt::HashedGrid{}), same(silt::VerletList<silt::Nbs>{});
}

TEST_CASE("walls: a linear spring's impact, whatever the surface, and what a moving wall brings") {
  // Half a period pi sqrt(m/k), largest force v sqrt(k m), nothing lost.
  const silt::LinearSpring::Material spring{.stiffness = 2000, .restitution = 1};
  const double v = 0.5, duration = std::numbers::pi * std::sqrt(mass / 2000);
  const auto hit = [&](silt::Surfaces surfaces, const Vec3d& at, const Vec3d& way,
                       silt::Motion motion = {}) {
    silt::Particles<Sphere> p;
    p.add({.position = at, .radius = 1e-3, .density = 2500, .velocity = way * v});
    silt::Simulation sim{std::move(p), silt::Contacts<silt::LinearSpring>{spring},
                         silt::ContactEvents{}};
    sim.add_wall(silt::Plane{{0, 0, -1}, {0, 0, 1}}, spring);  // far away: number 0
    sim.add_wall(std::move(surfaces), spring, std::move(motion));
    sim.time_step = duration / 400;
    const double before = energy_of(sim);
    const Events all = ended(sim, 4e-3);
    REQUIRE(all.size() == 1);
    CHECK(all[0].a == 0);
    CHECK(all[0].b == silt::no_particle);
    CHECK(all[0].wall == 1);
    CHECK(all[0].duration() == near(duration).epsilon(1.5 / 400));
    if (!sim.wall(1).moves())
      CHECK(std::abs(all[0].lost_energy - (before - energy_of(sim))) < 1e-8 * before);
    return all[0];
  };
  const auto check_at_rest = [&](const ContactEvent& c, const Vec3d& point, const Vec3d& normal) {
    CHECK(c.normal_speed == near(v).epsilon(1e-12));
    CHECK(c.largest_force == near(v * std::sqrt(2000 * mass)).epsilon(1e-4));
    CHECK(norm(c.point - point) < 2e-6);
    CHECK(norm(c.normal - normal) < 1e-9);
  };
  check_at_rest(hit(silt::Plane{{0, 0, 0}, {0, 0, 1}}, {1e-3, 2e-3, 1.5e-3}, {0, 0, -1}),
                {1e-3, 2e-3, 0}, {0, 0, 1});
  check_at_rest(hit(silt::Cylinder{{0, 0, -0.1}, {0, 0, 0.1}, 0.01, silt::Side::Inside},
                    {8.5e-3, 0, 0}, {1, 0, 0}),
                {0.01, 0, 0}, {-1, 0, 0});
  const Vec3d low{-0.01, -0.01, 0}, right{0.01, -0.01, 0}, up{-0.01, 0.01, 0}, far{0.01, 0.01, 0};
  const std::vector<std::array<Vec3d, 3>> plate{{low, right, up}, {right, far, up}};
  check_at_rest(hit(silt::TriangleMesh(plate), {1e-3, 2e-3, 1.5e-3}, {0, 0, -1}), {1e-3, 2e-3, 0},
                {0, 0, 1});

  // A plane that comes at u: the sphere leaves with v + 2 u.
  const double u = 0.25;
  const ContactEvent c = hit(silt::Plane{{0, 0, 0}, {0, 0, 1}}, {0, 0, 1.5e-3}, {0, 0, -1},
                             silt::translation({0, 0, u}));
  CHECK(c.normal_speed == near(v + u).epsilon(1e-9));
  CHECK(c.lost_energy == near(0).epsilon(1).scale(1e-4 * mass));  // of the wall's work: none
}

/// Spheres in a closed box without gravity that lose energy in contacts alone.
template <class... Policies>
auto cooling_gas(const Policies&... policies) {
  silt::Particles<Sphere> p;
  p.fill({{0, 0, 0}, {0.02, 0.02, 0.02}},
         {.radius = silt::uniform(0.8e-3, 1.2e-3), .density = 2500, .count = 60});
  for (std::size_t k = 0; k < p.size(); ++k) {
    const auto x = static_cast<double>(k);
    p[k].velocity = 0.4 * Vec3d{std::sin(3 * x), std::cos(5 * x), std::sin(7 * x + 1)};
  }
  silt::Simulation sim{std::move(p), silt::Contacts<HertzMindlin>{rubber}, policies...};
  sim.add_wall(silt::box({0, 0, 0}, {0.02, 0.02, 0.02}), rubber);
  return sim;
}

TEST_CASE("a cooling gas: all ends lose what all particles have no longer") {
  // The lever arm changes in a step: 3e-4 of what is lost at 20 steps a contact, less with shorter
  // ones.
  const auto run = [](double share_of_step) {
    auto sim = cooling_gas(silt::ContactEvents{});
    sim.run(0);
    sim.time_step = share_of_step * sim.step_length();
    const double before = energy_of(sim);
    double lost = 0;
    std::size_t begun = 0, over = 0;
    const auto begins = silt::on_contact_begin([&](const ContactEvent&) { ++begun; });
    const auto ends =
        silt::on_contact_end([&](const ContactEvent& c) { lost += c.lost_energy, ++over; });
    sim.run(0.06, begins, ends);
    for (int k = 0; k < 20000 && begun != over; ++k) sim.run(sim.step_length(), begins, ends);
    REQUIRE(begun == over);  // no contact lasts
    CHECK(over > 150);
    CHECK(lost > 0.3 * before);
    return std::abs(lost / (before - energy_of(sim)) - 1);
  };
  const double as_chosen = run(1), quarter = run(0.25);
  CHECK(as_chosen < 1e-3);
  CHECK(quarter < 0.5 * as_chosen);
}

TEST_CASE(
    "events are the same on any threads and from a checkpoint, contacts in progress included") {
  const auto watch = [](auto& sim, double duration, Events& all) {
    sim.run(duration, silt::on_contact_end([&](const ContactEvent& c) { all.push_back(c); }));
  };
  const auto same = [](const Events& one, const Events& two) {
    return std::equal(
        one.begin(), one.end(), two.begin(), two.end(), [](const auto& a, const auto& b) {
          return a.a == b.a && a.b == b.b && a.wall == b.wall && a.begin == b.begin &&
                 a.end == b.end && norm(a.point - b.point) == 0 &&
                 a.normal_speed == b.normal_speed && a.tangential_speed == b.tangential_speed &&
                 a.largest_force == b.largest_force && a.lost_energy == b.lost_energy;
        });
  };
  const auto path = (std::filesystem::temp_directory_path() / "silt_events.silt").string();
  Events one;
  auto sim = cooling_gas(silt::ContactEvents{});
  sim.threads = 1;
  watch(sim, 0.005, one);
  silt::save_checkpoint(sim, path);
  watch(sim, 0.005, one);
  auto again = cooling_gas(silt::ContactEvents{});
  again.threads = 2;
  Events two;
  watch(again, 0.005, two);
  const std::size_t until = two.size();
  watch(again, 0.005, two);
  CHECK(one.size() > 30);
  CHECK(same(one, two));
  CHECK(bits(sim) == bits(again));
  auto restarted = cooling_gas(silt::ContactEvents{});
  silt::load_checkpoint(restarted, path);
  std::filesystem::remove(path);
  Events rest;
  watch(restarted, 0.005, rest);
  CHECK(same(rest, Events(two.begin() + static_cast<std::ptrdiff_t>(until), two.end())));
  // Whoever watches, the particles go the same way.
  auto alone = cooling_gas();
  alone.run(0.005);
  alone.run(0.005);
  CHECK(bits(alone) == bits(sim));
}

TEST_CASE("a contact that lasts: a sphere that slides until it rolls loses 2/7 of its energy") {
  // Sliding at mu m g it takes 2 v/(7 mu g) = 5.8 ms until v = 5/7 v_0 and it rolls: 1/7 m v_0^2
  // are lost (L. Euler). A contact at rest is evaluated in every 8th step only:
  // catches steps that count twice, or not.
  const double v = 0.1, stiffness = 2000;
  silt::Particles<Sphere> p;
  p.add({.position = {0, 0, 1e-3 - mass * 9.81 / stiffness},
         .radius = 1e-3,
         .density = 2500,
         .velocity = {v, 0, 0}});
  const silt::LinearSpringFriction::Material rough{
      .stiffness = stiffness, .restitution = 0.5, .friction = 0.5};
  silt::Simulation sim{std::move(p), silt::Contacts<silt::LinearSpringFriction>{rough},
                       silt::ContactEvents{}};
  sim.gravity = {0, 0, -9.81};
  sim.time_step = 1e-6;
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, rough);
  Events all = ended(sim, 8e-3);
  CHECK(all.empty());
  CHECK(sim.velocity(0).x == near(5.0 / 7 * v).epsilon(1e-3));
  sim.gravity = {0, 0, 9.81};
  all = ended(sim, 1e-3);
  REQUIRE(all.size() == 1);
  CHECK(all[0].duration() > 8e-3);
  CHECK(all[0].tangential_speed == near(v).epsilon(1e-9));
  // The spring that was there at the start gives back 2e-4 of it.
  CHECK(all[0].lost_energy == near(mass * v * v / 7).epsilon(1e-3));
  CHECK(all[0].largest_force == near(mass * 9.81 * std::sqrt(1.25)).epsilon(0.01));
}

// Catches contacts that count as at rest by their age alone: 8.6 % too much energy and 5 % too
// little force of a hit after 2000 steps, at the step that silt chooses.
TEST_CASE("a contact that has been at rest for long and is hit: as if it were young") {
  const HertzMindlin::Material soft{
      .youngs_modulus = 1e8, .poisson_ratio = 0.3, .restitution = 0.5, .friction = 0.3};
  const double R = 5e-3;
  const auto hit = [&](int rested, double step) {
    silt::Particles<Sphere> p, ball;
    p.add({.position = {0, 0, R}, .radius = R, .density = 2500});
    ball.add({.position = {0, 0, 3.02 * R}, .radius = R, .density = 7500, .velocity = {0, 0, -1}});
    silt::Simulation sim{std::move(p), silt::Contacts<HertzMindlin>{soft}, silt::EnergyLedger{},
                         silt::ContactEvents{}};
    sim.threads = 1, sim.gravity = {0, 0, -9.81}, sim.time_step = step;
    sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, soft, {.name = "floor"});
    double lost = 0, largest = 0, told = 0;  // [J], [N]
    auto ends = silt::on_contact_end([&](const ContactEvent& c) {
      lost += c.lost_energy, told = std::max(told, c.b == silt::no_particle ? c.largest_force : 0);
    });
    sim.run(rested * step, ends);
    sim.add(ball);
    sim.run(0.02, ends,
            [&](const auto& s) { largest = std::max(largest, -s.wall("floor").force.z); });
    for (std::size_t k = 0; k < sim.rows(); ++k)  // ends all contacts
      sim.set_velocity(sim.id(k), {0, 0, 1.0 + 3.0 * static_cast<double>(sim.id(k))});
    sim.run(3e-3, ends);
    const auto e = sim.energy();
    CHECK(near_relative(told, largest, 1e-12));
    return lost / (e.normal_damping + e.tangential_damping + e.friction);
  };
  // Of second order in the step: 1.6e-3 and 1e-4 for young contacts, too.
  for (const int rested : {50, 2600}) CHECK(std::abs(hit(rested, 2e-5) - 1) < 2e-3);
  for (const int rested : {50, 2600}) CHECK(std::abs(hit(rested, 5e-6) - 1) < 2e-4);
}

TEST_CASE("a particle that leaves takes its contacts with it; a mesh is one wall") {
  silt::Particles<Sphere> p;
  p.add({.position = {0, 0, 0.99e-3}, .radius = 1e-3, .density = 2500, .velocity = {1, 0, 0}});
  silt::Simulation sim{std::move(p), silt::Contacts<HertzMindlin>{rubber}, silt::ContactEvents{}};
  sim.gravity = {0, 0, -9.81};
  std::vector<std::array<Vec3d, 3>> strip;
  for (int k = 0; k < 10; ++k) {
    const double x = -2e-3 + 2e-3 * k, w = 5e-3, next = x + 2e-3;
    strip.push_back({Vec3d{x, -w, 0}, Vec3d{next, -w, 0}, Vec3d{x, w, 0}});
    strip.push_back({Vec3d{next, -w, 0}, Vec3d{next, w, 0}, Vec3d{x, w, 0}});
  }
  sim.add_wall(silt::TriangleMesh(strip), rubber);
  sim.add_outlet({{0.01, -1, -1}, {1, 1, 1}});
  std::size_t begun = 0, over = 0;
  sim.run(0.03, silt::on_contact_begin([&](const ContactEvent&) { ++begun; }),
          silt::on_contact_end([&](const ContactEvent&) { ++over; }));
  CHECK(sim.size() == 0);
  CHECK(begun >= 1);
  CHECK(begun <= over + 1);  // it hops at most; edges between facets begin nothing
  CHECK(begun < 6);
}

}  // namespace contact_events_test
