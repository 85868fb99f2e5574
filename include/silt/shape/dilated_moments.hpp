// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <silt/core/dyn_array.hpp>
#include <silt/core/gauss_rule.hpp>
#include <silt/shape/polyhedron.hpp>

/// Mass properties of a polyhedron dilated by r: its core, a slab on each face, a cylindrical wedge
/// along each edge, and a spherical sector at each corner. The directions of the sectors cover the
/// sphere once.
///
/// Slabs are exact (products of polynomials, Gauss rule with two points). Wedges and sectors use
/// Gauss rules with 16 and 12 points in each angle; the integrands are smooth, and the error is
/// 1e-12 of the volume. The volume is checked by Steiner's formula (tests/shape/polyhedron.cpp).
/// Source: J. Steiner 1840; quadrature: P. J. Davis, P. Rabinowitz, Methods of Numerical
///         Integration (1984), sec. 2.7.

namespace silt::inline SILT_TARGET {

namespace detail {

inline void add_point(Moments& m, const Vec3d& point, double weight) {
  m.volume += weight, m.first += weight * point, m.second += weight * outer(point);
}

/// Integral over directions u in the spherical triangle of unit vectors a, b, c, on its flat
/// triangle: p = a + s (b - a) + s t (c - b), u = p/|p|, d omega = s |a . (b x c)| / |p|^3 ds dt.
/// Wide triangles are bisected first, as the flat triangle must not be near the origin.
template <class Add>
void sum_directions(const Vec3d& a, const Vec3d& b, const Vec3d& c, Add&& add) {
  static const GaussRule<12> rule;
  const double ab = dot(a, b), bc = dot(b, c), ca = dot(c, a);
  if (std::min({ab, bc, ca}) < 0.6) {  // the longest side becomes the first
    if (bc < ab && bc <= ca) return sum_directions(b, c, a, add);
    if (ca < ab) return sum_directions(c, a, b, add);
    const Vec3d middle = normalised(a + b);
    sum_directions(a, middle, c, add);
    return sum_directions(middle, b, c, add);
  }
  const double det = std::abs(dot(a, cross(b, c)));
  for (std::size_t i = 0; i < 12; ++i)
    for (std::size_t j = 0; j < 12; ++j) {
      const double s = rule.at[i], t = rule.at[j];
      const Vec3d p = a + s * (b - a) + (s * t) * (c - b);
      const double length = norm(p);
      add(p * (1 / length), rule.weight[i] * rule.weight[j] * s * det / (length * length * length));
    }
}

/// `body` with its origin at `origin`.
inline void add_slabs(const Polyhedron& body, const Vec3d& origin, Moments& m) {
  const GaussRule<2> height;
  for (const auto& face : body.faces()) {
    const auto corner = body.loop(face);
    const Vec3d a = body.vertices()[corner[0]] - origin;
    for (std::size_t k = 2; k < corner.size(); ++k) {
      const Vec3d b = body.vertices()[corner[k - 1]] - origin;
      const Vec3d c = body.vertices()[corner[k]] - origin;
      const double area = 0.5 * norm(cross(b - a, c - a));
      for (std::size_t h = 0; h < 2; ++h)  // midpoints of the sides: exact to second order
        for (const Vec3d& p : {a + b, b + c, c + a})
          add_point(m, 0.5 * p + (height.at[h] * body.radius()) * face.normal,
                    height.weight[h] * body.radius() * area / 3);
    }
  }
}

inline void add_wedges(const Polyhedron& body, const Vec3d& origin, Moments& m) {
  static const GaussRule<16> angle;
  const GaussRule<2> along, out;
  const double r = body.radius();
  for (const auto& edge : body.edges()) {
    const Vec3d a = body.vertices()[edge.from] - origin, b = body.vertices()[edge.to] - origin;
    const Vec3d n = body.faces()[edge.left].normal, o = body.faces()[edge.right].normal;
    const double theta = std::atan2(norm(cross(n, o)), dot(n, o));
    const Vec3d aside = normalised(o - dot(n, o) * n);
    for (std::size_t i = 0; i < 16; ++i) {
      const double phi = theta * angle.at[i];
      const Vec3d u = std::cos(phi) * n + std::sin(phi) * aside;
      for (std::size_t j = 0; j < 2; ++j)
        for (std::size_t k = 0; k < 2; ++k)  // rho d rho, to third order in rho
          add_point(m, a + along.at[j] * (b - a) + (r * out.at[k]) * u,
                    angle.weight[i] * theta * along.weight[j] * norm(b - a) * out.weight[k] * r *
                        r * out.at[k]);
    }
  }
}

inline void add_sectors(const Polyhedron& body, const Vec3d& origin, Moments& m) {
  const GaussRule<3> out;
  const double r = body.radius();
  for (const auto& v : body.graph())  // chained vertices share the directions of a corner
    sum_directions(body.faces()[v.face[0]].normal, body.faces()[v.face[1]].normal,
                   body.faces()[v.face[2]].normal, [&](const Vec3d& u, double omega) {
                     for (std::size_t k = 0; k < 3; ++k)
                       add_point(m, v.at - origin + (r * out.at[k]) * u,
                                 omega * out.weight[k] * r * r * r * out.at[k] * out.at[k]);
                   });
}

}  // namespace detail

/// Mass properties of the body with its dilation, for density 1, in the frame of its corners.
inline MassProperties mass_properties(const Polyhedron& body) {
  const auto core = mass_properties(body.triangles());
  if (body.radius() == 0) return core;
  Moments m = moments_of(body.triangles(), core.centroid);
  detail::add_slabs(body, core.centroid, m);
  detail::add_wedges(body, core.centroid, m);
  detail::add_sectors(body, core.centroid, m);
  return mass_properties_about(core.centroid, m);
}

inline MassProperties Polyhedron::mass_properties() const { return silt::mass_properties(*this); }

/// Shape in the frame of its centroid and principal axes.
struct PrincipalShape {
  DynArray<Polyhedron> parts;  // convex; one if the body is
  double volume;               // [m3]
  Vec3d inertia;               // [m5] principal moments for density 1
  double bounding_radius;      // [m] about the centroid
  RigidPose frame;             // centroid and axes in the original frame
};

namespace detail {
inline PrincipalShape principal_shape(const MassProperties& mass,
                                      const DynArray<Polyhedron>& parts) {
  PrincipalShape out{{}, mass.volume, mass.inertia, 0, {mass.centroid, mass.axes}};
  for (const auto& part : parts) {
    auto points = part.vertices();
    for (auto& p : points) p = out.frame.to_body(p);
    out.parts.push_back(Polyhedron::from_points(points, part.radius()));
    out.bounding_radius = std::max(out.bounding_radius, out.parts.back().bounding_radius());
  }
  return out;
}
}  // namespace detail

inline PrincipalShape principal_shape(const Polyhedron& body) {
  return detail::principal_shape(mass_properties(body), {body});
}

inline DynArray<SolidPart<Polyhedron::Kinds>> Polyhedron::solids(const MassProperties& mass) const {
  return {{detail::principal_shape(mass, {*this}).parts.front(), {0, 0, 0}, {}}};
}

static_assert(SolidShape<Polyhedron>);

/// Concave body: mass from its surface, contacts from its convex parts. The parts must fill it: the
/// sum of their volumes may differ from that of the mesh by 1e-3 (contact forces of overlapping
/// parts would add up).
inline PrincipalShape principal_shape(const DynArray<std::array<Vec3d, 3>>& mesh,
                                      const DynArray<Polyhedron>& parts) {
  const TriangleMesh solid = solid_mesh(mesh);
  double sum = 0;
  for (const auto& part : parts) sum += part.volume();
  require(std::abs(sum - solid.volume()) <= 1e-3 * solid.volume(),
          "principal_shape: ", parts.size(), " convex parts have ", sum,
          " [m3] together, the mesh ", solid.volume(), "; they must fill it without overlap");
  return detail::principal_shape(mass_properties(mesh), parts);
}

}  // namespace silt
