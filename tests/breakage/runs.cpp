// silt - BSD-3-Clause, see LICENSE
// Runs in which many grains break: books of mass and energy, threads, observers, restart, a burst.
#include <cmath>
#include <filesystem>
#include <vector>

#include <doctest/doctest.h>

#include <silt/breakage/selection.hpp>
#include <silt/io/checkpoint.hpp>
#include <silt/io/observers.hpp>

#include "breakage/scene.hpp"
#include "near.hpp"
#include "refusal.hpp"

namespace breakage_runs_test {

using namespace breakage_scene;  // NOLINT: of this test alone
using silt_test::has, silt_test::refusal;

std::vector<double> bits(const Sim& sim) {
  // Of the books what does not depend on which steps were observed.
  const auto e = sim.energy();
  std::vector<double> all{sim.time(),        static_cast<double>(sim.broken()),
                          sim.dust().mass(), sim.dust().number(),
                          e.parting,         e.breaking};
  add_particles(sim, all);
  return all;
}

TEST_CASE("breakage: the books of a shower of grains close, of mass and of energy") {
  // The error of the books falls with the square of the step, as without breakage.
  double last = 0;
  for (const double step : {1.2e-7, 0.6e-7}) {
    auto sim = shower(200);
    sim.time_step = step;
    std::size_t told = 0;
    double dust = 0;
    sim.run(1.2e-3, silt::on_break([&](const silt::BreakEvent& b) {
              ++told, dust += b.dust;
              CHECK(b.load >= b.strength);
              CHECK(b.cause != silt::BreakCause::Asked);
            }));
    CHECK(sim.broken() == told);
    CHECK(told > 40);
    CHECK(sim.size() > 300);
    CHECK(sim.dust().mass() == near(dust).epsilon(1e-12));
    const auto m = sim.mass_balance();
    CHECK(std::abs(m.residual()) < 1e-12 * m.fed);
    CHECK(m.dust > 0.01 * m.fed);
    const auto e = sim.energy();
    CHECK(e.breaking > 0);
    CHECK(e.parting > 0);
    CHECK(e.parting < 1e-2 * e.initial);
    const double share = std::abs(e.residual()) / e.initial;
    CHECK(share < 4e-4);  // 1.7e-4, then 4.5e-5 (computed)
    if (last > 0)
      CHECK(share < 0.5 * last);  // 0.27; first order would be 0.5, and other grains break
    last = share;
  }
}

#ifdef SILT_LONG_TESTS
TEST_CASE(
    "breakage: the same bits for any number of threads, with observers, and after a restart") {
  const auto run = [](int threads, bool observed) {
    auto sim = shower(120);
    sim.time_step = 1.5e-7, sim.threads = threads;
    std::size_t looked = 0;
    if (observed)
      sim.run(9e-4, silt::at<silt::ActionKind::Reads>(silt::every(3.1e-6),
                                                      [&](const auto&) { ++looked; }));
    else
      sim.run(9e-4);
    CHECK(sim.broken() > 30);
    return bits(sim);
  };
  const auto plain = run(1, false);
  CHECK(plain == run(3, false));
  CHECK(plain == run(2, true));

  const auto folder = std::filesystem::temp_directory_path() / "silt_breakage_restart";
  std::filesystem::create_directories(folder);
  const auto file = (folder / "run.silt").string();
  const auto with_a_fixed_one = [] {  // which cannot break
    auto sim = shower(120);
    silt::Particles<silt::Sphere> more;
    more.add({.position = {0.05, 0.05, 0.05}, .radius = 1e-3, .density = 2165, .fixed = true});
    sim.add(more);
    return sim;
  };
  auto first = with_a_fixed_one();
  first.time_step = 1.5e-7;
  // Saved while some are due to break before the next step.
  std::size_t due = 0, saved = 0;
  first.run(4e-4, silt::at<silt::ActionKind::Saves>(silt::every(1.5e-7), [&](const auto& s) {
              if (saved == 0 && s.time() > 2.5e-4 && s.breaks_due() > 0)
                due = s.breaks_due(), ++saved, silt::save_checkpoint(s, file);
            }));
  CHECK(due > 0);
  first.run(2e-4);
  auto second = with_a_fixed_one();
  second.time_step = 1.5e-7;
  silt::load_checkpoint(second, file);
  CHECK(second.breaks_due() == due);
  second.run(first.time() - second.time());
  CHECK(second.step() == first.step());
  CHECK(bits(second) == bits(first));

  auto other = shower(120, policy({.dust_below = 0.3e-3, .seed = 2}));
  has(refusal([&] { silt::load_checkpoint(other, file); }), "breakage: seed");
  auto weaker =
      shower(120, policy({.dust_below = 0.3e-3},
                         {.median = 7, .at_diameter = 2e-3, .exponent = 1.6, .spread = 3}));
  has(refusal([&] { silt::load_checkpoint(weaker, file); }), "the strength's");
  std::filesystem::remove_all(folder);
}
#endif

TEST_CASE("breakage: the share that breaks at a plate is the selection function") {
  constexpr std::size_t count = 2000;
  const double R = 1e-3;
  for (const double speed : {4.0, 7.0, 10.0}) {
    silt::Particles<silt::Sphere> feed;
    for (std::size_t k = 0; k < count; ++k)
      feed.add({.position = {0.01 * static_cast<double>(k % 50), 0.01 * static_cast<double>(k / 50),
                             1.001 * R},
                .radius = R,
                .density = 2165,
                .velocity = {0, 0, -speed}});
    // Few fragments, as they are not looked at.
    auto sim = simulation(std::move(feed), policy({.dust_below = 0.3e-3, .most_fragments = 4}));
    sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, salt);
    sim.time_step = 1.2e-7;
    std::size_t first_hits = 0;
    sim.run(2e-5, silt::on_break([&](const silt::BreakEvent& b) { first_hits += b.id < count; }));
    const double m = 2165 * silt::sphere_volume(R);
    const double E = 2e9 / (1 - 0.25 * 0.25) / 2;
    const double zeta = silt::damping_ratio(0.5, silt::DampingEnd::ZeroForce);
    const silt::Impact impact{
        .diameter = 2 * R,
        .mass = m,
        .speed = speed,
        .m_eff = m,
        .R_eff = R,
        .elastic_force = silt::hertz_max_elastic_force({E, R, m, speed, zeta}),
        .contact_force = NAN,
        .at_wall = true};
    const double expected = silt::selection(strong, silt::HertzEquivalence{}, impact);
    CHECK(expected > 0.05);
    CHECK(expected < 0.95);
    // Three standard deviations of the binomial law; the speed is within 1e-6 of its own.
    const double n = static_cast<double>(count);
    CHECK(std::abs(static_cast<double>(first_hits) - n * expected) <
          3 * std::sqrt(n * expected * (1 - expected)));
    // None of their fragments broke in the impact itself.
    CHECK(sim.broken() == first_hits);
  }
}

TEST_CASE("breakage: the mass balance knows grains that are added, removed and given other radii") {
  auto sim = shower(30);
  sim.time_step = 1e-7;
  sim.run(1e-6);
  sim.set_radius(3, 1.2e-3), sim.remove(4);
  silt::Particles<silt::Sphere> more;
  more.add({.position = {0.03, 0.03, 0.03}, .radius = 1e-3, .density = 2165});
  sim.add(more);
  sim.run(1e-6);
  const auto m = sim.mass_balance();
  CHECK(m.left > 0);
  CHECK(m.fed == near(m.present + m.left + m.dust).epsilon(1e-14));
}

#ifdef SILT_LONG_TESTS
TEST_CASE("breakage: ten thousand grains that burst in one step") {
  silt::Particles<silt::Sphere> feed;
  for (std::size_t k = 0; k < 10000; ++k)
    feed.add({.position = {2.1e-3 * static_cast<double>(k % 25),
                           2.1e-3 * static_cast<double>(k / 25 % 20),
                           1e-3 + 2.1e-3 * static_cast<double>(k / 500)},
              .radius = 1e-3,
              .density = 2165,
              .velocity = {0, 0, -1}});
  auto sim = simulation(std::move(feed), policy({.dust_below = 2e-4, .most_fragments = 24}));
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, salt);
  sim.threads = 2;
  sim.run(1e-7);
  for (silt::ParticleId id = 0; id < 10000; ++id) sim.break_particle(id);
  sim.run(sim.step_length());
  CHECK(sim.broken() == 10000);
  CHECK(sim.size() > 100000);
  const auto at_birth = sums_of(sim);
  sim.run(100 * sim.step_length());
  CHECK(sim.peak_overlap() < 0.3);
  const auto m = sim.mass_balance();
  CHECK(std::abs(m.residual()) < 1e-12 * m.fed);
  CHECK(sums_of(sim).kinetic < (1 + 1e-3) * at_birth.kinetic + sim.energy().parting);
}
#endif

}  // namespace breakage_runs_test
