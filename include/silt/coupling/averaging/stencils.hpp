// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cstdint>

#include <silt/core/dyn_array.hpp>
#include <silt/coupling/averaging/axis_range.hpp>
#include <silt/coupling/averaging/concept.hpp>
#include <silt/coupling/averaging/slab_lists.hpp>
#include <silt/coupling/averaging/stencil_rows.hpp>

namespace silt::inline SILT_TARGET {

/// Storage of a particle's weights.
enum class StencilKind : std::uint8_t {
  None,     // outside the grid
  Product,  // w_ijk = wx_i wy_j wz_k: only the factors are stored
  Dense     // one number per cell of a box of cells
};

/// Weights of all particles on the cells of a grid, and the loops over them.
///
/// A source of weights gives, for particle p,
///   StencilKind ranges(p, std::array<AxisRange, 3>&) const     cells in its range
///   void factor(p, direction, const AxisRange&, double* raw) const      raw() values (Product),
///                                                 with space for 8 more
///   void dense(p, ranges, double* raw) const     raw() values, x fastest (Dense), initially 0
/// They are not normalised, and refer to the unbounded grid. This class normalises, folds and wraps
/// them. The planes of the grid are processed in slabs; each slab adds its particles in their
/// order, which makes the sum of every cell independent of the threads.
/// Tests: tests/coupling/averaging.cpp.
class Stencils {
 public:
  explicit Stencils(const Grid& grid) : grid_(grid) {
    for (const int n : grid.cells())
      require(n < 65536, "averaging: the grid has ", n, " cells in a direction; at most 65535");
  }

  const Grid& grid() const { return grid_; }
  const AveragingReport& report() const { return report_; }

  /// Sets the open share of each cell, from 0 to 1: weights are divided by the openness in the
  /// particle's range, sum_c w_pc openness_c. Distributed values must then be multiplied by the
  /// openness, and gathered fields before.
  void open(const CellField& openness) {
    require(openness.grid() == grid_, "averaging: the field of open cells is not of its grid");
    bool any = false;
    for (int k = 0; k < grid_.nz(); ++k)
      for (int j = 0; j < grid_.ny(); ++j)
        for (int i = 0; i < grid_.nx(); ++i) {
          const double o = openness(i, j, k);
          require(o >= 0 && o <= 1 + 1e-9, "averaging: openness of cell (", i, ", ", j, ", ", k,
                  ") = ", o, " [-] must be in [0, 1]");
          any |= o > least_open;
        }
    require(any, "averaging: no cell of the grid is open");
    weigh(openness);
  }
  /// The same with any weights of cells instead.
  void weigh(const CellField& openness) { openness_.assign(1, openness); }
  /// Null: all cells are open.
  const CellField* openness() const { return openness_.empty() ? nullptr : openness_.data(); }

  template <class Source>
  void place(std::size_t n, const Source& source, const Team& team) {
    stencils_.resize(n);
    team.for_ranges(n, [&](std::size_t, std::size_t from, std::size_t to) {
      std::array<AxisRange, 3> r;
      for (std::size_t p = from; p < to; ++p) {
        const StencilKind kind = source.ranges(p, r);
        stencils_[p] = kind == StencilKind::None ? Stencil{} : header(kind, r);
      }
    });
    report_ = {.particles = n};
    std::uint64_t size = 0;
    for (auto& s : stencils_) {
      s.offset = size;
      size += room(s);
      if (s.nx == 0) ++report_.outside;
    }
    detail::make_room(weights_, static_cast<std::size_t>(size));
    report_.bytes = weights_.size() * sizeof(double) + n * sizeof(Stencil);
    closed_.assign(Team::most_ranges, 0);
    team.for_ranges(n, [&](std::size_t range, std::size_t from, std::size_t to) {
      DynArray<double> raw;
      std::array<AxisRange, 3> r;
      for (std::size_t p = from; p < to; ++p) {
        if (stencils_[p].nx == 0) continue;
        source.ranges(p, r);
        fill(stencils_[p], p, r, source, raw);
        if (openness()) closed_[range] += normalise_open(stencils_[p], r);
      }
    });
    for (const auto c : closed_) report_.without_open += c;
    slabs_.make(
        grid_, n,
        [&](std::size_t p) {
          return detail::Planes{stencils_[p].k, stencils_[p].nx > 0 ? stencils_[p].nz : 0};
        },
        team);
    report_.bytes += slabs_.bytes();
  }

  /// f_c = sum_p w_pc q_p, in the cells.
  void spread(Quantities q, CellFields f, const Team& team) const {
    detail::check_columns("spread", q, f, grid_, stencils_.size());
    if (stencils_.empty()) {
      for (CellField* field : f) field->fill(0);
      return;
    }
    Targets targets;
    for (std::size_t n = 0; n < q.size(); ++n) {
      targets.columns.push_back(q[n].data());
      targets.fields.push_back(f[n]->row(0, 0) - grid_.index(0, 0, 0));
    }
    team.for_parts(slabs_.size(), [&](std::size_t slab) {
      const int lower = slabs_.lower(slab), upper = slabs_.lower(slab + 1);
      for (CellField* field : f)
        for (int k = lower; k < upper; ++k)
          for (int j = 0; j < grid_.ny(); ++j) std::fill_n(field->row(j, k), grid_.nx(), 0.0);
      for (const std::uint32_t p : slabs_.members(slab)) {
        const Stencil& s = stencils_[p];
        detail::for_runs(s.k, s.nz, grid_.nz(), [&](int first, int done, int count) {
          const int low = std::max(first, lower), high = std::min(first + count, upper);
          if (low < high) add(s, p, targets, low, done + low - first, high - low);
        });
      }
    });
  }

  /// g_p = sum_c w_pc f_c.
  void gather(ConstCellFields f, GatheredValues g, const Team& team) const {
    detail::check_columns("gather", g, f, grid_, stencils_.size());
    constexpr std::size_t block = 4;
    team.for_ranges(stencils_.size(), [&](std::size_t, std::size_t from, std::size_t to) {
      const double* base[block];
      for (std::size_t q = 0; q < f.size(); q += block) {
        const std::size_t count = std::min(block, f.size() - q);
        for (std::size_t b = 0; b < count; ++b) base[b] = origin(*f[q + b]);
        for (std::size_t p = from; p < to; ++p) {
          double sum[block] = {};
          if (count == 4)
            collect<4>(stencils_[p], base, sum);
          else if (count == 3)
            collect<3>(stencils_[p], base, sum);
          else
            for (std::size_t b = 0; b < count; ++b) collect<1>(stencils_[p], base + b, sum + b);
          for (std::size_t b = 0; b < count; ++b) g[q + b][p] = sum[b];
        }
      }
    });
  }

  /// Calls use(i, j, k, w) for the weights of a particle. For tests and pictures: slow.
  template <class Use>
  void for_weights(std::size_t p, const Use& use) const {
    const Stencil& s = stencils_[p];
    for (int c = 0; c < s.nz; ++c)
      for (int b = 0; b < s.ny; ++b)
        for (int a = 0; a < s.nx + s.nx_wrapped; ++a) {
          const int i = a < s.nx ? s.i + a : a - s.nx;
          use(i, (s.j + b) % grid_.ny(), (s.k + c) % grid_.nz(), weight(s, a, b, c));
        }
  }

 private:
  static constexpr double least_open = 1e-12;

  struct Stencil {
    std::int32_t i = 0, j = 0, k = 0;                      // first cell
    std::uint16_t nx = 0, nx_wrapped = 0, ny = 0, nz = 0;  // cells; those of x from 0 on again
    std::uint16_t product = 0;
    std::uint64_t offset = 0;  // of its weights
    int row() const { return nx + nx_wrapped; }
  };

  /// Output of spread(): origins of fields, and columns of particles.
  struct Targets {
    DynArray<const double*> columns;
    DynArray<double*> fields;
  };

  static std::uint64_t room(const Stencil& s) {
    if (s.nx == 0) return 0;
    if (!s.product) return std::uint64_t(s.row()) * s.ny * s.nz;
    return static_cast<std::uint64_t>(
        detail::padded(detail::padded(s.nx) + detail::padded(s.nx_wrapped) + s.ny + s.nz));
  }
  Stencil header(StencilKind kind, const std::array<AxisRange, 3>& r) const {
    Stencil s;
    const auto small = [](int n) { return static_cast<std::uint16_t>(n); };
    s.i = r[0].start, s.j = r[1].start, s.k = r[2].start;
    const int before = std::min(r[0].count, grid_.nx() - r[0].start);
    s.nx = small(before), s.nx_wrapped = small(r[0].count - before);
    s.ny = small(r[1].count), s.nz = small(r[2].count);
    s.product = kind == StencilKind::Product;
    return s;
  }

  /// @name Factors of a product: x, x wrapped, y, z.
  /// @{
  const double* x(const Stencil& s) const { return &weights_[s.offset]; }
  const double* x_wrapped(const Stencil& s) const { return x(s) + detail::padded(s.nx); }
  const double* y(const Stencil& s) const { return x_wrapped(s) + detail::padded(s.nx_wrapped); }
  const double* z(const Stencil& s) const { return y(s) + s.ny; }
  /// @}
  double weight(const Stencil& s, int a, int b, int c) const {
    if (!s.product)
      return weights_[s.offset + static_cast<std::size_t>((c * s.ny + b) * s.row() + a)];
    return (a < s.nx ? x(s)[a] : x_wrapped(s)[a - s.nx]) * y(s)[b] * z(s)[c];
  }

  static double normalise(double* raw, std::size_t n) {
    double sum = 0;
    for (std::size_t m = 0; m < n; ++m) sum += raw[m];
    const double scale = 1 / sum;
    for (std::size_t m = 0; m < n; ++m) raw[m] *= scale;
    return sum;
  }

  template <class Source>
  void fill(Stencil& s, std::size_t p, const std::array<AxisRange, 3>& r, const Source& source,
            DynArray<double>& raw) {
    double* w = &weights_[s.offset];
    const auto length = [](int n) { return static_cast<std::size_t>(n); };
    if (s.product) {
      std::fill_n(w, room(s), 0.0);
      double* to[3] = {w, const_cast<double*>(y(s)), const_cast<double*>(z(s))};
      for (int d = 0; d < 3; ++d) {
        const AxisRange& axis = r[static_cast<std::size_t>(d)];
        raw.resize(std::max(raw.size(), length(axis.raw() + detail::stencil_pad)));
        source.factor(p, d, axis, raw.data());
        normalise(raw.data(), length(axis.raw()));
        // If x wraps, its second run has a separate place.
        const int gap = d == 0 ? detail::padded(s.nx) - s.nx : 0, run = d == 0 ? s.nx : 65536;
        for (int m = 0; m < axis.raw(); ++m) {
          const int place = axis.place(axis.low + m);
          to[d][place + (place < run ? 0 : gap)] += raw[length(m)];
        }
      }
      return;
    }
    const std::size_t all = length(r[0].raw()) * length(r[1].raw()) * length(r[2].raw());
    const bool bends = r[0].bends || r[1].bends || r[2].bends;
    if (bends) raw.resize(std::max(raw.size(), all));
    double* values = bends ? raw.data() : w;
    std::fill_n(values, all, 0.0);
    source.dense(p, r, values);
    normalise(values, all);
    if (!bends) return;
    std::fill_n(w, room(s), 0.0);
    for (int c = 0; c < r[2].raw(); ++c)
      for (int b = 0; b < r[1].raw(); ++b) {
        double* row = w + (r[2].place(r[2].low + c) * s.ny + r[1].place(r[1].low + b)) * s.row();
        for (int a = 0; a < r[0].raw(); ++a) row[r[0].place(r[0].low + a)] += *values++;
      }
  }

  /// Divides by the openness in range; if it is 0, puts all weight on the nearest open cell and
  /// returns 1.
  std::size_t normalise_open(Stencil& s, const std::array<AxisRange, 3>& r) {
    const double* base = origin(*openness());
    double seen = 0;
    collect<1>(s, &base, &seen);
    double* w = &weights_[s.offset];
    if (seen > least_open) {
      const double scale = 1 / seen;
      double* from = s.product ? const_cast<double*>(z(s)) : w;
      const std::uint64_t n = s.product ? s.nz : room(s);
      for (std::uint64_t m = 0; m < n; ++m) from[m] *= scale;
      return 0;
    }
    const auto middle = [](const AxisRange& a) {
      return a.start + a.place(std::clamp((a.low + a.high) / 2, a.low, a.high));
    };
    const auto cell = nearest_open(
        {middle(r[0]) % grid_.nx(), middle(r[1]) % grid_.ny(), middle(r[2]) % grid_.nz()});
    s.i = cell[0], s.j = cell[1], s.k = cell[2];
    s.nx = s.ny = s.nz = 1, s.nx_wrapped = 0, s.product = 0;
    w[0] = 1 / (*openness())(s.i, s.j, s.k);
    return 1;
  }

  /// The open cell nearest to `from` by centres; searches shells of cells until none can be nearer.
  std::array<int, 3> nearest_open(const std::array<int, 3>& from) const {
    const Vec3d& h = grid_.h();
    const double least = std::min({h.x, h.y, h.z});
    double best = std::numeric_limits<double>::infinity();
    std::array<int, 3> found = from;
    const auto on_grid = [&](int a, std::size_t d) {
      const int n = grid_.cells()[d];
      return grid_.periodic(static_cast<int>(d)) ? (a % n + n) % n : a >= 0 && a < n ? a : -1;
    };
    for (int shell = 0; shell * least * shell * least <= best; ++shell)
      for (int c = -shell; c <= shell; ++c)
        for (int b = -shell; b <= shell; ++b) {
          const bool side = std::abs(c) == shell || std::abs(b) == shell;
          for (int a = -shell; a <= shell; a += side || shell == 0 ? 1 : 2 * shell) {
            const double distance = a * h.x * a * h.x + b * h.y * b * h.y + c * h.z * c * h.z;
            if (distance >= best) continue;
            const int i = on_grid(from[0] + a, 0), j = on_grid(from[1] + b, 1),
                      k = on_grid(from[2] + c, 2);
            if (i < 0 || j < 0 || k < 0 || (*openness())(i, j, k) <= least_open) continue;
            best = distance, found = {i, j, k};
          }
        }
    return found;
  }

  static const double* origin(const CellField& f) { return f.row(0, 0) - f.grid().index(0, 0, 0); }

  /// Adds planes c ... of a stencil to those from k on.
  void add(const Stencil& s, std::size_t p, const Targets& to, int k, int c, int planes) const {
    const std::size_t row = grid_.row_stride(), plane = grid_.plane_stride();
    detail::for_runs(s.j, s.ny, grid_.ny(), [&](int first, int done, int rows) {
      const std::size_t at = grid_.index(0, first, k), i = static_cast<std::size_t>(s.i);
      if (s.product) {
        const std::size_t count = to.fields.size();
        detail::ProductBlock block{
            to.fields.data(), to.columns.data(), count, p,     at + i, row, plane, x(s),
            y(s) + done,      z(s) + c,          rows,  planes};
        detail::add_product(block, s.nx);
        if (s.nx_wrapped == 0) return;
        block.at = at, block.wx = x_wrapped(s);
        detail::add_product(block, s.nx_wrapped);
        return;
      }
      for (std::size_t n = 0; n < to.fields.size(); ++n) {
        const double q = to.columns[n][p];
        for (int m = 0; m < planes; ++m) {
          const double* w = x(s) + ((c + m) * s.ny + done) * s.row();
          double* target = to.fields[n] + at + static_cast<std::size_t>(m) * plane;
          for (int j = 0; j < rows; ++j, target += row, w += s.row()) {
            detail::add_dense(target + i, q, w, s.nx);
            if (s.nx_wrapped > 0) detail::add_dense(target, q, w + s.nx, s.nx_wrapped);
          }
        }
      }
    });
  }

  template <int Fields, int Packs>
  void collect_packs(const Stencil& s, const double* const* base, int i, const double* wx,
                     double* sum) const {
    detail::RowSums<Fields, Packs> sums;
    detail::for_runs(s.k, s.nz, grid_.nz(), [&](int k, int c, int planes) {
      for (int plane = 0; plane < planes; ++plane)
        detail::for_runs(s.j, s.ny, grid_.ny(), [&](int j, int b, int rows) {
          sums.add(base, grid_.index(i, j, k + plane), grid_.row_stride(), z(s)[c + plane],
                   y(s) + b, rows);
        });
    });
    sums.close(wx, sum);
  }
  template <int Fields>
  void collect_run(const Stencil& s, const double* const* base, int i, int n, const double* wx,
                   double* sum) const {
    constexpr int step = detail::stencil_lanes;
    for (; n > step; n -= 2 * step, i += 2 * step, wx += 2 * step)
      collect_packs<Fields, 2>(s, base, i, wx, sum);
    if (n > 0) collect_packs<Fields, 1>(s, base, i, wx, sum);
  }
  template <int Fields>
  void collect(const Stencil& s, const double* const* base, double* sum) const {
    if (s.nx == 0) return;
    if (s.product) {
      collect_run<Fields>(s, base, s.i, s.nx, x(s), sum);
      if (s.nx_wrapped > 0) collect_run<Fields>(s, base, 0, s.nx_wrapped, x_wrapped(s), sum);
      return;
    }
    detail::for_runs(s.k, s.nz, grid_.nz(), [&](int k, int c, int planes) {
      for (int plane = 0; plane < planes; ++plane)
        detail::for_runs(s.j, s.ny, grid_.ny(), [&](int j, int b, int rows) {
          const double* w = x(s) + ((c + plane) * s.ny + b) * s.row();
          for (int row = 0; row < rows; ++row, w += s.row()) {
            const std::size_t at = grid_.index(0, j + row, k + plane);
            for (int f = 0; f < Fields; ++f) {
              sum[f] += detail::dot_dense(base[f] + at + s.i, w, s.nx);
              if (s.nx_wrapped > 0)
                sum[f] += detail::dot_dense(base[f] + at, w + s.nx, s.nx_wrapped);
            }
          }
        });
    });
  }

  Grid grid_;
  DynArray<CellField> openness_;  // none: all open
  AlignedVector<Stencil> stencils_;
  AlignedVector<double> weights_;
  DynArray<std::size_t> closed_;
  detail::SlabLists slabs_;
  AveragingReport report_;
};

}  // namespace silt
