// silt - BSD-3-Clause, see LICENSE
#include <doctest/doctest.h>

#include <cmath>
#include <string>

#include <silt/coupling/drag/laws.hpp>
#include <silt/coupling/formulas.hpp>

#include "near.hpp"

namespace formulas_test {

using silt::DiFelice;
using silt::Ergun;
using silt::SchillerNaumann;
using silt::Stokes;
using silt::WenYu;

namespace {

constexpr double air = 1.2, air_viscosity = 1.8e-5;

template <class Call>
bool refused(const Call& call, const std::string& words) {
  try {
    call();
  } catch (const silt::InputError& error) {
    return std::string(error.what()).find(words) != std::string::npos;
  }
  return false;
}

/// A law that carries less the faster the flow.
struct Falling {
  template <class Real>
  Real normalised(const Real&, const Real& Re) const {
    return Real(1) / (Re * Re + Real(1));
  }
};

}  // namespace

TEST_CASE("coupling formulas: Archimedes number and minimum fluidisation of the reference's bed") {
  // C2 of the physics reference: 1 mm, 2500 kg/m3 in air, eps 0.4: Ar 9.08e4, Re 37.4, 0.561 m/s.
  const double d = 1e-3, rho_p = 2500;
  const double Ar = silt::archimedes_number(d, rho_p, air, air_viscosity);
  CHECK(std::abs(Ar - 9.08e4) <= 50);
  const double Re = silt::ergun_fluidisation_reynolds(0.4, Ar);
  CHECK(std::abs(Re - 37.4) <= 0.05);
  CHECK(near_relative(1406.25 * Re + 27.34375 * Re * Re, Ar, 1e-14));
  const double U = silt::minimum_fluidisation_velocity(Ergun(), 0.4, d, rho_p, air, air_viscosity);
  CHECK(std::abs(U - 0.561) <= 0.0005);
  CHECK(near_relative(U, Re * air_viscosity / (air * d), 1e-14));
  CHECK(silt::ergun_fluidisation_reynolds(0.4, 0) == 0);
}

TEST_CASE("coupling formulas: balance_reynolds equals Ergun's closed form from Ar 1e-12 to 1e14") {
  for (double digits = -12; digits <= 14; digits += 0.37)
    for (const double eps : {0.3, 0.4, 0.7}) {
      const double Ar = std::pow(10.0, digits);
      CHECK(near_relative(silt::balance_reynolds(Ergun(), eps, Ar),
                          silt::ergun_fluidisation_reynolds(eps, Ar), 1e-14));
    }
  CHECK(silt::balance_reynolds(WenYu(), 0.5, 0) == 0);
}

TEST_CASE("coupling formulas: the bed is carried where its pressure drop is its weight") {
  const double d = 2e-3, rho_p = 1500, rho = 1000, mu = 1e-3, eps = 0.45;
  const auto check = [&](const auto& law) {
    const double U = silt::minimum_fluidisation_velocity(law, eps, d, rho_p, rho, mu);
    CHECK(near_relative(silt::bed_pressure_gradient(law, eps, d, rho, mu, U),
                        (1 - eps) * (rho_p - rho) * 9.81, 1e-13));
  };
  check(Ergun());
  check(WenYu());
  check(DiFelice());
  check(silt::Beetstra());
  check(silt::Tenneti());
  check(silt::KochHill());
}

TEST_CASE("coupling formulas: Ergun's pressure gradient as he wrote it") {
  const double eps = 0.4, d = 1e-3, mu = air_viscosity, U = 0.3, p = 1 - eps, e3 = eps * eps * eps;
  const double drop = 150 * mu * p * p * U / (e3 * d * d) + 1.75 * air * p * U * U / (e3 * d);
  CHECK(near_relative(silt::ergun_pressure_gradient(eps, d, air, mu, U), drop, 1e-14));
}

TEST_CASE(
    "coupling formulas: terminal velocity: Stokes' and Newton's closed forms, rising as well") {
  const double d = 5e-5, rho_p = 2500, rho = 1000, mu = 1e-3, g = 9.81;
  const double stokes = (rho_p - rho) * g * d * d / (18 * mu);
  CHECK(near_relative(silt::terminal_velocity(Stokes(), d, rho_p, rho, mu), stokes, 1e-14));
  CHECK(near_relative(silt::terminal_velocity(Stokes(), d, 2 * rho - rho_p + 1000, rho, mu),
                      silt::terminal_velocity(Stokes(), d, rho_p - 1000, rho, mu), 1e-14));
  // Far beyond Re = 1000: v^2 = (4/3) (rho_p - rho) g d/(0.44 rho).
  const double newton = std::sqrt(4.0 / 3 * (7800 - 1.2) * g * 0.05 / (0.44 * 1.2));
  CHECK(near_relative(silt::terminal_velocity(SchillerNaumann(), 0.05, 7800, 1.2, air_viscosity),
                      newton, 1e-14));
  // A1.2 of the reference, which leaves buoyancy out: 2.8 and 3 mm, 1123 kg/m3, air: 8.74, 9.04.
  const auto falling = [](double size) {
    return silt::terminal_velocity(SchillerNaumann(), size, 1123 + 1.225, 1.225, 1.8e-5);
  };
  CHECK(std::abs(falling(2.8e-3) - 8.74) <= 0.005);
  CHECK(std::abs(falling(3e-3) - 9.04) <= 0.005);
}

TEST_CASE("coupling formulas: refusals") {
  CHECK(refused([] { silt::terminal_velocity(Stokes(), 0, 2500, 1.2, 1.8e-5); },
                "terminal_velocity: diameter d = 0 [m] must be finite and greater than 0"));
  CHECK(refused([] { silt::terminal_velocity(Stokes(), 1e-3, 2500, 1.2, -1); },
                "viscosity mu = -1 [Pa s]"));
  CHECK(refused([] { silt::minimum_fluidisation_velocity(Ergun(), 1.1, 1e-3, 2500, 1.2, 1.8e-5); },
                "fluid fraction eps = 1.1 [-] must be in (0, 1]"));
  CHECK(refused([] { silt::ergun_fluidisation_reynolds(0, 1); }, "fluid fraction eps = 0"));
  CHECK(refused([] { silt::balance_reynolds(Ergun(), 0.4, -1); }, "Archimedes number Ar = -1"));
  CHECK(refused([] { silt::balance_reynolds(Falling(), 0.4, 1e9); }, "carries no weight"));
  CHECK(refused([] { silt::ergun_pressure_gradient(0.4, 1e-3, 1.2, 1.8e-5, -1); },
                "superficial velocity U = -1 [m/s]"));
}

}  // namespace formulas_test
