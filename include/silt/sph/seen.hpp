// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <silt/core/lanes.hpp>
#include <silt/core/vec3.hpp>
#include <silt/sph/setup.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Sums of a probe over the liquid around it: V W (1, r, r r), V W rho (1, r) and V W v, with r
/// from the probe. `Real`: double, or a pack with one probe per lane.
template <class Real>
struct SphSeenBy {
  struct Mirrored {
    Real density;         // [kg/m3]
    Vec3<Real> velocity;  // [m/s] of the liquid
    Real share;           // [-] weight of this value
    Real nearer;          // [-] of the probe to the wall, over the liquid seen: at most 1
    Real over;            // [-] 1/weight; 0: sees no liquid
  };
  static Vec3<Real> none() { return {Real(0), Real(0), Real(0)}; }
  Real weight = Real(0), density = Real(0);
  Vec3<Real> way = none(), density_way = none(), velocity = none();
  Real xx = Real(0), xy = Real(0), xz = Real(0), yy = Real(0), yz = Real(0), zz = Real(0);

  /// Weighted linear least-squares fit with weights V W. For a quantity f with the sums of V W f r
  /// and V W f, the gradient is slope(those), and the value at `centre` is the mean.
  struct Fit {
    Vec3<Real> centre;
    Real A, B, C, E, F, G, det, s;
    double h;
    Mask<Real> known() const {
      constexpr double thin = 1e-4;  // of 0.01 of a uniform neighbourhood
      return det > Real(thin);
    }
    Vec3<Real> slope(const Vec3<Real>& of_way, const Real& sum) const {
      const Vec3<Real> t = (s * Real(h)) * (of_way - sum * centre);
      return (Real(1) / (det * Real(h))) * Vec3<Real>{A * t.x + B * t.y + C * t.z,
                                                      B * t.x + E * t.y + F * t.z,
                                                      C * t.x + F * t.y + G * t.z};
    }
  };
  Fit fit(double h) const {
    const Vec3<Real> centre = (Real(1) / weight) * way;
    // Second moments about the centre, in h^2 and per weight.
    const Real o = Real(1 / (h * h)), s = o / weight;
    const Real a = xx * s - centre.x * centre.x * o, b = xy * s - centre.x * centre.y * o,
               d = xz * s - centre.x * centre.z * o, f = yz * s - centre.y * centre.z * o,
               g = zz * s - centre.z * centre.z * o, across = yy * s - centre.y * centre.y * o;
    const Real flat(1e-9), e = select(across < flat, Real(1), across);  // 1 in 2D
    const Real A = e * g - f * f, B = d * f - b * g, C = b * f - d * e;
    const Real det = a * A + b * B + d * C;
    return {centre, A, B, C, a * g - d * d, b * d - a * f, a * e - b * b, det, s, h};
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
  Mirrored at(const Vec3<Real>& away, const Liquid& liquid, const Vec3d& gravity, double h,
              bool bodies) const {
    constexpr double nothing = 1e-6, little = 0.1;  // [-]
    const auto sees = weight > Real(nothing);
    const Real over = Real(1) / select(sees, weight, Real(1)), rho(liquid.density);
    const Real mean = over * density;
    const Vec3<Real> off = away - over * way;
    const Vec3d still = (liquid.density / (liquid.sound_speed * liquid.sound_speed)) * gravity;
    const Real rest =
        max(mean + (Real(still.x) * off.x + Real(still.y) * off.y + Real(still.z) * off.z), rho);
    const auto beyond = [this](double least, double slope) {  // from 0 to 1
      return max(min(Real(slope) * (weight - Real(least)), Real(1)), Real(0));
    };
    const Real mirrored = bodies ? beyond(0.5, 10) : Real(1);
    const Real sloped = min(mirrored, beyond(0.4, 5));
    const Fit fit = this->fit(h);
    const Vec3<Real> slope = fit.slope(density_way, density);
    const Real fitted = rest + sloped * (mean + dot(slope, off) - rest);
    const Real found = select(fit.known(), select(weight < Real(little), rest, fitted), rest);
    const Real half = Real(0.5) * dot(away, away), reach = half - over * dot(way, away);
    return {select(sees, found, rho), select(sees, over * velocity, none()),
            select(sees, mirrored, Real(0)), select(reach > half, half / reach, Real(1)),
            select(sees, over, Real(0))};
  }
};
using SphSeen = SphSeenBy<double>;

/// Sums of a particle over the liquid around it, with r from there: V grad W [1/m], V W [-],
/// V W r [m] and V W P [Pa].
struct SphLevel {
  Vec3d slope{0, 0, 0}, way{0, 0, 0};
  double weight = 0, pressure = 0;
};

}  // namespace silt::detail
