// silt - BSD-3-Clause, see LICENSE
// Charges against closed forms: the shifted force and the energy of two, a charge in a field and
// above a plane, a cloud against its direct sum, charging by impacts to saturation, the sum of all
// charges; refusals.
#include <cmath>
#include <filesystem>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <doctest/doctest.h>

#include <silt/contact/hertz_mindlin.hpp>
#include <silt/core/random.hpp>
#include <silt/io/checkpoint.hpp>
#include <silt/module/charge/tribo_charge.hpp>
#include <silt/simulation.hpp>
#include <silt/simulation/energy_ledger.hpp>

#include "near.hpp"
#include "refusal.hpp"

namespace charge_test {

using silt_test::has, silt_test::refusal;

using silt::Charge;
using silt::ElectricCharge;
using silt::TriboCharge;
using silt::Vec3d;

const double R = 50e-6, density = 2500, q = 2e-13;  // [m], [kg/m3], [C]
const double mass = 4.0 / 3 * std::numbers::pi * R * R * R * density;
const double k_e = 1 / (4 * std::numbers::pi * 8.8541878128e-12);  // [N m2/C2]
const silt::HertzMindlin::Material glass{
    .youngs_modulus = 1e7, .poisson_ratio = 0.25, .restitution = 0.8, .friction = 0.3};
const silt::HertzMindlin::Material elastic{
    .youngs_modulus = 1e7, .poisson_ratio = 0.25, .restitution = 1, .friction = 0};

inline silt::Particles<silt::Sphere> at(const std::vector<Vec3d>& places) {
  silt::Particles<silt::Sphere> p;
  for (const Vec3d& x : places) p.add({.position = x, .radius = R, .density = density});
  return p;
}
inline auto scene(const std::vector<Vec3d>& places, const Charge& charge) {
  silt::Simulation sim{at(places), silt::Contacts<silt::HertzMindlin>{glass}, charge,
                       silt::EnergyLedger{}};
  sim.guard.max_time_step = 1e3;  // nothing touches
  return sim;
}
using Contacts = silt::Contacts<silt::HertzMindlin, silt::SeveralMaterials>;
/// Grains of material 0, walls of material 1, of other work functions.
inline Contacts two_materials(const silt::HertzMindlin::Material& grains) {
  silt::HertzMindlin::Material plate = grains;
  plate.poisson_ratio = 0.3;
  Contacts contacts{{grains, plate}};
  contacts.set_pair(contacts.material(0), contacts.material(1),
                    {.restitution = grains.restitution, .friction = grains.friction});
  return contacts;
}
const TriboCharge::Surfaces surfaces{.work_functions = {4.0, 4.5}, .transfer_distance = 5e-7};
inline auto tribo(silt::Particles<silt::Sphere> grains, const silt::HertzMindlin::Material& of,
                  const TriboCharge::Surfaces& how) {
  return silt::Simulation{std::move(grains), two_materials(of),
                          TriboCharge{Charge{.cutoff = 1e-9}, how}};
}
template <class Sim>
double charge_of(const Sim& sim) {
  double sum = 0;
  for (std::size_t k = 0; k < sim.rows(); ++k) sum += sim.template field<ElectricCharge>(k);
  return sum;
}

// Catches a factor of 4 pi, a permittivity that multiplies, a force that is not shifted, one that
// attracts where it should repel, and a cut-off between surfaces.
TEST_CASE("charge: the force of two is Coulomb's, shifted to end at the cut-off") {
  const double r = 7 * R, r_c = 10 * R;
  auto sim = scene({{0, 0, 0}, {r, 0, 0}, {r + 1.001 * r_c, 0, 0}},
                   Charge{.cutoff = r_c, .permittivity = 2});
  sim.time_step = 1e-7;
  sim.field<ElectricCharge>(0) = q, sim.field<ElectricCharge>(1) = -2 * q;
  sim.field<ElectricCharge>(2) = q;
  sim.run(0);
  const double F = k_e / 2 * 2 * q * q * (1 / (r * r) - 1 / (r_c * r_c));
  CHECK(sim.module_force(0).x == near(F).epsilon(1e-14));
  CHECK(sim.module_force(1).x == -sim.module_force(0).x);
  CHECK(sim.module_force(2).x == 0);
}

// Catches work that the ledger does not know, a step that is not of second order, a force that
// belongs to other places than the contacts'.
TEST_CASE("charge: two that fly apart keep the sum of their energies, to second order") {
  const double r = 4 * R, r_c = 40 * R;
  const auto potential = [&](double x) {
    return k_e * q * q * (1 / x + x / (r_c * r_c) - 2 / r_c);
  };
  const auto error = [&](double step) {
    auto sim = scene({{0, 0, 0}, {r, 0, 0}}, Charge{.cutoff = r_c, .start_charge = q});
    sim.time_step = step;
    double worst = 0;
    sim.run(0.02, [&](const auto& s) {
      const double x = silt::norm(s.position(0) - s.position(1));
      const double kinetic =
          0.5 * mass *
          (silt::dot(s.velocity(0), s.velocity(0)) + silt::dot(s.velocity(1), s.velocity(1)));
      worst = std::max(worst, std::abs(kinetic + potential(x) - potential(r)));
    });
    const double gained = potential(r) - potential(silt::norm(sim.position(0) - sim.position(1)));
    // The ledger's work of modules is the potential's loss, to the order of the step.
    CHECK(sim.energy().modules == near(gained).epsilon(1e-4));
    CHECK(gained > 0.5 * potential(r));
    return worst / potential(r);
  };
  const double coarse = error(1e-4), fine = error(0.5e-4);
  CHECK(coarse < 1e-4);
  CHECK(coarse / fine == near(4).epsilon(0.1));
}

// The closed form of two equal charges that fall towards each other from rest, without a cut-off:
// t = sqrt(m r0^3/(4 k q^2)) (acos(sqrt(x)) + sqrt(x (1 - x))), x = r/r0.
TEST_CASE("charge: two opposite charges fall onto each other in Kepler's time") {
  const double r0 = 40 * R, r_c = 1e4 * r0;
  auto sim = scene({{0, 0, 0}, {r0, 0, 0}}, Charge{.cutoff = r_c});
  sim.field<ElectricCharge>(0) = q, sim.field<ElectricCharge>(1) = -q;
  const double x = 0.3;
  const double t = std::sqrt(mass * r0 * r0 * r0 / (4 * k_e * q * q)) *
                   (std::acos(std::sqrt(x)) + std::sqrt(x * (1 - x)));
  sim.time_step = t / 4000;
  sim.run(t);
  // Second order: (1/4000)^2 times some constants; the shift is 1e-8.
  CHECK(silt::norm(sim.position(1) - sim.position(0)) == near(x * r0).epsilon(2e-6));
}

TEST_CASE("charge: a field, and a plane that conducts") {
  auto sim = scene({{0, 0, 3 * R}}, Charge{.cutoff = R,
                                           .field = {1e4, 0, 0},
                                           .start_charge = -q,
                                           .planes = {{{0, 0, 0}, {0, 0, 2}}}});
  sim.time_step = 1e-6;
  sim.run(0);
  CHECK(sim.module_force(0).x == near(-q * 1e4).epsilon(1e-14));
  CHECK(sim.module_force(0).z == near(-k_e * q * q / (4 * 9 * R * R)).epsilon(1e-14));
  // Both sides of a plane: the normal's sign does not matter. Catches no force behind the plane,
  // and one that pushes away from it.
  for (const double side : {1.0, -1.0})
    for (const double normal : {2.0, -2.0}) {
      auto near_plane =
          scene({{0, 0, side * 3 * R}},
                Charge{.cutoff = R, .start_charge = q, .planes = {{{0, 0, 0}, {0, 0, normal}}}});
      near_plane.time_step = 1e-6;
      near_plane.run(0);
      CHECK(near_plane.module_force(0).z ==
            near(-side * k_e * q * q / (4 * 9 * R * R)).epsilon(1e-14));
    }
  // The rate too: a step that does not resolve the image's pull is refused behind the plane as
  // well.
  const silt::Seen behind{.position = {0, 0, -3 * R}, .mass = mass};
  CHECK(Charge{.cutoff = R, .planes = {{}}}.rate(behind, {q}) ==
        near(std::sqrt(k_e * q * q / (2 * 27 * R * R * R) / mass)).epsilon(1e-14));
  // Falls as if to its image: the closed form above with r = 2 d and the mass m/2 on 2 d.
  auto falls = scene({{0, 0, 40 * R}}, Charge{.cutoff = R, .start_charge = q, .planes = {{}}});
  const double d0 = 40 * R, x = 0.3;
  const double t = std::sqrt(2 * mass * d0 * d0 * d0 / (k_e * q * q)) *
                   (std::acos(std::sqrt(x)) + std::sqrt(x * (1 - x)));
  falls.time_step = t / 4000;
  falls.run(t);
  CHECK(falls.position(0).z == near(x * d0).epsilon(2e-6));
}

// Catches images of others left out (grains float above a charged layer), with the wrong sign,
// between pairs on different sides, and a force on one of both alone.
TEST_CASE("charge: a plane mirrors all charges: the direct sum with images, second order energy") {
  const double r_c = 1e5 * R;
  silt::Random random(7);
  std::vector<Vec3d> places{{0, 0, -3 * R}};
  while (places.size() < 40) {
    const Vec3d x{20 * R * random.uniform(), 20 * R * random.uniform(),
                  (1 + 8 * random.uniform()) * R};
    bool free = true;
    for (const Vec3d& y : places) free = free && silt::norm(x - y) > 2.2 * R;
    if (free) places.push_back(x);
  }
  const auto charge_of_id = [](std::size_t id) { return (id % 3 == 0 ? -0.7 : 1.0) * q; };
  const auto mirrored = [](const Vec3d& x) { return Vec3d{x.x, x.y, -x.z}; };
  std::vector<std::vector<Vec3d>> found;
  for (const int threads : {1, 3}) {
    auto sim = scene(places, Charge{.cutoff = r_c, .planes = {{{1, 2, 0}, {0, 0, -3}}}});
    for (std::size_t k = 0; k < places.size(); ++k)
      sim.field<ElectricCharge>(k) = charge_of_id(sim.id(k));
    sim.time_step = 1e-7, sim.threads = threads;
    sim.run(0);
    found.emplace_back(places.size());
    for (std::size_t k = 0; k < places.size(); ++k) found.back()[sim.id(k)] = sim.module_force(k);
  }
  for (std::size_t a = 0; a < places.size(); ++a) {
    Vec3d F{0, 0, 0};
    const auto add = [&](double charge, const Vec3d& from) {
      const Vec3d d = places[a] - from;
      F += k_e * charge_of_id(a) * charge / std::pow(silt::norm(d), 3) * d;
    };
    for (std::size_t b = 0; b < places.size(); ++b) {
      if (b != a) add(charge_of_id(b), places[b]);
      if (places[a].z * places[b].z > 0) add(-charge_of_id(b), mirrored(places[b]));
    }
    CHECK(silt::norm(found[0][a] - F) < 1e-6 * silt::norm(F));  // the shift: (r/r_c)^2 at most 1e-7
    CHECK(found[0][a] == found[1][a]);
  }
  // Two of one sign that fly apart, and to the plane.
  const auto error = [&](double step) {
    auto sim = scene({{0, 0, 4 * R}, {3 * R, 0, 6 * R}},
                     Charge{.cutoff = 30 * R, .start_charge = q, .planes = {{}}});
    sim.time_step = step;
    const auto energy = [&](const auto& s) {
      const auto U = [&](double r) {
        return k_e * q * q * (1 / r + r / (900 * R * R) - 2 / (30 * R));
      };
      const Vec3d a = s.position(0), b = s.position(1);
      double all = U(silt::norm(a - b)) - U(silt::norm(a - mirrored(b)));
      for (std::size_t k : {0, 1})
        all += 0.5 * mass * silt::dot(s.velocity(k), s.velocity(k)) -
               k_e * q * q / (4 * s.position(k).z);
      return all;
    };
    double start = 0, worst = 0;
    sim.run(4e-3, [&](const auto& s) {
      if (s.step() == 0) start = energy(s);
      worst = std::max(worst, std::abs(energy(s) - start));
    });
    CHECK(sim.position(1).x > 3.5 * R);
    return worst / (k_e * q * q / R);
  };
  const double coarse = error(2e-5), fine = error(1e-5);
  CHECK(coarse < 1e-3);
  CHECK(coarse / fine == near(4).epsilon(0.1));
}

// How much a cut-off leaves out, in a cloud of both signs; the direct sum is the oracle.
TEST_CASE("charge: a neutral cloud comes to its direct sum as the cut-off grows") {
  const double edge = 30 * R;
  silt::Random random(3);
  std::vector<Vec3d> places;
  while (places.size() < 500) {
    const Vec3d x{edge * random.uniform(), edge * random.uniform(), edge * random.uniform()};
    bool free = true;
    for (const Vec3d& y : places) free = free && silt::norm(x - y) > 2.2 * R;
    if (free) places.push_back(x);
  }
  const auto sign = [](std::size_t k) { return k % 2 == 0 ? q : -q; };
  std::vector<Vec3d> direct(500, {0, 0, 0});
  double scale = 0;
  for (std::size_t a = 0; a < 500; ++a) {
    for (std::size_t b = 0; b < 500; ++b) {
      if (a == b) continue;
      const Vec3d d = places[a] - places[b];
      direct[a] += k_e * sign(a) * sign(b) / std::pow(silt::norm(d), 3) * d;
    }
    scale += silt::dot(direct[a], direct[a]);
  }
  std::vector<double> errors;
  for (const double r_c : {5 * R, 10 * R, 20 * R, 1e5 * R}) {
    auto sim = scene(places, Charge{.cutoff = r_c});
    for (std::size_t k = 0; k < 500; ++k) sim.field<ElectricCharge>(k) = sign(sim.id(k));
    sim.time_step = 1e-7;
    sim.run(0);
    double sum = 0;
    for (std::size_t k = 0; k < 500; ++k) {
      const Vec3d d = sim.module_force(k) - direct[sim.id(k)];
      sum += silt::dot(d, d);
    }
    errors.push_back(std::sqrt(sum / scale));
    MESSAGE("cut-off ", r_c / R, " R: error ", errors.back(), " of the root mean square force");
  }
  CHECK(errors[1] < errors[0]);
  CHECK(errors[2] < errors[1]);
  CHECK(errors[3] < 1e-8);  // the shift alone, (r/r_c)^2 of the farthest: 7e-8 at most
}

// Catches an area that grows while it shrinks, a factor of 2 in the wall's mirror, charge of the
// wrong sign, one that depends on the step.
TEST_CASE("charge: impacts on walls charge a sphere to q_inf (1 - exp(-n/n0))") {
  const auto charged = [](double step) {
    auto sim = tribo(at({{0, 0, 0}}), elastic, surfaces);
    const double L = 3 * R;
    sim.add_wall(silt::Plane{{-L, 0, 0}, {1, 0, 0}}, two_materials(elastic).material(1));
    sim.add_wall(silt::Plane{{L, 0, 0}, {-1, 0, 0}}, two_materials(elastic).material(1));
    sim.set_velocity(0, {1, 0, 0});
    sim.time_step = step;
    double deepest = 0;
    int impacts = 0;
    bool touches = false;
    sim.run(4e-3, [&](const auto& s) {
      const double overlap = std::abs(s.position(0).x) + R - L;
      deepest = std::max(deepest, overlap);
      if (overlap > 0 && !touches) ++impacts;
      touches = overlap > 0;
    });
    const double V = 0.5, eps0 = 8.8541878128e-12;
    const double most = 2 * std::numbers::pi * eps0 * R * R * V / 5e-7, n0 = 2 * R / deepest;
    CHECK(!touches);
    CHECK(impacts > 15);
    const double given =
        sim.given_by_wall<TriboCharge>(0).sum + sim.given_by_wall<TriboCharge>(1).sum;
    CHECK(given == near(charge_of(sim)).epsilon(1e-12));
    const double ratio = charge_of(sim) / (most * (1 - std::exp(-impacts / n0)));
    CHECK(charge_of(sim) > 0.3 * most);
    return ratio;
  };
  // The deepest place lies between two steps, and Euler's rule within an impact: first order.
  CHECK(charged(1e-8) == near(1).epsilon(2e-3));
  CHECK(charged(1e-7) == near(1).epsilon(2e-2));
}

// Catches charge that one end gets and the other does not lose.
#ifdef SILT_LONG_TESTS
TEST_CASE("charge: grains of two materials in a box exchange charge and keep its sum") {
  const auto shaken = [](int threads) {
    silt::Particles<silt::Sphere> p;
    for (int k = 0; k < 64; ++k)
      p.add({.position = {(2.2 * (k % 4) + 1.2) * R, (2.2 * (k / 4 % 4) + 1.2) * R,
                          (2.2 * (k / 16) + 1.2) * R},
             .radius = R,
             .density = density,
             .material = static_cast<std::size_t>(k % 2)});
    auto sim = tribo(std::move(p), glass, surfaces);
    sim.add_wall(silt::box({0, 0, 0}, {9 * R, 9 * R, 9 * R}), two_materials(glass).material(0));
    sim.module<TriboCharge>().surfaces.insulated = {true};
    sim.module<TriboCharge>().cutoff = 6 * R;
    silt::Random random(5);
    for (silt::ParticleId id = 0; id < 64; ++id)
      sim.set_velocity(id, {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)});
    sim.threads = threads, sim.time_step = 1e-7;
    return sim;
  };
  auto sim = shaken(1);
  sim.run(1e-3);
  double all = 0, of_first = 0;
  for (std::size_t k = 0; k < 64; ++k) {
    all += std::abs(sim.field<ElectricCharge>(k));
    if (sim.material(k) == 0) of_first += sim.field<ElectricCharge>(k);
  }
  CHECK(all > 1e-14);
  CHECK(of_first > 0.4 * all);  // the lower work function gives electrons
  CHECK(std::abs(charge_of(sim)) < 1e-13 * all);
  CHECK(sim.given_by_wall<TriboCharge>(0).sum == 0);

  // Walls that exchange, two threads, and a checkpoint: all is counted, and the bits are the same.
  auto one = shaken(1), two = shaken(2), again = shaken(2);
  for (auto* s : {&one, &two, &again}) s->module<TriboCharge>().surfaces.insulated = {};
  one.run(1e-3), two.run(0.5e-3);
  const auto file = (std::filesystem::temp_directory_path() / "silt_charge.silt").string();
  silt::save_checkpoint(two, file), silt::load_checkpoint(again, file);
  std::filesystem::remove(file);
  again.run(0.5e-3);
  CHECK(one.given_by_wall<TriboCharge>(0).sum == near(charge_of(one)).epsilon(1e-10));
  CHECK(again.given_by_wall<TriboCharge>(0).sum == one.given_by_wall<TriboCharge>(0).sum);
  for (std::size_t k = 0; k < 64; ++k)
    CHECK(again.field<ElectricCharge>(again.find(k)) == one.field<ElectricCharge>(one.find(k)));
}
#endif

// Catches a step that does not know how fast charges swing.
TEST_CASE("charge: a step that does not resolve the force is refused") {
  auto sim = scene({{0, 0, 0}, {2.5 * R, 0, 0}}, Charge{.cutoff = 10 * R, .start_charge = 4e-10});
  sim.time_step = 1e-6;
  has(refusal([&] { sim.run(1e-4); }), "the modules' rate of particle 0 is");
  auto chosen =
      scene({{0, 0, 0}, {2.5 * R, 0, 0}}, Charge{.cutoff = 10 * R, .start_charge = 4e-12});
  chosen.run(0);
  const double rate = std::sqrt(4 * k_e * 4e-12 * 4e-12 / std::pow(2.5 * R, 3) / mass);
  CHECK(chosen.step_length() <= 1.0001 * std::numbers::pi / 20 / rate);
}

TEST_CASE("charge: refusals") {
  const auto of = [](const Charge& charge) {
    return refusal([&] {
      auto sim = scene({{0, 0, 0}}, charge);
      sim.time_step = 1e-6, sim.run(0);
    });
  };
  has(of(Charge{}), "Charge.cutoff = 0 [m] must be");
  has(of(Charge{.cutoff = R, .permittivity = 0}), "Charge.permittivity = 0 [-]");
  has(of(Charge{.cutoff = R, .field = {NAN, 0, 0}}), "Charge.field = ");
  has(of(Charge{.cutoff = R, .start_charge = INFINITY}), "Charge.start_charge = ");
  has(of(Charge{.cutoff = R, .planes = {{{0, 0, 0}, {0, 0, 0}}}}), "Charge.planes[0]: its point ");
  const auto in_a_box = [](const Vec3d& normal) {
    silt::Simulation sim{at({{0, 0, 0}}), silt::Contacts<silt::HertzMindlin>{glass},
                         silt::PeriodicBox{{{-1, -1, -1}, {1, 1, 1}}, {true, true, false}},
                         Charge{.cutoff = R, .planes = {{{0, 0, -0.5}, normal}}}};
    sim.time_step = 1e-6;
    return refusal([&] { sim.run(0); });
  };
  has(in_a_box({1e-3, 0, 1}), "along a direction in which the box is periodic");
  CHECK(in_a_box({0, 0, -2}) == "nothing was refused");
  const auto tribos = [](const TriboCharge::Surfaces& how) {
    return refusal([&] {
      auto sim = tribo(at({{0, 0, 0}}), glass, how);
      sim.add_wall(silt::Plane{{0, 0, -2 * R}, {0, 0, 1}}, two_materials(glass).material(1));
      sim.time_step = 1e-7, sim.run(0);
    });
  };
  has(tribos({.work_functions = {}}),
      "particle 0 is of material 0, which has no value [eV] in `work_functions`");
  has(tribos({.work_functions = {4}}),
      "wall 0 is of material 1, which has no value [eV] in `work_functions`");
  has(tribos({.work_functions = {4, NAN}}), "TriboCharge.work_functions[1] = ");
  has(tribos({.work_functions = {4, 5}, .transfer_distance = 0}),
      "TriboCharge.transfer_distance = 0 [m]");
  has(tribos({.work_functions = {4, 5}, .area_factor = -1}), "TriboCharge.area_factor = -1 [-]");
  has(tribos({.work_functions = {4, 5}, .insulated = {true, true}}),
      "TriboCharge.insulated has 2 entries");
}

}  // namespace charge_test
