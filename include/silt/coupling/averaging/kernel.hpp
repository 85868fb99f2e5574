// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <silt/core/powers.hpp>
#include <silt/coupling/averaging/stencil_averaging.hpp>

namespace silt::inline SILT_TARGET {

/// Kernel averaging: a particle is distributed with a smooth kernel wider than a cell. Suits cells
/// of any size; the only mode whose void fraction has no noise in time.
///
///   Form::Compact   K = B(x) B(y) B(z), B(x) = 15/16 (1 - x^2/R^2)^2 / R inside R, integrated over
///                   the cells (a polynomial): R = width d, at least 1.5 h (1)
///   Form::Gaussian  K = G(x) G(y) G(z), G = exp(-x^2/(2 s^2)) - exp(-9/2) inside 3 s, at the
///                   cells' centres, s = width d, at least h/2 (2)
///   Form::Cube      K = 1 in a box, integrated over the cells. Its edges are `width` times those
///                   of a cube of the particle's volume, less a cell's: with larger cells all is in
///                   that of the centre. No smoothing, so void fractions jump where particles cross
///                   faces; heat is exchanged by it whatever the mode (docs/gas_heat.md)
///   bodies          K = (1 - q^2)^2 or exp(-9/2 q^2) - exp(-9/2), at the cells' centres, with
///                   q = g(x) r/R, R of (1) or 3 s of (2): R and s are enlarged in each direction
///                   by the body's extent in radii r of the sphere of its volume (3)
///
/// Weights are normalised; the volume is exact. d is a sphere's diameter, for a body that of the
/// sphere of equal volume; g is the body's gauge (AveragedForm). Kernels are folded at walls.
/// Products of factors need little memory. The integrated B is smoother within cells. Second
/// moments are isotropic (standard deviation 0.378 R for B). The ratio <x^4>/(3 <x^2 y^2>), 1 if
/// isotropic, is 0.78 for B and 0.91 for the cut Gaussian: along diagonals tails extend up to
/// sqrt(3) R.
///
/// A cube is that of a sphere of the body's volume.
///
/// Deviations: the review's Gaussian jumps at its cut by exp(-9/2), which appears as noise in d
///             eps/dt; here it is lowered by this value. The minimum widths prevent kernels
///             narrower than a cell. Memory: spheres 100 to 350 bytes (3 to 15 cells across),
///             bodies 8 bytes per cell.
/// Source: H. Ma et al., Powder Technol. 412 (2022) 117972 (2), and (3) as exponent -g(x)^2/(2
///         k^2), k = s/r; (1) is silt's own.
/// Errors: check(): InputError for a width below 0.1 or above 100 diameters.
/// Tests:  tests/coupling/averaging.cpp, averaging_noise.cpp, averaging_bodies.cpp.
/// Valid:  cells of any size.
/// Units:  lengths in diameters of each particle.
struct Kernel {
  enum class Form { Compact, Gaussian, Cube };
  Form form = Form::Compact;
  double width = 0;  // [diameters] R of Compact, s of Gaussian; [edges] of Cube; 0: 3, 1 and 1

  void check() const {
    require(width == 0 || (width >= 0.1 && width <= 100), "Kernel.width = ", width,
            " [diameters] must be in [0.1, 100], or 0 for the usual one");
  }

  class Source;
  using Averaging = StencilAveraging<Kernel>;
};

class Kernel::Source {
 public:
  Source(const Kernel& mode, const Grid& grid, double, const AveragedParticles& particles)
      : form_(mode.form),
        per_radius_(2 *
                    (mode.width > 0           ? mode.width
                     : form_ == Form::Compact ? 3
                                              : 1) *
                    (form_ == Form::Compact    ? 1
                     : form_ == Form::Gaussian ? 3
                                               : half_edge)),
        of_(particles),
        frame_(grid) {}

  StencilKind ranges(std::size_t p, std::array<AxisRange, 3>& r) const {
    const auto s = frame_.at(of_.position[p]);
    if (!frame_.inside(s)) return StencilKind::None;
    const AveragedForm* body = form_of(p);
    if (!body) {
      for (std::size_t d = 0; d < 3; ++d) {
        const double reach = reach_in_cells(p, d);
        r[d] = form_ == Form::Gaussian ? frame_.range(d, s[d] - reach + 0.5, s[d] + reach - 0.5)
                                       : frame_.range(d, s[d] - reach, s[d] + reach);
      }
      return StencilKind::Product;
    }
    const RotationMatrix turn = rotation_matrix(of_.orientation[p]);
    const double R = body_reach(p, *body);
    const SuperEllipsoid outline{body->axes.x, body->axes.y, body->axes.z, body->s1, body->s2};
    for (std::size_t d = 0; d < 3; ++d) {
      const Vec3d e = turn.back({d == 0 ? 1.0 : 0, d == 1 ? 1.0 : 0, d == 2 ? 1.0 : 0});
      const double reach = R * outline.height(e) * frame_.inverse(d);
      r[d] = frame_.range(d, s[d] - reach + 0.5, s[d] + reach - 0.5);
    }
    return StencilKind::Dense;
  }

  /// Factors of (1) and (2), in packs.
  void factor(std::size_t p, int direction, const AxisRange& range, double* raw) const {
    using Pack = detail::StencilPack;
    const auto d = static_cast<std::size_t>(direction);
    const double s = frame_.at(of_.position[p])[d], inverse = 1 / reach_in_cells(p, d);
    const double first = (range.low - s) * inverse;
    if (form_ == Form::Cube) {
      for (int m = 0; m <= range.raw(); ++m) raw[m] = std::clamp(first + m * inverse, -1.0, 1.0);
      for (int m = 0; m < range.raw(); ++m) raw[m] = std::max(0.0, raw[m + 1] - raw[m]);
      return;
    }
    if (form_ == Form::Compact) {
      // All faces first, then their differences.
      const auto integral = [](double q) {
        const double x = std::clamp(q, -1.0, 1.0), x2 = x * x;
        return x * (1 - x2 * (2.0 / 3 - 0.2 * x2));
      };
      for (int m = 0; m <= range.raw(); ++m) raw[m] = integral(first + m * inverse);
      for (int m = 0; m < range.raw(); ++m) raw[m] = std::max(0.0, raw[m + 1] - raw[m]);
      return;
    }
    const double middle = first + 0.5 * inverse;
    for (int m = 0; m < range.raw(); m += detail::stencil_lanes) {
      const Pack q = Pack(middle) + (Pack(static_cast<double>(m)) + steps()) * Pack(inverse);
      store_any(raw + m, gaussian(Pack(q * q)));
    }
  }

  void dense(std::size_t p, const std::array<AxisRange, 3>& r, double* raw) const {
    using Pack = detail::StencilPack;
    const AveragedForm& body = *form_of(p);
    const auto s = frame_.at(of_.position[p]);
    const RotationMatrix turn = rotation_matrix(of_.orientation[p]);
    const double inverse = 1 / body_reach(p, body);
    // Body coordinates of a point in semi-axes, over the reach.
    const Vec3d a{inverse / body.axes.x, inverse / body.axes.y, inverse / body.axes.z};
    const auto seen = [&](const Vec3d& v) {
      const Vec3d b = turn.back(v);
      return Vec3d{b.x * a.x, b.y * a.y, b.z * a.z};
    };
    const Vec3d step = seen({frame_.h(0), 0, 0});
    const auto centre = [&](std::size_t d, int m) {
      return (r[d].low + m + 0.5 - s[d]) * frame_.h(d);
    };
    const int nx = r[0].raw();
    alignas(64) double lane[detail::stencil_lanes];
    for (int k = 0; k < r[2].raw(); ++k)
      for (int j = 0; j < r[1].raw(); ++j, raw += nx) {
        const Vec3d at = seen({centre(0, 0), centre(1, j), centre(2, k)});
        for (int i = 0; i < nx; i += detail::stencil_lanes) {
          const Pack m = Pack(static_cast<double>(i)) + steps();
          const Vec3<Pack> x{Pack(at.x) + m * Pack(step.x), Pack(at.y) + m * Pack(step.y),
                             Pack(at.z) + m * Pack(step.z)};
          const Pack q2 = body.ellipsoid() ? dot(x, x) : gauge_squared(body, x);
          store(lane, form_ == Form::Compact ? quartic(q2) : gaussian(q2));
          std::copy_n(lane, std::min(detail::stencil_lanes, nx - i), raw + i);
        }
      }
  }

 private:
  /// Null for a sphere.
  const AveragedForm* form_of(std::size_t p) const {
    if (of_.forms.empty() || form_ == Form::Cube) return nullptr;
    const AveragedForm& body = of_.forms[of_.form.empty() ? 0 : of_.form[p]];
    return body.sphere ? nullptr : &body;
  }
  double reach_in_cells(std::size_t p, std::size_t d) const {
    const double reach = per_radius_ * of_.radius[p] * frame_.inverse(d);
    return form_ == Form::Cube ? std::max(reach - 0.5, 1e-9) : std::max(reach, 1.5);
  }
  /// R or 3 s [m], at least 1.5 cells in the thinnest direction of the body.
  double body_reach(std::size_t p, const AveragedForm& body) const {
    const double h = std::max({frame_.h(0), frame_.h(1), frame_.h(2)});
    return std::max(per_radius_ * of_.radius[p], 1.5 * h / body.smallest_axis);
  }

  static detail::StencilPack steps() {
    alignas(64) static constexpr double of[16]{0, 1, 2,  3,  4,  5,  6,  7,
                                               8, 9, 10, 11, 12, 13, 14, 15};
    return load<detail::StencilPack>(of);
  }
  template <class Real>
  static Real gaussian(const Real& q2) {
    constexpr double edge = 0.011108996538242306;  // exp(-9/2)
    return max(exponential(Real(Real(-4.5) * min(q2, Real(1.0)))) - Real(edge), Real(0.0));
  }
  template <class Real>
  static Real quartic(const Real& q2) {
    const Real u = max(Real(1.0) - q2, Real(0.0));
    return u * u;
  }
  /// (g/reach)^2 of a super-ellipsoid; x in semi-axes over the reach.
  template <class Real>
  static Real gauge_squared(const AveragedForm& body, const Vec3<Real>& x) {
    const auto raised = [](const Real& v, double to) {
      return power(max(min(v, Real(1e6)), Real(1e-6)), Real(to));
    };
    const Real across = raised(abs(x.x), body.s2) + raised(abs(x.y), body.s2);
    const Real all =
        power(max(across, smallest<Real>()), Real(body.s1 / body.s2)) + raised(abs(x.z), body.s1);
    return power(max(all, smallest<Real>()), Real(2 / body.s1));
  }

  static constexpr double half_edge = 0.40299759827496166;  // [diameters] (pi/6)^(1/3)/2
  Form form_;
  double per_radius_;  // [-] R, 3 s or half an edge, over the radius
  const AveragedParticles& of_;
  detail::CellFrame frame_;
};

static_assert(AveragingMode<Kernel>);

}  // namespace silt
