// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <queue>

#include <silt/boundary/triangle_mesh.hpp>
#include <silt/core/dyn_array.hpp>
#include <silt/shape/multi_sphere.hpp>
#include <silt/shape/triangle_moments.hpp>

namespace silt::inline SILT_TARGET {

/// Mass properties of the interior of a closed mesh, exact.
inline MassProperties mass_properties(const TriangleMesh& mesh) {
  DynArray<std::array<Vec3d, 3>> triangles;
  for (const auto& [a, b, c] : mesh.triangles())
    triangles.push_back({mesh.vertices()[a], mesh.vertices()[b], mesh.vertices()[c]});
  return mass_properties(triangles);
}

/// Options of fit_spheres().
struct SphereFitOptions {
  std::size_t spheres = 50;     // [-] at most
  std::size_t resolution = 40;  // [-] cells of the search grid along the longest side
};

/// Result of fit_spheres().
struct SphereFit {
  MultiSphere form;      // mass and inertia are those of the mesh
  double volume_error;   // [-] volume of the union over that of the mesh, minus 1
  double surface_error;  // [m] distance of the two surfaces, root mean square
  double largest_error;  // [m]
};

namespace detail {

/// Inscribed spheres around the points of a grid. Each is chosen to contain as many points as
/// possible that no other sphere contains yet.
class SphereFitter {
 public:
  SphereFitter(const TriangleMesh& mesh, std::size_t resolution) : mesh_(mesh) {
    const Box box = mesh.bounds();
    const Vec3d e = box.extent();
    step_ = std::max({e.x, e.y, e.z}) / static_cast<double>(resolution);
    for (int d = 0; d < 3; ++d)
      count_[d] = static_cast<std::int64_t>(std::ceil((d == 0 ? e.x : d == 1 ? e.y : e.z) / step_));
    first_ =
        box.centre() -
        0.5 * step_ * Vec3d{double(count_[0] - 1), double(count_[1] - 1), double(count_[2] - 1)};
    depth_.assign(static_cast<std::size_t>(count_[0] * count_[1] * count_[2]), 0);
    for (std::size_t k = 0; k < depth_.size(); ++k)
      if (mesh.contains(place(k))) depth_[k] = distance(place(k));
    covered_.assign(depth_.size(), false);
  }

  DynArray<Ball> choose(std::size_t wanted) {
    struct Candidate {
      std::size_t gain, cell;
      bool operator<(const Candidate& b) const {
        return gain < b.gain || (gain == b.gain && cell > b.cell);
      }
    };
    std::priority_queue<Candidate> queue;
    for (std::size_t k = 0; k < depth_.size(); ++k)
      if (depth_[k] > 0) queue.push({gain(k), k});
    DynArray<Ball> balls;
    while (balls.size() < wanted && !queue.empty()) {
      const std::size_t cell = queue.top().cell;
      queue.pop();
      // The gain of a sphere can only decrease: if it is still the largest, the sphere is the best.
      const std::size_t now = gain(cell);
      if (now == 0) continue;
      if (!queue.empty() && Candidate{now, cell} < queue.top()) {
        queue.push({now, cell});
        continue;
      }
      balls.push_back({place(cell), depth_[cell]});
      visit(cell, [&](std::size_t k) { covered_[k] = true; });
    }
    return balls;
  }

 private:
  Vec3d place(std::size_t k) const {
    const auto i = static_cast<std::int64_t>(k);
    return first_ + step_ * Vec3d{double(i % count_[0]), double(i / count_[0] % count_[1]),
                                  double(i / (count_[0] * count_[1]))};
  }
  double distance(const Vec3d& p) const {
    double reach = 2 * step_;
    for (DynArray<std::uint32_t> near;; reach *= 2) {
      near.clear();
      mesh_.triangles_near(p, reach, near);
      double least = reach;
      for (const std::uint32_t t : near) least = std::min(least, mesh_.distance_to(t, p));
      if (least < reach) return least;
    }
  }
  /// Calls visit(k) for the grid points inside the mesh and inside the sphere around point `cell`.
  template <class Visit>
  void visit(std::size_t cell, const Visit& visit) const {
    const double radius = depth_[cell];
    const Vec3d centre = place(cell);
    const auto reach = static_cast<std::int64_t>(radius / step_);
    const auto k = static_cast<std::int64_t>(cell);
    const std::int64_t at[3] = {k % count_[0], k / count_[0] % count_[1],
                                k / (count_[0] * count_[1])};
    std::int64_t from[3], to[3];
    for (int d = 0; d < 3; ++d)
      from[d] = std::max<std::int64_t>(0, at[d] - reach),
      to[d] = std::min(count_[d] - 1, at[d] + reach);
    for (std::int64_t z = from[2]; z <= to[2]; ++z)
      for (std::int64_t y = from[1]; y <= to[1]; ++y)
        for (std::int64_t x = from[0]; x <= to[0]; ++x) {
          const auto n = static_cast<std::size_t>((z * count_[1] + y) * count_[0] + x);
          const Vec3d d = place(n) - centre;
          if (depth_[n] > 0 && dot(d, d) <= radius * radius) visit(n);
        }
  }
  std::size_t gain(std::size_t cell) const {
    std::size_t count = 0;
    visit(cell, [&](std::size_t k) { count += !covered_[k]; });
    return count;
  }

  const TriangleMesh& mesh_;
  double step_;
  std::int64_t count_[3];
  Vec3d first_;
  DynArray<double> depth_;  // [m] distance of inside points from the surface
  DynArray<bool> covered_;
};

/// Distances [m] of points of the mesh (three per triangle, more for large ones) from the surface
/// of the union.
inline void measure_surface(const TriangleMesh& mesh, SphereFit& fit) {
  const auto& v = mesh.vertices();
  double sum = 0, weight = 0, most = 0;
  const double fine = std::sqrt(mesh.area() / 20000);
  for (const auto& [i, j, k] : mesh.triangles()) {
    const Vec3d a = v[i], b = v[j] - a, c = v[k] - a;
    const double area = 0.5 * norm(cross(b, c));
    const int n = std::max(1, static_cast<int>(std::sqrt(area) / fine));
    for (int p = 0; p < n; ++p)
      for (int q = 0; p + q < n; ++q) {
        const Vec3d at = a + ((p + 1.0 / 3) / n) * b + ((q + 1.0 / 3) / n) * c;
        double gap = 1e300;
        for (const Ball& ball : fit.form.balls)
          gap = std::min(gap, norm(at - ball.centre) - ball.radius);
        const double w = area / (0.5 * n * (n + 1));
        sum += w * gap * gap, weight += w, most = std::max(most, std::abs(gap));
      }
  }
  fit.surface_error = std::sqrt(sum / weight), fit.largest_error = most;
}

}  // namespace detail

/// Fits spheres to a closed mesh: inscribed spheres, each placed where it fills most of the
/// remaining volume. Then all are scaled equally until their union has the volume of the mesh.
/// Sharp edges remain round; more spheres reduce the error, which is reported.
///
///   const silt::TriangleMesh mesh(silt::read_stl("stone.stl"));
///   const auto fit = silt::fit_spheres(mesh, {.spheres = 30});
///   const auto stone = particles.add_form(fit.form);
/// Errors: InputError for a mesh that is not closed, inside out or doubled, or options out of range.
/// Tests:  tests/shape/fit_spheres.cpp.
inline SphereFit fit_spheres(const TriangleMesh& mesh, const SphereFitOptions& options = {}) {
  require(mesh.is_closed(),
          "fit_spheres: the mesh is not closed, and has no inside; close its gaps or turn "
          "its triangles the same way round");
  require(mesh.volume() > 0, "fit_spheres: the volume of the mesh is ", mesh.volume(),
          " [m3]: its triangles face inwards; reverse them");
  detail::require_single("fit_spheres", mesh.triangles());
  require(options.spheres > 0, "SphereFitOptions.spheres = 0 [-] must be at least 1");
  require(options.resolution >= 4 && options.resolution <= 200,
          "SphereFitOptions.resolution = ", options.resolution, " [-] must be from 4 to 200");
  SphereFit fit{};
  fit.form.balls = detail::SphereFitter(mesh, options.resolution).choose(options.spheres);
  require(!fit.form.balls.empty(),
          "fit_spheres: the mesh is thinner than a cell; give a "
          "SphereFitOptions.resolution above ",
          options.resolution);
  const auto grown = [balls = fit.form.balls](double by) {
    auto all = balls;
    for (Ball& b : all) b.radius += by;
    return all;
  };
  // The volume grows with the radii: bisection.
  const double volume = mesh.volume();
  double low = 0, high = std::cbrt(volume);
  for (int k = 0; k < 24; ++k) {
    const double middle = 0.5 * (low + high);
    (moments_of_union(grown(middle), 0).volume < volume ? low : high) = middle;
  }
  fit.form.balls = grown(0.5 * (low + high));
  fit.form.mass = mass_properties(mesh);
  fit.volume_error = moments_of_union(fit.form.balls).volume / volume - 1;
  detail::measure_surface(mesh, fit);
  return fit;
}

}  // namespace silt
