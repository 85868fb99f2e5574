// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cmath>
#include <concepts>
#include <span>

#include <silt/core/threads.hpp>
#include <silt/coupling/averaging/averaged_form.hpp>
#include <silt/coupling/averaging/averaged_particles.hpp>
#include <silt/fluid/grid.hpp>

/// Averaging between particles and the cells of a Grid, the basis of every coupling mode.
///
/// A mode (Unresolved, TwoGrid, Kernel, Diffusion) defines weights w_pc >= 0 of particle p on cell
/// c with sum_c w_pc = 1, and with them
///
///   spread:  f_c = sum_p w_pc q_p      volume V_p -> solids volume of the cell, K_p, K_p v_p, F
///   gather:  g_p = sum_c w_pc f_c      fluid velocity, grad p, void fraction at the particle
///
/// The two are adjoint, <spread q, f> = <q, gather f>: the exchange is conservative to rounding.
/// Periodic directions wrap. Blocked cells get nothing: a particle's weights are normalised over
/// its open cells.
namespace silt::inline SILT_TARGET {

/// For each quantity: one number per particle; one CellField.
using Quantities = std::span<const std::span<const double>>;
/// Output of gather(): for each quantity one number per particle.
using GatheredValues = std::span<const std::span<double>>;
/// Output of spread().
using CellFields = std::span<CellField* const>;
/// Input of gather().
using ConstCellFields = std::span<const CellField* const>;

/// Averaging mode: the user's settings, with
///   void check() const                  throws InputError, one sentence
///   using Averaging = ...               operator, made from (mode, grid, diameter [m]): that of
///                                       the largest particles, the unit of widths
/// The operator has
///   void open(const CellField& cells, const Team&)      open share of each cell, from 0 to 1;
///                                                       before place()
///   void place(const AveragedParticles&, const Team&)
///   void spread(Quantities, CellFields, const Team&)        sets cells, not ghosts
///   void gather(ConstCellFields, GatheredValues, const Team&)        reads no ghosts
///   const AveragingReport& report() const
/// Results are equal, bit for bit, for every number of threads.
template <class M>
concept AveragingMode =
    std::constructible_from<typename M::Averaging, const M&, const Grid&, double> &&
    requires(const M& mode, typename M::Averaging& averaging, const CellField& cells,
             const AveragedParticles& particles, Quantities q, CellFields f, ConstCellFields g,
             GatheredValues v, const Team& team) {
  mode.check();
  averaging.open(cells, team);
  averaging.place(particles, team);
  averaging.spread(q, f, team);
  averaging.gather(g, v, team);
  { averaging.report() } -> std::convertible_to<const AveragingReport&>;
};

/// Sum of a field over the grid's cells.
inline double total(const CellField& field) {
  const Grid& g = field.grid();
  double sum = 0;
  for (int k = 0; k < g.nz(); ++k)
    for (int j = 0; j < g.ny(); ++j) {
      const double* row = field.row(j, k);
      double of_row = 0;
      for (int i = 0; i < g.nx(); ++i) of_row += row[i];
      sum += of_row;
    }
  return sum;
}

/// Solids volume [m3] in excess of the minimum void fraction, which is clipped by eps = max(1 -
/// solids/V_cell, least).
inline double clipped_solids(const CellField& solids, double least_void_fraction) {
  const Grid& g = solids.grid();
  const double most = (1 - least_void_fraction) * g.cell_volume();
  double sum = 0;
  for (int k = 0; k < g.nz(); ++k)
    for (int j = 0; j < g.ny(); ++j)
      for (int i = 0; i < g.nx(); ++i) sum += std::max(0.0, solids(i, j, k) - most);
  return sum;
}

namespace detail {

/// Refuses particles that no operator can place.
inline void check_particles(const AveragedParticles& of, const Grid& grid) {
  const Vec3d extent = grid.box().extent();
  const double most = std::max({extent.x, extent.y, extent.z});
  const std::size_t n = of.position.size();
  require(of.radius.size() == n, "AveragedParticles: ", of.radius.size(), " radii for ", n,
          " positions; give one each");
  require(n < 0xffffffffu, "AveragedParticles: ", n, " particles are more than 2^32 - 2");
  for (std::size_t p = 0; p < n; ++p)
    require(of.radius[p] > 0 && of.radius[p] <= most, "AveragedParticles: radius of particle ", p,
            " = ", of.radius[p], " [m] must be in (0, ", most, "], the length of the grid's box");
  if (of.forms.empty()) {
    require(of.form.empty(), "AveragedParticles: forms are numbered but none is given; set forms");
    return;
  }
  require(of.orientation.size() == n, "AveragedParticles: ", of.orientation.size(),
          " orientations for ", n, " bodies; give one each");
  require(of.form.empty() || of.form.size() == n, "AveragedParticles: ", of.form.size(),
          " numbers of forms for ", n, " bodies; give one each, or none if all have the first");
  for (std::size_t p = 0; p < of.form.size(); ++p)
    require(of.form[p] < of.forms.size(), "AveragedParticles: form ", of.form[p], " of particle ",
            p, " must be less than the number of forms, ", of.forms.size());
}

/// Refuses fields and quantities that do not match.
template <class Columns, class Fields>
void check_columns(const char* what, const Columns& columns, const Fields& fields, const Grid& grid,
                   std::size_t particles) {
  require(columns.size() == fields.size(), what, ": ", columns.size(),
          " quantities of particles but ", fields.size(), " fields; give as many");
  for (std::size_t q = 0; q < columns.size(); ++q) {
    require(columns[q].size() == particles, what, ": quantity ", q, " has ", columns[q].size(),
            " values for ", particles, " particles; place() the present ones first");
    require(fields[q] != nullptr && fields[q]->grid() == grid, what, ": field ", q,
            " is not one of the operator's grid");
  }
}

inline void check_diameter(double diameter) {
  require_positive("averaging: the diameter of the particles", diameter, "m");
}

}  // namespace detail
}  // namespace silt
