// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <utility>
#include <variant>
#include <vector>

#include <silt/core/error.hpp>
#include <silt/fluid/grid.hpp>

namespace silt::inline SILT_TARGET {

/// A wall at a side of the flow's box: the fluid has its velocity there.
struct NoSlip {
  Vec3d velocity{0, 0, 0};  // [m/s] along the wall
};

/// A wall without friction, or a plane of symmetry.
struct FreeSlip {};

/// Fluid flows in (or is drawn out) at a given velocity, which is superficial: that of the fluid in
/// front of the particles.
struct Inflow {
  Vec3d velocity{0, 0, 0};                             // [m/s]
  std::function<Vec3d(const Vec3d& place)> profile{};  // [m/s] at a place [m]; instead of velocity
};

/// Fluid flows out, at a given pressure.
struct Outflow {
  double pressure = 0;  // [Pa]
};

using FlowSide = std::variant<NoSlip, FreeSlip, Inflow, Outflow>;

namespace fluid_detail {

/// What bounds a flow at the six sides of its grid: values on boundary faces, and in ghosts.
class FlowSides {
 public:
  explicit FlowSides(const Grid& grid) : grid_(grid) {
    for (int e = 0; e < 3; ++e)
      for (int end = 0; end < 2; ++end)
        if (!grid.periodic(e)) set(e, end, NoSlip{});
  }

  void set(int direction, int end, const FlowSide& side) {
    constexpr const char* names = "xyz";
    require(direction >= 0 && direction < 3 && (end == 0 || end == 1), "FlowSolver: side (",
            direction, ", ", end, ") does not exist; directions are 0, 1, 2 and ends 0, 1");
    const char name[] = {names[direction], 0};
    require(!grid_.periodic(direction), "FlowSolver: the grid is periodic in ", name,
            "; it has no sides there");
    Side& s = sides_[static_cast<std::size_t>(direction)][static_cast<std::size_t>(end)];
    Side made{side, {}};
    for (int c = 0; c < 3; ++c) {
      std::vector<double> given = values(side, direction, end, c);
      if (c == direction && std::holds_alternative<NoSlip>(side))
        for (const double normal : given)
          require(normal == 0, "FlowSolver: a wall at a side in ", name,
                  " cannot have the velocity ", normal, " m/s across itself; use Inflow for that");
      made.given[static_cast<std::size_t>(c)] = std::move(given);
    }
    s = std::move(made);
  }

  bool open(int direction, int end) const {
    return !grid_.periodic(direction) && std::holds_alternative<Outflow>(at(direction, end).kind);
  }
  bool through(int direction, int end) const {
    return open(direction, end) ||
           (!grid_.periodic(direction) && std::holds_alternative<Inflow>(at(direction, end).kind));
  }
  /// The velocity [m/s] of the wall at a side; null if there is none.
  const Vec3d* wall(int direction, int end) const {
    if (grid_.periodic(direction)) return nullptr;
    const auto* const found = std::get_if<NoSlip>(&at(direction, end).kind);
    return found == nullptr ? nullptr : &found->velocity;
  }
  /// First and last face of direction d whose velocity is unknown, and one more.
  int first(int d) const { return grid_.periodic(d) || open(d, 0) ? 0 : 1; }
  int last(int d) const {
    return grid_.cells()[static_cast<std::size_t>(d)] + (open(d, 1) ? 1 : 0);
  }
  bool any_open() const {
    for (int e = 0; e < 3; ++e)
      if (open(e, 0) || open(e, 1)) return true;
    return false;
  }

  /// Sets the faces of component c that are given, and its ghosts.
  void fill_velocity(int c, Field& u) const {
    u.wrap_ghosts();
    for (int e = 0; e < 3; ++e) {
      if (grid_.periodic(e)) continue;
      for (int end = 0; end < 2; ++end) {
        const Side& side = at(e, end);
        const bool free = open(e, end), slips = free || std::holds_alternative<FreeSlip>(side.kind);
        const auto& given = side.given[static_cast<std::size_t>(c)];
        for_line(
            e, end,
            [&](Line line, std::size_t k) {
              line.data = &u;
              if (e == c) {
                if (!free) line(0) = given[k];
                // What flows back in brings nothing along.
                const double edge = line(0), out = end == 1 ? edge : -edge;
                line(1) = free ? (out > 0 ? edge : 0) : 2 * edge - line(-1);
                line(2) = line(1);
              } else {
                const double twice = slips ? 0 : 2 * given[k], sign = slips ? 1 : -1;
                line(1) = twice + sign * line(0), line(2) = twice + sign * line(-1);
              }
            },
            e == c);
      }
    }
  }
  /// Ghosts of a flux through the faces of direction c, as next to them.
  void fill_flux(int c, Field& f) const {
    f.wrap_ghosts();
    for (int e = 0; e < 3; ++e)
      for (int end = 0; end < 2 && !grid_.periodic(e); ++end)
        for_line(
            e, end,
            [&](Line line, std::size_t) {
              line.data = &f;
              line(1) = line(0);
            },
            e == c);
  }
  /// Ghosts of a cell field: of the next cell, or such that the mean on a face that fluid passes is
  /// `passed`.
  void fill_cells(Field& f) const {
    fill(
        f, 1, [](int, int) { return 0.0; }, false);
  }
  void fill_voidage(Field& f) const {
    fill(
        f, -1, [](int, int) { return 1.0; }, true);
  }
  void fill_pressure(Field& p, bool change) const {
    fill(
        p, -1,
        [&](int e, int end) {
          const auto* out = std::get_if<Outflow>(&at(e, end).kind);
          return out == nullptr || change ? 0.0 : out->pressure;
        },
        false);
  }

 private:
  struct Side {
    FlowSide kind = NoSlip{};
    std::array<std::vector<double>, 3> given;  // velocities where each component crosses the side
  };
  /// Values from a side outwards: 0 is the last one inside (or on it), 1 and 2 the ghosts.
  struct Line {
    Field* data;
    int at[3];
    int e, inner, outward;
    double& operator()(int k) const {
      int x[3] = {at[0], at[1], at[2]};
      x[e] = inner + k * outward;
      return (*data)(x[0], x[1], x[2]);
    }
  };
  const Side& at(int e, int end) const {
    return sides_[static_cast<std::size_t>(e)][static_cast<std::size_t>(end)];
  }
  /// Calls visit(line, k) for all values at a side, ghosts of other directions included. `faces`:
  /// the field stands on the faces of direction e.
  template <class Visit>
  void for_line(int e, int end, const Visit& visit, bool faces) const {
    constexpr int g = Grid::ghost;
    const int a = (e + 1) % 3, b = (e + 2) % 3;
    const auto& n = grid_.cells();
    std::size_t k = 0;
    Line line{nullptr, {0, 0, 0}, e, 0, 0};
    const int last = n[static_cast<std::size_t>(e)] - (faces ? 0 : 1);
    line.inner = end == 0 ? 0 : last, line.outward = end == 0 ? -1 : 1;
    for (int y = -g; y < n[static_cast<std::size_t>(b)] + g; ++y)
      for (int x = -g; x < n[static_cast<std::size_t>(a)] + g; ++x, ++k) {
        line.at[a] = x, line.at[b] = y;
        visit(line, k);
      }
  }
  template <class Value>
  void fill(Field& f, double sign, const Value& value, bool inflows) const {
    f.wrap_ghosts();
    for (int e = 0; e < 3; ++e) {
      if (grid_.periodic(e)) continue;
      for (int end = 0; end < 2; ++end) {
        const bool given = open(e, end) || (inflows && through(e, end));
        const double twice = given ? 2 * value(e, end) : 0, s = given ? sign : 1;
        for_line(
            e, end,
            [&](Line line, std::size_t) {
              line.data = &f;
              line(1) = twice + s * line(0), line(2) = line(1);
            },
            false);
      }
    }
  }
  /// Velocities that a side gives to component c, at all values for_line() visits.
  std::vector<double> values(const FlowSide& side, int e, int end, int c) const {
    const auto* const wall = std::get_if<NoSlip>(&side);
    const auto* const in = std::get_if<Inflow>(&side);
    std::vector<double> out;
    for_line(
        e, end,
        [&](const Line& line, std::size_t) {
          Vec3d v{0, 0, 0};
          if (wall != nullptr) v = wall->velocity;
          if (in != nullptr) v = in->velocity;
          if (in != nullptr && in->profile) {
            const Vec3d h = grid_.h(), low = grid_.box().min, high = grid_.box().max;
            double x[3] = {low.x + (line.at[0] + (c == 0 ? 0 : 0.5)) * h.x,
                           low.y + (line.at[1] + (c == 1 ? 0 : 0.5)) * h.y,
                           low.z + (line.at[2] + (c == 2 ? 0 : 0.5)) * h.z};
            const double ends[2][3] = {{low.x, low.y, low.z}, {high.x, high.y, high.z}};
            for (int b = 0; b < 3; ++b) x[b] = std::clamp(x[b], ends[0][b], ends[1][b]);
            x[e] = ends[end][e];
            v = in->profile({x[0], x[1], x[2]});
          }
          const double component = c == 0 ? v.x : c == 1 ? v.y : v.z;
          require(std::isfinite(component), "FlowSolver: a side is given the velocity ", component,
                  " m/s; give finite numbers");
          out.push_back(component);
        },
        false);
    return out;
  }

  Grid grid_;
  std::array<std::array<Side, 2>, 3> sides_;
};

}  // namespace fluid_detail

}  // namespace silt
