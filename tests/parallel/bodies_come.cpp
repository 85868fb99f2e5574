// silt - BSD-3-Clause, see LICENSE
//
// Bodies on many ranks: those that come and leave, fixed ones, several materials.
#include <silt/shape/multi_sphere.hpp>

#include "body_scenes.hpp"
#include "near.hpp"

namespace parallel_bodies_come_test {

namespace {

using silt_test::Seen;
using Shape = silt::MultiSphere;
using Grains = silt::Particles<Shape>;

/// Two forms; every seventh body is fixed, every second of another material.
Grains grains(std::array<int, 3> n, double lift = 0) {
  const auto forms = [](auto& all) {
    all.add_form(Shape{{{{-0.6e-3, 0, 0}, 1e-3}, {{0.5e-3, 0.1e-3, 0}, 0.8e-3}}});
    all.add_form(Shape{{{{0, 0, 0}, 1e-3}, {{0.9e-3, 0, 0}, 0.8e-3}, {{0, 0, 0.9e-3}, 0.8e-3}}});
    return std::size_t{2};
  };
  const auto plain = silt_test::bodies<Shape>(n, 6.1e-3, forms, 0.4);
  Grains all;
  forms(all);
  std::size_t k = 0;
  for (auto p : plain.all()) {
    p.position.z += lift, p.material = k % 2, p.fixed = k % 7 == 3;
    if (p.fixed) p.velocity = p.angular_velocity = {0, 0, 0};
    all.add(p), ++k;
  }
  return all;
}

template <class... Policies>
auto scene(Grains all, Policies... policies) {
  auto soft = silt_test::stone;
  soft.youngs_modulus = 2e6;
  silt::Contacts<silt_test::BodyLaw, silt::SeveralMaterials> contacts{{silt_test::stone, soft}};
  contacts.set_pair(silt_test::stone, soft, {.restitution = 0.4, .friction = 0.2});
  silt::Simulation sim{std::move(all), std::move(contacts), silt::VerletList<>{.skin = 0.3e-3},
                       std::move(policies)...};
  sim.gravity = {4, 0, -30};
  sim.threads = 1;
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, soft);
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 1, 0}}, silt_test::stone);
  sim.add_wall(silt::Plane{{0, 0.0122, 0}, {0, -1, 0}}, silt_test::stone);
  return sim;
}
auto ranks(const silt::ThreadComm& comm) {
  return silt_test::wandering(comm, silt_test::slide_length);
}

// Catches: rows of parts or bodies in another order than the other's after some have come before
// the ghosts; ids of parts given twice; velocities of the observed state at other bodies; an inlet
// that draws other places on each rank.
TEST_CASE("ranks: bodies that come and leave, fixed ones and two materials are as in one process") {
  const auto run = [](Seen& seen, const auto& look, auto... policies) {
    auto sim = scene(grains({6, 2, 1}), policies...);
    sim.add_inlet(silt::Box{{0.003, 0.003, 0.012}, {0.034, 0.0092, 0.02}},
                  {.radius = silt::uniform(0.0022, 0.003),
                   .density = 2500,
                   .rate = 1500,
                   .velocity = {0, 0, -0.5},
                   .form = 1});
    sim.add_outlet({{0.0305, -1, -1}, {0.3, 1, 1}});
    sim.run(0.01);
    sim.add(grains({4, 2, 1}, 0.022));
    CHECK(sim.size() == 12 + 8 + sim.inlet(0).placed - sim.outlet(0).count);
    sim.run(0.02, silt::at(silt::every(1e-3), [&](const auto& s) { look(s); }));
    CHECK(sim.size() == 12 + 8 + sim.inlet(0).placed - sim.outlet(0).count);
    seen.add(sim);
    return std::array{static_cast<double>(sim.inlet(0).placed), sim.inlet(0).mass,
                      static_cast<double>(sim.outlet(0).count), sim.outlet(0).mass};
  };
  Seen one;
  const auto books = run(one, [](const auto&) {});
  CHECK(books[0] > 5);
  CHECK(books[2] > 1);
  for (const int n : {2, 3}) {
    CAPTURE(n);
    Seen many;
    silt_test::Copies copies;
    silt::run_on_ranks(n, [&](const silt::ThreadComm& comm) {
      const auto of_rank = run(
          many, [&](const auto& s) { copies.add(s); }, ranks(comm));
      for (std::size_t k = 0; k < 4; ++k) CHECK(of_rank[k] == near(books[k]).epsilon(1e-12));
    });
    copies.compare();
    const auto off = many.off(one);
#ifdef SILT_TEST_TELLS
    std::printf("come, ranks %d: off %.3g m, %.3g m/s of %zu; in %g, out %g; copies %zu\n", n,
                off[0], off[1], one.all.size(), books[0], books[2], copies.pairs);
#endif
    CHECK(off[0] < 1e-12);
    CHECK(off[1] < 1e-10);
    CHECK(copies.pairs > 3);
    CHECK(copies.unlike + copies.alone + copies.ghost_pairs == 0);
  }
}

TEST_CASE("ranks: bodies by Bisection, which tells by a place who has them, are those of one") {
  const auto run = [](Seen& seen, auto... policies) {
    auto sim = scene(grains({6, 2, 2}), policies...);
    sim.run(0.01);
    sim.add(grains({4, 2, 1}, 0.03));
    sim.run(0.01);
    seen.add(sim);
  };
  Seen one, many;
  run(one);
  silt::run_on_ranks(4, [&](const silt::ThreadComm& comm) {
    run(many, silt::Ranks{comm, silt::Bisection{}});
  });
  CHECK(many.off(one)[0] < 1e-12);
}

TEST_CASE("ranks: more ranks than bodies, and ranks without any") {
  const auto run = [](Seen& seen, auto... policies) {
    auto sim = scene(grains({2, 1, 1}), policies...);
    sim.run(0.02);
    seen.add(sim);
  };
  Seen one, many;
  run(one);
  silt::run_on_ranks(5, [&](const silt::ThreadComm& comm) { run(many, ranks(comm)); });
  CHECK(many.off(one)[0] < 1e-13);
}

}  // namespace

}  // namespace parallel_bodies_come_test
