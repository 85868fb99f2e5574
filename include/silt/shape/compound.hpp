// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <string>

#include <silt/core/dyn_array.hpp>
#include <silt/shape/dilated_moments.hpp>
#include <silt/shape/narrow/sphere_polyhedron.hpp>
#include <silt/shape/poly_super_ellipsoid.hpp>

namespace silt::inline SILT_TARGET {

/// Rigid body of convex parts of one kind: a multi-super-ellipsoid, or a concave polyhedron.
///
///   silt::Compound<silt::SuperEllipsoid> cross{.parts = {{rod}, {rod, {}, quarter_turn}}};
///   silt::Compound<silt::Polyhedron> angle{.parts = {{wall}, {floor}},
///                                          .mass = silt::mass_properties(triangles)};
///
/// Contacts are those of the parts, each with its own history. Mass and inertia may be given, for
/// example from the surface of a concave polyhedron. Otherwise they are those of the union of the
/// parts, computed on a grid of points with `grid` points along the longest side of the bounding
/// box (200: error 1e-3 of volume and inertia).
///
/// Errors: check() throws InputError: no parts, or an error of a part's own check().
/// Tests: tests/shape/compound.cpp
/// Source: none: contacts are those of the parts.
/// Valid:  as its parts; parts may overlap.
/// Units:  SI.
template <SolidShape S>
struct Compound {
  static constexpr bool is_body = true, one_part = false;
  using Kinds = typename S::Kinds;
  struct Part {
    S shape;
    Vec3d centre{0, 0, 0};  // [m] origin of its frame, in the compound's frame
    Quaternion axes{};      // rotates its frame into the compound's
    bool operator==(const Part&) const = default;
  };

  DynArray<Part> parts;
  std::optional<MassProperties> mass = {};
  int grid = 200;

  bool operator==(const Compound&) const = default;

  void check() const {
    require(!parts.empty(), "Compound has no parts; give at least one");
    require(grid >= 10, "Compound.grid = ", grid, " [-] must be at least 10");
    const auto check_axes = [](const Quaternion& q, const std::string& whose) {
      const double length = std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
      require(std::abs(length - 1) < 1e-6, "Compound: the axes of ", whose, " have length ", length,
              " [-], but must be a unit quaternion, as rotation_about(axis, angle) returns it");
    };
    for (std::size_t k = 0; k < parts.size(); ++k) {
      const Part& p = parts[k];
      p.shape.check();
      require(is_finite(p.centre), "Compound: the centre of a part, ", p.centre,
              " [m], must be finite");
      check_axes(p.axes, text("part ", k));
    }
    if (mass) check_mass("Compound", *mass);
  }

  /// Description of the form for comparison (checkpoints): visit(name, number).
  template <class Visit>
  void describe(const Visit& visit) const {
    visit("parts", static_cast<double>(parts.size()));
    for (std::size_t k = 0; k < parts.size(); ++k) {
      const auto of_part = [&](const std::string& name, const auto& value) {
        visit(text("part ", k, ": ", name), value);
      };
      parts[k].shape.describe(of_part);
      const Quaternion& q = parts[k].axes;
      of_part("centre x [m]", parts[k].centre.x), of_part("centre y [m]", parts[k].centre.y);
      of_part("centre z [m]", parts[k].centre.z), of_part("axes w", q.w), of_part("axes x", q.x);
      of_part("axes y", q.y), of_part("axes z", q.z);
    }
  }

  MassProperties mass_properties() const {
    return mass ? *mass : parts.size() == 1 ? of_one() : silt::mass_properties(moments_of_union());
  }

  DynArray<SolidPart<Kinds>> solids(const MassProperties& of) const {
    DynArray<SolidPart<Kinds>> all;
    const Quaternion back = conjugate(of.axes);
    for (const Part& p : parts) {
      // The part is rotated and shifted in its own principal frame.
      const MassProperties own = p.shape.mass_properties();
      const Vec3d centroid = p.centre + rotate(p.axes, own.centroid);
      const Quaternion turn = back * p.axes * own.axes;
      for (auto& solid : p.shape.solids(own))
        all.push_back({std::move(solid.solid),
                       rotate(back, centroid - of.centroid) + rotate(turn, solid.centre),
                       turn * solid.axes});
    }
    return all;
  }

 private:
  MassProperties of_one() const {
    MassProperties m = parts.front().shape.mass_properties();
    m.centroid = parts.front().centre + rotate(parts.front().axes, m.centroid);
    m.axes = parts.front().axes * m.axes;
    return m;
  }

  static bool holds(const SuperEllipsoid& s, const Vec3d& x) { return s.value(x) <= 0; }
  static bool holds(const PolySuperEllipsoid& s, const Vec3d& x) { return s.value(x) <= 0; }
  static bool holds(const Polyhedron& s, const Vec3d& x) {
    if (s.radius() > 0) return sphere_contact(x, 0, PlacedPolyhedron{&s, {}}).overlap > 0;
    for (const auto& face : s.faces())
      if (dot(face.normal, x) > face.offset) return false;
    return true;
  }
  /// A point inside the part, in its frame, and the radius of the part about it.
  template <class Shape>
  static Vec3d middle_of(const Shape&) {
    return {0, 0, 0};
  }
  static Vec3d middle_of(const Polyhedron& s) {
    Box box;
    for (const Vec3d& v : s.vertices()) box.include(v);
    return box.min + 0.5 * box.extent();
  }
  static double bound(const Polyhedron& s) {
    const Vec3d middle = middle_of(s);
    double most = 0;
    for (const Vec3d& v : s.vertices()) most = std::max(most, norm(v - middle));
    return most + s.radius();
  }
  static double bound(const SuperEllipsoid& s) { return s.bounding_radius(); }
  static double bound(const PolySuperEllipsoid& s) { return s.bounding_radius(); }

  /// The grid is tilted: faces parallel to its planes would count a whole layer of cells too many
  /// or too few.
  Moments moments_of_union() const {
    const Quaternion tilt = rotation_about({0.26, 0.53, 0.81}, 0.7);
    // All about the middle of the parts, to avoid cancellation far from the frame's origin.
    DynArray<Vec3d> places;
    Box around;
    for (const Part& p : parts) {
      places.push_back(p.centre + rotate(p.axes, middle_of(p.shape)));
      around.include(places.back());
    }
    const Vec3d middle = around.min + 0.5 * around.extent();
    Box box;
    for (std::size_t k = 0; k < parts.size(); ++k) {
      const double r = bound(parts[k].shape);
      const Vec3d centre = rotate(conjugate(tilt), places[k] - middle);
      box.include(centre - Vec3d{r, r, r}), box.include(centre + Vec3d{r, r, r});
    }
    const Vec3d e = box.extent();
    const double h = std::max({e.x, e.y, e.z}) / grid;
    const auto cells = [&](double length) { return static_cast<int>(std::ceil(length / h)); };
    const int nx = cells(e.x), ny = cells(e.y), nz = cells(e.z);
    const Vec3d step{e.x / nx, e.y / ny, e.z / nz};
    const double cell = step.x * step.y * step.z;
    Moments m;
    m.origin = middle;
    for (int i = 0; i < nx; ++i)
      for (int j = 0; j < ny; ++j)
        for (int k = 0; k < nz; ++k) {
          const Vec3d x = rotate(
              tilt, box.min + Vec3d{(i + 0.5) * step.x, (j + 0.5) * step.y, (k + 0.5) * step.z});
          for (const Part& p : parts)
            if (holds(p.shape, rotate(conjugate(p.axes), x - (p.centre - middle)))) {
              m.volume += cell, m.first += cell * x, m.second += cell * outer(x);
              break;
            }
        }
    return m;
  }
};

}  // namespace silt
