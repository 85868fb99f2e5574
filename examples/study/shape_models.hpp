// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include <silt/core/random.hpp>
#include <silt/fill/bodies.hpp>
#include <silt/shape/fit_spheres.hpp>
#include <silt/shape/polyhedron.hpp>
#include <silt/shape/sphere.hpp>
#include <silt/shape/super_ellipsoid.hpp>
#include <silt/shape/surface_mesh.hpp>

/// The particles of the shape study, and the models that represent them.
namespace studies::shape {

using silt::Vec3d;

inline constexpr double radius = 2e-3;  // [m] of the sphere of equal volume, of every particle
inline constexpr double volume = 4.0 / 3 * std::numbers::pi * radius * radius * radius;  // [m3]

/// A shape for which models are made; superellipsoids have closed forms of all compared quantities.
struct Target {
  std::string name;
  silt::SuperEllipsoid exact;
};

/// The common volume.
inline Target target(const std::string& name, silt::SuperEllipsoid s) {
  const double scale = std::cbrt(volume / s.volume());
  s.a *= scale, s.b *= scale, s.c *= scale;
  return {name, s};
}
inline std::vector<Target> targets() {
  return {target("ellipsoid", {.a = 1.5, .b = 1, .c = 0.75}),
          target("cylinder", {.a = 1, .b = 1, .c = 1.5, .s1 = 8, .s2 = 2}),
          target("cube", {.a = 1, .b = 1, .c = 1, .s1 = 8, .s2 = 8})};
}

/// A sphere with a coefficient of rolling friction.
struct RollingSphere {
  double friction;  // [-]
};
using Form = std::variant<RollingSphere, silt::MultiSphere, silt::SuperEllipsoid, silt::Polyhedron>;
struct Model {
  std::string name;
  Form form;  // of any size: particles are scaled to `volume`
  /// [-] fraction of the step that silt chooses. With fifty spheres and more, several touch at
  /// once, and the guard requires shorter steps.
  double step_share = 1;
};

/// Uniformly distributed directions: the 12 vertices of an icosahedron (20 faces), with the centres
/// of its faces (32 points, 60 faces), with the midpoints of those edges (122 points, 240 faces).
/// Other numbers along a spiral.
inline std::vector<Vec3d> directions(std::size_t faces) {
  std::vector<Vec3d> all;
  if (faces > 240) {
    const double n = 0.5 * static_cast<double>(faces) + 2;
    for (double k = 0; k < n; ++k) {
      const double z = 1 - (2 * k + 1) / n, r = std::sqrt(1 - z * z), turn = 2.399963229 * k;
      all.push_back({r * std::cos(turn), r * std::sin(turn), z});
    }
    return all;
  }
  const double golden = 0.5 * (1 + std::sqrt(5.0));
  for (const double a : {-1.0, 1.0})
    for (const double b : {-golden, golden})
      for (const Vec3d& v : {Vec3d{0, a, b}, Vec3d{a, b, 0}, Vec3d{b, 0, a}})
        all.push_back(normalised(v));
  const auto hull = [&] { return silt::Polyhedron::from_points(all); };
  if (faces >= 60)
    for (const auto& [a, b, c] : hull().triangles()) all.push_back(normalised(a + b + c));
  if (faces >= 240) {
    const auto coarse = hull();
    for (const auto& e : coarse.edges())
      all.push_back(normalised(coarse.vertices()[e.from] + coarse.vertices()[e.to]));
  }
  return all;
}

/// Convex hull of points on the surface whose normals are the directions for so many `faces`. Of
/// 100 rotations of the directions (5 where the effect is small) the one with the largest hull.
/// Faces that lie in one plane are joined.
inline silt::Polyhedron hull_of(const silt::SuperEllipsoid& s, std::size_t faces) {
  const auto normals = directions(faces);
  silt::Random random(5);
  std::optional<silt::Polyhedron> best;
  for (int k = 0, turns = faces > 240 ? 5 : 100; k < turns; ++k) {
    const auto turn = silt::random_orientation(random);
    std::vector<Vec3d> points;
    for (const auto& n : normals) points.push_back(s.support(rotate(turn, n)));
    auto hull = silt::Polyhedron::from_points(points);
    if (!best || hull.volume() > best->volume()) best = std::move(hull);
  }
  return *best;
}

inline Model spheres_for(const Target& t, std::size_t count) {
  const auto surface = surface_of(t.exact, 16);
  std::vector<std::array<Vec3d, 3>> triangles;
  for (const auto& [a, b, c] : surface.triangles)
    triangles.push_back({surface.points[a], surface.points[b], surface.points[c]});
  auto fit = silt::fit_spheres(silt::solid_mesh(triangles), {.spheres = count});
  return {silt::text(count, " spheres"), fit.form, count > 100 ? 0.6 : count >= 50 ? 0.9 : 1};
}
inline Model faces_for(const Target& t, std::size_t count) {
  return {silt::text(count, " faces"), hull_of(t.exact, count), 1};
}
inline Model exact_for(const Target& t) { return {"super-ellipsoid", t.exact, 1}; }
/// Flat faces with sharp edges; for the cube only.
inline Model true_cube() {
  std::vector<Vec3d> corners;
  for (int k = 0; k < 8; ++k)
    corners.push_back({k & 1 ? 1.0 : -1.0, k & 2 ? 1.0 : -1.0, k & 4 ? 1.0 : -1.0});
  return {"6 faces", silt::Polyhedron::from_points(corners), 1};
}
inline Model sphere_with(double rolling_friction) {
  return {silt::text("sphere, mu_r = ", rolling_friction), RollingSphere{rolling_friction}, 1};
}

/// All models of a shape; fewer if quick.
inline std::vector<Model> models_for(const Target& t, bool quick) {
  std::vector<Model> all;
  for (const std::size_t n :
       quick ? std::vector<std::size_t>{5, 50} : std::vector<std::size_t>{5, 20, 50, 200})
    all.push_back(spheres_for(t, n));
  all.push_back(exact_for(t));
  if (t.name == "cube") all.push_back(true_cube());
  for (const std::size_t n :
       quick ? std::vector<std::size_t>{20, 60} : std::vector<std::size_t>{20, 60, 240, 2000})
    all.push_back(faces_for(t, n));
  return all;
}

/// Rms over all directions [-, of `radius`] of the distance between the tangent planes of the model
/// and of the exact shape. It does not detect hollows between spheres.
inline double outline_error(const Model& model, const silt::SuperEllipsoid& exact) {
  double sum = 0;
  constexpr int count = 2000;
  const auto height = [&](const Vec3d& n) {
    return std::visit(
        [&](const auto& form) {
          using F = std::decay_t<decltype(form)>;
          double most = 0;
          if constexpr (std::is_same_v<F, RollingSphere>) {
            most = radius;
          } else {
            const double v = form.mass_properties().volume, scale = std::cbrt(volume / v);
            if constexpr (std::is_same_v<F, silt::MultiSphere>) {
              for (const auto& b : form.balls) most = std::max(most, dot(b.centre, n) + b.radius);
            } else if constexpr (std::is_same_v<F, silt::Polyhedron>) {
              most = form.reach(n);
            } else {
              most = form.height(n);
            }
            most *= scale;
          }
          return most;
        },
        model.form);
  };
  for (int k = 0; k < count; ++k) {
    const double z = 1 - (2.0 * k + 1) / count, r = std::sqrt(1 - z * z), turn = 2.399963229 * k;
    const Vec3d n{r * std::cos(turn), r * std::sin(turn), z};  // evenly, by the golden angle
    const double gap = height(n) - exact.height(n);
    sum += gap * gap;
  }
  return std::sqrt(sum / count) / radius;
}

}  // namespace studies::shape
