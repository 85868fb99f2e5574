// silt - BSD-3-Clause, see LICENSE
//
// A contact law of your own. Grains yield: loading is soft, unloading stiffer. Each impact then
// dissipates the same share of the energy at every speed. Balls of three materials fall from the
// same height; the program prints the restitution of the first impact beside the prescribed one.
//
// picture: curves own_law/heights.csv --x time --y e=0.9,e=0.7,e=0.5 --y-label height -o own_law.png

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include <silt/silt.hpp>

// Plastic spring of Walton and Braun: k1 d while the overlap d increases, k2 (d - d_p) while it
// decreases; d_p is the plastic part of the largest overlap. The restitution is sqrt(k1/k2).
struct PlasticSpring {
  struct Material {
    double stiffness;    // [N/m] k1
    double restitution;  // [-]
    double friction;     // [-]
    bool operator==(const Material&) const = default;
  };
  template <class Real>
  struct Coefficients {
    Real loading, unloading, friction;  // [N/m], [N/m], [-]
  };
  template <class Real>
  struct History {
    Real largest;  // [m] overlap so far; 0 when a contact begins
  };
  static Coefficients<double> mix(const Material& a, const Material& b) {
    const double k1 = (a.stiffness + b.stiffness) / 2;
    const double e = std::min(a.restitution, b.restitution);  // of the one that yields more
    return {k1, k1 / (e * e), (a.friction + b.friction) / 2};
  }
  // Real is a double or a batch of lanes: use silt::max and silt::min instead of "if".
  template <class Real>
  static silt::Traction<Real> force(const silt::Contact<Real>& c, const Coefficients<Real>& p,
                                    History<Real>& h) {
    h.largest = silt::max(h.largest, c.overlap);
    const Real stays = h.largest * (Real(1) - p.loading / p.unloading);
    const Real normal = silt::max(p.unloading * (c.overlap - stays), Real(0));
    const auto& v = c.tangential_velocity;
    const Real speed = silt::sqrt(dot(v, v) + Real(1e-12));
    // Coulomb friction; near zero slip, where the direction is undefined, a dashpot of 0.1 N s/m.
    return {normal, -silt::min(p.friction * normal / speed, Real(0.1)) * v};
  }
  // For the time step: the shortest contact [s] of two bodies of this effective mass.
  static double contact_time(const Coefficients<double>& p, double, double m_eff, double) {
    return M_PI * std::sqrt(m_eff / p.unloading);
  }
};
static_assert(silt::ContactLaw<PlasticSpring>);

int main() {
  const double asked[] = {0.9, 0.7, 0.5}, radius = 5e-3, drop = 0.1;  // [-], [m], [m]
  const PlasticSpring::Material plate{.stiffness = 2e4, .restitution = 1, .friction = 0.3};
  silt::Contacts<PlasticSpring, silt::SeveralMaterials> contacts{{plate}};
  silt::Particles<silt::Sphere> balls;
  for (int k = 0; k < 3; ++k)
    balls.add({.position = {0.02 * k, 0, radius + drop},
               .radius = radius,
               .density = 2500,
               .material = contacts.add({2e4, asked[k], 0.3})});

  silt::Simulation sim{std::move(balls), contacts};
  sim.gravity = {0, 0, -9.81};
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, plate);

  std::array<double, 3> rebound{};  // [m] largest height after the first impact
  const double fall = std::sqrt(2 * drop / 9.81);
  sim.run(0.6,
          silt::table("own_law/heights.csv", {"time [s]", "e=0.9 [m]", "e=0.7 [m]", "e=0.5 [m]"},
                      silt::every(2e-3),
                      [&](const auto& s) {
                        std::array<double, 4> row{s.time()};
                        for (std::size_t k = 0; k < 3; ++k)
                          row[k + 1] = s.position(s.find(k)).z - radius;
                        return row;
                      }),
          silt::at(silt::every(1e-3), [&](const auto& s) {
            for (std::size_t k = 0; k < 3; ++k)
              if (s.time() > 1.2 * fall)
                rebound[k] = std::max(rebound[k], s.position(s.find(k)).z - radius);
          }));

  bool right = true;
  for (int k = 0; k < 3; ++k) {
    const double found = std::sqrt(rebound[k] / drop);
    std::printf("restitution %.3f, asked for %.1f\n", found, asked[k]);
    // Fails if the history is lost during an impact: the balls would lose no energy.
    right = right && std::abs(found - asked[k]) < 0.02;
  }
  return right ? 0 : 1;
}
