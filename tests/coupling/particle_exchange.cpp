// silt - BSD-3-Clause, see LICENSE

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include <doctest/doctest.h>

#include <silt/coupling/drag/laws.hpp>
#include <silt/coupling/particle_exchange.hpp>

#include "near.hpp"

namespace particle_exchange_test {

using silt::CoupledParticles;
using silt::MomentumModel;
using silt::ParticleExchange;
using silt::Team;
using silt::Vec3d;

namespace {

constexpr double d = 1e-3, density = 2500, rho = 1.2, mu = 1.8e-5;
const double V = std::numbers::pi / 6 * d * d * d, m = density * V;

/// Two particles in a fluid without a mesh.
struct Scene {
  std::vector<Vec3d> position{{0, 0, 0}, {1, 0, 0}}, velocity{{0, 0, 0.5}, {0.1, 0, 0}},
      acceleration{{0, 0, 0}, {0, 0, 0}};
  std::vector<double> radius{d / 2, d / 2}, volume{V, V}, mass{m, m};
  std::vector<Vec3d> force{2};

  CoupledParticles view() const {
    return {{position, radius}, velocity, volume, mass, acceleration};
  }
};

template <class Exchange>
void fill(Exchange& exchange, const Vec3d& u, const Vec3d& slope, double voidage) {
  auto& at = exchange.at;
  at.voidage.assign(2, voidage);
  const double of_u[3] = {u.x, u.y, u.z}, of_slope[3] = {slope.x, slope.y, slope.z};
  for (std::size_t k = 0; k < 3; ++k)
    at.velocity[k].assign(2, of_u[k]), at.slope[k].assign(2, of_slope[k]),
        at.stress[k].assign(2, 0);
}

}  // namespace

TEST_CASE("particle_exchange: drag follows its exponential and the fluid gets the opposite") {
  // Catches a coefficient without the exponential (24 % off at X = 0.5), and a fluid that is given
  // another force than the particles, or that of one of them alone.
  Scene s;
  ParticleExchange exchange{silt::Stokes{}};
  exchange.settings.fluid = {rho, mu};
  const Vec3d u{0.3, 0, -0.2};
  fill(exchange, u, {0, 0, 0}, 1);
  const double K = 3 * std::numbers::pi * mu * d, dt = 0.5 * m / K;
  exchange.check(s.view(), 2, 0);
  exchange.find(s.view(), dt, {}, Team{});
  exchange.give(s.view(), dt, true);
  const auto done = exchange.take(s.view(), dt, s.force);
  Vec3d by_fluid{0, 0, 0};
  for (std::size_t p = 0; p < 2; ++p) {
    const Vec3d exact = (m / dt * (1 - std::exp(-0.5))) * (u - s.velocity[p]);
    CHECK(norm(s.force[p] - exact) < 1e-12 * norm(exact));
    by_fluid += exchange.given.coefficient[p] * u - silt::vector_of(exchange.given.offset, p);
  }
  CHECK(norm(by_fluid - done.on_particles) < 1e-12 * done.magnitudes);
  CHECK(norm(done.on_particles - s.force[0] - s.force[1]) < 1e-12 * done.magnitudes);
}

TEST_CASE("particle_exchange: a fixed particle bears pressure in model A, drag over voidage in B") {
  // Catches a pressure of the wrong sign, twice or not at all, and B with the drag of A.
  Scene s;
  s.mass = {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  s.velocity = {{0, 0, 0}, {0, 0, 0}};
  const auto force = [&](MomentumModel model) {
    ParticleExchange exchange{silt::Stokes{}};
    exchange.settings = {{rho, mu}, model, {0, 0, -9.81}};
    fill(exchange, {0, 0, 0.1}, {0, 0, -50}, 0.6);
    exchange.find(s.view(), 1e-3, {}, Team{});
    exchange.give(s.view(), 1e-3, true);
    exchange.take(s.view(), 1e-3, s.force);
    return s.force[0].z;
  };
  const double K = silt::drag_coefficient(silt::Stokes{}, 0.6, 0.0, d, mu);
  CHECK(near_relative(force(MomentumModel::A), 0.1 * K + V * (50 + rho * 9.81), 1e-12));
  CHECK(near_relative(force(MomentumModel::B), 0.1 * K / 0.6 + V * rho * 9.81, 1e-12));
}

TEST_CASE("particle_exchange: where there is no fluid nothing acts") {
  // Catches buoyancy or drag on particles beyond the fluid.
  Scene s;
  ParticleExchange exchange{silt::Stokes{}};
  exchange.settings = {{rho, mu}, MomentumModel::A, {0, 0, -9.81}};
  fill(exchange, {0, 0, 1}, {0, 0, -50}, 1);
  exchange.at.voidage[1] = 0;
  exchange.find(s.view(), 1e-3, {}, Team{});
  exchange.give(s.view(), 1e-3, true);
  exchange.take(s.view(), 1e-3, s.force);
  CHECK(norm(s.force[1]) == 0);
  CHECK(exchange.given.coefficient[1] == 0);
  CHECK(norm(s.force[0]) > 0);
}

TEST_CASE("particle_exchange: particles so light that no explicit step is stable are known") {
  // Catches a gain that does not know the crowd or the added pressure: light ones pass unseen.
  Scene s;
  const auto gain = [&](double of_density, double voidage) {
    s.mass = {of_density * V, of_density * V};
    ParticleExchange exchange{silt::Stokes{}};
    exchange.settings.fluid = {1000, 1e-3};
    fill(exchange, {0, 0, 0}, {0, 0, 0}, voidage);
    exchange.find(s.view(), 1e-6, {}, Team{});
    return exchange.gain();
  };
  CHECK(near_relative(gain(500, 0.5), 2, 1e-2));  // (1 - eps)/eps rho/rho_p
  CHECK(near_relative(gain(8000, 0.5), 0.125, 1e-2));
  CHECK(gain(500, 0.99) < 0.05);
}

TEST_CASE("particle_exchange: spans that do not fit are refused") {
  Scene s;
  ParticleExchange exchange{silt::Stokes{}};
  CHECK_THROWS_AS(exchange.check(s.view(), 1, 0), silt::InputError);
  s.mass.pop_back();
  CHECK_THROWS_AS(exchange.check(s.view(), 2, 0), silt::InputError);
}

}  // namespace particle_exchange_test
