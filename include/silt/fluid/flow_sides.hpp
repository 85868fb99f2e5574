// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <optional>
#include <utility>
#include <variant>

#include <silt/core/dyn_array.hpp>
#include <silt/core/error.hpp>
#include <silt/fluid/flow_boundary.hpp>
#include <silt/fluid/side_area.hpp>
#include <silt/fluid/side_values.hpp>

namespace silt::inline SILT_TARGET {

namespace fluid_detail {

/// Boundary conditions of a flow at the six sides of its grid: values on boundary faces and in
/// ghosts.
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
    Side made{side, {}, {}, {}, {}, 1};
    if (auto* const in = std::get_if<Inflow>(&made.kind)) {
      require(std::isfinite(in->rate.value_or(0)),
              "FlowSolver: Inflow.rate = ", in->rate.value_or(0), " m3/s at a side in ", name,
              " is not finite");
      check_one_way(*in, name);
      const Vec3d& v = in->velocity;
      const bool alone = !in->profile && !in->velocity_in_time && !in->rate && !in->rate_in_time;
      if (alone && is_finite(v))
        require(along(v, direction) != 0 || dot(v, v) == 0, "FlowSolver: Inflow.velocity = ", v,
                " m/s at the ", end == 0 ? "lower" : "upper", " side in ", name,
                " lies along that side and brings no fluid; give it a part along ", name,
                ", or use NoSlip{.velocity} for a wall that moves along itself");
      if ((in->rate || in->rate_in_time) && !in->profile && v.x == 0 && v.y == 0 && v.z == 0)
        (direction == 0   ? in->velocity.x
         : direction == 1 ? in->velocity.y
                          : in->velocity.z) = (end == 0) == (in->rate.value_or(1) > 0) ? 1 : -1;
      if (in->outline) made.beyond = beyond(in->outline, direction, end);
    } else if (const auto* const out = std::get_if<Outflow>(&made.kind)) {
      require(std::isfinite(out->pressure), "FlowSolver: Outflow.pressure = ", out->pressure,
              " Pa at a side in ", name, " is not finite");
    }
    for (int c = 0; c < 3; ++c) {
      DynArray<double> given = values(made.kind, direction, end, c);
      if (c == direction && std::holds_alternative<NoSlip>(side))
        for (const double normal : given)
          require(normal == 0, "FlowSolver: a wall at a side in ", name,
                  " cannot have the velocity ", normal, " m/s across itself; use Inflow for that");
      made.given[static_cast<std::size_t>(c)] = std::move(given);
    }
    s = std::move(made);
  }

  /// Scales inflows with a rate or an outline. `boundary`: of the flow; null: none. area(e, i, j,
  /// k): share of a face of direction e in the fluid.
  template <class Area>
  void scale(const std::function<double(const Vec3d&)>& boundary, const Area& area) {
    for (int e = 0; e < 3; ++e)
      for (int end = 0; end < 2 && !grid_.periodic(e); ++end) {
        const auto* const in = std::get_if<Inflow>(&at(e, end).kind);
        if (in == nullptr) continue;
        if (!(in->rate || in->rate_in_time || in->outline)) {
          if (boundary) refuse_closed(e, end, area);
          continue;
        }
        set(e, end, FlowSide(at(e, end).kind));  // unscaled
        scale(e, end, boundary, area);
      }
  }

  /// Whether an inflow is time-dependent.
  bool any_changes() const {
    for (int e = 0; e < 3; ++e)
      for (int end = 0; end < 2; ++end)
        if (const auto* const in = changing(e, end); in != nullptr) return true;
    return false;
  }
  double time() const { return time_; }  // [s] of the values
  void set_time(double time) { time_ = time; }
  /// Updates time-dependent inflows to a time [s], `dt` [s] after the present one (0: unknown).
  /// Returns whether one has jumped: by more than a third of its new value, and at another rate
  /// than in the previous step.
  bool renew(double time, double dt) {
    time_ = time;
    bool jumped = false;
    for (int e = 0; e < 3; ++e)
      for (int end = 0; end < 2; ++end)
        if (const auto* const in = changing(e, end); in != nullptr)
          jumped = renew(e, end, *in, dt) || jumped;
    return jumped;
  }
  /// [1/s] Largest velocity of a time-dependent inflow over the cell size.
  double changing_courant() const {
    double most = 0;
    for (int e = 0; e < 3; ++e)
      for (int end = 0; end < 2; ++end)
        if (changing(e, end) != nullptr)
          for (int c = 0; c < 3; ++c)
            for (const double v : at(e, end).given[static_cast<std::size_t>(c)])
              most = std::max(most, std::abs(v) / along(grid_.h(), c));
    return most;
  }

  bool open(int direction, int end) const {
    return !grid_.periodic(direction) && std::holds_alternative<Outflow>(at(direction, end).kind);
  }
  bool through(int direction, int end) const {
    return open(direction, end) ||
           (!grid_.periodic(direction) && std::holds_alternative<Inflow>(at(direction, end).kind));
  }
  /// Velocity [m/s] of the wall at a side; null without a wall.
  const Vec3d* wall(int direction, int end) const {
    if (grid_.periodic(direction)) return nullptr;
    const auto* const found = std::get_if<NoSlip>(&at(direction, end).kind);
    return found == nullptr ? nullptr : &found->velocity;
  }
  /// First face and end of the faces of direction d whose velocity is unknown.
  int first(int d) const { return grid_.periodic(d) || open(d, 0) ? 0 : 1; }
  int last(int d) const {
    return grid_.cells()[static_cast<std::size_t>(d)] + (open(d, 1) ? 1 : 0);
  }
  bool any_open() const {
    for (int e = 0; e < 3; ++e)
      if (open(e, 0) || open(e, 1)) return true;
    return false;
  }

  /// Mean pressure [Pa] of the outlets; 0 without outlets.
  double outlet_pressure() const {
    double sum = 0, count = 0;
    for (int e = 0; e < 3; ++e)
      for (const int end : {0, 1})
        if (open(e, end)) sum += std::get<Outflow>(at(e, end).kind).pressure, ++count;
    return count > 0 ? sum / count : 0;
  }

  /// Sets the given faces of component c, and its ghosts. Inflow is given by its superficial
  /// velocity: at a side the void fraction `eps` is that of the cells there.
  void fill_velocity(int c, CellField& u, const CellField& eps) const {
    u.wrap_ghosts();
    for (int e = 0; e < 3; ++e) {
      if (grid_.periodic(e)) continue;
      for (int end = 0; end < 2; ++end) {
        const Side& side = at(e, end);
        const bool free = open(e, end), slips = free || std::holds_alternative<FreeSlip>(side.kind);
        const double* const given = side.given[static_cast<std::size_t>(c)].data();
        const std::ptrdiff_t out = outwards(e, end);
        if (e != c) {
          if (slips)
            for_edge(u, e, end, false,
                     [&](double* v, std::size_t) { v[out] = v[0], v[2 * out] = v[-out]; });
          else
            for_edge(u, e, end, false, [&](double* v, std::size_t k) {
              v[out] = 2 * given[k] - v[0], v[2 * out] = 2 * given[k] - v[-out];
            });
        } else if (free) {
          for_edge(u, e, end, true, [&](double* v, std::size_t) { v[out] = v[2 * out] = v[0]; });
        } else {
          const bool flows_in = std::holds_alternative<Inflow>(side.kind);
          const double* const beside = eps.values().data() - (end == 1 ? out : 0);
          for_edge(u, e, end, true, [&](double* v, std::size_t k) {
            v[0] = flows_in ? given[k] / beside[v - u.values().data()] : given[k];
            v[out] = v[2 * out] = 2 * v[0] - v[-out];
          });
        }
      }
    }
  }
  /// Ghosts of a flux through the faces of direction c: the neighbouring values.
  void fill_flux(int c, CellField& f) const {
    f.wrap_ghosts();
    for (int e = 0; e < 3; ++e)
      for (int end = 0; end < 2 && !grid_.periodic(e); ++end)
        for_edge(f, e, end, e == c,
                 [out = outwards(e, end)](double* v, std::size_t) { v[out] = v[0]; });
  }
  /// Ghosts of a cell field: the neighbouring cells.
  void fill_cells(CellField& f) const {
    fill(f, [](int, int) { return std::optional<double>(); });
  }
  /// As fill_cells, but with value(direction, end) at inflows.
  template <class Value>
  void fill_carried(CellField& f, const Value& value) const {
    fill_cells(f);
    for (int e = 0; e < 3; ++e)
      for (int end = 0; end < 2; ++end)
        if (through(e, end) && !open(e, end))
          for_edge(f, e, end, false,
                   [out = outwards(e, end), given = value(e, end)](double* v, std::size_t) {
                     v[out] = v[2 * out] = given;
                   });
  }
  /// Mean speed through an inflow [m/s], weighted with itself.
  double inflow_speed(int e, int end) const {
    double sum = 0, squares = 0;
    if (!through(e, end) || open(e, end)) return 0;
    for (const double v : at(e, end).given[static_cast<std::size_t>(e)])
      sum += std::abs(v), squares += v * v;
    return sum > 0 ? squares / sum : 0;
  }
  void fill_pressure(CellField& p, bool change) const {
    fill(p, [&](int e, int end) {
      const auto* out = std::get_if<Outflow>(&at(e, end).kind);
      return out == nullptr ? std::nullopt : std::optional(change ? 0.0 : out->pressure);
    });
  }

 private:
  using Side = SideValues;
  using Line = SideLine;
  const Inflow* changing(int e, int end) const {
    const auto* const in = grid_.periodic(e) ? nullptr : std::get_if<Inflow>(&at(e, end).kind);
    return in != nullptr && in->changes() ? in : nullptr;
  }
  bool renew(int e, int end, const Inflow& in, double dt) {
    Side& side = sides_[static_cast<std::size_t>(e)][static_cast<std::size_t>(end)];
    const DynArray<double> before = side.given[static_cast<std::size_t>(e)];
    const double rate = in.rate_in_time ? in.rate_in_time(time_) : 0;
    require(std::isfinite(rate), "FlowSolver: Inflow.rate_in_time is ", rate,
            " m3/s at t = ", time_, " s; it must be finite");
    for (int c = 0; c < 3; ++c) {
      auto& given = side.given[static_cast<std::size_t>(c)];
      const bool by_rate = static_cast<bool>(in.rate_in_time);
      given = by_rate ? side.shape[static_cast<std::size_t>(c)] : values(side.kind, e, end, c);
      for (double& v : given) v *= by_rate ? rate : side.factor;
    }
    return side.jumped(e, before, dt);
  }
  const Side& at(int e, int end) const {
    return sides_[static_cast<std::size_t>(e)][static_cast<std::size_t>(end)];
  }
  /// Memory offset from a value to the next one out of the box.
  std::ptrdiff_t outwards(int e, int end) const { return end == 0 ? -stride(e) : stride(e); }
  std::ptrdiff_t stride(int e) const {
    return e == 0   ? 1
           : e == 1 ? static_cast<std::ptrdiff_t>(grid_.row_stride())
                    : static_cast<std::ptrdiff_t>(grid_.plane_stride());
  }
  /// Calls visit(value, k) for the last values inside, or on the side, of all lines of a field that
  /// cross a side, including ghosts of other directions. `faces`: values on faces of direction e.
  template <class Visit>
  void for_edge(CellField& f, int e, int end, bool faces, const Visit& visit) const {
    constexpr int g = Grid::ghost;
    const int a = (e + 1) % 3, b = (e + 2) % 3;
    const auto& n = grid_.cells();
    int from[3] = {-g, -g, -g};
    from[e] = end == 0 ? 0 : n[static_cast<std::size_t>(e)] - (faces ? 0 : 1);
    double* row = &f(from[0], from[1], from[2]);
    std::size_t k = 0;
    for (int y = -g; y < n[static_cast<std::size_t>(b)] + g; ++y, row += stride(b)) {
      double* value = row;
      for (int x = -g; x < n[static_cast<std::size_t>(a)] + g; ++x, ++k, value += stride(a))
        visit(value, k);
    }
  }
  /// Calls visit(line, k) in the same order.
  template <class Visit>
  void for_line(int e, int end, const Visit& visit) const {
    constexpr int g = Grid::ghost;
    const int a = (e + 1) % 3, b = (e + 2) % 3;
    const auto& n = grid_.cells();
    std::size_t k = 0;
    Line line{{0, 0, 0}, e};
    line.at[e] = end == 0 ? 0 : n[static_cast<std::size_t>(e)] - 1;
    for (int y = -g; y < n[static_cast<std::size_t>(b)] + g; ++y)
      for (int x = -g; x < n[static_cast<std::size_t>(a)] + g; ++x, ++k) {
        line.at[a] = x, line.at[b] = y;
        visit(line, k);
      }
  }
  /// Ghosts of a cell field: the mean on a side is on_side(direction, end), or the neighbouring
  /// cell's value where that is empty.
  template <class OnSide>
  void fill(CellField& f, const OnSide& on_side) const {
    f.wrap_ghosts();
    for (int e = 0; e < 3; ++e) {
      if (grid_.periodic(e)) continue;
      for (int end = 0; end < 2; ++end) {
        const std::optional<double> held = on_side(e, end);
        const double twice = 2 * held.value_or(0), sign = held ? -1 : 1;
        for_edge(f, e, end, false, [&, out = outwards(e, end)](double* v, std::size_t) {
          v[out] = v[2 * out] = twice + sign * v[0];
        });
      }
    }
  }
  /// Point on the side [m] of a line of component c (3: of a cell), in the box.
  Vec3d place(const Line& line, int end, int c) const {
    const Vec3d h = grid_.h(), low = grid_.box().min, high = grid_.box().max;
    double x[3] = {low.x + (line.at[0] + (c == 0 ? 0 : 0.5)) * h.x,
                   low.y + (line.at[1] + (c == 1 ? 0 : 0.5)) * h.y,
                   low.z + (line.at[2] + (c == 2 ? 0 : 0.5)) * h.z};
    const double ends[2][3] = {{low.x, low.y, low.z}, {high.x, high.y, high.z}};
    for (int b = 0; b < 3; ++b) x[b] = std::clamp(x[b], ends[0][b], ends[1][b]);
    x[line.e] = ends[end][line.e];
    return {x[0], x[1], x[2]};
  }
  DynArray<char> beyond(const std::function<double(const Vec3d&)>& outline, int e, int end) const {
    DynArray<char> out;
    for_line(e, end, [&](const Line& line, std::size_t) {
      const Vec3d x = place(line, end, 3);
      const double away = outline(x);
      require(!std::isnan(away), "FlowSolver: Inflow.outline is not a number at ", x, " m");
      out.push_back(away > 0 ? 0 : 1);
    });
    return out;
  }
  /// Velocities of component c at a side, for all values of for_line().
  DynArray<double> values(const FlowSide& side, int e, int end, int c) const {
    const auto* const wall = std::get_if<NoSlip>(&side);
    const auto* const in = std::get_if<Inflow>(&side);
    DynArray<double> out;
    for_line(e, end, [&](const Line& line, std::size_t) {
      Vec3d v{0, 0, 0};
      if (wall != nullptr) v = wall->velocity;
      if (in != nullptr) {
        const Vec3d x = place(line, end, c);
        const bool passed = !in->outline || in->outline(x) > 0;
        if (passed)
          v = in->velocity_in_time ? in->velocity_in_time(x, time_)
              : in->profile        ? in->profile(x)
                                   : in->velocity;
      }
      const double component = along(v, c);
      require(std::isfinite(component), "FlowSolver: the ", end == 0 ? "lower" : "upper",
              " side in ", "xyz"[e], " is given the velocity ", component, " m/s in ", "xyz"[c],
              in != nullptr && in->velocity_in_time ? text(" at t = ", time_, " s") : "",
              "; give finite numbers");
      out.push_back(component);
    });
    return out;
  }
  static double along(const Vec3d& v, int c) { return c == 0 ? v.x : c == 1 ? v.y : v.z; }
  /// InputError for an inflow through faces that are all in walls of the boundary.
  template <class Area>
  void refuse_closed(int e, int end, const Area& area) const {
    const auto& n = grid_.cells();
    int face[3] = {0, 0, 0};
    face[e] = end == 0 ? 0 : n[static_cast<std::size_t>(e)];
    const int a = (e + 1) % 3, b = (e + 2) % 3;
    for (face[b] = 0; face[b] < n[static_cast<std::size_t>(b)]; ++face[b])
      for (face[a] = 0; face[a] < n[static_cast<std::size_t>(a)]; ++face[a])
        if (area(e, face[0], face[1], face[2]) > 0) return;
    require(false, "FlowSolver: the Inflow at the ", end == 0 ? "lower" : "upper", " side in ",
            "xyz"[e],
            " is all in walls of the FlowBoundary, and nothing can flow in; check the boundary's "
            "Side and place, or the side of the inflow");
  }

  template <class Area>
  void scale(int e, int end, const std::function<double(const Vec3d&)>& boundary,
             const Area& area) {
    Side& side = sides_[static_cast<std::size_t>(e)][static_cast<std::size_t>(end)];
    const Inflow& in = std::get<Inflow>(side.kind);
    const int a = (e + 1) % 3, b = (e + 2) % 3;
    const double h[3] = {grid_.h().x, grid_.h().y, grid_.h().z}, inwards = end == 0 ? 1 : -1;
    const double edge = end == 0 ? along(grid_.box().min, e) : along(grid_.box().max, e);
    const auto spot = [&](double u, double v) {
      double x[3];
      x[e] = edge, x[a] = u, x[b] = v;
      return Vec3d{x[0], x[1], x[2]};
    };
    const auto distance = [&](double u, double v) {
      const Vec3d x = spot(u, v);
      const double of_patch = in.outline(x);
      return boundary ? std::min(of_patch, boundary(x)) : of_patch;
    };
    const auto flux = [&](double u, double v) {
      if (in.velocity_in_time) return 1.0;
      return inwards * along(in.profile ? in.profile(spot(u, v)) : in.velocity, e);
    };
    const auto& n = grid_.cells();
    double passes = 0, both_ways = 0, wanted = 0;  // [m3/s]
    int faces = 0;
    for_line(e, end, [&](const Line& line, std::size_t k) {
      for (const int c : {a, b})
        if (line.at[c] < 0 || line.at[c] >= n[static_cast<std::size_t>(c)]) return;
      int face[3] = {line.at[0], line.at[1], line.at[2]};
      face[e] = end == 0 ? 0 : n[static_cast<std::size_t>(e)];
      if (const double share = area(e, face[0], face[1], face[2]); share > 0) {
        const double speed = in.velocity_in_time
                                 ? (side.beyond.empty() || side.beyond[k] == 0 ? 1 : 0)
                                 : inwards * side.given[static_cast<std::size_t>(e)][k];
        const double one = speed * share * h[a] * h[b];
        passes += one, both_ways += std::abs(one);
        if (side.beyond.empty() || side.beyond[k] == 0) ++faces;
      }
      if (in.rate || in.rate_in_time) return;
      const Vec3d x = place(line, end, 3);
      wanted += integral_inside<16>(along(x, a), along(x, b), h[a], h[b], distance, flux);
    });
    if (in.rate || in.rate_in_time) wanted = in.rate.value_or(1);
    const double factor = inflow_factor(wanted, passes, both_ways, faces, e, end);
    for (auto& given : side.given)
      for (double& v : given) v *= factor;
    if (in.velocity_in_time) side.factor = factor;
    if (!in.rate_in_time) return;
    side.shape = side.given;
    renew(e, end, in, 0);
  }

  Grid grid_;
  double time_ = 0;  // [s]
  std::array<std::array<Side, 2>, 3> sides_;
};

}  // namespace fluid_detail

}  // namespace silt
