// silt - BSD-3-Clause, see LICENSE
#include <cmath>
#include <filesystem>
#include <numbers>
#include <string>
#include <utility>

#include <doctest/doctest.h>

#include <silt/coupling/unsteady/history_force.hpp>
#include <silt/fluid.hpp>

#include "near.hpp"

namespace history_force_test {

using silt::HistoryForce;
using silt::Particles;
using silt::Sphere;
using silt::Vec3d;

namespace {

constexpr double pi = std::numbers::pi;

/// Spheres in a liquid whose cells are so large that it does not move.
auto in_liquid(Particles<Sphere> spheres, double step, std::size_t window = 30, int threads = 1) {
  const double width = 1;
  silt::FlowSolver flow(
      silt::Grid({{0, 0, 0}, {width, width, width}}, {3, 3, 3}, {true, true, true}), {1000, 1e-2});
  silt::CoupledFlow fluid{silt::Stokes{},
                          silt::Unresolved{.share = silt::Unresolved::Share::Centre}, flow,
                          HistoryForce{window}, silt::VirtualMass{}};
  fluid.steps = 1;
  silt::Simulation sim{std::move(spheres), silt::Contacts<silt::HertzMindlin>{{1e6, 0.3, 0.8, 0.3}},
                       fluid};
  sim.time_step = step;
  sim.threads = threads;
  sim.guard.max_time_step = 1e9;  // they meet nobody
  return sim;
}

/// Velocity over its last one, of a sphere released from rest in Stokes flow with virtual mass and
/// Basset's force; t in units of d^2/nu. Exact: J. Boussinesq (1885), A. B. Basset (1888), with
/// M s + C sqrt(pi s) + K = M (sqrt s + p)(sqrt s + q); real p, q for densities up to 0.625.
double exact_falling(double density, double t) {
  const double M = (density + 0.5) * pi / 6, K = 3 * pi, c = 1.5 * pi;
  const double root = std::sqrt(c * c - 4 * M * K), p = (c + root) / (2 * M),
               q = (c - root) / (2 * M);
  const auto w = [](double z) {
    if (z > 20)  // 1e-9
      return (1 - 0.5 / (z * z) * (1 - 1.5 / (z * z))) / (z * std::sqrt(pi));
    return std::exp(z * z) * std::erfc(z);
  };
  return 1 - (q * w(p * std::sqrt(t)) - p * w(q * std::sqrt(t))) / (q - p);
}

}  // namespace

TEST_CASE("history_force: a sphere released from rest in a Simulation follows the exact solution") {
  const double d = 1e-3, nu = 1e-5, g = 1e-3, unit = d * d / nu;
  const auto error = [&](double density, double t, int steps, std::size_t window) {
    Particles<Sphere> one;
    one.add({.position = {0.5, 0.5, 0.5}, .radius = d / 2, .density = 1000 * density});
    auto sim = in_liquid(std::move(one), t * unit / steps, window);
    sim.gravity = {0, 0, -g};
    sim.run(t * unit);
    const double last = (1 - density) * g * d * d / (18 * nu);
    return std::abs(sim.velocity(0).z / last - exact_falling(density, t));
  };
  // Within the window and far beyond it; drag, virtual mass and history from the first step on.
  for (const double density : {0.05, 0.3})
    for (const double t : {0.1, 1.0, 10.0}) {
      CAPTURE(density);
      CAPTURE(t);
      CHECK(error(density, t, 200, 30) < 1e-3);
    }
  // All in the window: no error of the tail, and first order in the step at the least.
  const double coarse = error(0.3, 1, 100, 100), fine = error(0.3, 1, 400, 400);
  CHECK(fine < 0.3 * coarse);
}

TEST_CASE(
    "history_force: what each particle remembers does not depend on places, threads or files") {
  // Many spheres, which get other places as they are sorted, and some of which leave.
  const std::string path = (std::filesystem::temp_directory_path() / "silt_history.silt").string();
  const auto make = [](int threads) {
    Particles<Sphere> many;
    for (int k = 0; k < 300; ++k)
      many.add(
          {.position = {0.1 + 0.8 * (k * 7 % 300) / 300, 0.5, 0.1 + 0.8 * (k * 53 % 300) / 300},
           .radius = 5e-4,
           .density = 300,
           .velocity = {1e-3 * std::sin(k), 0, 2e-3 * std::cos(k)}});
    auto sim = in_liquid(std::move(many), 1e-3, 30, threads);
    sim.gravity = {0, 0, -1e-3};
    sim.add_outlet({{0, 0, 0}, {0.3, 1, 1}});
    return sim;
  };
  auto whole = make(1);
  whole.run(0.02);
  silt::save_checkpoint(whole, path);
  whole.run(0.04);
  auto second = make(3);
  silt::load_checkpoint(second, path);
  second.run(0.04);
  REQUIRE(second.size() == whole.size());
  CHECK(whole.size() < 300);
  for (std::size_t k = 0; k < whole.rows(); ++k) {
    if (!whole.is_present(k)) continue;
    const std::size_t other = second.find(whole.id(k));
    REQUIRE(other < second.rows());
    CHECK(norm(whole.velocity(k) - second.velocity(other)) == 0);
    CHECK(norm(whole.fluid_force(k) - second.fluid_force(other)) == 0);
  }
  // Another step would need another memory.
  second.fluid().steps = 2;
  CHECK_THROWS_AS(second.run(0.01), silt::InputError);
  std::filesystem::remove(path);
}

TEST_CASE("history_force: places in the history follow the ids") {
  // Two orders of the same particles, one of which comes late and one of which leaves.
  const silt::Team team;
  HistoryForce a(4), b(4);
  const auto force = [](const HistoryForce& of, std::size_t place) {
    silt::InFluid at{};
    at.density = 1, at.viscosity = 1, at.diameter = 1, at.place = place;
    return of.force_on(at).x;
  };
  const auto slip = [](silt::ParticleId id, int n) {
    return Vec3d{std::sin(0.3 * n + id) + 2 * id, 0, 0};
  };
  for (std::uint32_t n = 0; n < 12; ++n) {
    std::vector<silt::ParticleId> ids{3, 1};
    if (n > 2) ids.push_back(7);
    if (n > 6) ids.erase(ids.begin());
    std::vector<silt::ParticleId> turned(ids.rbegin(), ids.rend());
    const auto tell = [&](HistoryForce& f, const std::vector<silt::ParticleId>& of) {
      std::vector<Vec3d> slips;
      for (const auto id : of) slips.push_back(slip(id, int(n)));
      f.remember(of, slips, 0.1, team);
    };
    tell(a, ids), tell(b, turned);
    for (std::size_t k = 0; k < ids.size(); ++k) CHECK(force(a, k) == force(b, ids.size() - 1 - k));
  }
  CHECK_THROWS_AS(HistoryForce(0), silt::InputError);
  // The mean over the first step of W(0)/sqrt(t) is 2 W/sqrt(dt), later 2 (sqrt(k) - sqrt(k - 1)).
  HistoryForce jump(4);
  const std::vector<silt::ParticleId> one{0};
  const std::vector<Vec3d> held{{1, 0, 0}};
  for (int k = 1; k <= 12; ++k) {
    jump.remember(one, held, 0.1, team);
    const double exact =
        1.5 * std::sqrt(pi) * 2 * (std::sqrt(k) - std::sqrt(k - 1)) / std::sqrt(0.1);
    CHECK(force(jump, 0) == near(exact).epsilon(k <= 4 ? 1e-12 : 2e-3));
  }
}

}  // namespace history_force_test
