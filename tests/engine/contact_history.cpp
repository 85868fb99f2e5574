// silt - BSD-3-Clause, see LICENSE
// The history of a contact lives as long as the contact: searching, pruning and sorting anew, and
// particles that come and go elsewhere, change nothing but the order of sums.
#include <set>

#include <boundary/support.hpp>
#include <engine/support.hpp>

#include <silt/contact/rolling/epsd.hpp>

namespace contact_history_test {

namespace {

using namespace engine_test;

/// Counts the searches of a run.
struct Searches {
  std::set<std::int64_t>* steps;
  template <class Sim>
  void operator()(const Sim& sim) const {
    steps->insert(sim.engine().lists.upkeep.searched_at);
  }
};

/// A pile that is sheared: layers of spheres in a box whose floor moves to and fro, and a slab of
/// triangles that presses from above; all its contacts stick, roll or slide.
auto pile(const silt::VerletList<>& search) {
  silt::Particles<Sphere> p;
  for (int k = 0; k < 48; ++k)
    p.add({.position = {1.99e-3 * (k % 4) + 1e-3 + 3e-4 * (k / 16), 1.99e-3 * (k / 4 % 4) + 1e-3,
                        1e-3 + 1.95e-3 * (k / 16)},
           .radius = 1e-3 * (1 - 2e-4 * k),
           .density = 2500});
  silt::Simulation sim{
      std::move(p),
      silt::Contacts<HertzMindlin, silt::RollingEpsd>{rubber, {.rolling_friction = 0.05}}, search};
  sim.gravity = {0, 0, -9.81};
  sim.time_step = 5e-6;
  sim.threads = 1;
  sim.add_wall(silt::box({0, 0, -1}, {8.55e-3, 7.96e-3, 1}), rubber);
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, rubber, silt::vibration({3e-4, 2e-4, 0}, 50));
  sim.add_wall(
      silt::TriangleMesh(boundary_test::box_soup({-1e-2, -1e-2, 5.88e-3}, {2e-2, 2e-2, 7e-3})),
      rubber, silt::vibration({0, 3e-4, 0}, 70));
  return sim;
}

constexpr double duration = 0.01;  // [s] 2000 steps

/// The largest difference of position [m], velocity times 1 ms [m] and surface speed times 1 ms [m]
/// of particles 0 ... 47.
double difference(const std::vector<ParticleBits>& a, const std::vector<ParticleBits>& b) {
  double most = 0;
  for (std::size_t k = 0; k < 48; ++k) {
    REQUIRE(a[k].id == k);
    REQUIRE(b[k].id == k);
    for (std::size_t n = 0; n < 9; ++n) {
      const double scale = n < 3 ? 1 : n < 6 ? 1e-3 : 1e-6;
      most = std::max(most, scale * std::abs(a[k].values[n] - b[k].values[n]));
    }
  }
  return most;
}

// Only the order of sums differs: 1e-16 of a force each step, 1e-18 m in the end as these contacts
// stick and damp and do not let it grow. A history that is lost once shows at 1e-5 m (the last
// test).
constexpr double round_off = 1e-15;  // [m]

}  // namespace

TEST_CASE("contact_history: a run that searches all the time agrees with one that searches once") {
  std::set<std::int64_t> steps;
  auto once = pile({.skin = 0.05, .sort = false});
  once.run(duration, Searches{&steps});
  CHECK(steps.size() == 1);
  const auto expected = bits(once);
  CHECK(once.touching_pairs() > 60);
  for (const double skin : {1e-7, 1e-5, 3e-4})
    for (const bool sort : {false, true}) {
      CAPTURE(skin);
      CAPTURE(sort);
      steps.clear();
      auto often = pile({.skin = skin, .sort = sort});
      often.run(duration, Searches{&steps});
      CHECK(steps.size() > (skin < 1e-6 ? 1900 : skin < 1e-4 ? 100 : 1));
      CHECK(difference(bits(often), expected) < round_off);
    }
  auto automatic = pile({});
  automatic.run(duration);
  CHECK(difference(bits(automatic), expected) < round_off);
}

TEST_CASE("contact_history: particles that come, go and pass elsewhere change no contact") {
  auto alone = pile({.skin = 0.05, .sort = false});
  alone.run(duration);
  for (const bool sort : {false, true}) {
    CAPTURE(sort);
    auto busy = pile({.skin = 2e-4, .sort = sort});
    busy.add_inlet(Box{{1e-3, 1e-3, 0.1}, {7e-3, 7e-3, 0.11}},
                   {.radius = 0.5e-3, .density = 2500, .rate = 2000, .velocity = {0, 0, 3}});
    busy.add_outlet({{0, 0, 0.115}, {1, 1, 0.2}});
    silt::Particles<Sphere> stranger;
    stranger.add({.position = {4e-3, 4e-3, 0.5}, .radius = 0.5e-3, .density = 2500});
    for (int part = 0; part < 5; ++part) {
      busy.run(duration / 5);
      if (part < 4) busy.add(stranger);
      stranger[0].position.z += 0.01;
    }
    CHECK(busy.outlet(0).count > 5);
    CHECK(difference(bits(busy), bits(alone)) < round_off);
  }
}

TEST_CASE("contact_history: it matters in this scene, so that the cases above can fail") {
  auto with = pile({.skin = 0.05, .sort = false}), without = pile({.skin = 0.05, .sort = false});
  with.run(duration / 2), without.run(duration / 2);
  for (int h = 0; h < 6; ++h) {
    auto& pairs = without.engine().lists.pairs;
    std::fill_n(pairs.history(h), pairs.padded_size(), 0.0);
  }
  with.run(duration / 2), without.run(duration / 2);
  CHECK(difference(bits(with), bits(without)) > 1e-6);
}

// A slice that is left out, counted twice or named after another's numbers.
TEST_CASE("contact_history: each number that a contact keeps has a name") {
  const auto words = [](const auto& sim) {
    using Engine = std::remove_cvref_t<decltype(sim.engine())>;
    static_assert(Engine::memory.is_whole());
    return Engine::memory.words();
  };
  CHECK(words(pile({})) == "3 of law, 3 of rolling");  // as the case above wipes out all six
  const silt::Contacts<HertzMindlin> contacts{rubber};
  CHECK(words(silt::Simulation{silt::Particles<Sphere>{}, contacts, silt::EnergyLedger{}}) ==
        "3 of law, 4 of ledger");
  CHECK(words(silt::Simulation{silt::Particles<silt::Polyhedron>{}, contacts,
                               silt::ContactEvents{}}) ==
        "3 of law, 4 of normal, 3 of law at point 2, 3 of law at point 3, 9 of area, 1 of "
        "radius, 13 of events");
  using Engine = std::remove_cvref_t<decltype(pile({}).engine())>;
  CHECK(Engine::memory.name_of(2) == "law[2]");
  CHECK(Engine::memory.name_of(3) == "rolling[0]");
}

}  // namespace contact_history_test
