// silt - BSD-3-Clause, see LICENSE
// A gas of inelastic spheres cools by Haff's law.

#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include <silt/boundary/domain.hpp>
#include <silt/contact/linear_spring.hpp>
#include <silt/core/random.hpp>
#include <silt/io/observers.hpp>
#include <silt/measure/polynomial_fit.hpp>
#include <silt/simulation.hpp>

#include "verification/gallery.hpp"

namespace verification {
namespace cooling_gas_cases {

using silt::Vec3d;

// Hard, smooth, equal spheres, homogeneous. With T = <v^2>/3 [m2/s2] and the number density n,
//   dT/dt = -(1 - e^2) w/3 (1 + 3/16 a2) T,  w = 4 n d^2 g0 sqrt(pi T)                        (1)
//   T = T0/(1 + t/tau)^2,  1/tau = (1 - e^2) w0/6 (1 + 3/16 a2)                               (2)
//   g0 = (1 - phi/2)/(1 - phi)^3                                                              (3)
//   a2 = 16 (1 - e)(1 - 2 e^2)/(81 - 17 e + 30 e^2 (1 - e))                                   (4)
// (2) P. K. Haff, J. Fluid Mech. 134 (1983) 401; (3) N. F. Carnahan, K. E. Starling, J. Chem. Phys.
// 51 (1969) 635; (4) the deviation of the velocity distribution from a Gaussian, T. P. C. van
// Noije, M. H. Ernst, Granular Matter 1 (1998) 57: 0.3 % of the rate here.
constexpr double phi = 0.05, e = 0.9, d = 1e-3;  // [-] share of solid, [-], [m]
constexpr double density = 2500, T0 = 1e-2;      // [kg/m3], [m2/s2]
constexpr double pi = std::numbers::pi;

double cooling_rate(double T) {  // [1/s] 1/tau
  const double n = 6 * phi / (pi * d * d * d), g0 = (1 - phi / 2) / std::pow(1 - phi, 3);
  const double a2 = 16 * (1 - e) * (1 - 2 * e * e) / (81 - 17 * e + 30 * e * e * (1 - e));
  return (1 - e * e) / 6 * 4 * n * d * d * g0 * std::sqrt(pi * T) * (1 + 3.0 / 16 * a2);
}

/// Gaussian velocities, with zero mean and exactly the temperature T0.
void set_velocities(silt::Particles<silt::Sphere>& gas) {
  silt::Random random(7);
  Vec3d mean{0, 0, 0};
  double sum = 0;
  for (std::size_t k = 0; k < gas.size(); ++k) {
    gas[k].velocity = {random.normal(), random.normal(), random.normal()};
    mean += gas[k].velocity * (1.0 / static_cast<double>(gas.size()));
  }
  for (std::size_t k = 0; k < gas.size(); ++k) {
    gas[k].velocity -= mean;
    sum += dot(gas[k].velocity, gas[k].velocity);
  }
  const double scale = std::sqrt(3 * T0 * static_cast<double>(gas.size()) / sum);
  for (std::size_t k = 0; k < gas.size(); ++k) gas[k].velocity = scale * gas[k].velocity;
}

template <class Sim>
double temperature(const Sim& sim) {
  double sum = 0;
  for (std::size_t k = 0; k < sim.rows(); ++k) sum += dot(sim.velocity(k), sim.velocity(k));
  return sum / 3 / static_cast<double>(sim.rows());
}

}  // namespace cooling_gas_cases

void cooling_gas(Gallery& gallery) {
  using namespace cooling_gas_cases;
  const std::size_t count = gallery.quick ? 1000 : 4000;
  const double last = gallery.quick ? 3 : 9;  // [tau]
  const double side = std::cbrt(static_cast<double>(count) * silt::Sphere::volume(d / 2) / phi);
  const silt::Box box{{0, 0, 0}, {side, side, side}};
  silt::Particles<silt::Sphere> gas;
  gas.fill(silt::Box{{d / 2, d / 2, d / 2}, {side - d / 2, side - d / 2, side - d / 2}},
           {.radius = silt::uniform(d / 2, d / 2),
            .density = density,
            .count = count,
            .arrangement = silt::Arrangement::Random});
  set_velocities(gas);
  // Stiffness for an overlap of 0.5 % of d at the relative speed sqrt(2 T0).
  const double m_eff = density * silt::Sphere::volume(d / 2) / 2, overlap = 0.005 * d;
  const double k = m_eff * 2 * T0 / (overlap * overlap);
  silt::Simulation sim{std::move(gas),
                       silt::Contacts<silt::LinearSpring>{{.stiffness = k, .restitution = e}},
                       silt::PeriodicBox{box, {true, true, true}}};
  sim.threads = gallery.threads;
  const double contact = silt::linear_contact_time(k, m_eff, 0);
  sim.time_step = contact / 20;

  const double tau = 1 / cooling_rate(T0), collisions = 6 / (1 - e * e) / tau;  // [s], [1/s]
  // ln T is a sum over all collisions, each with a standard deviation equal to its mean: three
  // standard deviations. Also, contacts have a duration, collisions in the theory have none.
  const auto tolerance = [&](double x) {
    const double of_one = collisions * tau;  // [-] collisions of a sphere in ln(1 + t/tau) = 1
    return 6 * std::sqrt(std::log1p(x) / (0.5 * static_cast<double>(count) * of_one)) +
           2 * collisions * contact;
  };
  auto table = gallery.table(
      "haff", {"time over tau [-]", "temperature over T0 [-]", "Haff [-]", "tolerance [-]"});
  Worst course, exponent;
  std::vector<double> lengths, logarithms;  // ln(1 + t/tau), ln T
  sim.run(last * tau, silt::at(silt::every(tau / 20), [&](const auto& s) {
            const double x = s.time() / tau, T = temperature(s) / T0;
            table.add_row({x, T, std::pow(1 + x, -2), tolerance(x)});
            course.compare_relative(T, std::pow(1 + x, -2), tolerance(x));
            if (x > 0.5) lengths.push_back(std::log(1 + x)), logarithms.push_back(std::log(T));
          }));
  const double slope = silt::fit_polynomial<1>(lengths, logarithms).coefficients()[1];
  exponent.compare(slope, -2, tolerance(last) / std::log((1 + last) / 1.5));
  gallery.check("haff_temperature", course,
                "three deviations of ln T, a sum of independent losses; contacts of a length of "
                "their own, twice collision rate times contact time");
  gallery.check("haff_exponent", exponent, "that of T at the end over the range of ln(1 + t/tau)");
  gallery.summary.result("haff_exponent", slope);
  gallery.summary.result("haff_collision_rate_times_contact_time", collisions * contact);
  gallery.summary.result("haff_box_over_diameter", side / d);
  gallery.summary.result("haff_spheres", static_cast<double>(count));
}

}  // namespace verification
