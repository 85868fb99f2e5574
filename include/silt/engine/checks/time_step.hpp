// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>

#include <silt/boundary/wall.hpp>
#include <silt/contact/contacts.hpp>
#include <silt/contact/formulas.hpp>
#include <silt/core/box.hpp>
#include <silt/core/dyn_array.hpp>
#include <silt/core/error.hpp>
#include <silt/engine/advance/wall_motion.hpp>
#include <silt/engine/checks/impact_damping.hpp>
#include <silt/engine/lists/list_upkeep.hpp>

namespace silt::inline SILT_TARGET::detail {

/// The spheres of one material that can have the shortest contacts: for linear springs the lightest
/// ones, for the Hertz law those with the smallest m^2/R, which may be a large sphere of low
/// density.
struct LightestSpheres {
  struct One {
    double radius = std::numeric_limits<double>::infinity();  // [m]
    double mass = std::numeric_limits<double>::infinity();    // [kg]
    bool operator==(const One&) const = default;
  };
  One of_mass, of_hertz;
  One largest{0};  // of the mobile ones
  /// Each of the three, without duplicates.
  DynArray<One> extremes() const {
    DynArray<One> all{of_mass};
    if (of_hertz != of_mass) all.push_back(of_hertz);
    if (largest != of_mass && largest != of_hertz) all.push_back(largest);
    return all;
  }
  double fixed = 0;                                     // [m] radius of the largest fixed sphere
  double least_density = One{}.mass, most_density = 0;  // [kg/m3] as m/R^3

  void include(const One& s) {
    if (!std::isfinite(s.mass)) {
      fixed = std::max(fixed, s.radius);
      return;
    }
    if (s.mass < of_mass.mass || (s.mass == of_mass.mass && s.radius > of_mass.radius)) of_mass = s;
    if (!any() || hertz(s) < hertz(of_hertz)) of_hertz = s;
    if (s.radius > largest.radius || (s.radius == largest.radius && s.mass < largest.mass))
      largest = s;
    const double density = s.mass / (s.radius * s.radius * s.radius);
    least_density = std::min(least_density, density);
    most_density = std::max(most_density, density);
  }
  /// Includes the spheres of both.
  void include_all(const LightestSpheres& more) {
    for (const One& s : more.extremes())
      if (more.any()) include(s);
    fixed = std::max(fixed, more.fixed);
    least_density = std::min(least_density, more.least_density);
    most_density = std::max(most_density, more.most_density);
  }
  bool any() const { return std::isfinite(of_hertz.mass); }
  bool is_of_one_density() const { return most_density <= (1 + 1e-9) * least_density; }
  static double hertz(const One& s) { return s.mass * s.mass / s.radius; }
};

/// Which materials may meet: spheres, and walls.
struct Meetings {
  DynArray<LightestSpheres> spheres;
  DynArray<bool> walls;
  DynArray<double> wall_mass;  // [kg] the smallest mass that meets a wall
};

/// True if the law has a closed form for its contact time.
template <class Law>
concept HasContactTime = requires(const typename Law::template Coefficients<double>& p) {
  { Law::contact_time(p, 1.0, 1.0, 1.0) } -> std::same_as<double>;
}
|| requires(const typename Law::template Coefficients<double>& p) {
  { Law::contact_time(p, 1.0, 1.0, 1.0, 1.0) } -> std::same_as<double>;
};

/// The contact that sets the time step.
struct ShortestContact {
  enum class Partner { Sphere, Fixed, Wall };
  double time = std::numeric_limits<double>::infinity();  // [s] that the step is a fraction of
  double contact = 0;                                     // [s] contact duration: longer if damped
  std::size_t material_i = 0, material_j = 0;
  double radius_i = 0, radius_j = 0;  // [m]
  Partner partner = Partner::Sphere;
};

/// The shortest contact of impacts at `speed` [m/s], over all pairs that may meet: for each pair of
/// materials the lightest spheres of each; walls only where they exist. A sphere can meet another
/// one of its own kind. If two materials have one density each, the shortest contact is between
/// their smallest or largest spheres. For several densities per material a bound is used:
///   m*^2/R* >= h_i h_j/(h_i + h_j), h the least m^2/R of a material
/// which is reached when a sphere of i meets one that is h_j/h_i times as large and as heavy.
/// `pairs`: matrix of materials, row by row.
template <class Law, class Integrator>
class ShortestContactSearch {
  using Coefficients = typename Law::template Coefficients<double>;
  using One = LightestSpheres::One;
  using Partner = ShortestContact::Partner;

 public:
  ShortestContactSearch(const DynArray<Coefficients>& pairs, const Meetings& meetings, double speed,
                        double slip_mobility)
      : speed_(speed), slip_mobility_(slip_mobility) {
    const std::size_t n = meetings.walls.size();
    for (std::size_t k = 0; k < pairs.size(); ++k) {
      const auto &a = meetings.spheres[k / n], &b = meetings.spheres[k % n];
      if (!a.any()) continue;
      p_ = &pairs[k], i_ = k / n, j_ = k % n;
      const auto of_a = a.extremes(), of_b = b.extremes();
      for (const One& s : of_a) {
        for (const One& other : of_b)
          if (b.any() && (i_ != j_ || s == other || law_needs_radii<Law>))
            look(s, other, Partner::Sphere);
        if (b.fixed > 0) look(s, {b.fixed, infinite}, Partner::Fixed);
        if (meetings.walls[j_]) look(s, {infinite, meetings.wall_mass[j_]}, Partner::Wall);
      }
      if (b.any() && i_ != j_ && !(a.is_of_one_density() && b.is_of_one_density())) {
        const double share =
            LightestSpheres::hertz(b.of_hertz) / LightestSpheres::hertz(a.of_hertz);
        look(a.of_hertz, {share * a.of_hertz.radius, share * a.of_hertz.mass}, Partner::Sphere);
      }
    }
  }
  const ShortestContact& found() const { return found_; }

 private:
  static constexpr double infinite = std::numeric_limits<double>::infinity();

  void look(const One& s, const One& other, Partner partner) {
    Meeting m{s.radius, other.radius, 0, 0, speed_, slip_mobility_};
    m.m_eff = std::isfinite(other.mass) ? s.mass * (other.mass / (s.mass + other.mass)) : s.mass;
    m.R_eff = std::isfinite(other.radius) ? s.radius * (other.radius / (s.radius + other.radius))
                                          : s.radius;
    if (!std::isfinite(other.radius)) m.radius_j = 0;
    double contact;
    if constexpr (law_needs_radii<Law>)
      contact = Law::contact_time(*p_, m.radius_i, m.radius_j, m.m_eff, speed_);
    else
      contact = Law::contact_time(*p_, m.R_eff, m.m_eff, speed_);
    require(contact > 0, "the contact law's contact_time() is ", contact,
            " s for R_eff = ", m.R_eff, " m, m_eff = ", m.m_eff, " kg and a speed of ", speed_,
            " m/s; it must be greater than 0, or infinite where it is not known: mend it");
    const double time = time_to_resolve<Law, Integrator>(*p_, m, contact);
    if (time < found_.time) found_ = {time, contact, i_, j_, m.radius_i, m.radius_j, partner};
  }

  const Coefficients* p_ = nullptr;
  std::size_t i_ = 0, j_ = 0;
  double speed_, slip_mobility_;
  ShortestContact found_;
};

/// The most characteristic value of a material, in brackets; empty if not known.
template <class Material>
std::string leading_value(const Material& m) {
  if constexpr (requires { m.youngs_modulus; })
    return sentence(" (youngs_modulus = ", m.youngs_modulus, " Pa)");
  else if constexpr (requires { m.stiffness; })
    return sentence(" (stiffness = ", m.stiffness, " N/m)");
  else if constexpr (requires { m.solid; })
    return leading_value(m.solid);
  else if constexpr (requires { m.body; })
    return leading_value(m.body);
  else
    return {};
}

/// "material 1 'steel' (youngs_modulus = 2e+11 Pa)"
template <class ContactsType>
std::string name_of_material(const ContactsType& contacts, std::size_t k) {
  return contacts.material_name(k) + leading_value(contacts.material(k));
}

/// The pair with the shortest contact, for a message.
template <class ContactsType>
std::string describe(const ShortestContact& c, const ContactsType& contacts) {
  const auto sphere = [&](std::size_t material, double radius) {
    return sentence("radius ", radius, " m and ", name_of_material(contacts, material));
  };
  auto words = sentence("of a particle of ", sphere(c.material_i, c.radius_i));
  if (c.partner == ShortestContact::Partner::Wall)
    words += sentence(" with a wall of ", name_of_material(contacts, c.material_j));
  else if (c.partner == ShortestContact::Partner::Fixed)
    words += sentence(" with a fixed one of ", sphere(c.material_j, c.radius_j));
  else
    words += sentence(" with one of ", sphere(c.material_j, c.radius_j));
  if (c.time < c.contact)
    words += sentence(", which lasts ", c.contact,
                      " s but is so strongly damped that it counts as ", c.time, " s");
  return words;
}

/// The largest present speed [m/s] of a wall where there are particles; 0 where there are none.
inline double speed_near(const Wall& wall, const Box& particles, double time) {
  constexpr double moment = 1e-6;  // [s] short compared with any motion that can be resolved
  if (!wall.moves() || !(particles.min.x <= particles.max.x)) return 0;
  if (wall.is_driven()) {
    if (const auto* d = std::get_if<ServoForce>(&wall.drive)) return d->max_speed;
    Wall next = wall;
    if (const auto* d = std::get_if<ServoTorque>(&wall.drive)) next.state.rate = d->max_rate;
    drift_wall(next, moment);
    return displacement_of(wall, wall.pose, next.pose, particles) / moment;
  }
  const double way =
      largest_displacement(wall.pose_at(time), wall.pose_at(time + moment), particles);
  return std::isfinite(way) ? way / moment : 0;  // if not finite, the run reports it
}

}  // namespace silt::detail
