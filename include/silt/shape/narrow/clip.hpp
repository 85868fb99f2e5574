// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <bit>
#include <memory>
#include <utility>

#include <silt/shape/polyhedron.hpp>

/// Cuts a convex body by half-spaces. The topology depends only on signs, and rounding cannot break
/// it.
///
/// The body is a graph with three edges at each vertex (clip_graph.hpp). A cut removes the vertices
/// outside, puts a new vertex on each edge that crosses the plane, and connects each new vertex to
/// the next along the face between them. For any signs the result is a closed graph of the same
/// kind, or several; vertices in the plane of the cut count as inside.
/// Source: D. Powell, T. Abel, An exact general remeshing scheme applied to physically conservative
///         voxelization, J. Comput. Phys. 297 (2015) 340-356, sec. 3 (the walk around faces).
///
/// Tests:  tests/shape/volume_overlap.cpp

namespace silt::inline SILT_TARGET::detail {

/// Half-space normal . x <= offset.
struct HalfSpace {
  Vec3d normal;
  double offset;
};

/// Numbers of faces made by cuts begin here; lower numbers are the body's own.
inline constexpr std::size_t first_cut_face = 4352;
static_assert(Polyhedron::most_faces <= first_cut_face);

template <class Room>
Room* make_room_of_thread() {
  thread_local const auto room = std::make_unique_for_overwrite<Room>();
  return room.get();
}
/// Memory of one thread for one kind of work, kept for the lifetime of the thread. It is not
/// initialised: of a large block the system provides only the pages that are used.
template <class Room>
SILT_INLINE Room& room_of_thread() {
  thread_local constinit Room* room = nullptr;
  if (room == nullptr) [[unlikely]]
    room = make_room_of_thread<Room>();
  return *room;
}

/// A body after cuts. It is in the thread's memory, one at a time: 1.5 MB, of which small bodies
/// use little.
class ClippedBody {
 public:
  /// Bodies and cutters have at most Polyhedron::most_faces each, and a simple polytope with F
  /// faces has 2 F - 4 vertices.
  static constexpr std::size_t most_vertices = 4 * Polyhedron::most_faces + 432;
  static_assert(most_vertices <= 1 << 16 &&
                first_cut_face + Polyhedron::most_faces <= 1 << 16);  // numbers of 16 bits

  struct Graph {
    alignas(64) double x[most_vertices], y[most_vertices], z[most_vertices];
    std::array<std::uint16_t, 4> neighbour[most_vertices], face[most_vertices];
    std::size_t size;

    Vec3d at(std::size_t v) const { return {x[v], y[v], z[v]}; }
  };

  ClippedBody() = default;
  ClippedBody(const ClippedBody&) = delete;
  /// The object of this thread, with an uncut body.
  static SILT_INLINE ClippedBody& whole(const Polyhedron& body) {
    ClippedBody& all = room_of_thread<ClippedBody>();
    all.start_ = &body.graph_columns(), all.current_ = 0;
    return all;
  }

  /// Removes the part outside the half-space; false if nothing is left. `name` of the new face.
  bool cut(const HalfSpace& half, std::size_t name) {
    if (start_ == nullptr) {
      const Graph& now = graphs_[current_];
      return cut_from({now.x, now.y, now.z, now.neighbour, now.face, now.size}, half, name);
    }
    const auto& s = *std::exchange(start_, nullptr);
    const Source whole{s.x.data(),         s.y.data(),    s.z.data(),
                       s.neighbour.data(), s.face.data(), s.size};
    const std::size_t before = current_;
    if (!cut_from(whole, half, name)) return false;
    if (current_ == before) copy(whole);  // completely inside the half-space
    return true;
  }
  /// After at least one cut with a non-empty result.
  const Graph& graph() const { return graphs_[current_]; }

 private:
  using Real = Lanes<DefaultArch>::Real;
  static constexpr std::size_t width = Lanes<DefaultArch>::width;

  /// Body to cut: columns of coordinates, padded by copies to full lanes.
  struct Source {
    const double *x, *y, *z;
    const std::array<std::uint16_t, 4>*neighbour, *face;
    std::size_t size;
  };

  void copy(const Source& from) {
    Graph& to = graphs_[current_];
    for (std::size_t v = 0; v < (from.size + width - 1) / width * width; ++v)
      to.x[v] = from.x[v], to.y[v] = from.y[v], to.z[v] = from.z[v];
    std::copy_n(from.neighbour, from.size, to.neighbour);
    std::copy_n(from.face, from.size, to.face);
    to.size = from.size;
  }

  /// Heights of all vertices over the plane; returns how many are outside.
  SILT_INLINE std::size_t heights(const Source& from, const HalfSpace& half) {
    const Real nx(half.normal.x), ny(half.normal.y), nz(half.normal.z), offset(half.offset);
    std::size_t inside = 0;
    for (std::size_t v = 0; v < from.size; v += width) {
      const Real h = nx * load_any<Real>(from.x + v) + ny * load_any<Real>(from.y + v) +
                     nz * load_any<Real>(from.z + v) - offset;
      store(height_ + v, h);
      auto bits = lane_bits(h <= Real(0));
      if (from.size - v < width) bits &= (std::uint64_t{1} << (from.size - v)) - 1;
      inside += static_cast<std::size_t>(std::popcount(bits));
    }
    return from.size - inside;
  }

  /// Numbers the vertices inside consecutively, and returns their number.
  SILT_INLINE std::size_t number(const Source& from, std::size_t outside) {
    std::size_t kept = 0;
    const auto keep = [&](std::size_t v) {
      old_[kept] = static_cast<std::uint16_t>(v), number_[v] = static_cast<std::uint16_t>(kept);
    };
    if (from.size < 256 || 4 * outside < 3 * from.size) {
      for (std::size_t v = 0; v < from.size; ++v) keep(v), kept += height_[v] <= 0;
      return kept;
    }
    for (std::size_t v = 0; v < from.size; v += width) {  // few of many: a cap
      auto bits = lane_bits(load<Real>(height_ + v) <= Real(0));
      if (from.size - v < width) bits &= (std::uint64_t{1} << (from.size - v)) - 1;
      for (; bits != 0; bits &= bits - 1)
        keep(v + static_cast<std::size_t>(std::countr_zero(bits))), ++kept;
    }
    return kept;
  }

  SILT_INLINE bool cut_from(const Source& from, const HalfSpace& half, std::size_t name) {
    const std::size_t outside = heights(from, half);
    if (outside == 0) return true;
    if (outside == from.size) return false;
    current_ ^= 1;
    Graph& to = graphs_[current_];
    const std::size_t kept = number(from, outside);
    std::size_t crossings = 0;
    for (std::size_t i = 0; i < kept; ++i) {
      const std::size_t v = old_[i];
      to.x[i] = from.x[v], to.y[i] = from.y[v], to.z[i] = from.z[v], to.face[i] = from.face[v];
      for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t other = from.neighbour[v][k];
        if (height_[other] <= 0)
          to.neighbour[i][k] = number_[other];
        else
          add_vertex(from, to, i, k, kept + crossings++, name);
      }
    }
    to.size = kept + crossings;
    join(to, kept);
    for (std::size_t v = to.size; v % width != 0; ++v)
      to.x[v] = to.x[0], to.y[v] = to.y[0], to.z[v] = to.z[0];
    return true;
  }

  /// New vertex w on the edge from kept vertex i to its neighbour k. A walk from i keeps the face
  /// of that edge on its left and continues to neighbour 1.
  SILT_INLINE void add_vertex(const Source& from, Graph& to, std::size_t i, std::size_t k,
                              std::size_t w, std::size_t name) {
    const std::size_t v = old_[i], other = from.neighbour[v][k];
    const double part = height_[v] / (height_[v] - height_[other]);
    to.x[w] = from.x[v] + part * (from.x[other] - from.x[v]);
    to.y[w] = from.y[v] + part * (from.y[other] - from.y[v]);
    to.z[w] = from.z[v] + part * (from.z[other] - from.z[v]);
    const std::uint16_t before = from.face[v][k], after = from.face[v][k == 2 ? 0 : k + 1];
    to.neighbour[i][k] = static_cast<std::uint16_t>(w);
    to.neighbour[w][0] = static_cast<std::uint16_t>(i);
    // One store of 8 bytes, as the next cut loads 8: a load from several stores would stall.
    to.face[w] = {after, before, static_cast<std::uint16_t>(name), 0};
    leaves_by_[before] = static_cast<std::uint16_t>(w);
  }

  /// Connects each new vertex w to the one where the face on its left leaves again. A plane leaves
  /// a face once; if rounding makes it cross the plane of a face repeatedly, a walk around the face
  /// decides.
  SILT_INLINE void join(Graph& g, std::size_t kept) const {
    bool once = true;
    for (std::size_t w = kept; w < g.size; ++w) {
      const std::size_t next = leaves_by_[g.face[w][0]];
      once &= leaves_by_[g.face[w][1]] == w;
      g.neighbour[next][1] = static_cast<std::uint16_t>(w);
      g.neighbour[w][2] = static_cast<std::uint16_t>(next);
    }
    if (!once) [[unlikely]]
      walk(g, kept);
  }
  static void walk(Graph& g, std::size_t kept) {
    for (std::size_t w = kept; w < g.size; ++w) {
      std::size_t before = w, at = g.neighbour[w][0];
      while (at < kept) {
        const auto& around = g.neighbour[at];
        const std::size_t k = around[0] == before ? 1 : around[1] == before ? 2 : 0;
        before = std::exchange(at, around[k]);
      }
      g.neighbour[at][1] = static_cast<std::uint16_t>(w);
      g.neighbour[w][2] = static_cast<std::uint16_t>(at);
    }
  }

  const Polyhedron::GraphColumns* start_;
  std::size_t current_;
  alignas(64) double height_[most_vertices];
  std::uint16_t number_[most_vertices], old_[most_vertices];
  std::uint16_t leaves_by_[2 * first_cut_face];  // new vertex at which the cut leaves a face
  Graph graphs_[2];
};

}  // namespace silt::detail
