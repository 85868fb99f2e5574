// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>

#include <silt/core/vec3.hpp>
#include <silt/sph/setup.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Sums of a probe over the liquid around it: V W (1, r, r r), V W rho (1, r) and V W v, with r
/// from the probe.
struct SphSeen {
  struct Mirrored {
    double density;  // [kg/m3]
    Vec3d velocity;  // [m/s] of the liquid
    double share;    // [-] weight of this value
  };
  double weight = 0, density = 0;
  Vec3d way{0, 0, 0}, density_way{0, 0, 0}, velocity{0, 0, 0};
  double xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;

  /// Weighted linear least-squares fit with weights V W. For a quantity f with the sums of V W f r
  /// and V W f, the gradient is slope(those), and the value at `centre` is the mean.
  struct Fit {
    Vec3d centre;
    double A, B, C, E, F, G, det, s, h;
    bool known() const {
      constexpr double thin = 1e-4;  // of 0.01 of a uniform neighbourhood
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
    // Second moments about the centre, in h^2 and per weight.
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

  /// Density and velocity of a wall's particle at `away` [m] from the probe, its mirror image:
  /// density by a linear fit (mDBC), velocity as a mean. If there is too little liquid for a
  /// gradient, those of a liquid at rest: below 0.4 of a full neighbourhood, partly up to 0.6.
  /// (With the gradients of films and drops, jets of three particles that hit a plane quadrupled
  /// their energy.) Between bodies in contact the image may be in another body, near the liquid of
  /// another pore. With `bodies`, if less than half of the neighbourhood is liquid, the density is
  /// that of a liquid at rest and the velocity is not used; from 0.6 on both are used fully. (At a
  /// plane wall the value is 0.65 to 0.7.) Without this, a packed bed in a liquid with no-slip
  /// becomes unstable within milliseconds.
  ///
  /// Source: A. English, J. M. Dominguez, R. Vacondio, A. J. C. Crespo, P. K. Stansby, S. J. Lind,
  ///         L. Chiapponi, M. Gomez-Gesteira, Comput. Part. Mech. 9 (2022) 1 (recalled).
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

/// Sums of a particle over the liquid around it, with r from there: V grad W [1/m], V W [-],
/// V W r [m] and V W P [Pa].
struct SphLevel {
  Vec3d slope{0, 0, 0}, way{0, 0, 0};
  double weight = 0, pressure = 0;
};

}  // namespace silt::detail
