// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include <silt/core/error.hpp>

namespace silt::inline SILT_TARGET {

/// Velocity profile over a smooth wall, from the viscous layer to the logarithmic layer:
///
///   y+ = u+ + exp(-kappa B) (exp(kappa u+) - 1 - kappa u+ - (kappa u+)^2/2 - (kappa u+)^3/6)   (1)
///   nu_t / nu = dy+/du+ - 1                                                                    (2)
///
/// u+ = u/u*, y+ = u* y/nu, u* = sqrt(tau_wall/rho).
/// Source: D. B. Spalding, J. Appl. Mech. 28 (1961) 455; kappa and B as in the friction law of
///         smooth pipes (H. Schlichting, Boundary-Layer Theory, 7th ed., 1979, ch. XX).
/// Valid:  smooth walls, attached flows along them; not in separation.
/// Tests:  tests/fluid/turbulence.cpp, tests/fluid/k_epsilon.cpp
struct WallLaw {
  static constexpr double kappa = 0.4, B = 5.5;

  static double y_plus(double u_plus) {
    const double k = kappa * u_plus;
    return u_plus + lift() * (std::exp(k) - 1 - k - k * k / 2 - k * k * k / 6);
  }
  /// [-] eddy viscosity over the fluid's.
  static double eddy(double u_plus) {
    const double k = kappa * u_plus;
    return kappa * lift() * (std::exp(k) - 1 - k - k * k / 2);
  }
  /// u+ at a point with u y / nu = u+ y+ = `reynolds`.
  static double u_plus(double reynolds) {
    static const Table table(searched);
    return table.covers(reynolds) ? newton(table(reynolds), reynolds) : searched(reynolds);
  }
  /// u+ at a distance y+.
  static double u_plus_at(double distance) {
    static const Table table(searched_at);
    return table.covers(distance) ? newton_at(table(distance), distance) : searched_at(distance);
  }

 private:
  static double lift() {
    static const double value = std::exp(-kappa * B);
    return value;
  }
  /// y+ and dy+/du+.
  static std::pair<double, double> height(double u_plus) {
    const double k = kappa * u_plus, e = lift() * (std::exp(k) - 1 - k - k * k / 2);
    return {u_plus + e - lift() * k * k * k / 6, 1 + kappa * e};
  }
  static double newton(double u, double reynolds) {
    const auto [y, slope] = height(u);
    return u - (u * y - reynolds) / (y + u * slope);
  }
  static double newton_at(double u, double distance) {
    const auto [y, slope] = height(u);
    return u - (y - distance) / slope;
  }
  /// From above, where both are convex.
  static double searched(double reynolds) {
    if (!(reynolds > 0)) return 0;
    return solved(reynolds, std::min(std::sqrt(reynolds), std::log(1 + reynolds) / kappa + B),
                  newton);
  }
  static double searched_at(double distance) {
    if (!(distance > 0)) return 0;
    return solved(distance, std::min(distance, std::log(1 + distance) / kappa + B), newton_at);
  }
  template <class Newton>
  static double solved(double of, double u, const Newton& next) {
    for (int n = 0; n < 50; ++n) {
      const double last = u;
      u = next(last, of);
      if (std::abs(u - last) < 1e-10 * u) break;
    }
    return u;
  }

  /// Table of ln u+ over the logarithm of the argument, cubic interpolation between 32 values a
  /// factor of e apart. Its error, below 1e-7, is squared by one Newton step.
  class Table {
   public:
    explicit Table(double (*of)(double)) {
      for (int k = 0; k < count; ++k) values_[at(k)] = std::log(of(std::exp(from + k / density)));
    }
    bool covers(double x) const { return x > least && x < most; }
    double operator()(double x) const {
      const double place = (std::log(x) - from) * density;
      const int k = std::clamp(static_cast<int>(place), 1, count - 3);
      const double t = place - k, *const v = &values_[at(k)];
      // Lagrange interpolation with four points.
      return std::exp(v[-1] * (-t * (t - 1) * (t - 2) / 6) +
                      v[0] * ((t + 1) * (t - 1) * (t - 2) / 2) +
                      v[1] * (-(t + 1) * t * (t - 2) / 2) + v[2] * ((t + 1) * t * (t - 1) / 6));
    }

   private:
    static constexpr double from = -10, density = 32, least = 1e-4, most = 1e12;
    static constexpr int count = 1216;  // to exp(28)
    static std::size_t at(int k) { return static_cast<std::size_t>(k); }
    std::array<double, count> values_{};
  };
};

/// Turbulence by Prandtl's mixing length, as measured in pipes and between plates:
///
///   mu_t = rho l^2 |S|,  |S| = sqrt(2 S:S)                                                     (1)
///   l/R = (0.14 - 0.08 (1 - y/R)^2 - 0.06 (1 - y/R)^4) (1 - exp(-y+/26))                       (2)
///
/// y is the distance from the nearest wall, y+ = y sqrt(tau/rho)/nu with the local shear stress.
/// The momentum equations then have tau + mu_t (grad u + grad u'). In cells at walls mu_t and the
/// wall shear are those of WallLaw; the first cell may be in the viscous or in the logarithmic
/// layer.
///
/// Source: J. Nikuradse, VDI-Forschungsheft 356 (1932), and H. Schlichting, Boundary-Layer Theory,
///         7th ed., 1979, eq. (20.18) (length); E. R. van Driest, J. Aeronaut. Sci. 23 (1956) 1007.
/// Valid:  flows along walls; for separated flows use KEpsilon. Particles do not change it. Least
///         accurate if y+ of the first cells is below some 40 (FlowSolver::wall_units()): there
///         friction is up to 13 % too high, and 35 % at walls oblique to the cells.
/// Tests:  tests/fluid/turbulence.cpp
/// Units:  SI.
/// Errors: InputError naming field, value, unit and allowed range.
struct MixingLength {
  double half_width = 0;  // [m] R: radius of the pipe, half the distance of the plates

  void check() const { require_positive("MixingLength.half_width", half_width, "m"); }
  double length(double y) const {  // [m]
    const double r = 1 - std::clamp(y / half_width, 0.0, 1.0), r2 = r * r;
    return half_width * (0.14 - 0.08 * r2 - 0.06 * r2 * r2);
  }
  static double damping(double y_plus) { return 1 - std::exp(-y_plus / 26); }
};

}  // namespace silt
