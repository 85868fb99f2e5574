// silt - BSD-3-Clause, see LICENSE
// Showers whose time step follows the smallest grains that are there: threads, observers, restarts,
// books; a fluid of several steps of the particles.
#include <cmath>
#include <filesystem>
#include <vector>

#include <doctest/doctest.h>

#include <silt/fluid.hpp>
#include <silt/io/checkpoint.hpp>
#include <silt/io/observers.hpp>

#include "breakage/scene.hpp"
#include "near.hpp"
#include "refusal.hpp"

namespace breakage_step_runs_test {

using namespace breakage_scene;  // NOLINT: of this test alone
using silt_test::has, silt_test::refusal;

constexpr auto living = silt::BreakStep::SmallestLiving;

std::vector<double> bits(const Sim& sim) {
  const auto e = sim.energy();
  std::vector<double> all{sim.time(),        sim.step_length(), static_cast<double>(sim.broken()),
                          sim.dust().mass(), e.parting,         e.breaking};
  add_particles(sim, all);
  return all;
}
Sim shower_of_living(std::size_t count) {
  auto sim = shower(count, policy({.dust_below = 0.2e-3, .step = living}));
  sim.guard.max_overlap = 0.6;
  return sim;
}
/// Takes out the small ones now and then.
auto sieve() {
  return silt::at(silt::every(1e-4), [](Sim& sim) {
    std::vector<silt::ParticleId> small;
    for (std::size_t k = 0; k < sim.rows(); ++k)
      if (sim.is_present(k) && sim.radius(k) < 0.6e-3) small.push_back(sim.id(k));
    for (const silt::ParticleId id : small) sim.remove(id);
  });
}

TEST_CASE("step of the smallest living: the same bits for any threads, with observers, restarted") {
  const auto run = [](int threads, bool observed) {
    auto sim = shower_of_living(120);
    sim.threads = threads;
    if (observed)
      sim.run(9e-4, sieve(), [](const auto&) {});
    else
      sim.run(9e-4, sieve());
    CHECK(sim.broken() > 30);
    return bits(sim);
  };
  const auto plain = run(1, false);
  CHECK(plain == run(3, false));
  CHECK(plain == run(2, true));

  auto pieces = shower_of_living(120);
  auto sieved = sieve();
  for (int n = 0; n < 9; ++n) pieces.run((n + 1) * 1e-4 - pieces.time(), sieved);
  CHECK(bits(pieces) == plain);

  const auto folder = std::filesystem::temp_directory_path() / "silt_breakage_step";
  std::filesystem::create_directories(folder);
  const auto file = [&](std::size_t k) { return (folder / std::to_string(k)).string(); };
  // Saved in the step after which the step is the first fragments', in the middle, and right after
  // it has grown.
  auto first = shower_of_living(120);
  std::size_t saved = 0, shorter = 0, longer = 0;
  double last = 0;
  first.run(
      9e-4, sieve(), silt::at<silt::ActionKind::Saves>(silt::every(1e-9), [&](const auto& s) {
        shorter += last > 0 && s.step_length() < 0.9 * last;
        longer += last > 0 && s.step_length() > 1.1 * last;
        last = s.step_length();
        const bool now = saved == 0 ? s.broken() > 0 : saved == 1 ? s.time() > 3.3e-4 : longer > 0;
        if (saved < 3 && now) silt::save_checkpoint(s, file(saved++));
      }));
  CHECK(saved == 3);
  CHECK(shorter > 1);
  CHECK(longer > 1);
  CHECK(bits(first) == plain);
  for (std::size_t k = 0; k < saved; ++k) {
    auto second = shower_of_living(120);
    silt::load_checkpoint(second, file(k));
    second.run(9e-4 - second.time(), sieve());
    CHECK(second.step() == first.step());
    CHECK(bits(second) == plain);
  }
  auto other = shower(120, policy({.dust_below = 0.2e-3}));
  has(refusal([&] { silt::load_checkpoint(other, file(0)); }), "breakage: step");
  std::filesystem::remove_all(folder);
}

TEST_CASE("step of the smallest living: observers at their times, and books that close") {
  auto sim = shower_of_living(200);
  std::vector<double> at;
  double longest = 0, shortest = 1;
  const double interval = 7.3e-6;
  sim.run(1.2e-3, silt::at<silt::ActionKind::Reads>(silt::every(interval), [&](const auto& s) {
            at.push_back(s.time());
            longest = std::max(longest, s.step_length());
            shortest = std::min(shortest, s.step_length());
          }));
  CHECK(longest > 4 * shortest);
  // Catches times that are reckoned with the new step from the start on.
  CHECK(at.size() == static_cast<std::size_t>(1.2e-3 / interval) + 1);
  for (std::size_t k = 0; k < at.size(); ++k)
    CHECK(std::abs(at[k] - static_cast<double>(k) * interval) < 1.001 * longest);
  CHECK(sim.time() >= 1.2e-3 * (1 - 1e-12));
  CHECK(sim.time() < 1.2e-3 + longest);
  const auto m = sim.mass_balance();
  CHECK(std::abs(m.residual()) < 1e-12 * m.fed);
  const auto e = sim.energy();
  CHECK(std::abs(e.residual()) < 4e-4 * e.initial);  // 8.8e-5 (computed)
}

TEST_CASE(
    "step of the smallest living: a fluid that starts suddenly gives its impulse all the same") {
  // Catches a change of the step in the middle of a fluid's step that gives a part of what the
  // fluid has given once more, or not at all: the step changes twice here, as the grain is faster
  // and as fragments come. Virtual mass: (rho_p + rho/2) dv = 3/2 rho dU.
  const double U = 0.1, density = 2165;
  for (int after = 0; after < 8; ++after) {
    silt::FlowSolver flow(silt::Grid({{0, 0, 0}, {0.1, 0.1, 0.2}}, {5, 5, 10}, {true, true, false}),
                          {1000, 0}, {.tolerance = 1e-9});
    flow.set_side(2, 0, silt::Inflow{{0, 0, U}});
    flow.set_side(2, 1, silt::Outflow{});
    silt::Particles<silt::Sphere> grains;
    for (const double z : {0.05, 0.15})
      grains.add({.position = {0.05, 0.05, z}, .radius = 1.5e-3, .density = density});
    silt::CoupledFlow water{silt::Stokes{}, silt::Kernel{}, std::move(flow), silt::VirtualMass{}};
    water.steps = 7;
    silt::Simulation sim{
        std::move(grains), silt::Contacts<silt::HertzMindlin>{salt}, std::move(water),
        halving({.dust_below = 0.3e-3, .separation_speed = 0, .step = living})};  // no dust
    sim.gravity = {0, 0, -1e-9};
    sim.run(1e-9);
    const double step = sim.step_length();
    sim.run(after * step);
    sim.break_particle(1);
    sim.run(100 * step);
    CHECK(sim.step_length() < 0.5 * step);
    const double expected = U * 3 * 1000 / (2 * density + 1000);
    CHECK(sim.velocity(sim.find(0)).z == near(expected).epsilon(1e-4));  // 3e-5 (computed)
  }
}

// Catches dust whose place the fluid fills in one step: 1.4e6 Pa here.
TEST_CASE("a grain that becomes dust in a fluid does not make its pressure jump") {
  silt::FlowSolver flow(silt::Grid({{0, 0, 0}, {0.02, 0.02, 0.04}}, {4, 4, 8}, {true, true, false}),
                        {1000, 1e-3}, {.tolerance = 1e-9});
  flow.set_side(2, 0, silt::Inflow{{0, 0, 0.1}});
  flow.set_side(2, 1, silt::Outflow{});
  silt::Particles<silt::Sphere> grains;
  for (const double z : {0.01, 0.02})
    grains.add({.position = {0.01, 0.01, z}, .radius = 1.5e-3, .density = 2165});
  silt::CoupledFlow water{silt::Stokes{}, silt::Kernel{}, std::move(flow), silt::VirtualMass{}};
  water.steps = 7;
  silt::Simulation sim{std::move(grains), silt::Contacts<silt::HertzMindlin>{salt},
                       std::move(water), halving({.dust_below = 2.99e-3, .step = living})};
  sim.gravity = {0, 0, -1e-9};
  sim.run(1e-9);
  sim.run(100 * sim.step_length());
  const auto low = [&] { return sim.fluid().flow().pressure()(1, 2, 0); };
  const double before = low();
  sim.break_particle(1);
  double most = 0;  // [Pa]
  for (int k = 0; k < 50; ++k) {
    sim.run(sim.step_length());
    most = std::max(most, std::abs(low() - before));
  }
  CHECK(sim.size() == 1);
  // What is left: the changed fluxes around the place, 118 Pa here (computed).
  CHECK(most < 300);
}

TEST_CASE(
    "step of the smallest living, tables of materials: numbers of a checkpoint that cannot be") {
  using silt::detail::LivingSizes;
  constexpr double inf = INFINITY;
  CHECK(LivingSizes::can_be({}));
  CHECK(LivingSizes::can_be({0, 3, 0, 1e-9, 1e-15, 1e-3, inf, inf, inf}));
  CHECK(!LivingSizes::can_be({0, 3}));
  CHECK(!LivingSizes::can_be({inf, 3, 0}));
  CHECK(!LivingSizes::can_be({-1e-7, 3, 0}));
  CHECK(!LivingSizes::can_be({0, 3, 0, 1e-9, -1, 1e-3}));
  silt::SizeTables tables;
  tables.add<true>(2, [](silt::SizeTable& t) { t.add(1e-3, 1e-6, 1, 0); });
  auto numbers = tables.state_of_materials();
  silt::SizeTables again;
  again.restore_of_materials(numbers);
  CHECK(again.of.size() == 3);
  CHECK(again.of_material(2).mass() == 1e-6);
  CHECK(again.of_material(7).mass() == 0);
  for (const double count : {-1.0, 1e9, std::nan("")}) {
    auto bad = numbers;
    bad[0] = count;
    has(refusal([&] { silt::SizeTables().restore_of_materials(bad); }), "SizeTable");
  }
  numbers.pop_back();
  has(refusal([&] { silt::SizeTables().restore_of_materials(numbers); }), "SizeTables: the state");
}

}  // namespace breakage_step_runs_test
