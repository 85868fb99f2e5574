// silt - BSD-3-Clause, see LICENSE
#include <algorithm>
#include <cmath>
#include <numbers>
#include <type_traits>
#include <vector>

#include <silt/boundary/cylinder.hpp>
#include <silt/boundary/triangle_mesh.hpp>
#include <silt/contact/cohesion/area_cohesion.hpp>
#include <silt/contact/cohesion/capillary_bridge.hpp>
#include <silt/contact/cohesion/dmt.hpp>
#include <silt/contact/cohesion/van_der_waals.hpp>
#include <silt/contact/cohesion/viscous_bridge.hpp>
#include <silt/contact/hertz_mindlin.hpp>
#include <silt/contact/jkr.hpp>
#include <silt/contact/linear_spring.hpp>
#include <silt/contact/rolling/epsd.hpp>

#include "boundary/support.hpp"
#include "physics/support.hpp"

namespace cohesion_test {

// Laws that act at a distance, through the whole engine: lists, pairs, all kinds of walls (B9,
// V10).

namespace {

using namespace silt;
using namespace physics_test;

constexpr double radius = 1e-3, density = 2500;  // [m], [kg/m3]
const HertzMindlin::Material elastic{1e8, 0.25, 1, 0.4};
using Dusty = Cohesive<HertzMindlin, VanDerWaals>;
using Wet = Cohesive<HertzMindlin, CapillaryBridge>;
/// Of a scale that a step of some 0.1 us sees well.
const Dusty::Material dust{elastic, {.hamaker = 1e-13, .closest = 2e-6, .cutoff = 1e-4}};
const Wet::Material wet{elastic, {.surface_tension = 0.072, .contact_angle = 0.3, .volume = 1e-12}};
/// Folded by a box that repeats, the two spheres of padding were in one place, without a radius.
template <class Material, class Law>
void check_books_in_a_box(const Material& material, const Law&, double length) {
  Particles<Sphere> three;
  for (int n = 0; n < 3; ++n)
    three.add({.position = {1e-2 + 2.2e-3 * n, 1e-2, 1e-2},
               .radius = radius,
               .density = density,
               .velocity = {n == 0 ? 0.1 : 0.0, 0, 0}});
  Simulation sim{std::move(three), Contacts<Law>{material}, EnergyLedger{},
                 PeriodicBox{{{0, 0, 0}, {length, length, length}}, {true, true, true}}};
  sim.threads = 1, sim.time_step = 2e-7;
  sim.run(1e-6);
  CHECK(sim.energy().initial == near(0.5 * density * sphere_volume(radius) * 0.01).epsilon(1e-12));
  CHECK(std::abs(sim.energy().residual()) < 1e-12 * sim.energy().initial);
}
/// The dusty ones are in a box of one type throughout; here it repeats far away.
const PeriodicBox room{{{-2, -2, -2}, {2, 2, 2}}, {false, true, false}};
const Jkr::Material sticky{1e7, 0.25, 1, 1, 0.4};  // w = 1 J/m2, softened

Particles<Sphere>::Particle sphere(const Vec3d& position, const Vec3d& velocity = {0, 0, 0},
                                   bool fixed = false) {
  Particles<Sphere>::Particle p{
      .position = position, .radius = radius, .density = density, .velocity = velocity};
  p.fixed = fixed;
  return p;
}

/// One sphere and what it is near to.
template <class Law, class... Policies>
auto scene(const typename Law::Material& m,
           std::initializer_list<Particles<Sphere>::Particle> spheres, Policies... policies) {
  Particles<Sphere> p;
  for (const auto& s : spheres) p.add(s);
  Simulation sim{std::move(p), Contacts<Law>{m}, policies...};
  sim.threads = 1;
  return sim;
}

TriangleMesh slab() { return TriangleMesh(boundary_test::box_soup({-1, -1, -1}, {1, 1, 0})); }

/// The speed of a sphere that comes to z = 0 at `speed` from beyond the range, after it has left.
template <class Law, class... Policies>
double speed_after(const typename Law::Material& m, double speed, const Surfaces& surfaces,
                   double time_step, Policies... policies) {
  auto sim = scene<Law>(m, {sphere({0, 0, 1.5 * radius}, {0, 0, -speed})}, policies...);
  sim.add_wall(surfaces, m);
  sim.time_step = time_step;
  sim.run(1.3 * radius / speed);
  return sim.velocity(0).z;
}

/// Integral of an attraction over the gaps from 0 to `range` [J].
template <class Law>
double work(const typename Law::Material& m, double R_eff, double range) {
  const auto p = Law::mix(m, m, Law::like(m));
  double sum = 0;
  const int n = 20000;
  Contact<double> c{};
  c.R_eff = R_eff, c.m_eff = c.inverse_m_eff = 1;
  for (int k = 0; k < n; ++k) {
    c.overlap = -range * (k + 0.5) / n;
    typename Law::template History<double> h{};
    if constexpr (requires { h.attached; }) h.attached = 1;
    sum -= Law::force(c, p, h).normal * range / n;
  }
  return sum;
}

}  // namespace

TEST_CASE("cohesion: at a gap the force is the law's, at planes, meshes, cylinders and spheres") {
  const auto p = Dusty::mix(dust, dust, Dusty::like(dust));
  const double mass = mass_of(radius, density), dt = 1e-8;
  for (const double share : {0.02, 0.3, 0.97, 1.02}) {
    const double gap = share * dust.cohesion.cutoff;
    const auto expected = [&](double R_eff) {
      Contact<double> c{};
      c.overlap = -gap, c.R_eff = R_eff;
      return share < 1 ? VanDerWaals::attraction(c, p.cohesion) : 0.0;
    };
    const auto pulled = [&](auto sim, const Vec3d& towards, double R_eff, bool at_wall) {
      sim.time_step = dt;
      sim.run(4 * dt);
      const Vec3d v = velocity_of(sim, 0);
      const double force = dot(v, towards) * mass / (4 * dt);
      CAPTURE(share);
      CAPTURE(R_eff);
      // It moves by 1e-16 m, and the lists have double positions: rounding.
      CHECK(std::abs(force - expected(R_eff)) <= 1e-6 * expected(R_eff));
      CHECK(norm(v - dot(v, towards) * towards) <= 1e-9 * std::abs(dot(v, towards)));
      if (at_wall)
        CHECK(std::abs(dot(sim.wall(0).force, towards) + expected(R_eff)) <=
              1e-6 * expected(R_eff));
    };
    const Vec3d down{0, 0, -1};
    const auto near_wall = [&](const Surfaces& surfaces, Motion motion = {}) {
      auto sim = scene<Dusty>(dust, {sphere({0, 0, radius + gap})}, room);
      sim.add_wall(surfaces, dust, std::move(motion));
      return sim;
    };
    pulled(near_wall(Plane{{0, 0, 0}, {0, 0, 1}}), down, radius, true);
    pulled(near_wall(slab()), down, radius, true);
    pulled(near_wall(Cylinder{{0, -1, -1}, {0, 1, -1}, 1, Side::Outside}), down, radius, true);
    pulled(near_wall(Plane{{0, 0, 0}, {0, 0, 1}}, translation({0, 0, 0})), down, radius, true);
    pulled(
        scene<Dusty>(dust, {sphere({0, 0, radius + gap}), sphere({0, 0, -radius}, {}, true)}, room),
        down, radius / 2, false);
    // Through the faces of a repeating box.
    pulled(
        scene<Dusty>(dust, {sphere({0, 0, 9 * radius - gap / 2}), sphere({0, 0, radius}, {}, true)},
                     PeriodicBox{{{-0.1, -0.1, 0}, {0.1, 0.1, 10 * radius + gap / 2}},
                                 {false, false, true}}),
        {0, 0, 1}, radius / 2, false);
  }
}

TEST_CASE("cohesion: van der Waals conserves energy: a bounce, and a fall out of the range") {
  auto strong = dust;
  strong.cohesion.hamaker = 1e-10;
  for (const Surfaces& surfaces : {Surfaces{Plane{{0, 0, 0}, {0, 0, 1}}}, Surfaces{slab()}})
    for (const double speed : {0.05, 0.5})  // [m/s] 13 and 1300 nJ; the well is 8 nJ deep
      CHECK(near_relative(speed_after<Dusty>(strong, speed, surfaces, 1e-7, room), speed, 5e-4));
  // Two free spheres at rest, a tenth of the range apart: at touch they have the work between.
  auto sim = scene<Dusty>(strong, {sphere({0, 0, 0}), sphere({0, 0, 2 * radius + 1e-5})}, room);
  sim.time_step = 1e-7;
  double fastest = 0;
  for (int k = 0; k < 40000; ++k) {
    sim.run(1e-7);
    const double gap = position_of(sim, 1).z - position_of(sim, 0).z - 2 * radius;
    if (gap < 0) break;
    fastest = velocity_of(sim, 0).z - velocity_of(sim, 1).z;
  }
  const double energy = work<Dusty>(strong, radius / 2, 1e-5);
  const double m_eff = mass_of(radius, density) / 2;
  CHECK(near_relative(0.5 * m_eff * fastest * fastest, energy, 0.01));  // the last step is a cut
}

TEST_CASE("cohesion: a bounce with a bridge costs the work of tearing it, once") {
  const double rupture = CapillaryBridge::range(CapillaryBridge::mix(wet.cohesion), 1.0);
  const double mass = mass_of(radius, density), cost = work<Wet>(wet, radius, rupture);
  const double least = std::sqrt(2 * cost / mass);
  for (const Surfaces& surfaces : {Surfaces{Plane{{0, 0, 0}, {0, 0, 1}}}, Surfaces{slab()}}) {
    for (const double share : {1.05, 1.5, 3.0}) {
      const double v = share * least;
      CAPTURE(share);
      CHECK(near_relative(speed_after<Wet>(wet, v, surfaces, 2e-7),
                          std::sqrt(v * v - least * least), 0.01 / (share * share - 1)));
    }
    // Slower, it does not get away.
    CHECK(std::abs(speed_after<Wet>(wet, 0.9 * least, surfaces, 2e-7)) < 0.9 * least);
  }
  auto stuck = scene<Wet>(wet, {sphere({0, 0, 1.05 * radius}, {0, 0, -0.9 * least})});
  stuck.add_wall(Plane{{0, 0, 0}, {0, 0, 1}}, wet);
  stuck.time_step = 2e-7;
  for (int k = 0; k < 20; ++k) {
    stuck.run(1e-3);
    CHECK(stuck.position(0).z < radius + rupture);
  }
  // Two spheres: R* and m* are half of the above, so the speed is the same.
  auto pair = scene<Wet>(
      wet, {sphere({0, 0, 0}, {0, 0, 0}), sphere({0, 0, 2.2 * radius}, {0, 0, -2 * least})});
  pair.time_step = 2e-7;
  pair.run(0.6 * radius / least);
  const double away = velocity_of(pair, 1).z - velocity_of(pair, 0).z;
  const double tear = work<Wet>(wet, radius / 2, rupture) / (mass / 2);
  CHECK(near_relative(away, std::sqrt(4 * least * least - 2 * tear), 0.01));
}

TEST_CASE(
    "cohesion: a viscous bridge takes the speed of its closed form, or keeps what is slower") {
  using Syrup = Cohesive<HertzMindlin, ViscousBridge>;
  const double h = 1e-6;  // [m]
  const Syrup::Material syrup{
      elastic, {.contact_angle = 0.3, .volume = 1e-12, .viscosity = 0.01, .roughness = h}};
  const double rupture = ViscousBridge::range(ViscousBridge::mix(syrup.cohesion), radius);
  const double lost = 6 * std::numbers::pi * 0.01 * radius * radius / mass_of(radius, density) *
                      (1 + std::log(rupture / h));  // [m/s]
  for (const double share : {0.5, 1.2, 2.0, 5.0}) {
    CAPTURE(share);
    // It touches, so that the bridge is there, with next to no energy in the spring.
    auto sim =
        scene<Syrup>(syrup, {sphere({0, 0, radius - 1e-9}, {0, 0, share * lost})}, EnergyLedger{});
    sim.add_wall(Plane{{0, 0, 0}, {0, 0, 1}}, syrup);
    sim.time_step = 5e-8;
    sim.run(share > 1 ? 4 * rupture / (lost * (share - 1)) : 2e-3);
    const double v = velocity_of(sim, 0).z;
    if (share > 1)
      CHECK(near_relative(v, (share - 1) * lost, 0.01 / (share - 1)));  // of the cut gap, O(dt)
    else
      CHECK((v < 1e-3 * lost && sim.position(0).z < radius + rupture));
    CHECK(std::abs(sim.energy().residual()) < 1e-6 * sim.energy().initial);
  }
}

TEST_CASE("cohesion: JKR spheres stick below the closed form's speed and lose that energy above") {
  const auto p = Jkr::mix(sticky, sticky, Jkr::like(sticky));
  const double mass = mass_of(radius, density);
  const AdhesivePair wall{p.twice_modulus / 2, radius, 1};
  const double slowest = jkr_sticking_speed(wall, mass);
  for (const Surfaces& surfaces : {Surfaces{Plane{{0, 0, 0}, {0, 0, 1}}}, Surfaces{slab()}})
    for (const double share : {1.05, 1.3, 3.0}) {
      const double v = share * slowest;
      CAPTURE(share);
      // The force jumps at touch, which a step sees late by half of it: 1e-3 of the energy.
      CHECK(near_relative(speed_after<Jkr>(sticky, v, surfaces, 2e-7),
                          v * std::sqrt(1 - 1 / (share * share)), 5e-3 / (share * share - 1)));
    }
  auto stuck = scene<Jkr>(sticky, {sphere({0, 0, 1.001 * radius}, {0, 0, -0.95 * slowest})});
  stuck.add_wall(Plane{{0, 0, 0}, {0, 0, 1}}, sticky);
  stuck.time_step = 2e-7;
  stuck.run(1e-6 + 0.001 * radius / slowest);
  for (int k = 0; k < 20; ++k) {
    stuck.run(3e-4);
    CHECK(stuck.position(0).z < radius - jkr_overlap_at_parting(wall));
  }
}

TEST_CASE("cohesion: what hangs from a ceiling falls when it weighs more than the pull-off force") {
  const auto p = Jkr::mix(sticky, sticky, Jkr::like(sticky));
  const AdhesivePair ceiling{p.twice_modulus / 2, radius, 1};
  auto damped = sticky;
  damped.restitution = 0.3;
  const Cohesive<HertzMindlin, Dmt>::Material dmt{{1e7, 0.25, 0.3, 0.4}, {1}};
  const double mass = mass_of(radius, density);
  // As jkr, 1 % of the radius deep at rest: k = 0.2/(3 pi) E*.
  const double E = p.twice_modulus / 2, k = 0.2 / (3 * std::numbers::pi) * E;
  const Cohesive<HertzMindlin, AreaCohesion>::Material area{dmt.body, {k}};
  const double area_pull_off =
      2.0 / 3 * std::pow(std::numbers::pi * k, 3) * std::pow(radius / E, 2);
  for (const double share : {0.97, 1.03}) {
    const auto hangs = [&]<class Law>(Law, const typename Law::Material& m, double pull_off) {
      const double rest = std::is_same_v<Law, Cohesive<HertzMindlin, AreaCohesion>>
                              ? 0.01 * radius
                              : jkr_overlap_at_rest(ceiling);
      auto sim = scene<Law>(m, {sphere({0, 0, -radius + rest})});
      sim.add_wall(Plane{{0, 0, 0}, {0, 0, -1}}, m);
      sim.time_step = 1e-6;
      for (int k = 1; k <= 100; ++k) {  // so slowly that it does not swing
        sim.gravity = {0, 0, -share * pull_off / mass * std::min(k / 80.0, 1.0)};
        sim.run(5e-4);
      }
      return sim.position(0).z > -1.1 * radius;
    };
    CAPTURE(share);
    CHECK(hangs(Jkr{}, damped, jkr_pull_off(ceiling)) == (share < 1));
    CHECK(hangs(Cohesive<HertzMindlin, Dmt>{}, dmt, dmt_pull_off(ceiling)) == (share < 1));
    CHECK(hangs(Cohesive<HertzMindlin, AreaCohesion>{}, area, area_pull_off) == (share < 1));
  }
}

namespace {

/// A wet and dusty pile that is shaken, all its bridges at work.
using Paste = Cohesive<Wet, VanDerWaals>;
auto pile(const VerletList<>& search) {
  const Paste::Material paste{{{2e7, 0.25, 0.6, 0.4}, {0.072, 0.3, 2e-12}},
                              {.hamaker = 1e-12, .closest = 1e-5, .cutoff = 1e-4}};
  Particles<Sphere> p;
  for (int k = 0; k < 48; ++k)
    p.add({.position = {2.05e-3 * (k % 4) + 1.1e-3 + 3e-4 * (k / 16),
                        2.05e-3 * (k / 4 % 4) + 1.1e-3, 1.01e-3 + 2e-3 * (k / 16)},
           .radius = 1e-3 * (1 - 2e-4 * k),
           .density = density});
  Simulation sim{std::move(p), Contacts<Paste, RollingEpsd>{paste, {.rolling_friction = 0.05}},
                 search};
  sim.gravity = {0, 0, -g};
  sim.time_step = 2e-6;
  sim.threads = 1;
  sim.add_wall(box({0, 0, -0.01}, {9e-3, 9e-3, 0.02}), paste);
  sim.add_wall(Plane{{0, 0, 0}, {0, 0, 1}}, paste, vibration({3e-4, 2e-4, 2e-4}, 60));
  sim.add_wall(TriangleMesh(boundary_test::box_soup({-1e-2, -1e-2, 6.2e-3}, {2e-2, 2e-2, 8e-3})),
               paste, vibration({0, 3e-4, 2e-4}, 70));
  return sim;
}

}  // namespace

TEST_CASE("cohesion: lists of any skin see the same attractions and keep the same bridges") {
  const auto places = [](const auto& sim) {
    std::vector<Vec3d> of;
    for (std::uint32_t k = 0; k < 48; ++k) of.push_back(position_of(sim, k));
    return of;
  };
  const double duration = 5e-3;
  auto once = pile({.skin = 0.05, .sort = false});
  once.run(duration);
  const auto expected = places(once);
  for (const auto& search :
       {VerletList<>{}, VerletList<>{.skin = 1e-6}, VerletList<>{.skin = 1e-4}}) {
    auto often = pile(search);
    often.run(duration);
    CHECK(often.engine().lists.upkeep.searched_at > 0);
    const auto found = places(often);
    double most = 0;
    for (std::size_t k = 0; k < 48; ++k) most = std::max(most, norm(found[k] - expected[k]));
    CAPTURE(search.skin.value_or(0));
    CHECK(most < 1e-12);  // round-off of 2500 steps; a bridge lost once shows at 1e-7 m
  }
  // It would show: bridges forgotten once.
  auto forgetful = pile({.skin = 0.05, .sort = false});
  forgetful.run(duration / 2);
  auto& pairs = forgetful.engine().lists.pairs;
  std::fill_n(pairs.history(3), pairs.padded_size(), 0.0);
  forgetful.run(duration / 2);
  double most = 0;
  const auto found = places(forgetful);
  for (std::size_t k = 0; k < 48; ++k) most = std::max(most, norm(found[k] - expected[k]));
  CHECK(most > 1e-8);
}

TEST_CASE("cohesion: in mixed precision the same bounce") {
  const Surfaces plane{Plane{{0, 0, 0}, {0, 0, 1}}};
  const double v =
      3 *
      jkr_sticking_speed({Jkr::mix(sticky, sticky, Jkr::like(sticky)).twice_modulus / 2, radius, 1},
                         mass_of(radius, density));
  // Seven digits of each of some hundred forces.
  CHECK(near_relative(speed_after<Jkr>(sticky, v, plane, 2e-7, Mixed{}),
                      speed_after<Jkr>(sticky, v, plane, 2e-7), 1e-4));
  CHECK(near_relative(speed_after<Wet>(wet, 0.5, plane, 2e-7, Mixed{}),
                      speed_after<Wet>(wet, 0.5, plane, 2e-7), 1e-4));
}

TEST_CASE("cohesion: the books of spheres in a box that repeats are numbers, of any length") {
  const Cohesive<HertzMindlin, ViscousBridge>::Material viscous{elastic,
                                                                {.surface_tension = 0.072,
                                                                 .contact_angle = 0.2,
                                                                 .volume = 1e-12,
                                                                 .viscosity = 1e-3,
                                                                 .roughness = 1e-6}};
  for (const double length : {0.02, 0.05, 0.0625}) {  // 1 m is a multiple of each
    check_books_in_a_box(dust, Dusty{}, length);
    check_books_in_a_box(wet, Wet{}, length);
    check_books_in_a_box(viscous, Cohesive<HertzMindlin, ViscousBridge>{}, length);
  }
}

TEST_CASE("cohesion: a range that would act through both faces of a repeating box is refused") {
  auto wide = dust;
  wide.cohesion.cutoff = 1.1 * radius;
  auto sim = scene<Dusty>(wide, {sphere({0, 0, 0})},
                          PeriodicBox{{{0, 0, 0}, {6.1 * radius, 1, 1}}, {true, false, false}});
  sim.time_step = 1e-7;
  std::string sentence;
  try {
    sim.run(1e-6);
  } catch (const InputError& error) {
    sentence = error.what();
  }
  CHECK(sentence.find("PeriodicBox: its length") != std::string::npos);
  CHECK(sentence.find("range 0.0011 m") != std::string::npos);
}

}  // namespace cohesion_test
