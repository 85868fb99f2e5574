// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>

#include <silt/core/vec3.hpp>
#include <silt/sph/setup.hpp>

namespace silt::inline SILT_TARGET::detail {

/// What a probe sees of the liquid around it: sums of V W (1, r, r r) and of V W rho (1, r), with r
/// from the probe, and of V W v.
struct SphSeen {
  struct Mirrored {
    double density;  // [kg/m3]
    Vec3d velocity;  // [m/s] of the liquid
    double share;    // [-] by which that counts
  };
  double weight = 0, density = 0;
  Vec3d way{0, 0, 0}, density_way{0, 0, 0}, velocity{0, 0, 0};
  double xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;

  /// The linear function through what is seen, by least squares with weights V W: of a quantity f
  /// with the sums of V W f r and V W f the slope is slope(those), the value at `centre` the
  /// mean.
  struct Fit {
    Vec3d centre;
    double A, B, C, E, F, G, det, s, h;
    bool known() const {
      constexpr double thin = 1e-4;  // of 0.01 of an even neighbourhood
      return det > thin;
    }
    Vec3d slope(const Vec3d& of_way, double sum) const {
      const Vec3d t = (s * h) * (of_way - sum * centre);
      return (1 / (det * h)) * Vec3d{A * t.x + B * t.y + C * t.z, B * t.x + E * t.y + F * t.z,
                                     C * t.x + F * t.y + G * t.z};
    }
  };
  Fit fit(double h_) const {
    const Vec3d centre = (1 / weight) * way;
    // Second moments about the centre, in h^2 and by weight.
    const double s = 1 / (weight * h_ * h_), o = 1 / (h_ * h_);
    const double a = xx * s - centre.x * centre.x * o, b = xy * s - centre.x * centre.y * o,
                 d = xz * s - centre.x * centre.z * o, f = yz * s - centre.y * centre.z * o,
                 g = zz * s - centre.z * centre.z * o;
    const double flat = 1e-9;
    double e = yy * s - centre.y * centre.y * o;
    if (e < flat) e = 1;  // in 2D
    const double A = e * g - f * f, B = d * f - b * g, C = b * f - d * e;
    const double det = a * A + b * B + d * C;
    return {centre, A, B, C, a * g - d * d, b * d - a * f, a * e - b * b, det, s, h_};
  }

  /// Density and velocity of a wall's particle that is `away` [m] from the probe, its mirror image:
  /// density as a linear function through what is seen (mDBC), velocity as a mean. Where too little
  /// is seen for a slope, that of a liquid at rest: below 0.4 of a neighbourhood, in part up to
  /// 0.6. (By the slope of films and drops, jets of three particles that hit a plane gained four
  /// times their energy.) Between bodies that touch the image lies in another one and sees the
  /// liquid of another pore. Among `bodies`, where less than half of the neighbourhood is liquid,
  /// the density is that of a liquid at rest, and its velocity does not count; wholly it does from
  /// 0.6 on. (At a plane wall 0.65 to 0.7 are.) Without, a packed bed in a liquid that sticks to it
  /// blows up within milliseconds.
  ///
  /// Source: A. English, J. M. Dominguez, R. Vacondio, A. J. C. Crespo, P. K. Stansby, S. J. Lind,
  ///   L. Chiapponi, M. Gomez-Gesteira, Comput. Part. Mech. 9 (2022) 1 (recalled).
  Mirrored at(const Vec3d& away, const Liquid& liquid, const Vec3d& gravity, double h,
              bool bodies) const {
    constexpr double nothing = 1e-6, little = 0.1;  // [-]
    if (!(weight > nothing)) return {liquid.density, {0, 0, 0}, 0};
    const Vec3d centre = (1 / weight) * way, flow = (1 / weight) * velocity;
    const double mean = density / weight;
    const double c = liquid.sound_speed;
    const Vec3d still = (liquid.density / (c * c)) * gravity;
    const double rest = std::max(mean + dot(still, away - centre), liquid.density);
    const double mirrored = bodies ? std::clamp(10 * (weight - 0.5), 0.0, 1.0) : 1;
    const double sloped = std::min(mirrored, std::clamp(5 * (weight - 0.4), 0.0, 1.0));
    if (weight < little || sloped == 0) return {rest, flow, mirrored};
    const Fit fit = this->fit(h);
    if (!fit.known()) return {rest, flow, mirrored};
    const Vec3d slope = fit.slope(density_way, density);
    return {rest + sloped * (mean + dot(slope, away - centre) - rest), flow, mirrored};
  }
};

}  // namespace silt::detail
