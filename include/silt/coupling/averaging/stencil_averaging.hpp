// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <silt/core/dyn_array.hpp>
#include <silt/coupling/averaging/balance.hpp>

namespace silt::inline SILT_TARGET {

namespace detail {

/// Sets open cells to new_value(openness, value), and blocked ones to 0 whatever they contain.
template <class NewValue>
void change_open(const CellField& openness, CellFields fields, const Team& team,
                 const NewValue& new_value) {
  const Grid& g = openness.grid();
  team.for_parts(static_cast<std::size_t>(g.nz()), [&](std::size_t plane) {
    const int k = static_cast<int>(plane);
    for (CellField* field : fields)
      for (int j = 0; j < g.ny(); ++j) {
        double* to = field->row(j, k);
        const double* o = openness.row(j, k);
        for (int i = 0; i < g.nx(); ++i) to[i] = o[i] > 0 ? new_value(o[i], to[i]) : 0.0;
      }
  });
}

}  // namespace detail

/// Multiplies fields by the open share of each cell; 0 where it is blocked.
inline void multiply_openness(const CellField& openness, CellFields fields, const Team& team) {
  detail::change_open(openness, fields, team, [](double o, double v) { return o * v; });
}
/// Sets fields to 0 in blocked cells.
inline void clear_blocked(const CellField& openness, CellFields fields, const Team& team) {
  detail::change_open(openness, fields, team, [](double, double v) { return v; });
}

/// Copies of fields, times openness if given, kept from call to call.
class FieldCopies {
 public:
  ConstCellFields of(ConstCellFields fields, const CellField* openness, const Team& team) {
    room_for(fields.size(), fields.empty() ? nullptr : &fields[0]->grid());
    if (fields.empty()) return {};
    const Grid& g = fields[0]->grid();
    team.for_parts(static_cast<std::size_t>(g.nz()), [&](std::size_t plane) {
      const int k = static_cast<int>(plane);
      for (std::size_t q = 0; q < fields.size(); ++q)
        for (int j = 0; j < g.ny(); ++j) {
          const double* from = fields[q]->row(j, k);
          double* to = copies_[q].row(j, k);
          if (!openness) {
            std::copy(from, from + g.nx(), to);
            continue;
          }
          const double* o = openness->row(j, k);
          for (int i = 0; i < g.nx(); ++i) to[i] = o[i] > 0 ? o[i] * from[i] : 0.0;
        }
    });
    return {constant_.data(), fields.size()};
  }
  /// `n` scratch fields of a grid with undefined values; the memory is shared by all functions.
  CellFields room_for(std::size_t n, const Grid* grid) {
    if (grid && !copies_.empty() && !(copies_[0].grid() == *grid)) copies_.clear();
    if (grid && copies_.size() < n) {
      copies_.resize(n, CellField(*grid));
      constant_.clear(), all_.clear();
      for (CellField& f : copies_) constant_.push_back(&f), all_.push_back(&f);
    }
    return {all_.data(), n};
  }

 private:
  DynArray<CellField> copies_;
  DynArray<const CellField*> constant_;
  DynArray<CellField*> all_;
};

/// Operator of modes whose weights are stencils on the grid itself. Mode::Source(mode, grid,
/// diameter, particles) is the argument of Stencils::place.
template <class Mode>
class StencilAveraging {
 public:
  StencilAveraging(const Mode& mode, const Grid& grid, double diameter)
      : mode_(mode), diameter_(diameter), stencils_(grid) {
    mode.check();
    detail::check_diameter(diameter);
  }
  const Grid& grid() const { return stencils_.grid(); }
  const Stencils& stencils() const { return stencils_; }
  const AveragingReport& report() const { return stencils_.report(); }

  void open(const CellField& cells, const Team& team = {}) {
    const auto source_of = [&](const AveragedParticles& of) {
      return typename Mode::Source(mode_, grid(), diameter_, of);
    };
    detail::Balance::open(stencils_, cells, cells, diameter_, source_of, team);
  }
  void place(const AveragedParticles& particles, const Team& team = {}) {
    detail::check_particles(particles, grid());
    const typename Mode::Source source(mode_, stencils_.grid(), diameter_, particles);
    stencils_.place(particles.position.size(), source, team);
  }
  void spread(Quantities q, CellFields f, const Team& team = {}) {
    stencils_.spread(q, f, team);
    if (stencils_.openness()) multiply_openness(*stencils_.openness(), f, team);
  }
  void gather(ConstCellFields f, GatheredValues g, const Team& team = {}) {
    detail::check_columns("gather", g, f, grid(), report().particles);
    if (stencils_.openness())
      stencils_.gather(copies_.of(f, stencils_.openness(), team), g, team);
    else
      stencils_.gather(f, g, team);
  }

 private:
  Mode mode_;
  double diameter_;
  Stencils stencils_;
  FieldCopies copies_;
};

namespace detail {

/// Common part of all sources: positions in units of cells, and ranges around them.
class CellFrame {
 public:
  explicit CellFrame(const Grid& grid)
      : min_(grid.box().min),
        inverse_{1 / grid.h().x, 1 / grid.h().y, 1 / grid.h().z},
        h_{grid.h().x, grid.h().y, grid.h().z},
        cells_(grid.cells()) {
    for (std::size_t d = 0; d < 3; ++d) periodic_[d] = grid.periodic(static_cast<int>(d));
  }
  /// Position in cells from the lower corner [-].
  std::array<double, 3> at(const Vec3d& x) const {
    return {(x.x - min_.x) * inverse_[0], (x.y - min_.y) * inverse_[1],
            (x.z - min_.z) * inverse_[2]};
  }
  double inverse(std::size_t d) const { return inverse_[d]; }
  double h(std::size_t d) const { return h_[d]; }
  bool inside(const std::array<double, 3>& s) const {
    for (std::size_t d = 0; d < 3; ++d) {
      if (periodic_[d] ? !(std::abs(s[d]) < 4e8) : !(s[d] >= 0 && s[d] <= cells_[d])) return false;
    }
    return true;
  }
  /// Cells touched by low ... high [cells]; for a particle on the upper end the last cell.
  AxisRange range(std::size_t d, double low, double high) const {
    return {whole(low), whole(high), cells_[d], periodic_[d]};
  }
  AxisRange cell(std::size_t d, double s) const {
    int c = whole(s);
    if (!periodic_[d]) c = std::min(c, cells_[d] - 1);
    return {c, c, cells_[d], periodic_[d]};
  }
  /// The two cells whose centres are on either side.
  AxisRange hat(std::size_t d, double s) const {
    const int c = whole(s - 0.5);
    return {c, c + 1, cells_[d], periodic_[d]};
  }

 private:
  static int whole(double s) { return static_cast<int>(std::clamp(std::floor(s), -5e8, 5e8)); }
  Vec3d min_;
  std::array<double, 3> inverse_, h_;
  std::array<int, 3> cells_;
  std::array<bool, 3> periodic_{};
};

}  // namespace detail

}  // namespace silt
