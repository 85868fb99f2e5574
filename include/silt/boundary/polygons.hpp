// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include <silt/core/dyn_array.hpp>
#include <silt/core/error.hpp>
#include <silt/core/vec3.hpp>

namespace silt::inline SILT_TARGET::detail {

/// A surface as in OBJ, PLY and VTP files: points, and faces given by point numbers.
struct Polygons {
  std::string file;               // prefix of messages
  DynArray<Vec3d> points;         // in the file's unit
  DynArray<std::size_t> corners;  // point numbers from 0, face after face
  DynArray<std::size_t> ends;     // end of each face in `corners`
  DynArray<std::size_t> lines;    // line of each face in the file; empty: unknown

  std::string face(std::size_t f) const {
    return lines.empty() ? text(file, ", face ", f + 1, " of ", ends.size())
                         : text(file, ", line ", lines[f], ": the face");
  }
};

/// Polygons as triangle fans from their first corner; points times `scale` [m].
/// Errors: FileError for a file without faces, a face of fewer than three corners, a point number
///         out of range, a point that is not finite, and a polygon whose fan would fold back.
inline DynArray<std::array<Vec3d, 3>> fanned(const Polygons& p, double scale) {
  if (p.ends.empty())
    throw FileError(text(p.file, " has no faces; a surface needs triangles or polygons"));
  DynArray<std::array<Vec3d, 3>> triangles;
  std::size_t begin = 0;
  for (std::size_t f = 0; f < p.ends.size(); begin = p.ends[f++]) {
    const std::size_t corners = p.ends[f] - begin;
    if (corners < 3)
      throw FileError(
          text(p.face(f), " has ", corners, " corners; a face needs at least 3, remove it"));
    for (std::size_t k = begin; k < p.ends[f]; ++k) {
      if (p.corners[k] >= p.points.size())
        throw FileError(text(p.face(f), " names point ", p.corners[k] + 1, ", but there are only ",
                             p.points.size(), ", counted from 1"));
      const Vec3d& corner = p.points[p.corners[k]];
      if (!is_finite(scale * corner))
        throw FileError(text(p.face(f), " has the corner ", corner, ", times scale = ", scale,
                             "; coordinates must be finite"));
    }
    const auto at = [&](std::size_t k) { return scale * p.points[p.corners[begin + k]]; };
    Vec3d whole{0, 0, 0};
    for (std::size_t k = 2; k < corners; ++k) {
      triangles.push_back({at(0), at(k - 1), at(k)});
      whole += cross(at(k - 1) - at(0), at(k) - at(0));
    }
    // In the fan of a concave polygon some triangle has the opposite orientation.
    for (std::size_t k = 2; k < corners && corners > 3; ++k)
      if (dot(cross(at(k - 1) - at(0), at(k) - at(0)), whole) < -1e-6 * dot(whole, whole))
        throw FileError(text(p.face(f), " is a concave polygon of ", corners,
                             " corners; let the program that wrote it export triangles"));
  }
  return triangles;
}

}  // namespace silt::inline SILT_TARGET::detail
