// silt - BSD-3-Clause, see LICENSE
// What an observer throws: the same type, with who threw, and when.
#include <stdexcept>
#include <string>
#include <utility>

#include <doctest/doctest.h>

#include <silt/contact/hertz_mindlin.hpp>
#include <silt/io/observers.hpp>
#include <silt/simulation.hpp>

#include "refusal.hpp"

namespace observer_errors_test {

using silt_test::has, silt_test::refusal;

const silt::HertzMindlin::Material glass{
    .youngs_modulus = 1e3, .poisson_ratio = 0.25, .restitution = 0.9, .friction = 0.4};
auto scene() {
  silt::Particles<silt::Sphere> p;
  p.add({.position = {0, 0, 0}, .radius = 1e-3, .density = 2500, .velocity = {0, 0, -1}});
  silt::Simulation sim{std::move(p), silt::Contacts<silt::HertzMindlin>{glass},
                       silt::ContactEvents{}};
  sim.time_step = 1e-4;
  return sim;
}
/// An error of the user's own.
struct Mine : std::runtime_error {
  explicit Mine(int n) : std::runtime_error("mine"), number(n) {}
  int number;
};
struct Watch {
  template <class Sim>
  void operator()(const Sim& sim) {
    if (sim.step() == 20) throw std::invalid_argument("odd");
  }
};
struct Impacts {
  template <class Log>
  void tell(const Log&) const {
    throw std::out_of_range("far");
  }
  template <class Sim>
  void operator()(const Sim&) const {}
};

// Catches a second run after one that failed, whose error says nothing of the first.
TEST_CASE("a run after one that failed says so") {
  auto sim = scene();
  sim.guard.domain = silt::Box{{-1, -1, -5e-3}, {1, 1, 1}};
  const auto first = refusal([&] { sim.run(0.1); });
  CHECK(has(first, "outside guard.domain"));
  CHECK(first.find("an earlier run") == first.npos);
  const std::int64_t failed_at = sim.step();
  const auto second = refusal([&] { sim.run(0.1); });
  const auto words = silt::text("an earlier run of this simulation failed in step ", failed_at);
  CHECK(has(second, words.c_str()));
  CHECK(has(second, "build the simulation anew"));
  // An observer's own error is no failure of the simulation.
  auto other = scene();
  CHECK_THROWS(other.run(0.01, Watch{}));
  other.guard.domain = silt::Box{{-1, -1, -5e-3}, {1, 1, 1}};
  CHECK(refusal([&] { other.run(0.1); }).find("an earlier run") == std::string::npos);
}

// Catches a run within a run, after which the outer one's observers missed some of their times.
TEST_CASE("observers: a run within a run is refused") {
  auto sim = scene();
  const auto words = refusal([&] {
    sim.run(0.01, [](auto& s) {
      if (s.step() == 10) s.run(0.001);
    });
  });
  CHECK(has(words, "Simulation::run was called by an observer of a run"));
  CHECK(has(words, "at t = 0.001 s, step 10"));
  sim.run(0.001);
  CHECK(sim.step() == 20);
}

// Catches an error that does not say when, one that is of another type, and one that lost its own
// fields.
TEST_CASE("observers: their errors keep their type and say who threw at which time") {
  auto sim = scene();
  const auto nothing = [](const auto&) {};
  CHECK_THROWS_AS(sim.run(0.01, nothing, Watch{}), std::invalid_argument);
  auto again = scene();
  CHECK(refusal([&] { again.run(0.01, nothing, Watch{}); }) ==
        "odd; thrown by observer 2 of 2 'Watch' at t = 0.002 s, step 20");
  // The simulation goes on from where it was.
  again.run(0.001);
  CHECK(again.step() == 30);
  const auto lambda = [](auto& s) {
    if (s.step() == 10) s.set_velocity(7, {0, 0, 0});
  };
  auto third = scene();
  try {
    third.run(0.01, lambda);
    CHECK(false);
  } catch (const silt::InputError& e) {
    CHECK(has(e.what(), "there is no particle 7"));
    CHECK(has(e.what(), "; thrown by observer 1 of 1 at t = 0.001 s, step 10"));
  }
  auto fourth = scene();
  try {
    fourth.run(0.01, [](const auto& s) {
      throw silt::SimulationError("stop", s.step(), {0}, silt::Vec3d{1, 2, 3});
    });
    CHECK(false);
  } catch (const silt::SimulationError& e) {
    CHECK(has(e.what(), "stop; thrown by observer 1 of 1 at t = 0 s, step 0"));
    CHECK(e.particles == std::vector<std::uint64_t>{0});
    CHECK(e.position.z == 3);
  }
  // What silt does not know goes on as it is.
  auto fifth = scene();
  try {
    fifth.run(0.01, [](const auto&) { throw Mine(4); });
    CHECK(false);
  } catch (const Mine& e) {
    CHECK(e.number == 4);
    CHECK(std::string(e.what()) == "mine");
  }
  auto sixth = scene();
  CHECK_THROWS_AS(sixth.run(0.01, [](const auto&) { throw 5; }), int);
}

TEST_CASE("observers: what is told of contacts throws likewise") {
  auto sim = scene();
  sim.add_wall(silt::Plane{{0, 0, -1.05e-3}, {0, 0, 1}}, glass);
  CHECK(has(refusal([&] { sim.run(0.01, Impacts{}); }),
            "far; thrown by observer 1 of 1 'Impacts' at"));
}

}  // namespace observer_errors_test
