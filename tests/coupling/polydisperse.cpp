// silt - BSD-3-Clause, see LICENSE

#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include <silt/coupling/averaging/diffusion.hpp>
#include <silt/coupling/averaging/kernel.hpp>
#include <silt/coupling/averaging/two_grid.hpp>
#include <silt/coupling/averaging/unresolved.hpp>
#include <silt/coupling/coupled_flow.hpp>
#include <silt/coupling/drag/laws.hpp>
#include <silt/coupling/formulas.hpp>

#include "near.hpp"
#include "refusal.hpp"

namespace polydisperse_test {

using namespace silt;

namespace {

double sphere(double d) { return std::numbers::pi / 6 * d * d * d; }

/// Sum of the drags of a mixture at one slip over that of as much volume in spheres of the mean.
template <class Law>
double over_mean(const Polydisperse<Law>& drag, double ratio, double eps, double slip) {
  const double d[] = {1e-3, ratio * 1e-3}, n[] = {9, 2};
  double d2 = 0, d3 = 0;
  for (int i = 0; i < 2; ++i) d2 += n[i] * d[i] * d[i], d3 += n[i] * d[i] * d[i] * d[i];
  const double mean = d3 / d2, n_mean = d3 / (mean * mean * mean);
  InFluid at{};
  at.density = 1.2, at.viscosity = 1.8e-5, at.voidage = eps, at.mean_diameter = mean;
  const auto K = [&](double size) {
    at.diameter = size;
    return detail::drag_on(drag, at, slip_reynolds(eps, at.density, slip, size, at.viscosity));
  };
  const double Re = slip_reynolds(eps, at.density, slip, mean, at.viscosity);
  return (n[0] * K(d[0]) + n[1] * K(d[1])) /
         (n_mean * drag_coefficient(drag.law, eps, Re, mean, at.viscosity));
}

/// A bed at rest in a box that is periodic along x and y: a large sphere in the middle of each
/// cell, and as much volume of small ones on a lattice around it. `only`: the small ones in the
/// lower half alone, the large ones in the upper.
struct Bed {
  static constexpr double d = 1e-3, solids = 0.4, U = 0.4;  // [m] small ones, [-], [m/s]
  static constexpr int across = 3, along = 10;              // [cells]
  double h;                                                 // [m] of a cell
  std::vector<Vec3d> position, velocity, force;
  std::vector<double> radius, volume, mass;

  explicit Bed(int ratio, bool apart = false) : h(std::cbrt(2 * sphere(ratio * d) / solids)) {
    const int small = ratio * ratio * ratio * (apart ? 2 : 1), large = apart ? 2 : 1;
    for (int k = 0; k < along; ++k)
      for (int j = 0; j < across; ++j)
        for (int i = 0; i < across; ++i) {
          const Vec3d corner{i * h, j * h, k * h};
          const bool low = 2 * k < along;
          if (!apart || low) put(corner, small, ratio, 0.5 * d);
          if (!apart || !low) put(corner, large, 1, 0.5 * ratio * d);
        }
    const std::size_t n = position.size();
    velocity.assign(n, {0, 0, 0}), force = velocity;
    for (const double r : radius)
      volume.push_back(sphere(2 * r)), mass.push_back(1e9 * volume.back());
  }
  /// `count` spheres in a cell, in layers of side^2 places.
  void put(const Vec3d& corner, int count, int side, double r) {
    const int layers = count / (side * side);
    for (int k = 0; k < layers; ++k)
      for (int j = 0; j < side; ++j)
        for (int i = 0; i < side; ++i) {
          position.push_back(
              corner + Vec3d{(i + 0.5) * h / side, (j + 0.5) * h / side, (k + 0.5) * h / layers});
          radius.push_back(r);
        }
  }
  CoupledParticles view() const { return {{position, radius}, velocity, volume, mass}; }
};
constexpr FluidProperties air{1.2, 1.8e-5};

/// Pressure gradients [Pa/m] in the lower and the upper half.
template <class Drag, class Mode>
std::array<double, 2> slopes(const Drag& drag, const Mode& mode, Bed bed) {
  const double w = Bed::across * bed.h;
  const Grid g({{0, 0, 0}, {w, w, Bed::along * bed.h}}, {Bed::across, Bed::across, Bed::along},
               {true, true, false});
  FlowSolver solver(g, air);
  solver.set_side(2, 0, Inflow{.velocity = {0, 0, Bed::U}});
  solver.set_side(2, 1, Outflow{});
  CoupledFlow flow(drag, mode, std::move(solver));
  CoupledStep step;
  for (int s = 0; s < 40; ++s) step = flow.advance(bed.view(), 5e-4, bed.force);
  CHECK(norm(step.momentum_error) < 1e-12 * step.exchanged);
  const auto& p = flow.flow().pressure();
  return {(p(1, 1, 1) - p(1, 1, 3)) / (2 * bed.h), (p(1, 1, 6) - p(1, 1, 8)) / (2 * bed.h)};
}
double ergun(double d) {
  return ergun_pressure_gradient(1 - Bed::solids, d, air.density, air.viscosity, Bed::U);
}

}  // namespace

TEST_CASE(
    "Polydisperse: together the sizes feel the drag of the Sauter mean, at any void fraction") {
  // Catches Re of the particle's own diameter and the factor of model B, 1.09 times
  // the drag at eps = 0.4 and 1.19 times at 0.8. 1e-12: powers of Re.
  for (const double eps : {0.4, 0.8})
    for (const double slip : {1e-4, 3.0}) {
      CHECK(near_relative(over_mean(Polydisperse{Gidaspow{}}, 2.6, eps, slip), 1, 1e-12));
      CHECK(near_relative(over_mean(Polydisperse{Beetstra{}}, 2.6, eps, slip), 1, 1e-12));
    }
  // One size, and by hand at y = 2, where the law is 1/eps: 2 + 0.064 8 = 2.512.
  CHECK(near_relative(over_mean(Polydisperse{Beetstra{}, 0.064}, 1, 0.5, 0.1), 1.064, 1e-12));
  InFluid at{};
  at.voidage = 1, at.diameter = 2e-3, at.mean_diameter = 1e-3;
  CHECK(near_relative(Polydisperse{Stokes{}, 0.064}.normalised(at, 1.0), 2.512, 1e-15));
}

TEST_CASE("Polydisperse: the pressure drop of a mixed bed is Ergun's with the Sauter mean") {
  // Each cell has one large sphere and as much volume of small ones. 1e-3: the flow after 40 steps;
  // measured below 5e-5. Without it the means of 1/d^2 and of 1/d by volume, in closed form: 1.055
  // and 1.115 times at these Re.
  const auto both = [](int ratio, const auto& mode) {
    const double mean = 2 * Bed::d * ratio / (1 + ratio);
    const double mixed = slopes(Polydisperse{Ergun{}}, mode, Bed(ratio))[0];
    CHECK(mixed == near(ergun(mean)).epsilon(1e-3));
    const double plain = slopes(Ergun{}, mode, Bed(ratio))[0];
    CHECK(plain == near(0.5 * (ergun(Bed::d) + ergun(ratio * Bed::d))).epsilon(1e-3));
    CHECK(plain > 1.05 * mixed);
  };
  for (const int ratio : {2, 3}) {
    CAPTURE(ratio);
    both(ratio, Unresolved{});
    both(ratio, Kernel{});
    both(ratio, TwoGrid{});
    both(ratio, Diffusion{});
  }
}

TEST_CASE("Polydisperse: the mean is that around a particle, not of all") {
  // Small ones below, large ones above: each half has the drop of its own size; measured 1.0005 and
  // 1.0008. With the mean of all it would be 0.54 and 2.6 times as large.
  const auto of = slopes(Polydisperse{Ergun{}}, Unresolved{}, Bed(3, true));
  CHECK(of[0] == near(ergun(Bed::d)).epsilon(1e-3));
  CHECK(of[1] == near(ergun(3 * Bed::d)).epsilon(1e-3));
}

TEST_CASE("Polydisperse: what it cannot be is refused") {
  CHECK(silt_test::refusal([] {
          Polydisperse{Ergun{}, -1.0}.check();
        }).find("cubic = -1 must be 0") != std::string::npos);
  Bed bed(2);
  ParticleExchange<Polydisperse<Ergun>> exchange{Polydisperse{Ergun{}}};
  exchange.settings.fluid = air;
  exchange.at.voidage.assign(bed.position.size(), 0.5);
  CHECK(silt_test::refusal([&] {
          exchange.find(bed.view(), 1e-3, {}, Team{});
        }).find("mean diameters") != std::string::npos);
}

}  // namespace polydisperse_test
