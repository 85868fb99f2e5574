// silt - BSD-3-Clause, see LICENSE
//
// Restitution and friction of a bead from two throws (docs/calibration.md).

#include <silt/silt.hpp>
#include <silt/study/calibrate.hpp>

namespace {

// One bead above or on a plate.
auto bead(double restitution, double friction, double height, silt::Vec3d velocity) {
  const silt::HertzMindlin::Material glass{.youngs_modulus = 5e6,
                                           .poisson_ratio = 0.25,
                                           .restitution = restitution,
                                           .friction = friction};
  silt::Particles<silt::Sphere> one;
  one.add(
      {.position = {0, 0, 2e-3 + height}, .radius = 2e-3, .density = 2500, .velocity = velocity});
  silt::Simulation sim{std::move(one), silt::Contacts<silt::HertzMindlin>{glass}};
  sim.gravity = {0, 0, -9.81};
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, glass);
  return sim;
}

// The rebound height [mm] of a bead that falls from 50 mm.
double bounce(double restitution, double friction) {
  auto sim = bead(restitution, friction, 0.05, {0, 0, 0});
  sim.run(0.11);  // it has met the plate once
  double top = 0;
  for (double before = -1; top > before; sim.run(1e-3)) before = top, top = sim.position(0).z;
  return 1e3 * (top - 2e-3);
}

// The distance [mm] that a bead thrown along the plate travels in 0.2 s: it slides, then rolls.
double throw_along(double restitution, double friction) {
  auto sim = bead(restitution, friction, 0, {0.5, 0, 0});
  sim.run(0.2);
  return 1e3 * sim.position(0).x;
}

}  // namespace

int main() {
  silt::Calibration cal{{.folder = "calibration"},
                        {{.name = "restitution [-]", .least = 0.3, .most = 0.95},
                         {.name = "friction [-]", .least = 0.05, .most = 0.6}},
                        {{.name = "bounces [mm]", .measured = 28.1, .error = 1.0},
                         {.name = "comes [mm]", .measured = 76.0, .error = 0.5}}};
  cal.run([](const std::vector<double>& p, std::uint64_t) {
    return std::vector<double>{bounce(p[0], p[1]), throw_along(p[0], p[1])};
  });
  cal.report();

  const auto& result = cal.result();
  const double restitution = result.parameters[0].recommended;
  std::printf("restitution %.3f, from %.3f to %.3f\n", restitution, result.parameters[0].low,
              result.parameters[0].high);

  // Fails if the calibration finds other values: e^2 = 28.1/50, and the friction of a bead that
  // slides until 5/7 of its speed is left and travels 76 mm in 0.2 s.
  const double slides = 0.5 * (2.0 / 7) / 9.81;  // [s] times friction
  const double friction = 0.5 * (0.5 * 2 / 7) * slides / (0.076 - 0.2 * 0.5 * 5 / 7);
  const bool right = std::abs(restitution - std::sqrt(28.1 / 50)) < 0.01 &&
                     std::abs(result.parameters[1].recommended / friction - 1) < 0.05;
  if (!right)
    std::printf("wrong: restitution must be %.3f, friction %.3f\n", std::sqrt(28.1 / 50), friction);
  return right ? 0 : 1;
}
