// silt - BSD-3-Clause, see LICENSE
// Checkpoints of bodies, and of the books of energy, that go on on another number of ranks; changes
// of single bodies.
#include <silt/shape/multi_sphere.hpp>
#include <silt/shape/super_ellipsoid.hpp>

#include <bit>

#include <silt/io/checkpoint.hpp>
#include <silt/module/field.hpp>

#include "body_scenes.hpp"

namespace parallel_body_restart_test {

namespace {

using silt_test::Seen;
constexpr std::size_t terms = sizeof(silt::EnergyBalance) / sizeof(double);
using Numbers = std::array<double, terms + 1>;  // energy, and the sum of the fields

/// How many ranks; 0: without Ranks.
template <class Scene, class Use>
void on(int ranks, const Scene& scene, const Use& use) {
  if (ranks == 0) {
    auto sim = scene(silt::EnergyLedger{});
    return use(sim);
  }
  silt::run_on_ranks(
      ranks,
      [&](const silt::ThreadComm& comm) {
        auto sim = scene(silt::EnergyLedger{}, silt_test::wandering(comm, silt_test::slide_length));
        use(sim);
      },
      30);
}
template <class Sim>
Numbers numbers_of(const Sim& sim) {
  Numbers all{};
  const auto energy = std::bit_cast<std::array<double, terms>>(sim.energy());
  std::copy(energy.begin(), energy.end(), all.begin());
  for (std::size_t k = 0; k < sim.rows(); ++k)
    if (sim.is_present(k))
      all[terms] += sim.template field<"age">(k) * static_cast<double>(sim.id(k));
  all[terms] = sim.sum_over_ranks(all[terms]);
  return all;
}

/// Goes on from files of 3 ranks and of one process, on other numbers of both.
template <class Shape, class AddForms>
void check_restart(const AddForms& forms, double half, double limit) {
  const silt_test::Folder folder;
  const auto scene = [&](auto... policies) {
    return silt_test::slide<Shape>(forms, silt::Field<"age">{}, policies...);
  };
  Seen expected;
  Numbers numbers{};
  double turned_over = 0;
  on(0, scene, [&](auto& sim) {
    for (std::size_t k = 0; k < sim.rows(); ++k)
      sim.template field<"age">(k) = 1 + static_cast<double>(sim.id(k));
    sim.run(half);
    CHECK(sim.touching_pairs() > 3);
    CHECK(sim.energy().tangential > 1e-7 * sim.energy().turned_over);  // contacts remember
    save_checkpoint(sim, folder / "one.silt");
    sim.run(half / 4);
    expected.add(sim), numbers = numbers_of(sim), turned_over = sim.energy().turned_over;
  });
  on(3, scene, [&](auto& sim) {
    for (std::size_t k = 0; k < sim.rows(); ++k)
      sim.template field<"age">(k) = 1 + static_cast<double>(sim.id(k));
    sim.run(half);
    save_checkpoint(sim, folder / "three.silt");
  });
  for (const std::string from : {"one.silt", "three.silt"})
    for (const int n : {0, 1, 2, 5}) {
      if (n == 0 && from == "one.silt") continue;
      CAPTURE(from);
      CAPTURE(n);
      Seen seen;
      Numbers got{};
      on(n, scene, [&](auto& sim) {
        load_checkpoint(sim, folder / from);
        CHECK(sim.size() == 24);
        sim.run(half / 4);
        CHECK(sim.size() == 24);
        seen.add(sim);
        const auto of_rank = numbers_of(sim);
        if (sim.rank() == 0) got = of_rank;
      });
      const auto [place, velocity] = seen.off(expected);
      CHECK(place < limit);
      CHECK(velocity < 100 * limit);
      for (std::size_t k = 0; k < terms; ++k) {
        CAPTURE(k);
        CHECK(std::abs(got[k] - numbers[k]) < 1e-8 * turned_over);
      }
      CHECK(got[terms] == numbers[terms]);  // whole numbers
    }
}

// Catches: contacts that forget, parts at other bodies, fields of others, books that are summed
// twice or left behind. What a contact remembers is some 1e-2 of the motion.
const auto grains = [](auto& all) {
  using Shape = silt::MultiSphere;
  all.add_form(Shape{{{{-0.6e-3, 0, 0}, 1e-3}, {{0.5e-3, 0.1e-3, 0}, 0.8e-3}}});
  all.add_form(Shape{{{{0, 0, 0}, 1e-3}, {{0.9e-3, 0, 0}, 0.8e-3}, {{0, 0.9e-3, 0}, 0.8e-3}}});
  return std::size_t{2};
};
TEST_CASE("ranks: multi-spheres and their books go on on other numbers of ranks") {
  check_restart<silt::MultiSphere>(grains, 0.02, 1e-12);
}

// Catches: parts of a body that stay on another rank, or keep their size there.
TEST_CASE("ranks: bodies that are removed, thrown and grow are those of one process") {
  const auto scene = [&](auto... policies) {
    return silt_test::slide<silt::MultiSphere>(grains, silt::Field<"age">{}, policies...);
  };
  const auto edit = silt::at(silt::every(0.004), [](auto& sim) {
    sim.set_velocity(5, {0.2, 0, 0.3}), sim.set_angular_velocity(9, {50, 0, 20});
    for (std::size_t k = 0; k < sim.rows(); ++k)
      if (sim.is_present(k) && sim.id(k) % 3 == 1) sim.set_radius(sim.id(k), 1.005 * sim.radius(k));
    for (std::size_t k = 0; k < sim.rows(); ++k)
      if (sim.is_present(k) && sim.time() > 0.011 && sim.id(k) % 6 == 2) sim.remove(sim.id(k));
  });
  Seen one;
  on(0, scene, [&](auto& sim) {
    auto own = edit;
    sim.run(0.02, own), one.add(sim);
    CHECK(sim.size() == 20);
  });
  for (const int n : {2, 3}) {
    Seen many;
    on(n, scene, [&](auto& sim) {
      auto own = edit;
      sim.run(0.02, own), many.add(sim);
      CHECK(sim.size() == 20);
    });
    CHECK(many.off(one)[0] < 1e-12);
    CHECK(many.off(one)[1] < 1e-10);
  }
}

TEST_CASE("ranks: super-ellipsoids, whose contacts remember their gap, go on likewise") {
  using Shape = silt::SuperEllipsoid;
  check_restart<Shape>(
      [](auto& all) {
        all.add_form(Shape{.a = 1e-3, .b = 0.9e-3, .c = 0.6e-3, .s1 = 4, .s2 = 4});
        return std::size_t{1};
      },
      0.02, 1e-12);
}

}  // namespace

}  // namespace parallel_body_restart_test
