// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string>
#include <tuple>

#include <silt/core/error.hpp>
#include <silt/sph/opening.hpp>
#include <silt/sph/setup.hpp>

namespace silt::inline SILT_TARGET::detail {

/// An opening of an Sph with the axes of the rectangle.
struct SphOpening {
  Opening opening;
  OpeningSetup setup;
  bool inlet = false;
  bool plane = false;  // of a liquid in 2D
  Vec3d middle{0, 0, 0}, normal{0, 0, 0};
  std::array<Vec3d, 2> along{};        // [-]
  std::array<double, 2> length{};      // [m]
  std::array<std::size_t, 2> sites{};  // [-] spacings along them
  OpeningBooks books{};

  std::string called() const { return text(inlet ? "inlet " : "outlet ", in_quotes(setup.name)); }

  /// A point in coordinates of the opening [m]: distance in front of it (negative: behind), and
  /// position along its edges from its middle.
  struct Seen {
    double front;
    std::array<double, 2> along;
  };
  /// Whether a point is within the rectangle extended by `more` [m].
  bool within(const Seen& at, double more) const {
    return std::abs(at.along[0]) <= 0.5 * length[0] + more &&
           std::abs(at.along[1]) <= 0.5 * length[1] + more;
  }
  /// visit(i, j, position) for the centres of its squares, one spacing wide.
  template <class Visit>
  void for_each_site(double spacing, const Visit& visit) const {
    for (std::size_t i = 0; i < sites[0]; ++i)
      for (std::size_t j = 0; j < sites[1]; ++j) {
        const auto off = [&](std::size_t e, std::size_t k) {
          return ((static_cast<double>(k) + 0.5) * spacing - 0.5 * length[e]) * along[e];
        };
        visit(i, j, middle + off(0, i) + off(1, j));
      }
  }
  /// Finds the axes; InputError for an impossible opening.
  void lay_out(const SphSetup& sph) {
    Opening& o = opening;
    const std::string name = called();
    plane = sph.dimensions == 2;
    if (plane) {
      require(o.edge.y == 0 && o.into.y == 0 && norm(o.second_edge) == 0, "Sph: in 2D ", name,
              " lies in x and z and has one edge; its edge is ", o.edge, " m, its second edge ",
              o.second_edge, " m, into ", o.into);
      require(!(std::abs(o.corner.y - sph.region.min.y) > 1e-6 * sph.spacing), "Sph: ", name,
              " has its corner at ", o.corner,
              " m, but in 2D the liquid lies in the plane y = ", sph.region.min.y,
              " m; give the corner that y");
      o.corner.y = sph.region.min.y, o.second_edge = {0, sph.spacing, 0};
    }
    for (const Vec3d& x : {o.corner, o.edge, o.second_edge, o.into})
      require(is_finite(x), "Sph: ", name, ": its corner ", o.corner, " m, edges ", o.edge,
              " m and ", o.second_edge, " m, and into ", o.into, " must be finite");
    const double turn = norm(o.into);
    require(turn > 0, "Sph: ", name, " has no direction; give Opening.into, towards the liquid");
    normal = (1 / turn) * o.into;
    const Vec3d edges[2] = {o.edge, o.second_edge};
    for (std::size_t e = 0; e < 2; ++e) {
      const double l = norm(edges[e]), across = l / sph.spacing;
      require(l > 0.5 * sph.spacing && std::abs(across - std::round(across)) < 1e-6 * across,
              "Sph: ", name, " has an edge of ", l, " m, which is ", across,
              " spacings; it must be a whole number of them");
      along[e] = (1 / l) * edges[e], length[e] = l;
      sites[e] = static_cast<std::size_t>(std::round(across));
    }
    constexpr double askew = 1e-6;
    require(std::abs(dot(along[0], along[1])) < askew && std::abs(dot(along[0], normal)) < askew &&
                std::abs(dot(along[1], normal)) < askew,
            "Sph: ", name, ": its edges ", o.edge, " m and ", o.second_edge, " m and into ", o.into,
            " must be at right angles");
    middle = o.corner + 0.5 * o.edge;
    if (sph.dimensions == 3) middle += 0.5 * o.second_edge;
    const double facing[3] = {normal.x, normal.y, normal.z};
    for (std::size_t d = 0; d < 3; ++d)
      require(!sph.periodic[d] || std::abs(facing[d]) < 1e-9, "Sph: ", name, " faces ", "xyz"[d],
              ", in which the region is periodic; liquid re-enters there by itself");
    const Box b = sph.region.grown(1e-6 * sph.spacing);
    for (const Vec3d& x :
         {o.corner, o.corner + o.edge, sph.dimensions == 2 ? o.corner : o.corner + o.second_edge,
          sph.dimensions == 2 ? o.corner : o.corner + o.edge + o.second_edge})
      require(x.x >= b.min.x && x.x <= b.max.x && x.y >= b.min.y && x.y <= b.max.y &&
                  x.z >= b.min.z && x.z <= b.max.z,
              "Sph: ", name, " has a corner at ", x, " m, outside of SphSetup.region from ",
              sph.region.min, " to ", sph.region.max,
              " m; its buffer may be outside, the opening may not");
  }
  /// InputError for impossible conditions.
  void check(const Liquid& liquid) const {
    const auto& [velocity, pressure] = std::tie(setup.velocity, setup.pressure);
    require(!inlet || velocity.given() || pressure.given(), "Sph: ", called(),
            " has neither a velocity nor a pressure; give one");
    if (const Vec3d* const v = velocity.constant()) {
      const double forward = dot(*v, normal);
      require(is_finite(*v), "Sph: ", called(), ": velocity = ", *v, " m/s must be finite");
      require(inlet ? forward > 0 : forward <= 0, "Sph: ", called(), ": its velocity of ", *v,
              inlet ? " m/s points out of the liquid; reverse Opening.into or the velocity"
                    : " m/s points into the liquid; reverse it, or add an inlet");
      check_velocity(*v, liquid, middle, 0);
    }
    const double* const p = pressure.constant();
    require(p == nullptr || std::isfinite(*p), "Sph: ", called(),
            ": pressure = ", p == nullptr ? 0 : *p, " Pa must be finite");
    require(!pressure.hydrostatic || std::isfinite(pressure.hydrostatic->surface),
            "Sph: ", called(), ": Hydrostatic.surface must be finite");
    require(!setup.surface || std::isfinite(*setup.surface), "Sph: ", called(),
            ": surface must be finite");
    require(!setup.surface || inlet, "Sph: ", called(),
            ": an outlet has no surface of its own, liquid leaves at any height; for its pressure "
            "give silt::Hydrostatic{surface}");
  }
  bool is_prescribed() const { return setup.velocity.given() && setup.pressure.given(); }
  /// [m/s] at a point on the opening.
  Vec3d velocity_at(const Vec3d& foot, double time, const Liquid& liquid) const {
    const Vec3d v = setup.velocity.at(foot, time);
    if (setup.velocity.constant() != nullptr) return v;
    const double forward = dot(v, normal);
    require(is_finite(v), "Sph: ", called(), ": its velocity at ", foot, " m, t = ", time, " s is ",
            v, " m/s; it must be finite");
    check_velocity(v, liquid, foot, time);
    const double none = 1e-9 * liquid.sound_speed;
    require(inlet ? forward >= -none : forward <= none, "Sph: ", called(), ": its velocity at ",
            foot, " m, t = ", time, " s is ", v,
            inlet ? " m/s, out of the liquid; an inlet's function must lead in, or be 0"
                  : " m/s, into the liquid; an outlet's function must lead out, or be 0");
    return v;
  }
  /// [Pa] at a point in the buffer.
  double pressure_at(const Vec3d& x, double time, const Liquid& liquid,
                     const Vec3d& gravity) const {
    if (const auto& still = setup.pressure.hydrostatic)
      return std::max(
          liquid.density * (std::sqrt(dot(gravity, gravity)) * still->surface + dot(gravity, x)),
          0.0);
    const double p = setup.pressure.at(x, time);
    require(std::isfinite(p) && p > -0.1 * liquid.stiffness(), "Sph: ", called(),
            ": its pressure at ", x, " m, t = ", time, " s is ", p, " Pa; it must be finite, and ",
            "above ", -0.1 * liquid.stiffness(), " Pa");
    return p;
  }
  void check_velocity(const Vec3d& v, const Liquid& liquid, const Vec3d& at, double time) const {
    require(norm(v) <= 0.1 * liquid.sound_speed * (1 + 1e-9), "Sph: ", called(),
            " has a velocity of ", v, " m/s at ", at, " m, t = ", time,
            " s, faster than a tenth of Liquid.sound_speed = ", liquid.sound_speed,
            " m/s; use a larger sound_speed");
    require(!plane || std::abs(v.y) <= 1e-9 * norm(v), "Sph: ", called(), " has a velocity of ", v,
            " m/s at ", at, " m, t = ", time,
            " s, with a part along y, but in 2D the liquid lies in x and z; give a velocity with y "
            "= 0");
  }
};

}  // namespace silt::detail
