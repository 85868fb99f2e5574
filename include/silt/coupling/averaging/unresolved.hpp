// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <silt/core/dyn_array.hpp>
#include <silt/coupling/averaging/ball_points.hpp>
#include <silt/coupling/averaging/sphere_overlap.hpp>
#include <silt/coupling/averaging/stencil_averaging.hpp>

namespace silt::inline SILT_TARGET {

/// Unresolved averaging: a particle's volume is counted in the cells that contain it. For cells
/// larger than particles.
///
///   Share::Centre      all to the cell of its centre. d eps/dt grows as 1/dt, eps may be below 0.
///   Share::Satellites  equal parts to the cells of `points` interior points; for bodies, those of
///                      their AveragedForm. Error of a share at h = d: 0.08 (8 points), 0.03 (29),
///                      0.015 (100).
///   Share::Exact       the overlap volumes of sphere and cells (sphere_overlap.hpp), for cells of
///                      any size. Spheres only.
/// Source: H. Ma et al., Powder Technol. 412 (2022) 117972; the overlap is silt's own.
/// Errors: check(): InputError for fewer than 1 or more than 1e6 points; place(): for bodies with
///         Share::Exact.
/// Tests:  tests/coupling/averaging.cpp, averaging_overlap.cpp, averaging_bodies.cpp.
/// Valid:  cells larger than particles; Share::Exact: spheres in cells of any size.
/// Units:  lengths in diameters of the largest particles.
struct Unresolved {
  enum class Share { Centre, Satellites, Exact };
  Share share = Share::Exact;
  int points = 29;  // [-] of Satellites, for spheres

  void check() const {
    require(points >= 1 && points <= 1000000, "Unresolved.points = ", points,
            " [-] must be in [1, 1000000]");
  }

  class Source;
  using Averaging = StencilAveraging<Unresolved>;
};

class Unresolved::Source {
 public:
  Source(const Unresolved& mode, const Grid& grid, double, const AveragedParticles& particles)
      : share_(mode.share), of_(particles), frame_(grid) {
    require(share_ != Share::Exact || of_.forms.empty(),
            "Unresolved: Share::Exact is for spheres only; use Share::Satellites for bodies");
    if (share_ == Share::Satellites && of_.forms.empty())
      points_ = detail::ball_points(mode.points);
  }

  StencilKind ranges(std::size_t p, std::array<AxisRange, 3>& r) const {
    const auto s = frame_.at(of_.position[p]);
    if (!frame_.inside(s)) return StencilKind::None;
    if (share_ == Share::Centre) {
      for (std::size_t d = 0; d < 3; ++d) r[d] = frame_.cell(d, s[d]);
      return StencilKind::Dense;
    }
    if (of_.forms.empty()) {
      for (std::size_t d = 0; d < 3; ++d) {
        const double reach = of_.radius[p] * frame_.inverse(d);
        r[d] = frame_.range(d, s[d] - reach, s[d] + reach);
      }
      return StencilKind::Dense;
    }
    double low[3] = {s[0], s[1], s[2]}, high[3] = {s[0], s[1], s[2]};
    for_points(p, [&](const std::array<double, 3>& x) {
      for (std::size_t d = 0; d < 3; ++d)
        low[d] = std::min(low[d], x[d]), high[d] = std::max(high[d], x[d]);
    });
    for (std::size_t d = 0; d < 3; ++d) r[d] = frame_.range(d, low[d], high[d]);
    return StencilKind::Dense;
  }
  void factor(std::size_t, int, const AxisRange&, double*) const {}

  void dense(std::size_t p, const std::array<AxisRange, 3>& r, double* raw) const {
    if (share_ == Share::Centre) {
      *raw = 1;
      return;
    }
    const int nx = r[0].raw(), ny = r[1].raw();
    if (share_ == Share::Exact) return exact(p, r, raw);
    for_points(p, [&](const std::array<double, 3>& x) {
      int c[3];
      for (std::size_t d = 0; d < 3; ++d)  // rounding may be between this and the range
        c[d] = std::clamp(static_cast<int>(std::floor(x[d])) - r[d].low, 0, r[d].raw() - 1);
      raw[(c[2] * ny + c[1]) * nx + c[0]] += 1;
    });
  }

 private:
  template <class Use>
  void for_points(std::size_t p, const Use& use) const {
    if (of_.forms.empty()) {
      for (const Vec3d& x : points_) use(frame_.at(of_.position[p] + x * of_.radius[p]));
      return;
    }
    const RotationMatrix turn = rotation_matrix(of_.orientation[p]);
    for (const Vec3d& x : of_.forms[of_.form.empty() ? 0 : of_.form[p]].points)
      use(frame_.at(of_.position[p] + turn * x * of_.radius[p]));
  }

  void exact(std::size_t p, const std::array<AxisRange, 3>& r, double* raw) const {
    thread_local SphereOverlap overlap;
    thread_local std::array<DynArray<double>, 3> planes;
    const auto s = frame_.at(of_.position[p]);
    const double scale = 1 / of_.radius[p];
    std::array<int, 3> cells;
    for (std::size_t d = 0; d < 3; ++d) {
      cells[d] = r[d].raw();
      planes[d].clear();
      for (int m = 0; m <= cells[d]; ++m)
        planes[d].push_back((r[d].low + m - s[d]) * frame_.h(d) * scale);
    }
    overlap.shares(
        planes[0].data(), planes[1].data(), planes[2].data(), cells,
        [&](int i, int j, int k, double v) { raw[(k * cells[1] + j) * cells[0] + i] = v; });
  }

  Share share_;
  const AveragedParticles& of_;
  detail::CellFrame frame_;
  DynArray<Vec3d> points_;
};

static_assert(AveragingMode<Unresolved>);

}  // namespace silt
