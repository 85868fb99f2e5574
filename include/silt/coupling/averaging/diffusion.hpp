// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <silt/core/dyn_array.hpp>
#include <silt/coupling/averaging/line_diffusion.hpp>
#include <silt/coupling/averaging/two_grid.hpp>

namespace silt::inline SILT_TARGET {

/// Diffusion averaging: particles distribute to the adjacent cells, and the result is smoothed by
/// diffusion. The width depends neither on cells nor on particle sizes; the cost is proportional to
/// the number of cells.
///
///   d f / d tau = lap f  from 0 to tau = b^2/4, b = width d, in `steps` implicit steps (1)
///
/// A point becomes a Gaussian exp(-x^2/b^2) with the standard deviation b/sqrt(2), more accurately
/// with more steps. No flux through walls and blocked cells; sums are conserved. gather uses the
/// adjoint of the same steps (line_diffusion.hpp).
///
///   Share     Hat - linear between the eight centres around a particle, also for bodies; Exact -
///             the common volumes, for spheres. Both are continuous in time, unlike the cell of the
///             centre.
/// Source: R. Sun, H. Xiao, Int. J. Multiphase Flow 77 (2015) 142 (b about 6 d).
/// Errors: check(): InputError for a width outside (0, 1000] or steps outside [1, 1000]; place():
///         for bodies with Share::Exact.
/// Tests:  tests/coupling/averaging.cpp, averaging_diffusion.cpp.
/// Valid:  cells of any size; bodies with Share::Hat.
/// Units:  lengths in diameters of the largest particles.
struct Diffusion {
  enum class Share { Hat, Exact };
  double width = 6;  // [diameters] b
  int steps = 3;     // [-]
  Share share = Share::Hat;

  void check() const {
    require(width > 0 && width <= 1000, "Diffusion.width = ", width,
            " [diameters] must be in (0, 1000]");
    require(steps >= 1 && steps <= 1000, "Diffusion.steps = ", steps, " [-] must be in [1, 1000]");
  }

  class Averaging;
};

class Diffusion::Averaging {
 public:
  Averaging(const Diffusion& mode, const Grid& grid, double diameter)
      : mode_((mode.check(), detail::check_diameter(diameter), mode)),
        diameter_(diameter),
        stencils_(grid),
        diffusion_(grid, 0.25 * mode.width * diameter * mode.width * diameter / mode.steps) {}

  const Grid& grid() const { return stencils_.grid(); }
  const AveragingReport& report() const { return stencils_.report(); }

  void open(const CellField& cells, const Team& team = {}) {
    const auto balance = [&](const auto& source_of) {
      balance_.assign(1,
                      detail::Balance::open(stencils_, cells, cells, diameter_, source_of, team));
    };
    mode_.share == Share::Hat ? balance(detail::hat_shares(grid()))
                              : balance(detail::exact_shares(grid()));
    open_.assign(1, cells);
    diffusion_.open(cells);
  }
  void place(const AveragedParticles& particles, const Team& team = {}) {
    detail::check_particles(particles, grid());
    const std::size_t n = particles.position.size();
    if (mode_.share == Share::Hat)
      return stencils_.place(n, detail::hat_shares(grid())(particles), team);
    require(particles.forms.empty(), "Diffusion: Share::Exact is for spheres only; use Share::Hat");
    stencils_.place(n, detail::exact_shares(grid())(particles), team);
  }
  void spread(Quantities q, CellFields f, const Team& team = {}) {
    stencils_.spread(q, f, team);
    if (!open_.empty()) multiply_openness(balance_[0], f, team);
    for (int s = 0; s < mode_.steps; ++s) diffusion_.step(f, team);
    if (!open_.empty()) multiply_openness(open_[0], f, team);
  }
  void gather(ConstCellFields f, GatheredValues g, const Team& team = {}) {
    detail::check_columns("gather", g, f, grid(), report().particles);
    const ConstCellFields smooth = copies_.of(f, nullptr, team);
    const CellFields own = copies_.room_for(f.size(), &grid());
    if (!open_.empty()) clear_blocked(open_[0], own, team);
    for (int s = 0; s < mode_.steps; ++s) diffusion_.adjoint_step(own, team);
    if (!open_.empty()) multiply_openness(*stencils_.openness(), own, team);
    stencils_.gather(smooth, g, team);
  }

 private:
  Diffusion mode_;
  double diameter_;
  Stencils stencils_;
  LineDiffusion diffusion_;
  FieldCopies copies_;
  DynArray<CellField> open_, balance_;  // none: all cells are open
};

static_assert(AveragingMode<Diffusion>);

}  // namespace silt
