// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include <silt/contact/hertz_mindlin.hpp>
#include <silt/contact/impact.hpp>
#include <silt/simulation.hpp>

namespace verification {

using silt::Vec3d;

struct Solid {
  double youngs_modulus;  // [Pa]
  double poisson_ratio;   // [-]
  double density;         // [kg/m3]
};

/// `solid` made stiff enough to count as rigid, as Chung and Ooi's planes.
inline Solid rigid(Solid solid) {
  solid.youngs_modulus *= 1000;
  return solid;
}

struct Ball {
  Solid solid;
  double radius;            // [m]
  Vec3d velocity{0, 0, 0};  // [m/s]
  Vec3d spin{0, 0, 0};      // [rad/s]

  double mass() const { return solid.density * silt::Sphere::volume(radius); }
};

/// A ball that falls on the plane z = 0, or on another ball below it.
struct Impact {
  Ball ball;
  Solid plane{};                   // counts if there is no other ball
  std::optional<Ball> other = {};  // touches the plane z = 0 from below
  double restitution = 1;          // [-]
  double friction = 0;             // [-]
  double steps = 500;              // [-] an undamped contact
  double first_gap = 7.3;          // [-] steps until touch
  double full_radius = 0;          // [m] of Softened laws
  double softness = 1;             // [-] what they make of E*
  const Solid& partner() const { return other ? other->solid : plane; }
  double R_eff() const {
    return other ? silt::effective_radius(ball.radius, other->radius) : ball.radius;
  }
  double m_eff() const {
    return other ? silt::effective_mass(ball.mass(), other->mass()) : ball.mass();
  }
  double E_eff() const { return softness * modulus_of_solids(); }
  double modulus_of_solids() const {
    return silt::effective_modulus(ball.solid.youngs_modulus, ball.solid.poisson_ratio,
                                   partner().youngs_modulus, partner().poisson_ratio);
  }
  /// S_t/S_n [-]
  double stiffness_ratio() const {
    return 4 *
           silt::effective_shear_modulus(ball.solid.youngs_modulus, ball.solid.poisson_ratio,
                                         partner().youngs_modulus, partner().poisson_ratio) /
           modulus_of_solids();
  }
  /// Approach speed [m/s].
  double normal_speed() const { return (other ? other->velocity.z : 0) - ball.velocity.z; }
  silt::HertzImpact hertz(silt::DampingEnd end) const {
    return {E_eff(), R_eff(), m_eff(), normal_speed(), silt::damping_ratio(restitution, end)};
  }
  double contact_time() const {  // [s] without damping
    return silt::hertz_contact_time(E_eff(), R_eff(), m_eff(), normal_speed());
  }
};

/// Quantities during the contact; the force along the normal.
struct Moment {
  double time, overlap, force;  // [s] since touch, [m], [N]
};

struct Rebound {
  Vec3d velocity, spin;                   // [m/s], [rad/s] of the ball
  Vec3d other_velocity, other_spin;       // of the other one, if there is one
  double largest_overlap, largest_force;  // [m], [N]
  double duration;                        // [s] in which the force acts
  double safeguarded;                     // [-] how often the safeguard of Softened acted
  std::vector<Moment> history;
};

template <class Law>
auto scene_of(const Impact& impact) {
  const auto material = [&](const Solid& s) {
    if constexpr (requires(typename Law::Material m) { m.full_radius; })
      return typename Law::Material{
          .solid = {.youngs_modulus = s.youngs_modulus, .poisson_ratio = s.poisson_ratio},
          .full_radius = impact.full_radius};
    else
      return typename Law::Material{.youngs_modulus = s.youngs_modulus,
                                    .poisson_ratio = s.poisson_ratio};
  };
  const auto upper = material(impact.ball.solid), lower = material(impact.partner());
  silt::Contacts<Law, silt::SeveralMaterials> contacts{{upper}};
  contacts.set_pair(upper, lower, {impact.restitution, impact.friction});

  const double dt = impact.contact_time() / impact.steps;
  const double gap = impact.first_gap * dt * impact.normal_speed();
  silt::Particles<silt::Sphere> balls;
  const auto add = [&](const Ball& b, double height) {
    balls.add({.position = {0, 0, height},
               .radius = b.radius,
               .density = b.solid.density,
               .velocity = b.velocity,
               .angular_velocity = b.spin,
               .material = contacts.add(material(b.solid))});
  };
  add(impact.ball, impact.ball.radius + gap);
  if (impact.other) add(*impact.other, -impact.other->radius);
  silt::Simulation sim{std::move(balls), contacts};
  if (!impact.other) sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, lower);
  sim.threads = 1;
  sim.time_step = dt;
  sim.guard.max_overlap = 0.5;  // that of the safeguard of Softened, 0.3, is passed before it acts
  return sim;
}

/// Runs the impact in a Simulation. The force is the second difference of the distance; for
/// leapfrog this is exact, for planes and balls alike.
template <class Law>
Rebound strike(const Impact& impact) {
  auto sim = scene_of<Law>(impact);
  const double dt = *sim.time_step, reach = impact.ball.radius;
  const double other_reach = impact.other ? impact.other->radius : 0;
  Rebound out{};
  double gaps[3] = {0, 0, 0};  // [m] two steps ago, one, now
  // Twice the undamped contact: the longest here, e = 0.1 until zero overlap, takes 1.51 of it.
  sim.run(2 * impact.contact_time() + (impact.first_gap + 3) * dt, [&](const auto& s) {
    const Vec3d a = s.position(s.find(0));
    const Vec3d b = impact.other ? s.position(s.find(1)) : Vec3d{a.x, a.y, 0};
    std::rotate(gaps, gaps + 1, gaps + 3);
    gaps[2] = norm(a - b) - reach - other_reach;
    if (s.step() < 2 || gaps[1] >= 0) return;
    const double force = impact.m_eff() * (gaps[2] - 2 * gaps[1] + gaps[0]) / (dt * dt);
    out.largest_overlap = std::max(out.largest_overlap, -gaps[1]);
    out.largest_force = std::max(out.largest_force, force);
    if (std::abs(force) > 1e-6 * out.largest_force) out.duration += dt;
    out.history.push_back({s.time() - dt * (impact.first_gap + 1), -gaps[1], force});
  });
  out.velocity = sim.velocity(sim.find(0));
  out.spin = sim.angular_velocity(sim.find(0));
  if constexpr (requires { sim.safeguarded(); })
    out.safeguarded = static_cast<double>(sim.safeguarded());
  if (impact.other) {
    out.other_velocity = sim.velocity(sim.find(1));
    out.other_spin = sim.angular_velocity(sim.find(1));
  }
  return out;
}

/// Allowed relative error with `steps` per contact in restitution, overlap and force: the dashpot's
/// force starts at some instant within a step, an error of up to one step of it, 2 pi zeta/n, plus
/// leapfrog's own 1.9/n^2 (tests/physics/impact.cpp).
inline double step_error(double zeta, double steps) {
  return 2 * std::numbers::pi * zeta / steps + 1.9 / (steps * steps);
}

}  // namespace verification
