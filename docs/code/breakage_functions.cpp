// silt - BSD-3-Clause, see LICENSE
// A program of docs/breakage.md: the functions without a simulation. A sphere of the synthetic
// material S hits a steel wall.

#include <cmath>
#include <cstdio>
#include <numbers>

#include <silt/silt.hpp>

/// The input of the functions for an impact of a sphere of this diameter [m] at this speed [m/s].
silt::Impact on_steel(double diameter, double speed) {
  const double mass = 2165 * std::numbers::pi / 6 * std::pow(diameter, 3);
  const silt::HertzImpact hertz{.E_eff = silt::effective_modulus(20e9, 0.25, 210e9, 0.3),
                                .R_eff = diameter / 2,
                                .m_eff = mass,
                                .speed = speed};
  return {.diameter = diameter,
          .mass = mass,
          .speed = speed,
          .m_eff = mass,
          .R_eff = diameter / 2,
          .elastic_force = silt::hertz_max_elastic_force(hertz),
          .contact_force = NAN,
          .at_wall = true};
}

int main() {
  const silt::LogLogisticStrength strength{
      .median = 31, .at_diameter = 2e-3, .exponent = 1.6, .spread = 3};
  const silt::HertzEquivalence hertz;
  const silt::GaudinSchuhmann sizes{.exponent = 0.8, .coarsest = 0.8};
  const silt::PowerFatigue fatigue{.kappa = 0.1, .psi = 3};

  // How many break at 8 m/s, and the life of one whose rank is 0.3.
  const silt::Impact impact = on_steel(2e-3, 8);
  const double broken = silt::selection(strength, hertz, impact);
  double left = strength.strength(impact.diameter, impact.mass, 0.3);
  const double load = hertz.load(on_steel(2e-3, 3));
  int impacts = 1;
  while (load < left) left = fatigue.weakened(left, load), ++impacts;

  // It breaks: fragments from 0.3 mm on, of smaller sizes the dust, kept in a table.
  const silt::Broken parent{impact.diameter, impact.mass, left, load, 3};
  silt::check_sizes(sizes, parent);
  silt::Random random(1);
  silt::SizeTable dust(1e-3);
  const auto fragments =
      silt::fragment_sizes(sizes, parent, 2165, {.dust_below = 0.3e-3, .most = 12}, random);
  silt::add_dust(dust, sizes, parent, fragments, 2165, 0.02);
  std::printf("%.3f break at 8 m/s; at 3 m/s one of the rank 0.3 breaks at the impact %d\n", broken,
              impacts);
  std::printf("%zu fragments, dust %.3f of the mass, d50 of the dust %.3g mm\n",
              fragments.masses.size(), fragments.dust / parent.mass, 1e3 * dust.quantile(0.5));

  double mass = dust.mass();
  for (const double m : fragments.masses) mass += m;
  return std::abs(mass / parent.mass - 1) < 1e-12 && std::abs(broken - 0.79) < 0.01 ? 0 : 1;
}
