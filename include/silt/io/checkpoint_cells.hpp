// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include <silt/core/dyn_array.hpp>
#include <silt/core/error.hpp>
#include <silt/io/checkpoint_checks.hpp>
#include <silt/shape/convex_hull.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Forms of cells of broken polyhedra (engine/population/cell_forms.hpp) in checkpoints, stored as
/// their corners and faces. All other numbers follow from these bit for bit. Forms added by users
/// come from the program.
/// Tests: tests/breakage/polyhedra_restart.cpp.
template <class Form>
struct CellsState {
  DynArray<std::uint32_t> sizes;       // corners and faces of each cell
  DynArray<std::uint32_t> face_sizes;  // corners of each face
  DynArray<std::uint32_t> loops;       // of the faces, one after the other
  DynArray<Vec3d> corners;

  static CellsState of(std::span<const Form> cells) {
    CellsState s;
    for (const Form& cell : cells) {
      const ConvexFaces body = cell.shape.convex_faces();
      s.sizes.push_back(static_cast<std::uint32_t>(body.vertices.size()));
      s.sizes.push_back(static_cast<std::uint32_t>(body.faces.size()));
      s.corners.insert(s.corners.end(), body.vertices.begin(), body.vertices.end());
      for (const auto& loop : body.faces) {
        s.face_sizes.push_back(static_cast<std::uint32_t>(loop.size()));
        s.loops.insert(s.loops.end(), loop.begin(), loop.end());
      }
    }
    return s;
  }
  template <class Archive>
  void visit(Archive& a) {
    const auto count = [](const auto& column) {
      return Archive::loads ? CheckpointLoader::any_count : column.size();
    };
    a.column("breakage.cells", sizes, count(sizes));
    a.rows("breakage.corners", corners, count(corners));
    a.column("breakage.face_sizes", face_sizes, count(face_sizes));
    a.column("breakage.loops", loops, count(loops));
  }
  /// Restores the forms; refuses corners and faces that do not bound a convex body.
  DynArray<Form> forms(const CheckpointLoader& a) const {
    a.need(sizes.size() % 2 == 0, "breakage.cells has ", sizes.size(), " numbers, not two each");
    Rest corner{a, "breakage.corners", corners.size()}, loop{a, "breakage.loops", loops.size()},
        face{a, "breakage.face_sizes", face_sizes.size()};
    DynArray<Form> all;
    for (std::size_t k = 0; k < sizes.size(); k += 2) {
      ConvexFaces body;
      const std::size_t from = corner.next(sizes[k], k / 2), end = from + sizes[k];
      body.vertices.assign(at(corners, from), at(corners, end));
      const std::size_t first = face.next(sizes[k + 1], k / 2);
      for (std::size_t f = first; f < first + sizes[k + 1]; ++f) {
        const std::size_t begin = loop.next(face_sizes[f], k / 2);
        body.faces.emplace_back(at(loops, begin), at(loops, begin + face_sizes[f]));
      }
      try {
        all.emplace_back(decltype(Form::shape)::from_faces(body));
      } catch (const InputError& error) {
        a.refuse("breakage: cell ", k / 2, " is not a convex body: ", error.what());
      }
    }
    corner.end(), face.end(), loop.end();
    return all;
  }

 private:
  template <class Column>
  static auto at(const Column& column, std::size_t k) {
    return column.begin() + static_cast<std::ptrdiff_t>(k);
  }
  /// Remainder of a column while cells take their parts of it.
  struct Rest {
    const CheckpointLoader& a;
    const char* name;
    std::size_t size, taken = 0;

    std::size_t next(std::size_t count, std::size_t cell) {
      a.need(count <= size - taken, name, " has ", size, " entries, too few for cell ", cell);
      taken += count;
      return taken - count;
    }
    void end() const {
      a.need(taken == size, name, " has ", size, " entries, but the cells have ", taken);
    }
  };
};

}  // namespace silt::detail
