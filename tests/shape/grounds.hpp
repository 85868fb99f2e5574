// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <silt/shape/narrow/solid_mesh_contacts.hpp>

#include "solid_bodies.hpp"

/// Grounds of triangles for tests of contacts with meshes.
namespace solid_test {

using shape_test::Soup;

inline void add_quad(Soup& soup, const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d) {
  soup.push_back({a, b, c}), soup.push_back({a, c, d});
}

/// A flat square floor, z = height(x, y), of irregular triangles; patches that share no corners.
template <class Height>
Soup floor_of(Draws& r, int n, double half, Height&& height) {
  std::vector<Vec3d> p;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) {
      const double w = 2 * half / n, jitter = 0.3 * w;
      const bool rim = i == 0 || j == 0 || i == n || j == n;
      const double x = -half + w * i + (rim ? 0 : r.uniform(-jitter, jitter));
      const double y = -half + w * j + (rim ? 0 : r.uniform(-jitter, jitter));
      p.push_back({x, y, height(x, y)});
    }
  Soup out;
  const auto at = [&](int i, int j) { return p[static_cast<std::size_t>(j * (n + 1) + i)]; };
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      if (r.uniform() < 0.5)
        add_quad(out, at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
      else
        add_quad(out, at(i + 1, j), at(i + 1, j + 1), at(i, j + 1), at(i, j));
    }
  return out;
}

/// A flat floor in two parts that share no corners: the fine one's rim has them on the coarse one's
/// triangles' sides.
inline TriangleMesh floor_with_seam(Draws& r) {
  Soup soup = floor_of(r, 4, 1.5, [](double, double) { return 0.; });
  for (auto& t : soup)
    for (auto& p : t) p.x -= 1.5;
  for (auto t : floor_of(r, 7, 1.5, [](double, double) { return 0.; })) {
    for (auto& p : t) p.x += 1.5;
    soup.push_back(t);
  }
  return TriangleMesh(soup);
}

/// A step: floor z = 0 for x > 0, going down at x = 0, floor z = -1 for x < 0.
inline TriangleMesh step_mesh() {
  Soup soup;
  add_quad(soup, {0, -5, 0}, {5, -5, 0}, {5, 5, 0}, {0, 5, 0});
  add_quad(soup, {0, -5, -1}, {0, -5, 0}, {0, 5, 0}, {0, 5, -1});
  add_quad(soup, {-5, -5, -1}, {0, -5, -1}, {0, 5, -1}, {-5, 5, -1});
  return TriangleMesh(soup, 0.1);
}

/// The roof of a house whose ridge is the y axis; slopes fall by `slope`.
inline TriangleMesh ridge_mesh(double slope) {
  Soup soup;
  add_quad(soup, {0, -5, 0}, {3, -5, -3 * slope}, {3, 5, -3 * slope}, {0, 5, 0});
  add_quad(soup, {0, 5, 0}, {-3, 5, -3 * slope}, {-3, -5, -3 * slope}, {0, -5, 0});
  return TriangleMesh(soup, 0.1);
}
/// A pyramid whose tip is the origin.
inline TriangleMesh tip_mesh(double slope) {
  Soup soup;
  const Vec3d p[4] = {
      {3, 0, -3 * slope}, {0, 3, -3 * slope}, {-3, 0, -3 * slope}, {0, -3, -3 * slope}};
  for (int k = 0; k < 4; ++k) soup.push_back({Vec3d{0, 0, 0}, p[k], p[(k + 1) % 4]});
  return TriangleMesh(soup, 0.1);
}

template <class Body>
Touches at(const TriangleMesh& mesh, const Body& body) {
  std::vector<std::uint32_t> near;
  mesh.triangles_near(detail::centre_of(body), detail::bound_of(body), near);
  return all([&](SolidContact* out, int n) { return mesh_contacts(body, mesh, near, out, n); });
}

}  // namespace solid_test
