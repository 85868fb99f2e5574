// silt - BSD-3-Clause, see LICENSE
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include <silt/core/lanes.hpp>
#include <silt/coupling/drag/laws.hpp>
#include <silt/coupling/particle_exchange.hpp>
#include <silt/fluid/flow_solver.hpp>

#include "near.hpp"

namespace syamlal_obrien_test {

using silt::MinimumFluidisation;
using silt::SyamlalOBrien;

namespace {

/// Fhat at Re = 0.1, 1, 10, 100, 500, computed apart in the form that MFIX's source has: the
/// coefficient 0.75 mu eps (0.63 sqrt(x) + 4.8)^2/(V_r d^2) a volume of solids, over 18 mu eps/d^2.
constexpr struct {
  double eps, Fhat[5];
} table[] = {{0.4, {23.431072, 16.695954, 25.312495, 106.448936, 415.785374}},
             {0.5, {15.429980, 11.904465, 15.411174, 54.295224, 199.118401}},
             {0.6, {8.939693, 8.346567, 10.355171, 31.858492, 110.228638}},
             {0.8, {2.759544, 3.366840, 5.015910, 13.922031, 44.128104}},
             {0.9, {1.647926, 2.003883, 3.180123, 8.723831, 26.508677}},
             {0.999, {1.045870, 1.234257, 1.931762, 5.159779, 14.945009}}};
constexpr double Res[] = {0.1, 1, 10, 100, 500};

constexpr silt::FluidProperties air{1.2, 1.8e-5};
/// Grains of 1 mm in air that begin to move at Ergun's velocity: Re = 37.4.
constexpr MinimumFluidisation bed{0.561, 0.4, 1e-3, 2500, air, 9.81};

template <class Law>
double fhat(const Law& law, const MinimumFluidisation& of) {
  return law.normalised(of.voidage,
                        of.fluid.density * of.velocity * of.diameter / of.fluid.viscosity);
}
std::string refusal(const MinimumFluidisation& of) {
  try {
    SyamlalOBrien::calibrated(of);
  } catch (const silt::InputError& e) {
    return e.what();
  }
  return {};
}
template <class Scalar>
double pack_difference(const SyamlalOBrien& law) {
  using Pack = typename silt::Lanes<silt::DefaultArch, Scalar>::Real;
  constexpr std::size_t W = silt::Lanes<silt::DefaultArch, Scalar>::width;
  double worst = 0;
  for (const double Re : {0.0, 1e-3, 0.3, 7.0, 80.0, 990.0, 3000.0})
    for (double eps = 0.31; eps < 0.999; eps += 0.013) {
      alignas(64) Scalar e[W], r[W], F[W];
      for (std::size_t w = 0; w < W; ++w) {
        e[w] = static_cast<Scalar>(w % 2 == 0 ? eps : 1.3 - eps);
        r[w] = static_cast<Scalar>(w % 3 == 0 ? Re : 1.7 * Re);
      }
      silt::store(F, law.normalised(silt::load<Pack>(e), silt::load<Pack>(r)));
      for (std::size_t w = 0; w < W; ++w) {
        const double one = law.normalised(static_cast<double>(e[w]), static_cast<double>(r[w]));
        const double error = std::abs(static_cast<double>(F[w]) / one - 1);
        if (!(error < 1)) return error;
        worst = std::max(worst, error);
      }
    }
  return worst;
}

}  // namespace

TEST_CASE("SyamlalOBrien: Fhat equals MFIX's form to the table's last digit") {
  for (const auto& row : table)
    for (int k = 0; k < 5; ++k) {
      CAPTURE(row.eps);
      CAPTURE(Res[k]);
      CHECK(std::abs(SyamlalOBrien().normalised(row.eps, Res[k]) - row.Fhat[k]) <= 0.50001e-6);
    }
}

TEST_CASE("SyamlalOBrien: limits, and the jump at eps = 0.85") {
  // V_r is A without inertia, and B at the largest Re: Fhat = 0.96/A, and by (0.63^2/24) Re_i/B^2.
  CHECK(near_relative(SyamlalOBrien().normalised(0.6, 0.0), 0.96 / std::pow(0.6, 4.14), 1e-12));
  CHECK(near_relative(SyamlalOBrien().velocity_ratio(0.6, 1e9), 0.8 * std::pow(0.6, 1.28), 1e-7));
  // A lone sphere feels Dalla Valle's drag.
  CHECK(near_relative(SyamlalOBrien().normalised(1.0, 50.0), silt::DiFelice().normalised(1.0, 50.0),
                      1e-12));
  const auto jump = [](const SyamlalOBrien& law) {
    return law.normalised(0.85 + 1e-12, 300.0) / law.normalised(0.85, 300.0) - 1;
  };
  CHECK(std::abs(jump({})) < 1.2e-3);
  CHECK(std::abs(jump({})) > 1e-5);
  CHECK(std::abs(jump(SyamlalOBrien::calibrated(bed))) < 1e-9);
}

TEST_CASE("SyamlalOBrien: lanes equal doubles to 1e-13, lanes of float to 1e-5") {
  for (const SyamlalOBrien& law : {SyamlalOBrien{}, SyamlalOBrien::calibrated(bed)}) {
    CHECK(pack_difference<double>(law) <= 1e-13);
    // 6e-8 in eps and Re, by powers up to V_r^-2, eps^-8.
    CHECK(pack_difference<float>(law) <= 1e-5);
  }
}

TEST_CASE("SyamlalOBrien: calibrated, it bears the bed at the measured velocity") {
  // The drag asked for is that of the bed's weight in the fluid: (1 - eps)(rho_p - rho) g a volume.
  const double slip = bed.velocity / bed.voidage;
  const double beta = silt::interphase_coefficient(
      SyamlalOBrien::calibrated(bed), bed.voidage,
      air.density * bed.velocity * bed.diameter / air.viscosity, bed.diameter, air.viscosity);
  const double weight = (1 - bed.voidage) * (bed.particle_density - air.density) * bed.gravity;
  CHECK(near_relative(beta * slip / bed.voidage, weight, 1e-12));
  // Ergun's velocity it was: as much drag as Ergun's; uncalibrated it has 0.966 of that.
  CHECK(near_relative(fhat(SyamlalOBrien::calibrated(bed), bed), fhat(silt::Ergun(), bed), 1e-3));
  CHECK(fhat(SyamlalOBrien(), bed) / fhat(silt::Ergun(), bed) ==
        doctest::Approx(0.966).epsilon(1e-3));

  // Round trip: the velocity of the law as it is gives its own c1 back, and d1 to what the jump is.
  for (const double eps : {0.4, 0.5, 0.6}) {
    MinimumFluidisation own = bed;
    own.voidage = eps;
    double low = 1e-3, high = 10;
    while (high / low > 1 + 1e-15) {
      own.velocity = std::sqrt(low * high);
      (fhat(SyamlalOBrien(), own) < own.normalised_drag() ? low : high) = own.velocity;
      if (own.velocity == low && own.velocity == high) break;
      if (std::nextafter(low, high) >= high) break;
    }
    const SyamlalOBrien found = SyamlalOBrien::calibrated(own);
    CHECK(near_relative(found.c1, 0.8, 1e-9));
    CHECK(near_relative(found.d1, 2.65, 2e-3));
  }
}

TEST_CASE("SyamlalOBrien: the flow through a calibrated bed loses its weight in pressure") {
  const silt::Grid grid({{0, 0, 0}, {0.01, 0.01, 0.05}}, {2, 2, 20}, {true, true, false});
  const auto gradient = [&](const SyamlalOBrien& law) {
    silt::FlowSolver flow(grid, air, {.model = silt::MomentumModel::A});
    flow.set_side(2, 0, silt::Inflow{.velocity = {0, 0, bed.velocity}});
    flow.set_side(2, 1, silt::Outflow{});
    const double beta = silt::interphase_coefficient(
        law, bed.voidage, air.density * bed.velocity * bed.diameter / air.viscosity, bed.diameter,
        air.viscosity);
    flow.voidage().fill(bed.voidage), flow.drag().fill(beta);
    for (int s = 0; s < 100; ++s) flow.step(1e-3);
    return (flow.pressure()(0, 0, 5) - flow.pressure()(0, 0, 14)) / (9 * grid.h().z);
  };
  const double weight = (1 - bed.voidage) * (bed.particle_density - air.density) * bed.gravity;
  CHECK(near_relative(gradient(SyamlalOBrien::calibrated(bed)), weight, 1e-6));
}

TEST_CASE("SyamlalOBrien: beds that cannot be are refused") {
  const auto with = [](auto change) {
    MinimumFluidisation of = bed;
    change(of);
    return refusal(of);
  };
  using B = MinimumFluidisation;
  CHECK(with([](B& b) { b.velocity = 0; }).find("MinimumFluidisation.velocity") == 0);
  CHECK(with([](B& b) { b.voidage = 0.95; }).find("MinimumFluidisation.voidage") == 0);
  CHECK(with([](B& b) { b.diameter = -1; }).find("MinimumFluidisation.diameter") == 0);
  CHECK(with([](B& b) { b.particle_density = 1; }).find("particle_density") != std::string::npos);
  CHECK(with([](B& b) { b.fluid.viscosity = 0; }).find("viscosity") != std::string::npos);
  CHECK(with([](B& b) { b.diameter = 1e-4, b.velocity = 1e-3; }).find("more drag") !=
        std::string::npos);
  CHECK(with([](B& b) { b.diameter = 1e-6, b.velocity = 1e-6; }).find("below 0.01") !=
        std::string::npos);
}

TEST_CASE("SyamlalOBrien: constants that cannot be are refused by the coupling") {
  const auto of = [](double c1, double d1) {
    try {
      silt::ParticleExchange<SyamlalOBrien>{SyamlalOBrien{c1, d1}};
    } catch (const silt::InputError& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  CHECK(of(0.8, 2.65).empty());
  CHECK(of(1.5, -1).empty());  // calibrated laws may have such a d1
  CHECK(of(-1, 2).find("SyamlalOBrien.c1 = -1") == 0);
  CHECK(of(0.8, NAN).find("SyamlalOBrien.d1 = nan") == 0);
}

}  // namespace syamlal_obrien_test
