// silt - BSD-3-Clause, see LICENSE
// A module with a flux, of docs/modules.md: heat flows through a row of beads between a hot and a
// cold wall.

#include <cmath>
#include <cstdio>

#include <silt/silt.hpp>

struct Conduction {
  double conductivity, heat_capacity;  // [W/(m K)], [J/(kg K)]
  double hot, cold;                    // [K] of walls 0 and 1
  struct Fields {
    double temperature = 293;  // [K]
  };
  static constexpr std::array names{"temperature [K]"};
  static constexpr auto exchanged = &Fields::temperature;
  template <class Real>
  Real flux(const silt::Touching<Real>& c, const Real& a, const Real& b) const {  // [W] into a
    return Real(2 * conductivity) * sqrt(c.R_eff * c.overlap) * (b - a);
  }
  double at_wall(std::size_t wall, double) const { return wall == 0 ? hot : cold; }
  void update(const silt::Seen& p, Fields& f, double watts, double dt) const {
    f.temperature += watts / (p.mass * heat_capacity) * dt;
  }
};

int main() {
  const silt::HertzMindlin::Material rubber{
      .youngs_modulus = 1e6, .poisson_ratio = 0.3, .restitution = 0.3, .friction = 0.4};
  const double R = 1e-3, length = 9.8e-3;  // [m] five beads, pressed together
  silt::Particles<silt::Sphere> beads;
  for (int k = 0; k < 5; ++k)
    beads.add({.position = {(k + 0.5) * length / 5, 0, 0}, .radius = R, .density = 1000});
  // With a small heat capacity the steady state is reached sooner, and is the same.
  silt::Simulation sim{std::move(beads), silt::Contacts<silt::HertzMindlin>{rubber},
                       Conduction{.conductivity = 50, .heat_capacity = 2, .hot = 393, .cold = 293}};
  sim.add_wall(silt::Plane{{0, 0, 0}, {1, 0, 0}}, rubber);
  sim.add_wall(silt::Plane{{length, 0, 0}, {-1, 0, 0}}, rubber);
  sim.time_step = 5e-6;  // nothing moves, so that silt cannot choose it
  sim.run(0.1);

  // Fails if ends are interchanged, if walls give nothing or twice, or if a bead receives heat that
  // its neighbour does not lose. Reference: resistances in series, from the actual overlaps.
  const auto resistance = [](double R_eff, double overlap) {
    return 1 / (100 * std::sqrt(R_eff * overlap));
  };
  const auto x = [&](std::size_t k) { return sim.position(sim.find(k)).x; };
  double before[6];  // [K/W] between the hot wall and each bead; in all
  before[0] = resistance(R, R - x(0));
  for (std::size_t k = 1; k < 5; ++k)
    before[k] = before[k - 1] + resistance(R / 2, 2 * R - (x(k) - x(k - 1)));
  before[5] = before[4] + resistance(R, R - (length - x(4)));
  bool right = true;
  for (std::size_t k = 0; k < 5; ++k) {
    const double found = sim.field<Conduction>(sim.find(k)).temperature;
    const double wanted = 393 - 100 * before[k] / before[5];
    std::printf("bead %zu: %.3f K, in series %.3f K\n", k, found, wanted);
    right &= std::abs(found - wanted) < 1e-3;
  }
  return right ? 0 : 1;
}
