// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <initializer_list>
#include <span>
#include <utility>
#include <vector>

#include <silt/coupling/averaging/concept.hpp>
#include <silt/coupling/drag/concept.hpp>
#include <silt/coupling/momentum_exchange.hpp>
#include <silt/fluid/flow_solver.hpp>

namespace silt::inline SILT_TARGET {

/// The particles of a coupling step, one value each; at its end, except for velocities, which are
/// those of its start.
struct CoupledParticles {
  AveragedParticles shape;                   // where they are, and how large
  std::span<const Vec3d> velocity;           // [m/s]
  std::span<const double> volume;            // [m3]
  std::span<const double> mass;              // [kg]
  std::span<const Vec3d> acceleration = {};  // [m/s2] by all but the fluid; left out: none
};

/// What a coupling step did.
struct CoupledStep {
  FlowStep flow;
  AveragingReport averaging;
  double clipped = 0;       // [m3] solids that the least voidage leaves no room for
  double volume_error = 0;  // [-] solids in cells over the particles' volume, less 1
  Vec3d momentum_error{};   // [N] drag on particles and on the fluid: their sum, 0 but for rounding
};

/// Particles and a flow, each of which feels the other: one fluid step of an unresolved, two-grid,
/// kernel or diffusion coupling.
///
///   weights of the particles' places -> eps = 1 - sum w V/V_cell                              (1)
///   u, eps at the particles -> K (drag law) -> b, c of MomentumExchange                       (2)
///   fluid: sum w b, sum w (b v + c), each over V_cell; FlowSolver::step                       (3)
///   particles: F = b (u' - v) - c - V grad p' (model A)                                       (4)
///
/// with the same weights in all of them. Hold the forces over the particles' own steps until the
/// next one. Gravity: p is without the fluid's weight, so a particle also bears -rho V g, which
/// advance() adds. Drag is of model A; of model B it is over eps.
///
/// Source: Z. Y. Zhou et al., J. Fluid Mech. 661 (2010) 482 (models); MomentumExchange.
/// Not included: the viscous stress' force on the particles (model A), virtual mass, lift.
/// Errors: those of FlowSolver and the averaging mode; InputError for spans that do not fit.
/// Tests:  tests/coupling/coupled_flow.cpp.
template <DragLaw Drag, AveragingMode Mode>
class CoupledFlow {
 public:
  /// `diameter` [m]: of the largest particles, in which the mode's widths are.
  CoupledFlow(const Grid& grid, const FluidProperties& fluid, const Drag& drag, const Mode& mode,
              double diameter, const FlowOptions& options = {})
      : flow_(grid, fluid, options), drag_(drag), averaging_(mode, grid, diameter), solids_(grid) {}

  FlowSolver& flow() { return flow_; }
  const FlowSolver& flow() const { return flow_; }
  double least_voidage = 0.3;  // [-] of a cell; what it leaves out is counted
  Vec3d gravity{0, 0, 0};      // [m/s2]

  /// Advances the flow by dt [s] and gives the force on each particle [N].
  CoupledStep advance(const CoupledParticles& particles, double dt, std::span<Vec3d> force,
                      const Team& team = {}) {
    const std::size_t n = particles.velocity.size();
    check(particles, force.size());
    CoupledStep done;
    averaging_.place(particles.shape, team);
    done.averaging = averaging_.report();
    spread_volume(particles, done, team);
    find_cell_velocities(team);
    gather({&cells_[0], &cells_[1], &cells_[2], &flow_.voidage()}, {0, 1, 2, 3}, n, team);
    find_exchange(particles, dt, team);
    spread_drag(particles, n, team);
    done.flow = flow_.step(dt, team);
    find_cell_velocities(team);
    find_pressure_gradients(team);
    gather({&cells_[0], &cells_[1], &cells_[2], &cells_[3], &cells_[4], &cells_[5]},
           {0, 1, 2, 4, 5, 6}, n, team);
    const bool in_pressure = flow_.options().model == MomentumModel::A;
    const Vec3d buoyancy = -flow_.fluid().density * gravity;
    Vec3d on_particles{0, 0, 0};
    for (std::size_t p = 0; p < n; ++p) {
      const Vec3d u{values_[0][p], values_[1][p], values_[2][p]};
      const Vec3d drag = exchange_[p].force(u, particles.velocity[p]);
      on_particles += drag;
      force[p] = drag + particles.volume[p] * buoyancy;
      if (in_pressure)
        force[p] -= particles.volume[p] * Vec3d{values_[4][p], values_[5][p], values_[6][p]};
    }
    done.momentum_error = on_particles - drag_of_fluid();
    return done;
  }

 private:
  static constexpr std::size_t quantities = 7;

  void check(const CoupledParticles& of, std::size_t forces) const {
    const std::size_t n = of.velocity.size();
    const auto same = [n](std::size_t count, const char* what) {
      require(count == n, "CoupledParticles: ", count, " ", what, " for ", n,
              " velocities; give one each");
    };
    same(of.shape.position.size(), "positions"), same(of.volume.size(), "volumes");
    same(of.mass.size(), "masses"), same(forces, "forces");
    if (!of.acceleration.empty()) same(of.acceleration.size(), "accelerations");
    require(least_voidage > 0 && least_voidage < 1, "CoupledFlow.least_voidage = ", least_voidage,
            " must be in (0, 1)");
  }

  void spread_volume(const CoupledParticles& of, CoupledStep& done, const Team& team) {
    Field* const to[] = {&solids_};
    const std::span<const double> volume[] = {of.volume};
    averaging_.spread(volume, to, team);
    const Grid& g = flow_.grid();
    double particles = 0;
    for (const double v : of.volume) particles += v;
    if (particles > 0 && done.averaging.outside == 0)
      done.volume_error = total(solids_) / particles - 1;
    done.clipped = clipped_solids(solids_, least_voidage);
    const double over = 1 / g.cell_volume();
    for_rows(team, [&](int j, int k) {
      const double* const s = solids_.row(j, k);
      double* const eps = flow_.voidage().row(j, k);
      for (int i = 0; i < g.nx(); ++i) eps[i] = std::max(1 - s[i] * over, least_voidage);
    });
  }
  /// Cell velocities: the mean of both faces.
  void find_cell_velocities(const Team& team) {
    for (int d = 0; d < 3; ++d) {
      const int s[3] = {d == 0, d == 1, d == 2};
      for_rows(team, [&](int j, int k) {
        const Field& u = flow_.velocity(d);
        const double *low = u.row(j, k), *high = u.row(j + s[1], k + s[2]) + s[0];
        double* const to = cells_[static_cast<std::size_t>(d)].row(j, k);
        for (int i = 0; i < flow_.grid().nx(); ++i) to[i] = 0.5 * (low[i] + high[i]);
      });
    }
  }
  /// The mean of the slopes at both faces; beside a side, of the inner one alone.
  void find_pressure_gradients(const Team& team) {
    const Grid& g = flow_.grid();
    Field& p = flow_.pressure();
    flow_.fill_pressure_ghosts();
    const double h[3] = {g.h().x, g.h().y, g.h().z};
    for (int d = 0; d < 3; ++d) {
      const int s[3] = {d == 0, d == 1, d == 2};
      const int last = g.cells()[static_cast<std::size_t>(d)] - 1;
      const bool low_held = flow_.holds_pressure(d, 0), high_held = flow_.holds_pressure(d, 1);
      for_rows(team, [&](int j, int k) {
        const double *c = p.row(j, k), *below = p.row(j - s[1], k - s[2]) - s[0],
                     *above = p.row(j + s[1], k + s[2]) + s[0];
        double* const to = cells_[static_cast<std::size_t>(3 + d)].row(j, k);
        for (int i = 0; i < g.nx(); ++i) {
          const int at = d == 0 ? i : d == 1 ? j : k;
          const bool low = at > 0 || low_held, high = at < last || high_held;
          const double sum = (low ? c[i] - below[i] : 0) + (high ? above[i] - c[i] : 0);
          to[i] = sum / (h[d] * std::max(1, low + high));
        }
      });
    }
  }
  void gather(std::initializer_list<const Field*> fields,
              std::initializer_list<std::size_t> columns, std::size_t n, const Team& team) {
    std::array<std::span<double>, quantities> to;
    std::size_t count = 0;
    for (const std::size_t c : columns) {
      values_[c].resize(n);
      to[count++] = values_[c];
    }
    averaging_.gather(ConstCellFields(fields.begin(), fields.size()),
                      GatheredValues(to.data(), count), team);
  }
  void find_exchange(const CoupledParticles& of, double dt, const Team& team) {
    exchange_.resize(of.velocity.size());
    const double rho = flow_.fluid().density, mu = flow_.fluid().viscosity;
    const bool model_A = flow_.options().model != MomentumModel::B;
    const bool alone = flow_.options().model == MomentumModel::Simplified;
    team.for_ranges(exchange_.size(), [&](std::size_t, std::size_t from, std::size_t to) {
      for (std::size_t p = from; p < to; ++p) {
        const Vec3d u{values_[0][p], values_[1][p], values_[2][p]};
        const double eps = alone ? 1 : std::clamp(values_[3][p], least_voidage, 1.0);
        const double d = 2 * of.shape.radius[p], slip = norm(u - of.velocity[p]);
        const double K = drag_coefficient(drag_, eps, slip_reynolds(eps, rho, slip, d, mu), d, mu);
        const Vec3d a = of.acceleration.empty() ? Vec3d{0, 0, 0} : of.acceleration[p];
        exchange_[p] = momentum_exchange(of.mass[p], model_A ? K : model_b(K, eps), dt, a);
      }
    });
  }
  void spread_drag(const CoupledParticles& of, std::size_t n, const Team& team) {
    for (std::size_t c = 0; c < 4; ++c) values_[c].resize(n);
    for (std::size_t p = 0; p < n; ++p) {
      const auto& e = exchange_[p];
      const Vec3d push = e.coefficient * of.velocity[p] + e.offset;
      values_[0][p] = push.x, values_[1][p] = push.y, values_[2][p] = push.z;
      values_[3][p] = e.coefficient;
    }
    Field* const to[] = {&flow_.drag_velocity(0), &flow_.drag_velocity(1), &flow_.drag_velocity(2),
                         &flow_.drag()};
    const std::span<const double> from[] = {values_[0], values_[1], values_[2], values_[3]};
    averaging_.spread(from, to, team);
    const double over = 1 / flow_.grid().cell_volume();
    for_rows(team, [&](int j, int k) {
      for (Field* f : to) {
        double* const row = f->row(j, k);
        for (int i = 0; i < flow_.grid().nx(); ++i) row[i] *= over;
      }
    });
  }
  /// The force of the fluid on the particles as the fluid felt it, with its sign turned [N].
  Vec3d drag_of_fluid() {
    Vec3d sum{0, 0, 0};
    const Grid& g = flow_.grid();
    for (int k = 0; k < g.nz(); ++k)
      for (int j = 0; j < g.ny(); ++j)
        for (int i = 0; i < g.nx(); ++i) {
          const double K = flow_.drag()(i, j, k);
          const auto of = [&](int d) {
            return K * cells_[static_cast<std::size_t>(d)](i, j, k) -
                   flow_.drag_velocity(d)(i, j, k);
          };
          sum += Vec3d{of(0), of(1), of(2)};
        }
    return g.cell_volume() * sum;
  }
  template <class Visit>
  void for_rows(const Team& team, const Visit& visit) const {
    team.for_parts(static_cast<std::size_t>(flow_.grid().nz()), [&](std::size_t k) {
      for (int j = 0; j < flow_.grid().ny(); ++j) visit(j, static_cast<int>(k));
    });
  }

  FlowSolver flow_;
  Drag drag_;
  typename Mode::Averaging averaging_;
  Field solids_;                                                           // [m3]
  std::vector<Field> cells_ = std::vector<Field>(6, Field(flow_.grid()));  // u, grad p
  std::array<std::vector<double>, quantities> values_;  // u or b v + c; eps or b; grad p
  std::vector<MomentumExchange<double>> exchange_;
};

}  // namespace silt
