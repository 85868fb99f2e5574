// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cstddef>

#include <silt/core/dyn_array.hpp>
#include <silt/fluid/concept.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Flow values in cells that are needed at particles.
class CellValues {
 public:
  using Three = DynArray<CellField>;  // by direction; empty if never needed

  explicit CellValues(const Grid& g) : velocity(3, CellField(g)), slope(velocity) {}

  Three velocity;         // [m/s] the mean of both faces
  Three slope;            // [Pa/m] of the pressure
  Three stress;           // [N/m3] div tau of the last step; from find_stress()
  Three curl;             // [1/s] of the velocity; from find_curl()
  Three stretch, strain;  // [1/s] rates of strain xx, yy, zz and yz, zx, xy; from find_strain()
  Three convection;       // [m/s2] u grad u; from find_convection()

  template <FlowOnGrid Flow>
  void find_velocity(const Flow& flow, const Team& team) {
    for (int d = 0; d < 3; ++d) {
      const int s[3] = {d == 0, d == 1, d == 2};
      CellField& to = velocity[at(d)];
      for_rows(flow, team, [&](int j, int k) {
        const CellField& u = flow.velocity(d);
        const double *low = u.row(j, k), *high = u.row(j + s[1], k + s[2]) + s[0];
        double* const out = to.row(j, k);
        for (int i = 0; i < flow.grid().nx(); ++i) out[i] = 0.5 * (low[i] + high[i]);
      });
    }
  }

  /// Mean of the slopes at both faces; next to a side or a wall only of the open face.
  template <FlowOnGrid Flow>
  void find_slope(Flow& flow, const Team& team) {
    const Grid& g = flow.grid();
    CellField& p = flow.pressure();
    flow.fill_pressure_ghosts();
    for (int d = 0; d < 3; ++d) {
      const int s[3] = {d == 0, d == 1, d == 2};
      const int last = g.cells()[at(d)] - 1;
      const double h = width(g, d);
      const bool low_held = flow.holds_pressure(d, 0), high_held = flow.holds_pressure(d, 1);
      for_rows(flow, team, [&](int j, int k) {
        const double *c = p.row(j, k), *below = p.row(j - s[1], k - s[2]) - s[0],
                     *above = p.row(j + s[1], k + s[2]) + s[0];
        double* const to = slope[at(d)].row(j, k);
        const OpenEnds open(flow.open_faces(d), s, j, k);
        for (int i = 0; i < g.nx(); ++i) {
          const int place = d == 0 ? i : d == 1 ? j : k;
          const bool low = (place > 0 || low_held) && open.low(i),
                     high = (place < last || high_held) && open.high(i);
          const double sum = (low ? c[i] - below[i] : 0) + (high ? above[i] - c[i] : 0);
          to[i] = sum / (h * std::max(1, low + high));
        }
      });
    }
  }

  /// div tau, the mean of both faces; next to a wall or a side that is not periodic only of the
  /// inner face.
  template <FlowOnGrid Flow>
  void find_stress(const Flow& flow, const Team& team) {
    const Grid& g = flow.grid();
    make(stress, g);
    for (int d = 0; d < 3; ++d) {
      const CellField& of = flow.stress(d);
      const int last = g.cells()[at(d)] - 1;
      const int s[3] = {d == 0, d == 1, d == 2};
      for_rows(flow, team, [&](int j, int k) {
        const OpenEnds open(flow.inner_faces(d), s, j, k);
        for (int i = 0; i < g.nx(); ++i) {
          const int place = d == 0 ? i : d == 1 ? j : k;
          const bool low = (place > 0 || g.periodic(d)) && open.low(i),
                     high = (place < last || g.periodic(d)) && open.high(i);
          int up[3] = {i, j, k};
          up[d] = place == last ? 0 : place + 1;  // wraps if periodic
          const double sum = (low ? of(i, j, k) : 0) + (high ? of(up[0], up[1], up[2]) : 0);
          stress[at(d)](i, j, k) = sum / std::max(1, low + high);
        }
      });
    }
  }

  /// The exchanged force on the particles as it acted on the fluid [N]; `borne` null: 0.
  template <FlowOnGrid Flow>
  Vec3d exchanged(Flow& flow, const CellField* borne) const {
    Vec3d sum{0, 0, 0};
    const Grid& g = flow.grid();
    for (int k = 0; k < g.nz(); ++k)
      for (int j = 0; j < g.ny(); ++j) {
        const double* const open = flow.open_row(j, k);
        for (int i = 0; i < g.nx(); ++i) {
          const double K = flow.drag()(i, j, k);
          const auto of = [&](int d) {
            const double push = K * velocity[at(d)](i, j, k) - flow.drag_velocity(d)(i, j, k);
            return borne == nullptr ? push
                                    : push + (*borne)(i, j, k) *
                                                 (slope[at(d)](i, j, k) - stress[at(d)](i, j, k));
          };
          sum += (open != nullptr ? open[i] : 1) * Vec3d{of(0), of(1), of(2)};
        }
      }
    return g.cell_volume() * sum;
  }

  template <FlowOnGrid Flow>
  void find_curl(const Flow& flow, const Team& team) {
    const Grid& g = flow.grid();
    make(curl, g);
    for_rows(flow, team, [&](int j, int k) {
      for (int i = 0; i < g.nx(); ++i)
        for (int c = 0; c < 3; ++c) {
          const int a = (c + 1) % 3, b = (c + 2) % 3;
          curl[at(c)](i, j, k) = difference(g, velocity[at(b)], a, i, j, k) -
                                 difference(g, velocity[at(a)], b, i, j, k);
        }
    });
  }

  /// Rates of strain [1/s]: xx, yy, zz, yz, zx, xy.
  template <FlowOnGrid Flow>
  void find_strain(const Flow& flow, const Team& team) {
    const Grid& g = flow.grid();
    make(stretch, g), make(strain, g);
    for_rows(flow, team, [&](int j, int k) {
      for (int i = 0; i < g.nx(); ++i)
        for (int c = 0; c < 3; ++c) {
          const int a = (c + 1) % 3, b = (c + 2) % 3;
          stretch[at(c)](i, j, k) = difference(g, velocity[at(c)], c, i, j, k);
          strain[at(c)](i, j, k) = 0.5 * (difference(g, velocity[at(b)], a, i, j, k) +
                                          difference(g, velocity[at(a)], b, i, j, k));
        }
    });
  }

  template <FlowOnGrid Flow>
  void find_convection(const Flow& flow, const Team& team) {
    const Grid& g = flow.grid();
    make(convection, g);
    for_rows(flow, team, [&](int j, int k) {
      for (int i = 0; i < g.nx(); ++i)
        for (int c = 0; c < 3; ++c) {
          const CellField& u = velocity[at(c)];
          double sum = 0;
          for (int d = 0; d < 3; ++d)
            sum += velocity[at(d)](i, j, k) * difference(g, u, d, i, j, k);
          convection[at(c)](i, j, k) = sum;
        }
    });
  }

  template <FlowOnGrid Flow, class Visit>
  static void for_rows(const Flow& flow, const Team& team, const Visit& visit) {
    team.for_parts(static_cast<std::size_t>(flow.grid().nz()), [&](std::size_t k) {
      for (int j = 0; j < flow.grid().ny(); ++j) visit(j, static_cast<int>(k));
    });
  }

 private:
  /// Open faces of the cells of a row, of two in one direction; `faces` null: all open.
  struct OpenEnds {
    OpenEnds(const CellField* faces, const int (&s)[3], int j, int k)
        : at_low(faces ? faces->row(j, k) : nullptr),
          at_high(faces ? faces->row(j + s[1], k + s[2]) + s[0] : nullptr) {}
    bool low(int i) const { return at_low == nullptr || at_low[i] > 0; }
    bool high(int i) const { return at_high == nullptr || at_high[i] > 0; }
    const double *at_low, *at_high;
  };

  static std::size_t at(int d) { return static_cast<std::size_t>(d); }
  static double width(const Grid& g, int d) {
    return d == 0 ? g.h().x : d == 1 ? g.h().y : g.h().z;
  }
  static void make(Three& field, const Grid& g) {
    if (field.empty()) field.assign(3, CellField(g));
  }
  /// The next cell in a direction; whether there is one.
  static bool neighbour(const Grid& g, int d, int way, int i, int j, int k, int (&n)[3]) {
    n[0] = i, n[1] = j, n[2] = k;
    const int count = g.cells()[at(d)];
    n[d] += way;
    if (n[d] >= 0 && n[d] < count) return true;
    if (!g.periodic(d)) return false;
    n[d] = (n[d] + count) % count;
    return true;
  }
  /// Central; next to a side towards the inner cell.
  static double difference(const Grid& g, const CellField& u, int d, int i, int j, int k) {
    double value[2] = {u(i, j, k), u(i, j, k)};
    int steps = 0;
    for (const int side : {0, 1}) {
      int n[3];
      if (neighbour(g, d, 2 * side - 1, i, j, k, n)) value[side] = u(n[0], n[1], n[2]), ++steps;
    }
    return (value[1] - value[0]) / (std::max(1, steps) * width(g, d));
  }
};

}  // namespace silt::detail
