// silt - BSD-3-Clause, see LICENSE

#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <doctest/doctest.h>

#include <silt/core/random.hpp>
#include <silt/coupling/averaging/diffusion.hpp>
#include <silt/coupling/averaging/kernel.hpp>
#include <silt/coupling/averaging/two_grid.hpp>
#include <silt/coupling/averaging/unresolved.hpp>
#include <silt/coupling/coupled_flow.hpp>
#include <silt/coupling/drag/laws.hpp>
#include <silt/coupling/drag/oriented.hpp>
#include <silt/coupling/formulas.hpp>

#include "near.hpp"

namespace coupled_flow_test {

using silt::CoupledFlow;
using silt::CoupledParticles;
using silt::FlowSolver;
using silt::FluidProperties;
using silt::Grid;
using silt::MomentumModel;
using silt::Vec3d;

namespace {

struct Grains {
  std::vector<Vec3d> position, velocity, force;
  std::vector<double> radius, volume, mass;

  void add(const Vec3d& x, double d, double density, const Vec3d& v = {0, 0, 0}) {
    const double V = std::numbers::pi / 6 * d * d * d;
    position.push_back(x), velocity.push_back(v), force.push_back({0, 0, 0});
    radius.push_back(0.5 * d), volume.push_back(V), mass.push_back(density * V);
  }
  CoupledParticles view() const { return {{position, radius}, velocity, volume, mass}; }
};

/// Drag that does not depend on anything but the size.
struct Given {
  double by_stokes;
  template <class Real>
  Real normalised(const Real&, const Real&) const {
    return Real(static_cast<silt::ScalarOf<Real>>(by_stokes));
  }
};

/// One that throws if told so.
struct Failing : Given {
  static inline bool fails = false;
  template <class Real>
  Real normalised(const Real& Re, const Real& eps) const {
    silt::require(!fails, "the law of the test fails");
    return Given::normalised(Re, eps);
  }
};

/// Pressure gradient in the middle of a bed of spheres at rest, over Ergun's.
template <class Mode>
double over_ergun(const Mode& mode, MomentumModel model, double cell_over_diameter,
                  int layers = 24) {
  const double d = 1e-3, a = d * 1.02, U = 0.4;  // lattice spacing
  const int across = 8;
  const double width = across * a, height = 3 * layers * a;
  const int n = std::max(1, static_cast<int>(std::lround(width / (cell_over_diameter * d))));
  const Grid g({{0, 0, 0}, {width, width, height}}, {n, n, 3 * n * layers / across},
               {true, true, false});
  const FluidProperties air{1.2, 1.8e-5};
  CoupledFlow flow(silt::Ergun{}, mode, silt::FlowSolver(g, air, {.model = model}));
  flow.flow().set_side(2, 0, silt::Inflow{{0, 0, U}});
  flow.flow().set_side(2, 1, silt::Outflow{});
  Grains grains;
  for (int k = 0; k < layers; ++k)
    for (int j = 0; j < across; ++j)
      for (int i = 0; i < across; ++i)
        grains.add({(i + 0.5) * a, (j + 0.5) * a, (layers + k + 0.5) * a}, d, 1e9);  // held
  for (int s = 0; s < 60; ++s) flow.advance(grains.view(), 5e-4, grains.force);
  const double eps = 1 - grains.volume[0] / (a * a * a);
  // Over the middle third of the bed, where no mode sees its ends.
  const int in_bed = n * layers / across, low = in_bed + in_bed / 3, high = in_bed + 2 * in_bed / 3;
  const auto mean = [&](int k) {
    double sum = 0;
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) sum += flow.flow().pressure()(i, j, k);
    return sum / (n * n);
  };
  const double slope = (mean(low) - mean(high)) / ((high - low) * g.h().z);
  return slope / silt::ergun_pressure_gradient(eps, d, air.density, air.viscosity, U);
}

}  // namespace

TEST_CASE("the pressure drop of a bed at rest is Ergun's") {
  // 1e-3: what the modes see of the bed's ends, and the pressure's tolerance; 1e-2 where the coarse
  // cells, of three diameters, hold two layers or three. Diffusion spreads by
  // implicit steps, whose tails are long: with a width of 3 and 8 diameters to the ends it is 2 %
  // low, with 16 less than 2e-4.
  for (const MomentumModel model : {MomentumModel::A, MomentumModel::B}) {
    CHECK(over_ergun(silt::Kernel{}, model, 2) == near(1).epsilon(1e-3));
    CHECK(over_ergun(silt::Diffusion{.width = 3}, model, 2, 48) == near(1).epsilon(1e-3));
    CHECK(over_ergun(silt::TwoGrid{}, model, 2) == near(1).epsilon(1e-2));
  }
  CHECK(over_ergun(silt::Kernel{}, MomentumModel::A, 1) == near(1).epsilon(1e-3));
  // Cells of the size of a lattice cell hold one sphere each.
  CHECK(over_ergun(silt::Unresolved{}, MomentumModel::A, 4) == near(1).epsilon(1e-3));
}

TEST_CASE("what the fluid gets the particles give, to rounding") {
  for (const MomentumModel model : {MomentumModel::A, MomentumModel::B}) {
    const Grid g({{0, 0, 0}, {0.01, 0.01, 0.01}}, {8, 8, 8}, {true, true, true});
    // So little viscosity that its stress is nothing, and a drag that makes up for it.
    CoupledFlow flow(Given{1e11}, silt::Kernel{},
                     silt::FlowSolver(g, {1.2, 1e-14}, {.model = model, .tolerance = 1e-8}));
    silt::Random random(7);
    Grains grains;
    for (int p = 0; p < 300; ++p) {
      const auto r = [&](double low, double high) { return random.uniform(low, high); };
      grains.add({r(0, 0.01), r(0, 0.01), r(0, 0.01)}, r(0.5e-3, 1e-3), 50,
                 {r(-1, 1), r(-1, 1), r(0, 2)});
    }
    const double dt = 1e-4;
    double scale = 0;
    for (int s = 0; s < 5; ++s) {
      const Vec3d before = flow.flow().momentum();
      const auto step = flow.advance(grains.view(), dt, grains.force);
      Vec3d given{0, 0, 0};
      for (std::size_t p = 0; p < grains.mass.size(); ++p) {
        given += dt * grains.force[p];
        scale += dt * norm(grains.force[p]);
        grains.velocity[p] += (dt / grains.mass[p]) * grains.force[p];
        grains.position[p] += dt * grains.velocity[p];
      }
      CHECK(std::abs(step.volume_error) < 1e-12);
      CHECK(norm(step.momentum_error) * dt < 1e-12 * scale);
      // The first step's fluid has not had the particles' room taken from it before.
      if (s > 0) CHECK(norm(flow.flow().momentum() - before + given) < 1e-10 * scale);
    }
    // Continuity: the pressure's tolerance of what the particles and the flow have moved, which is
    // less than a tenth of a cell.
    const silt::FluidClosure& most = flow.closure();
    CHECK((most.volume > 0 && most.volume < 1e-12));
    CHECK((most.momentum > 0 && most.momentum < 1e-12));
    CHECK((most.continuity > 0 && most.continuity < 0.1 * flow.flow().options().tolerance));
    CHECK(most.clipped == 0);
  }
}

TEST_CASE("a grain settles at its terminal velocity") {
  // Glass, 0.5 mm, in water: Re about 35. Steps of half a relaxation time.
  const double d = 0.5e-3, rho = 2500, mu = 1e-3, water = 1000;
  const Grid g({{0, 0, 0}, {0.012, 0.012, 0.03}}, {12, 12, 30}, {false, false, false});
  CoupledFlow flow(silt::SchillerNaumann{}, silt::Kernel{.width = 6},
                   silt::FlowSolver(g, {water, mu}));
  flow.gravity = {0, 0, -9.81};
  Grains grains;
  grains.add({0.006, 0.006, 0.025}, d, rho);
  const double expected = silt::terminal_velocity(silt::SchillerNaumann{}, d, rho, water, mu, 9.81);
  const double dt = 4e-3;
  const std::vector<Vec3d> acceleration{flow.gravity};  // what drag is up against in a step
  for (int s = 0; s < 40; ++s) {
    CoupledParticles view = grains.view();
    view.acceleration = acceleration;
    flow.advance(view, dt, grains.force);
    grains.velocity[0] += dt * (grains.force[0] * (1 / grains.mass[0]) + flow.gravity);
    grains.position[0] += dt * grains.velocity[0];
  }
  // A grain that stirs its own surroundings falls a little faster.
  CHECK(-grains.velocity[0].z > expected);
  CHECK(-grains.velocity[0].z == near(expected).epsilon(0.01));
}

// Catches solids that are put in, or taken out, once more after a step that a law had ended.
TEST_CASE("a step that a user's law has ended can be made again as if it had not been tried") {
  double pressure[2];
  for (const bool fails : {false, true}) {
    FlowSolver solver(Grid({{0, 0, 0}, {0.01, 0.01, 0.03}}, {4, 4, 12}, {true, true, false}),
                      {1.2, 1.8e-5});
    solver.set_side(2, 0, silt::Inflow{{0, 0, 1}});
    solver.set_side(2, 1, silt::Outflow{});
    CoupledFlow flow(Failing{{1}}, silt::Kernel{}, std::move(solver));
    Grains grains;
    grains.add({0.005, 0.005, 0.01}, 2e-3, 2500);
    for (int s = 0; s < 4; ++s) flow.advance(grains.view(), 1e-4, grains.force);
    flow.take_away({grains.position[0], grains.radius[0], 0.5 * grains.volume[0]});
    grains.volume[0] *= 0.5;
    grains.add({0.005, 0.005, 0.02}, 2e-3, 2500);
    CoupledParticles view = grains.view();
    const std::vector<double> put_in{0, grains.volume[1]};
    view.put_in = put_in;
    Failing::fails = fails;
    if (fails) CHECK_THROWS_AS(flow.advance(view, 1e-4, grains.force), silt::InputError);
    Failing::fails = false;
    flow.advance(view, 1e-4, grains.force);
    pressure[fails] = flow.flow().pressure()(1, 2, 0);
  }
  CHECK(pressure[0] == pressure[1]);
}

TEST_CASE("a fluid without viscosity is refused at the start, for drag laws that need it") {
  // Catches drag that is not a number, which only the first step would report.
  const Grid g({{0, 0, 0}, {1, 1, 1}}, {4, 4, 4}, {true, true, true});
  const auto coupled = [&g](const auto& drag) {
    return [&g, drag] { CoupledFlow flow(drag, silt::Kernel{}, silt::FlowSolver(g, {1000, 0})); };
  };
  const auto refused = [&](const auto& drag) {
    CHECK_THROWS_WITH_AS(coupled(drag)(),
                         doctest::Contains("FluidProperties.viscosity = 0 Pa s must be given and "
                                           "positive, as the drag law needs a Reynolds number"),
                         silt::InputError);
  };
  refused(silt::Ergun{}), refused(silt::Gidaspow{}), refused(silt::DiFelice{});
  refused(silt::Beetstra{}), refused(silt::KochHill{}), refused(silt::SchillerNaumann{});
  refused(silt::WenYu{}), refused(silt::OrientedDrag{});
  coupled(silt::Stokes{})();  // no drag
}

TEST_CASE("spans that do not fit are refused") {
  const Grid g({{0, 0, 0}, {1, 1, 1}}, {4, 4, 4}, {true, true, true});
  CoupledFlow flow(silt::Ergun{}, silt::Kernel{}, silt::FlowSolver(g, {1.2, 1.8e-5}));
  Grains grains;
  grains.add({0.5, 0.5, 0.5}, 0.1, 1000);
  CHECK_THROWS_WITH_AS(flow.advance(grains.view(), 1e-3, {}),
                       "CoupledParticles: 0 forces for 1 velocities; give one each",
                       silt::InputError);
  flow.least_voidage = 0;
  CHECK_THROWS_WITH_AS(flow.advance(grains.view(), 1e-3, grains.force),
                       "CoupledFlow.least_voidage = 0 must be in (0, 1)", silt::InputError);
}

}  // namespace coupled_flow_test
