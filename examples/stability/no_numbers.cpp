// silt - BSD-3-Clause, see LICENSE
// NaN, and meaningless combinations: all must be refused or stopped.

#include <cmath>
#include <limits>

#include <silt/contact/hertz_mindlin.hpp>
#include <silt/contact/linear_spring.hpp>
#include <silt/contact/rolling/epsd.hpp>

#include "stability/impact.hpp"
#include "stability/table.hpp"

namespace stability {

namespace no_numbers_rows {

using namespace silt;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double radius = 1e-3, density = 2500;  // [m], [kg/m3]
const HertzMindlin::Material rubber{1e7, 0.3, 0.5, 0.3};

/// A user-defined law whose force is NaN above some overlap.
struct Broken {
  struct Material {
    double k;  // [N/m]
    bool operator==(const Material&) const = default;
  };
  template <class Real>
  struct Coefficients {
    Real k;
  };
  static Coefficients<double> mix(const Material& a, const Material&) { return {a.k}; }
  template <class Real>
  static Real force(const Contact<Real>& c, const Coefficients<Real>& p) {
    return p.k * c.overlap + sqrt(Real(1e-5) - c.overlap);
  }
};

/// A user-defined rolling model whose couple is NaN.
struct BrokenRolling {
  static constexpr bool is_rolling_model = true;
  struct Pair {};
  template <class Real>
  struct Coefficients {
    Real unused;
  };
  static Coefficients<double> mix(const Pair&) { return {0}; }
  static void check(const Pair&) {}
  template <class Real>
  static Vec3<Real> torque(const RollingContact<Real>& c, const Coefficients<Real>&) {
    const Real none = sqrt(-c.overlap - Real(1));
    return {none, none, none};
  }
};

template <class ContactsType>
auto falling(const ContactsType& contacts, const Vec3d& velocity = {0, 0, -1}) {
  Particles<Sphere> spheres;
  spheres.add({.position = {0, 0, 1.05 * radius},
               .radius = radius,
               .density = density,
               .velocity = velocity});
  Simulation sim{std::move(spheres), contacts};
  sim.threads = 1;
  return sim;
}

/// The run ended normally, which it must not.
Measures passed(const Vec3d& velocity) {
  return {{is_finite(velocity) ? "passed as if nothing were" : "no number at the end", NAN, 0}};
}

/// A scene that `change` makes invalid.
template <class Change>
Measures spoilt(const Change& change, const Surfaces& floor = Plane{{0, 0, 0}, {0, 0, 1}},
                const Motion& motion = {}) {
  const Contacts<HertzMindlin> contacts{rubber};
  auto sim = falling(contacts);
  sim.add_wall(floor, rubber, motion);
  change(sim);
  sim.run(2e-3);
  return passed(sim.velocity(0));
}

Motion motion_of(double start, const std::function<Pose(double)>& later) {
  return [=](double t) { return t < start ? Pose{} : later(t); };
}

}  // namespace no_numbers_rows

void no_numbers(Table& table) {
  using namespace no_numbers_rows;
  table.scene("What is no number", "stopped or refused, never gone on with");
  const auto same = [](auto&) {};
  const Surfaces floor = Plane{{0, 0, 0}, {0, 0, 1}};
  // The message must be about the error made here: any other would hide it.
  const auto row = [&](const std::string& name, const std::string& words,
                       const std::function<Measures()>& run) { table.stops(name, words, run); };
  row("gravity", "Simulation::gravity", [&] { return spoilt([](auto& s) { s.gravity.z = nan; }); });
  row("time step", "Simulation::time_step = nan",
      [&] { return spoilt([](auto& s) { s.time_step = nan; }); });
  row("guard.max_overlap", "Guard.max_overlap = nan",
      [&] { return spoilt([](auto& s) { s.guard.max_overlap = nan; }); });
  row("duration", "duration = nan", [&] {
    auto sim = falling(Contacts<HertzMindlin>{rubber});
    sim.run(nan);
    return passed(sim.velocity(0));
  });
  row("velocity of a particle", "velocity = (0, nan, 0)", [&] {
    return passed(falling(Contacts<HertzMindlin>{rubber}, {0, nan, 0}).velocity(0));
  });
  row("modulus", "youngs_modulus = nan", [&] {
    return passed(falling(Contacts<HertzMindlin>{{nan, 0.3, 0.5, 0.3}}).velocity(0));
  });
  row("point of a plane", "Plane.point = (0, 0, nan)", [&] {
    return spoilt(same, Plane{{0, 0, nan}, {0, 0, 1}});
  });
  row("corner of a mesh", "has the vertex (0, 0, nan)", [&] {
    return spoilt(same, TriangleMesh({{Vec3d{0, 0, nan}, Vec3d{1, 0, 0}, Vec3d{0, 1, 0}}}));
  });
  row("gravity, changed by an observer", "gravity = (0, 0, nan)", [&] {
    auto sim = falling(Contacts<HertzMindlin>{rubber});
    sim.run(1e-3, [&](const auto& s) {
      if (s.step() == 5) sim.gravity.z = nan;
    });
    return passed(sim.velocity(0));
  });
  row("place of a moving wall, from the start", "gives a pose that is not finite", [&] {
    return spoilt(same, floor, [](double) { return Pose{{}, {0, 0, nan}}; });
  });
  row("place of a moving wall, later", "gives a pose that is not finite", [&] {
    return spoilt(same, floor, motion_of(2e-5, [](double) { return Pose{{}, {0, 0, nan}}; }));
  });
  row("place of a moving mesh, later", "gives a pose that is not finite", [&] {
    const double s = 20 * radius;
    return spoilt(same, TriangleMesh({{Vec3d{-s, -s, 0}, Vec3d{s, -s, 0}, Vec3d{0, s, 0}}}),
                  motion_of(2e-5, [](double) {
                    return Pose{{}, {0, 0, nan}};
                  }));
  });
  row("rotation of a moving wall is no rotation", "quaternion is not of length 1", [&] {
    return spoilt(same, floor, [](double) { return Pose{{2, 0, 0, 0}, {0, 0, 0}}; });
  });
  row("force of a law of the user's", "velocity of particle 0 is not finite", [&] {
    const Contacts<Broken> contacts{{1e3}};
    auto sim = falling(contacts);
    sim.add_wall(floor, {1e3});
    sim.time_step = 1e-6;
    sim.run(1e-3);
    return passed(sim.velocity(0));
  });
  row("couple of a rolling model of the user's", "angular velocity of particle 0 is not finite",
      [&] {
        const Contacts<LinearSpring, BrokenRolling> contacts{{1e4, 0.5}, {}};
        auto sim = falling(contacts);
        sim.add_wall(floor, {1e4, 0.5});
        sim.run(1e-3);
        return passed(sim.angular_velocity(0));
      });

  table.scene("What makes no sense", "stopped or refused, never gone on with");
  row("a wall jumps over a grain", "overlaps wall 0", [&] {
    return spoilt(same, floor, motion_of(2e-5, [](double) { return Pose{{}, {0, 0, 0.01}}; }));
  });
  row("a mesh jumps over a grain", "is above its limit", [&] {
    const double s = 20 * radius;
    return spoilt(same, TriangleMesh({{Vec3d{-s, -s, 0}, Vec3d{s, -s, 0}, Vec3d{0, s, 0}}}),
                  motion_of(2e-5, [](double) {
                    return Pose{{}, {0, 0, 0.01}};
                  }));
  });
  row("guard.max_overlap = 2 with a mesh wall, soft", "must be less than 1 together", [&] {
    const Contacts<LinearSpring> contacts{{.stiffness = 1, .restitution = 0.5}};
    auto sim = falling(contacts);
    const double s = 20 * radius;
    sim.add_wall(TriangleMesh({{Vec3d{-s, -s, 0}, Vec3d{s, -s, 0}, Vec3d{0, s, 0}}}),
                 {.stiffness = 1, .restitution = 0.5});
    sim.guard.max_overlap = 2;
    sim.run(5 * radius);
    return Measures{{"through the mesh", sim.position(0).z < 0 ? 1.0 : 0.0, 0}};
  });
  row("two spheres in the same place", "(0, 0, 0)", [&] {
    Particles<Sphere> spheres;
    for (int k = 0; k < 2; ++k)
      spheres.add({.position = {0, 0, 0}, .radius = radius, .density = density});
    Simulation sim{std::move(spheres), Contacts<HertzMindlin>{rubber}};
    sim.threads = 1, sim.time_step = 1e-6;
    sim.run(1e-3);
    return passed(sim.velocity(0));
  });
  row("two spheres in the same place, guard.max_overlap = 3", "(0, 0, 0)", [&] {
    Particles<Sphere> spheres;
    for (int k = 0; k < 2; ++k)
      spheres.add({.position = {0, 0, 0}, .radius = radius, .density = density});
    Simulation sim{std::move(spheres), Contacts<HertzMindlin>{rubber}};
    sim.threads = 1, sim.time_step = 1e-6, sim.guard.max_overlap = 3;
    sim.run(1e-3);
    return passed(sim.velocity(0));
  });
}

}  // namespace stability
