// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>
#include <vector>

#include <silt/core/quaternion.hpp>
#include <silt/silt.hpp>

namespace engine_test {

using silt::ContactSeen;
using silt::Vec3d;

/// Momentum and angular momentum of every particle just after the kick of the present step.
struct Momenta {
  Vec3d linear, angular;  // [kg m/s], [kg m2/s] about its own centre, along the axes of space
};
template <class Sim>
std::map<silt::ParticleId, Momenta> momenta(const Sim& sim) {
  std::map<silt::ParticleId, Momenta> all;
  const auto& e = sim.engine();
  for (std::size_t k = 0; k < sim.rows(); ++k) {
    if (!sim.is_present(k) || !std::isfinite(sim.mass(k))) continue;
    Momenta& of = all[sim.id(k)];
    if constexpr (Sim::of_bodies) {
      const auto& b = e.mover.bodies[k];
      of = {sim.mass(k) * b.velocity, rotate(b.orientation, b.momentum)};
    } else {
      const auto& m = e.particles.motion[k];
      of = {sim.mass(k) * m.velocity(), {0, 0, 0}};
      if constexpr (Sim::rotates)
        of.angular = (0.4 * sim.mass(k) * sim.radius(k)) * m.spin_velocity();
    }
  }
  return all;
}

/// An observer of every step: the contacts of each particle must give it the momentum and the
/// angular momentum that the step's kick gave it, and those of each wall its force and torque.
class SumCheck {
 public:
  static constexpr bool reads_contacts = true;
  std::size_t contacts = 0, steps = 0;
  double most_force = 0, most_torque = 0, wall_force = 0, wall_torque = 0;  // [-] errors over scale

  template <class Sim>
  bool is_due(const Sim& sim) const {
    return !sim.awaits_contacts();
  }
  template <class Sim>
  void operator()(const Sim& sim) {
    std::map<silt::ParticleId, Momenta> sums;
    std::vector<Momenta> of_walls(sim.walls(), Momenta{{0, 0, 0}, {0, 0, 0}});
    double force = 1e-12, torque = 1e-15;
    sim.visit_contacts(
        [&](const ContactSeen& c) {
          ++contacts;
          const auto add = [&](silt::ParticleId id, const Vec3d& f, const Vec3d& t) {
            auto& to = sums.try_emplace(id, Momenta{{0, 0, 0}, {0, 0, 0}}).first->second;
            to.linear += f, to.angular += t;
          };
          add(c.a, c.force, c.torque_a);
          force = std::max(force, norm(c.force)), torque = std::max(torque, norm(c.torque_a));
          CHECK(std::abs(norm(c.normal) - 1) < 1e-6);
          if (c.wall == silt::no_wall) {
            CHECK(c.a < c.b);
            add(c.b, -c.force, c.torque_b);
          } else {
            const Vec3d arm = c.wall_point - sim.wall(c.wall).reference;
            of_walls[c.wall].linear -= c.force;
            of_walls[c.wall].angular -= cross(arm, c.force) + c.couple;
            torque = std::max(torque, norm(cross(arm, c.force)));
          }
        },
        "test");
    const auto now = momenta(sim);
    for (const auto& [id, after] : now) {
      const auto before = last_.find(id);
      if (before == last_.end()) continue;
      const auto sum = sums.try_emplace(id, Momenta{{0, 0, 0}, {0, 0, 0}}).first->second;
      const double m = sim.mass(sim.find(id)), per_step = 1 / sim.step_length();
      const Vec3d f = per_step * (after.linear - before->second.linear) - m * sim.gravity;
      const Vec3d t = per_step * (after.angular - before->second.angular);
      most_force = std::max(most_force, norm(f - sum.linear) / force);
      if constexpr (Sim::rotates)
        most_torque = std::max(most_torque, norm(t - sum.angular) / torque);
    }
    for (std::size_t w = 0; w < sim.walls(); ++w) {
      wall_force = std::max(wall_force, norm(sim.wall(w).force - of_walls[w].linear) / force);
      wall_torque = std::max(wall_torque, norm(sim.wall(w).torque - of_walls[w].angular) / torque);
    }
    last_ = now, ++steps;
  }

 private:
  std::map<silt::ParticleId, Momenta> last_;
};

/// `rounding`: of the sums, relative to the largest force or torque of any contact.
template <class Sim>
SumCheck check_sums(Sim& sim, double start, int steps, double rounding) {
  sim.run(start);
  SumCheck check;
  sim.run(steps * sim.step_length(), check);
  CHECK(check.steps >= static_cast<std::size_t>(steps));
  CHECK(check.most_force < rounding);
  CHECK(check.most_torque < rounding);
  CHECK(check.wall_force < rounding);
  CHECK(check.wall_torque < rounding);
  return check;
}

/// All numbers of all contacts, in their order.
template <class Sim>
std::vector<double> numbers_of(const Sim& sim) {
  std::vector<double> all;
  sim.for_each_contact([&](const ContactSeen& c) {
    for (const auto whole :
         {c.a, c.b, silt::ParticleId{c.wall}, silt::ParticleId{c.surface},
          silt::ParticleId{c.part_a}, silt::ParticleId{c.part_b}, silt::ParticleId{c.facet}})
      all.push_back(static_cast<double>(whole));
    for (const auto& v : {c.point, c.normal, c.branch, c.force, c.tangential_force, c.torque_a,
                          c.torque_b, c.couple, c.spring})
      all.insert(all.end(), {v.x, v.y, v.z});
    all.insert(all.end(), {c.overlap, c.normal_force, c.cohesion});
    all.insert(all.end(), c.history.begin(), c.history.end());
  });
  return all;
}

}  // namespace engine_test
