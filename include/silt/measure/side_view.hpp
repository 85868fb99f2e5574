// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <vector>

#include <silt/core/error.hpp>
#include <silt/measure/polynomial_fit.hpp>

namespace silt::inline SILT_TARGET {

/// Picture with square pixels: numbers by column and row, from the lower left.
struct Picture {
  double left = 0, bottom = 0, pixel = 0;  // [m]
  std::size_t columns = 0, rows = 0;
  std::vector<float> value;  // [-] row by row

  float& at(std::size_t column, std::size_t row) { return value[row * columns + column]; }
  float at(std::size_t column, std::size_t row) const { return value[row * columns + column]; }
  double x(std::size_t column) const {  // [m] of its middle
    return left + (static_cast<double>(column) + 0.5) * pixel;
  }
  double top_of(std::size_t row) const {  // [m] of its upper side
    return bottom + (static_cast<double>(row) + 1) * pixel;
  }
};

/// Heat map of a film: share of the frames in which particles cover a pixel, seen along an axis.
/// Used to find the surface of a bed.
///
///   silt::SideView view(-R, R, -R, R, 1e-3);
///   view.next_frame();                         // 100 times
///   view.add_disc(x, z, radius);               // each particle
///   const auto line = silt::repose_line(view.share());
///
/// Errors: InputError for invalid sizes, and for a disc before the first frame.
/// Tests:  tests/measure/side_view.cpp
class SideView {
 public:
  SideView(double left, double right, double bottom, double top, double pixel) {  // [m]
    require(std::isfinite(pixel) && pixel > 0, "SideView: pixel = ", pixel,
            " [m] must be finite and greater than 0");
    require(right > left && top > bottom && (right - left) / pixel <= 2e4 &&
                (top - bottom) / pixel <= 2e4,
            "SideView: from ", left, " to ", right, " and from ", bottom, " to ", top,
            " [m] must be a rectangle of at most 20000 pixels each way, of ", pixel, " m");
    seen_.left = left, seen_.bottom = bottom, seen_.pixel = pixel;
    seen_.columns = static_cast<std::size_t>(std::ceil((right - left) / pixel - 1e-9));
    seen_.rows = static_cast<std::size_t>(std::ceil((top - bottom) / pixel - 1e-9));
    seen_.value.assign(seen_.columns * seen_.rows, 0);
    last_.assign(seen_.value.size(), 0);
  }
  void next_frame() { ++frames_; }
  std::uint32_t frames() const { return frames_; }
  /// Marks the pixels with their centres within `radius` [m]; each counts once per frame.
  void add_disc(double x, double z, double radius) {
    require(frames_ > 0, "SideView: call next_frame() before the first disc");
    const double p = seen_.pixel, from_left = x - seen_.left, above = z - seen_.bottom;
    const auto clip = [](double place, std::size_t most) {
      return static_cast<std::size_t>(std::clamp(place, 0.0, static_cast<double>(most)));
    };
    const std::size_t low = clip(std::ceil((above - radius) / p - 0.5), seen_.rows);
    const std::size_t high = clip(std::floor((above + radius) / p - 0.5) + 1, seen_.rows);
    for (std::size_t row = low; row < high; ++row) {
      const double dz = (static_cast<double>(row) + 0.5) * p - above;
      const double half = std::sqrt(std::max(radius * radius - dz * dz, 0.0));
      const std::size_t first = clip(std::ceil((from_left - half) / p - 0.5), seen_.columns);
      const std::size_t end = clip(std::floor((from_left + half) / p - 0.5) + 1, seen_.columns);
      for (std::size_t k = row * seen_.columns + first; k < row * seen_.columns + end; ++k)
        if (last_[k] != frames_) last_[k] = frames_, seen_.value[k] += 1;
    }
  }
  /// Share of the frames in which each pixel was covered.
  Picture share() const {
    Picture out = seen_;
    if (frames_ > 0)
      for (float& v : out.value) v /= static_cast<float>(frames_);
    return out;
  }

 private:
  Picture seen_;
  std::vector<std::uint32_t> last_;
  std::uint32_t frames_ = 0;
};

/// 1 where the picture is at least `level`, else 0.
inline Picture above_level(Picture picture, double level) {
  for (float& v : picture.value) v = v >= static_cast<float>(level) ? 1 : 0;
  return picture;
}

/// Means over squares of 2 n + 1 pixels; 0 outside the picture.
inline Picture smoothed(const Picture& picture, std::size_t n) {
  Picture out = picture;
  const std::size_t w = picture.columns, h = picture.rows;
  const float share = 1 / static_cast<float>(2 * n + 1);
  const auto along = [&](const std::vector<float>& from, std::vector<float>& to, std::size_t lines,
                         std::size_t length, std::size_t between, std::size_t step) {
    std::vector<float> sums(length + 1);
    for (std::size_t line = 0; line < lines; ++line) {
      for (std::size_t k = 0; k < length; ++k)
        sums[k + 1] = sums[k] + from[line * between + k * step];
      for (std::size_t k = 0; k < length; ++k)
        to[line * between + k * step] =
            share * (sums[std::min(k + n + 1, length)] - sums[k > n ? k - n : 0]);
    }
  };
  std::vector<float> rows(picture.value.size());
  along(picture.value, rows, h, w, w, 1);
  along(rows, out.value, w, h, 1, w);
  return out;
}

/// Options of repose_line().
struct ReposeOptions {
  double level = 0.5;      // [-] share of frames from which a pixel belongs to the bed
  double smooth = 5e-3;    // [m] half side length of the smoothing squares
  double from_top = 0.06;  // [m] along x from the highest point to the first point of the line
  double end = 0;          // [m] omitted at the lower end of the bed
  bool to_right = true;    // the bed falls to the right; false: to the left
};

/// Surface of a bed, and the line through its straight part.
struct ReposeLine {
  double angle = 0, error = 0;  // [degrees], and its standard error from the scatter
  double top_x = 0, top_z = 0;  // [m] the highest point
  PolynomialFit<1> line;        // height over x
  std::vector<double> x, z;     // [m] surface: highest pixel of each column
  std::vector<bool> in_line;    // whether the point is used for the line
  Picture bed;                  // 1 in the bed, after the smoothing
};

/// Dynamic angle of repose as seen by a camera: the heat map above a level, smoothed; the highest
/// pixel of each column; and a line through those that begin `from_top` beside the highest one.
///
/// Source: B. Doroszek et al., Minerals 14 (2024) 407, section 3.7.1, which begins 60 mm beside the
///         highest point and gives neither level nor smoothing.
/// Valid:  for a straight surface with 2 pixels of noise and 120 columns the error is at most 0.3
///         degrees (tests).
/// Errors: InputError if no pixel reaches the level, or fewer than 5 columns are left.
inline ReposeLine repose_line(const Picture& share, const ReposeOptions& options = {}) {
  require(options.level > 0 && options.level <= 1, "repose_line: level = ", options.level,
          " [-] must be in (0, 1]");
  require(options.smooth >= 0 && options.from_top >= 0 && options.end >= 0,
          "repose_line: smooth, from_top and end [m] must be at least 0");
  ReposeLine out;
  const auto n = static_cast<std::size_t>(std::lround(options.smooth / share.pixel));
  out.bed = above_level(smoothed(above_level(share, options.level), n), 0.5);
  std::size_t top = 0;  // of the points
  for (std::size_t column = 0; column < out.bed.columns; ++column)
    for (std::size_t row = out.bed.rows; row-- > 0;)
      if (out.bed.at(column, row) > 0) {
        out.x.push_back(out.bed.x(column)), out.z.push_back(out.bed.top_of(row));
        const double higher = out.z.back() - out.z[top];
        if (higher > 0 || (higher == 0 && !options.to_right)) top = out.x.size() - 1;
        break;
      }
  require(!out.x.empty(), "repose_line: no pixel is covered in a share of ", options.level,
          " of the frames; use a lower level, or check that there is a bed");
  out.top_x = out.x[top], out.top_z = out.z[top];
  const double side = options.to_right ? 1 : -1;
  const double last = side * (options.to_right ? out.x.back() : out.x.front()) - options.end;
  std::vector<double> x, z;
  for (std::size_t k = 0; k < out.x.size(); ++k) {
    const double place = side * out.x[k];
    out.in_line.push_back(place >= side * out.top_x + options.from_top && place <= last);
    if (out.in_line.back()) x.push_back(out.x[k]), z.push_back(out.z[k]);
  }
  require(x.size() >= 5, "repose_line: ", x.size(), " columns lie ", options.from_top,
          " m and more from the highest point at x = ", out.top_x,
          " m, and a line needs 5; use a smaller from_top or a larger bed");
  out.line = fit_polynomial<1>(x, z);
  const double slope = out.line.a[1] / out.line.scale;
  constexpr double degrees = 180 / std::numbers::pi;
  out.angle = -side * std::atan(slope) * degrees;
  out.error = out.line.deviation * std::sqrt(out.line.spread[1][1]) / out.line.scale /
              (1 + slope * slope) * degrees;
  return out;
}

}  // namespace silt
