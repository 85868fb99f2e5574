// silt - BSD-3-Clause, see LICENSE
// Particles that are removed, added or given another velocity in the middle of a run.
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <engine/support.hpp>

#include <silt/io/checkpoint.hpp>
#include <silt/io/observers.hpp>
#include <silt/module/field.hpp>
#include <silt/shape/dilated_moments.hpp>
#include <silt/shape/multi_sphere.hpp>
#include <silt/shape/polyhedron.hpp>
#include <silt/shape/super_ellipsoid.hpp>
#include <silt/simulation/contact_check.hpp>

#include "near.hpp"

namespace edits_test {

namespace {

using namespace engine_test;
using silt::InputError;
using silt::ParticleId;

constexpr double g = 9.81;  // [m/s2]

silt::Particles<Sphere> heap(std::size_t count = 1200) {
  silt::Particles<Sphere> p;
  p.fill({{0, 0, 1e-3}, {20e-3, 20e-3, 40e-3}}, {.radius = silt::uniform(0.6e-3, 0.9e-3),
                                                 .density = 2500,
                                                 .count = count,
                                                 .arrangement = silt::Arrangement::Lattice});
  return p;
}

template <class... More>
auto box_of(silt::Particles<Sphere> p, More... more) {
  silt::Simulation sim{std::move(p), silt::Contacts<HertzMindlin>{rubber}, more...};
  sim.gravity = {0, 0, -g};
  sim.threads = 1;
  sim.time_step = 1e-5;
  sim.add_wall(silt::box({0, 0, 0}, {20e-3, 20e-3, 60e-3}), rubber);
  return sim;
}

/// Takes particles away and brings others, one at a time, wherever they are.
struct Stream {
  std::int64_t every = 7;  // [steps]
  std::size_t births = 0, gone = 0;
  silt::Random random{3};

  template <class Sim>
  void operator()(Sim& sim) {
    if (sim.step() % every != 0 || sim.step() == 0) return;
    if (++births % 3 == 0) {
      const auto k = static_cast<std::size_t>(random.uniform(0, double(sim.rows())));
      if (sim.is_present(k)) sim.remove(sim.id(k)), ++gone;
    }
    silt::Particles<Sphere> one;
    const auto site = static_cast<double>(births % 64);  // free again after 64: they fall 2 mm
    one.add(
        {.position = {2e-3 + 2e-3 * std::floor(site / 8), 2e-3 + 2e-3 * std::fmod(site, 8), 0.05},
         .radius = 0.6e-3,
         .density = 2500,
         .velocity = {0, 0, -0.5}});
    sim.add(one);
  }
};

}  // namespace

// Catches: rows that have left but stay in contacts (their place is not a number), gaps in the
// lists that the next newcomer is written into, searches for each.
TEST_CASE(
    "edits: a stream of removals and births in a heap misses no contact and seldom searches") {
  const auto run = [](auto sim) {
    Stream stream;
    Searches searches;
    silt::ContactCheck<> look;
    sim.run(0.03, stream, look, searches);  // 3 000 steps
    CHECK(stream.births > 400);
    CHECK(stream.gone > 100);
    CHECK(sim.size() == 1200 + stream.births - stream.gone);
    CHECK(look.contacts() > 300000);
    // 1200/64 + 8 newcomers at most go without.
    CHECK(searches.count < stream.births / 4);
  };
  run(box_of(heap()));
#ifdef SILT_LONG_TESTS
  run(box_of(heap(), silt::Mixed{}));
  run(box_of(heap(), silt::EnergyLedger{}, silt::ContactEvents{}));
#endif
}

TEST_CASE("edits: the bits of a stream depend on no thread, and go on from a checkpoint") {
  const auto run = [](int threads, bool restarts) {
    auto sim = box_of(heap(2800));
    sim.threads = threads;
    Stream stream;
    sim.run(4e-3, stream);
    CHECK(sim.engine().lists.pairs.grouped() < sim.rows());  // amid newcomers
    if (!restarts) {
      sim.run(4e-3, stream);
      return bits(sim);
    }
    std::string folder = (std::filesystem::temp_directory_path() / "silt_edits_XXXXXX").string();
    REQUIRE(::mkdtemp(folder.data()) != nullptr);
    silt::save_checkpoint(sim, folder + "/amid.silt");
    auto other = box_of(heap(2800));
    other.threads = threads;
    silt::load_checkpoint(other, folder + "/amid.silt");
    std::filesystem::remove_all(folder);
    other.run(4e-3, stream);
    return bits(other);
  };
  const auto one = run(1, false);
  CHECK(one == run(3, false));
  CHECK(one == run(2, true));
}

TEST_CASE("edits: a velocity that is set is that of the instant, for the path and the books") {
  const auto run = [](auto sim, double step) {
    sim.gravity = {0, 0, -g};
    sim.time_step = step;
    const Vec3d up{0.3, 0, 2};
    sim.run(0.0101);
    const Vec3d from = sim.position(sim.find(1));
    const double t = sim.time();
    const auto before = sim.energy();
    const double kinetic = before.kinetic();
    sim.set_velocity(1, up);
    CHECK(norm(sim.velocity(sim.find(1)) - up) == 0);
    CHECK(sim.energy().openings - before.openings ==
          near(sim.energy().kinetic() - kinetic).epsilon(1e-9));
    sim.run(0.02);
    const double dt = sim.time() - t;
    // A parabola, which leapfrog and Gear follow up to round-off.
    const Vec3d to = from + dt * up + Vec3d{0, 0, -0.5 * g * dt * dt};
    CHECK(norm(sim.position(sim.find(1)) - to) < 1e-12);
    CHECK(norm(sim.velocity(sim.find(1)) - up - Vec3d{0, 0, -g * dt}) < 1e-12);
    CHECK(sim.energy().residual() < 1e-9 * kinetic);
  };
  silt::Particles<Sphere> two;
  two.add({.position = {0, 0, 0}, .radius = 1e-3, .density = 2500, .velocity = {1, 0, 0}});
  two.add({.position = {1, 0, 0}, .radius = 1e-3, .density = 2500});
  const silt::Contacts<HertzMindlin> contacts{rubber};
  run(silt::Simulation{two, contacts, silt::EnergyLedger{}}, 1e-5);
#ifdef SILT_LONG_TESTS
  run(silt::Simulation{two, contacts, silt::EnergyLedger{}, silt::Mixed{}}, 1e-5);
  run(silt::Simulation{two, contacts, silt::EnergyLedger{}, silt::Gear{}}, 1e-5);
#endif
}

// Catches derivatives that are not known yet, in a prediction.
#ifdef SILT_LONG_TESTS
TEST_CASE("edits: particles that come between the runs of Gear's integrator fall like others") {
  silt::Particles<Sphere> first, second;
  first.add({.position = {1, 0, 0}, .radius = 1e-3, .density = 2500});
  second.add({.position = {0, 0, 0}, .radius = 1e-3, .density = 2500, .velocity = {1, 0, 0}});
  silt::Simulation sim{first, silt::Contacts<HertzMindlin>{rubber}, silt::Gear{}};
  sim.gravity = {0, 0, -g};
  sim.time_step = 1e-5;
  sim.run(0.01);
  sim.add(second);
  sim.run(0.02);
  const std::size_t k = sim.find(1);
  CHECK(norm(sim.position(k) - Vec3d{0.02, 0, -0.5 * g * 4e-4}) < 1e-12);
  CHECK(norm(sim.velocity(k) - Vec3d{1, 0, -g * 0.02}) < 1e-12);
}
#endif

// Catches the place of one that has left, which is no number, in the check of the run: it stopped.
#ifdef SILT_LONG_TESTS
TEST_CASE("edits: a particle is removed between the runs of Gear's integrator") {
  silt::Particles<Sphere> two;
  for (const double x : {0.0, 1.0})
    two.add({.position = {x, 0, 0}, .radius = 1e-3, .density = 2500});
  silt::Simulation sim{std::move(two), silt::Contacts<HertzMindlin>{rubber}, silt::Gear{}};
  sim.gravity = {0, 0, -g};
  sim.time_step = 1e-5;
  sim.run(0.01);
  sim.remove(0);
  sim.run(0.02);
  CHECK(sim.size() == 1);
  CHECK(norm(sim.position(sim.find(1)) - Vec3d{1, 0, -0.5 * g * 9e-4}) < 1e-12);
}
#endif

// Catches what leaves before anything was counted, and is booked all the same.
TEST_CASE("edits: a particle that leaves before the first step is in no book") {
  silt::Particles<Sphere> two;
  two.add({.position = {0, 0, 0}, .radius = 1e-3, .density = 2500, .velocity = {1, 0, 0}});
  two.add({.position = {1, 0, 0}, .radius = 1e-3, .density = 2500, .velocity = {0, 2, 0}});
  silt::Simulation sim{std::move(two), silt::Contacts<HertzMindlin>{rubber}, silt::EnergyLedger{}};
  sim.time_step = 1e-5;
  sim.add_outlet({{0.9, -1, -1}, {2, 1, 1}});
  sim.run(1e-3);
  CHECK(sim.size() == 1);
  CHECK(sim.energy().openings == 0);
  CHECK(std::abs(sim.energy().residual()) < 1e-12 * sim.energy().kinetic());
}

TEST_CASE("edits: what is set or removed in an observer acts from that instant on") {
  silt::Particles<Sphere> three;
  for (const double x : {-5e-3, 0.0, 5e-3})
    three.add({.position = {x, 0, 0}, .radius = 1e-3, .density = 2500});
  silt::Simulation sim{std::move(three), silt::Contacts<HertzMindlin>{rubber}};
  sim.time_step = 1e-5;
  sim.run(0.02, silt::at(silt::every(0.01), [](auto& s) {
            if (s.step() != 1000) return;
            s.set_velocity(0, {0.5, 0, 0});
            s.set_angular_velocity(0, {0, 0, 7});
            s.remove(1);  // which it would have hit
          }));
  CHECK(sim.size() == 2);
  CHECK(sim.find(1) == sim.rows());
  // Free all the way: 0.01 s at 0.5 m/s.
  CHECK(std::abs(sim.position(sim.find(0)).x - (-5e-3 + 0.01 * 0.5)) < 1e-14);
  CHECK(norm(sim.angular_velocity(sim.find(0)) - Vec3d{0, 0, 7}) < 1e-12);
  CHECK(sim.peak_overlap() == 0);
}

TEST_CASE("edits: a grain on a floor sinks in as its weight grows, and the books are kept") {
  silt::Particles<Sphere> p;
  p.add({.position = {0, 0, 1e-3}, .radius = 1e-3, .density = 2500});
  silt::Simulation sim{std::move(p), silt::Contacts<HertzMindlin>{rubber}, silt::EnergyLedger{}};
  sim.gravity = {0, 0, -g};
  sim.threads = 1;
  sim.time_step = 2e-6;
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, rubber);
  const auto at_rest = [&] {
    sim.run(0.1);
    // Hertz on a plane: 4/3 E* sqrt(r) d^(3/2) = m g; both are rubber.
    const double r = sim.radius(0), m = 2500 * Sphere::volume(r);
    const double E =
        rubber.youngs_modulus / (2 * (1 - rubber.poisson_ratio * rubber.poisson_ratio));
    CHECK(sim.mass(0) == near(m).epsilon(1e-10));  // 200 000 changes, three roundings in each
    CHECK(r - sim.position(0).z ==
          near(std::cbrt(std::pow(0.75 * m * g / (E * std::sqrt(r)), 2))).epsilon(1e-6));
  };
  at_rest();
  // Grown by 2 % in 0.4 s it stays at rest, and its centre rises.
  sim.run(0.4, [](auto& s) {
    if (s.radius(0) < 1.02e-3) s.set_radius(0, s.radius(0) * (1 + 1e-7));
  });
  const double r = sim.radius(0), m = 2500 * Sphere::volume(r), ratio = r / 1e-3;
  CHECK(r == near(1.02e-3).epsilon(1e-3));
  at_rest();
  const auto e = sim.energy();
  // The mass came at the height of its centre; 1 %: the overlap.
  CHECK(e.openings == near((1 - std::pow(ratio, -4)) * m * g * r * 3 / 4).epsilon(0.01));
  // What growth does against the contact is the one thing that no book has: the integral of m g dr;
  // 2 %: the overlap grows too.
  CHECK(e.residual() == near((1 - std::pow(ratio, -4)) * m * g * r / 4).epsilon(0.02));
  sim.set_radius(0, 0.8e-3);
  at_rest();
}

TEST_CASE("edits: another material acts in contacts that there are") {
  const HertzMindlin::Material soft{
      .youngs_modulus = 1e6, .poisson_ratio = 0.3, .restitution = 0.5, .friction = 0.3};
  HertzMindlin::Material stiff = soft;
  stiff.youngs_modulus = 8e6;
  const auto sunk = [&](auto shapes, std::size_t material) {
    shapes.add({.position = {0, 0, 1e-3}, .radius = 1e-3, .density = 2500, .material = material});
    silt::Contacts<HertzMindlin, silt::SeveralMaterials> contacts{{soft, stiff}};
    contacts.set_pair(soft, stiff, {.restitution = 0.5, .friction = 0.3});
    silt::Simulation sim{std::move(shapes), std::move(contacts)};
    sim.gravity = {0, 0, -g};
    sim.threads = 1;
    sim.time_step = 2e-6;
    sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, stiff);
    sim.run(0.05);
    if (material == 0) {
      CHECK(has_words(refusal<InputError>([&] { sim.set_material(0, 2); }),
                      {"set_material", "material 2", "2 materials"}));
      sim.set_material(0, 1);
      sim.run(0.05);
    }
    CHECK(sim.material(0) == 1);
    return sim.position(0).z;
  };
  silt::Particles<silt::MultiSphere> ball;
  ball.add_form(silt::MultiSphere{.balls = {{{0, 0, 0}, 1e-3}}});
  CHECK(sunk(silt::Particles<Sphere>{}, 0) ==
        near(sunk(silt::Particles<Sphere>{}, 1)).epsilon(1e-9));
  CHECK(sunk(ball, 0) == near(sunk(ball, 1)).epsilon(1e-9));
}

TEST_CASE("edits: sizes that change in mid-run change no bit by threads or from a checkpoint") {
  const auto run = [](int threads, bool restarts) {
    auto sim = box_of(heap(2800));
    sim.threads = threads;
    silt::Random random{9};
    const auto abrade = [&](auto& s) {
      const auto k = static_cast<std::size_t>(random.uniform(0, double(s.rows())));
      s.set_radius(s.id(k), s.radius(k) * random.uniform(0.97, 1.01));
    };
    sim.run(4e-3, abrade);
    for (std::size_t k = 0; k < sim.rows(); ++k)  // so that the largest measured is there no more
      if (sim.radius(k) > 0.85e-3) sim.set_radius(sim.id(k), 0.85e-3);
    if (!restarts) {
      sim.run(4e-3, abrade);
      return bits(sim);
    }
    std::string folder = (std::filesystem::temp_directory_path() / "silt_sizes_XXXXXX").string();
    REQUIRE(::mkdtemp(folder.data()) != nullptr);
    silt::save_checkpoint(sim, folder + "/amid.silt");
    auto other = box_of(heap(2800));
    other.threads = threads;
    silt::load_checkpoint(other, folder + "/amid.silt");
    std::filesystem::remove_all(folder);
    other.run(4e-3, abrade);
    return bits(other);
  };
  const auto one = run(1, false);
  CHECK(one == run(3, false));
  CHECK(one == run(2, true));
}

// Catches: "start without overlaps", "added twice" long after the start.
TEST_CASE("edits: an overlap that a change of a size has made is called so") {
  silt::Particles<Sphere> two;
  for (const double x : {5e-3, 7.1e-3})
    two.add({.position = {x, 5e-3, 30e-3}, .radius = 1e-3, .density = 2500});
  auto sim = box_of(std::move(two));
  sim.run(1e-3);
  const auto words = [&](auto&& run) { return refusal<silt::SimulationError>(run); };
  const std::string grown = words([&] {
    sim.run(1e-3, silt::at(silt::every(0.5e-3), [](auto& s) {
              if (s.step() == 150) s.set_radius(1, 1.8e-3);
            }));
  });
  CHECK(has_words(grown,
                  {"particles 0 and 1", "Simulation::set_radius of particle 1", "smaller steps"}));
  CHECK_FALSE(has_words(grown, {"start without overlaps"}));
  CHECK_FALSE(has_words(grown, {"twice"}));

  silt::Particles<silt::MultiSphere> balls;
  balls.add_form(silt::MultiSphere{.balls = {{{-0.6e-3, 0, 0}, 0.8e-3}, {{0.6e-3, 0, 0}, 0.8e-3}}});
  balls.add_form(silt::MultiSphere{
      .balls = {{{-1e-3, 0, 0}, 0.5e-3}, {{0, 0, 0}, 0.8e-3}, {{1e-3, 0, 0}, 0.5e-3}}});
  balls.add({.form = 1, .position = {0, 0, 0.77e-3}, .radius = 1.4e-3, .density = 2500});
  silt::Simulation bodies{balls, silt::Contacts<HertzMindlin>{rubber}};
  bodies.time_step = 1e-6;
  bodies.guard.max_overlap = 0.02;
  bodies.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, rubber);
  bodies.run(1e-5);
  bodies.set_form(0, 0);  // thicker by 0.05 mm
  CHECK(has_words(words([&] { bodies.run(1e-5); }),
                  {"overlaps wall 0", "Simulation::set_form of particle 0"}));
}

TEST_CASE("edits: a particle that is not there, and values that cannot be, are refused") {
  auto sim = box_of(heap(10));
  CHECK(has_words(refusal<InputError>([&] { sim.remove(10); }),
                  {"Simulation::remove", "no particle 10"}));
  sim.remove(3);
  CHECK(sim.size() == 9);
  CHECK(has_words(refusal<InputError>([&] { sim.remove(3); }), {"no particle 3", "has left"}));
  const std::string of_none = refusal<InputError>([&] { sim.remove(silt::no_particle); });
  CHECK(has_words(of_none, {"Simulation::remove", "silt::no_particle", "wall"}));
  CHECK_FALSE(has_words(of_none, {"18446744073709551615"}));
  CHECK(has_words(refusal<InputError>([&] {
                    sim.set_velocity(3, {0, 0, 0});
                  }),
                  {"Simulation::set_velocity", "no particle 3"}));
  CHECK(has_words(refusal<InputError>([&] {
                    sim.set_velocity(4, {0, NAN, 0});
                  }),
                  {"set_velocity", "finite"}));
  CHECK(has_words(refusal<InputError>([&] {
                    sim.set_angular_velocity(4, {0, NAN, 0});
                  }),
                  {"set_angular_velocity", "finite"}));
  for (const double r : {0.0, -1e-3, double(NAN), double(INFINITY)})
    CHECK(has_words(refusal<InputError>([&] { sim.set_radius(4, r); }),
                    {"Simulation::set_radius", "finite and greater than 0"}));
  CHECK(has_words(refusal<InputError>([&] { sim.set_radius(3, 1e-3); }), {"no particle 3"}));
  silt::Simulation repeats{
      heap(10), silt::Contacts<HertzMindlin>{rubber},
      silt::PeriodicBox{{{0, 0, 0}, {20e-3, 20e-3, 60e-3}}, {true, true, false}}};
  CHECK(has_words(refusal<InputError>([&] { repeats.set_radius(4, 4e-3); }),
                  {"set_radius", "PeriodicBox", "3 diameters"}));
  sim.run(1e-3);
  CHECK(sim.size() == 9);
}

}  // namespace edits_test
