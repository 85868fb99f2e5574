// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <silt/core/error.hpp>
#include <silt/core/threads.hpp>
#include <silt/fluid/flow_rows.hpp>
#include <silt/fluid/flow_sides.hpp>
#include <silt/fluid/grid.hpp>
#include <silt/fluid/pressure_solver.hpp>

namespace silt::inline SILT_TARGET {

/// An incompressible Newtonian fluid.
struct FluidProperties {
  double density = 1.2;       // [kg/m3]
  double viscosity = 1.8e-5;  // [Pa s]
};

/// Volume-averaged momentum equations, with the pressure p and the force f of the particles:
///   A           d(eps rho u)/dt + div(eps rho u u) = -eps grad p + eps div tau + f
///   B                                              =     -grad p +     div tau + f
///   Simplified  of the fluid alone (eps = 1); for dilute flow, solids below 1 %
enum class MomentumModel { A, B, Simplified };

struct FlowOptions {
  MomentumModel model = MomentumModel::A;
  double tolerance = 1e-6;    // [-] of the pressure's residual
  int most_iterations = 200;  // [-] of the pressure solver
};

/// What a step did.
struct FlowStep {
  double courant = 0;  // [-] the largest sum over directions of |u| dt / h of any cell
  int iterations = 0;  // of the pressure solver
  double removed = 0;  // [-] of the continuity equation's right side: what no flow could balance
};

/// Incompressible flow, averaged over volumes that hold particles, on the staggered (MAC) cells of
/// a Grid: velocities on faces, all else in cells.
///
///   d(eps)/dt + div(eps u) = 0                                                                 (1)
///   momentum as MomentumModel says, tau = mu (grad u + grad u' - 2/3 div u 1)                  (2)
///   f = K (v - u) + s                                                                          (3)
///
/// u [m/s] is the velocity between the particles (interstitial), eps u the superficial one. Before
/// a step the caller sets eps as it will be at its end, and K, K v (drag of the particles) and
/// other forces s. Drag is implicit and limits no step. The pressure is without the fluid's weight:
/// what hangs in the fluid bears its buoyancy besides.
///
/// A step: fluxes eps u extrapolated to its middle; advection and viscosity by Heun's rule; drag
/// and pressure by incremental projection, with the drag in the diagonal and in the weight of the
/// pressure:
///
///   D u* = rho m u / dt + T - e grad p + K v + s,   D = rho m' / dt + K                        (4)
///   div(eps e / D grad dp) = div(eps u*) + (eps' - eps) / dt,   u' = u* - e / D grad dp        (5)
///
/// with e = eps (model A) or 1. m is the fluid that fluxes F have carried into the volume of a
/// velocity, m' = m - dt div F; it follows eps by a step. With it momentum is kept to rounding and
/// a uniform flow stays one, whatever eps does.
/// Second order in space and time on smooth flows; in time drag is of first order.
/// Stable where courant <= 1 and mu dt / (rho eps) sum 1/h^2 < 1/2: see stable_step().
///
/// Source: F. H. Harlow, J. E. Welch, Phys. Fluids 8 (1965) 2182 (staggered cells); J. van Kan,
///   SIAM J. Sci. Stat. Comput. 7 (1986) 870 (incremental projection); Z. Y. Zhou et al., J. Fluid
///   Mech. 661 (2010) 482 (models A and B are sets II and III).
/// Threads: results are the same, bit for bit, for every number of threads.
/// Errors: InputError for sides, fluids and fields that cannot be; Error, with a sentence, where a
///   step cannot be made.
/// Tests:  tests/fluid/flow_solver.cpp.
class FlowSolver {
 public:
  FlowSolver(const Grid& grid, const FluidProperties& fluid, const FlowOptions& options = {})
      : grid_(grid), fluid_(fluid), options_(options), sides_(grid), solver_(grid) {
    require(std::isfinite(fluid.density) && fluid.density > 0,
            "FluidProperties.density = ", fluid.density, " kg/m3 must be positive");
    require(std::isfinite(fluid.viscosity) && fluid.viscosity >= 0,
            "FluidProperties.viscosity = ", fluid.viscosity, " Pa s must not be negative");
    require(options.tolerance > 0 && options.tolerance < 1,
            "FlowOptions.tolerance = ", options.tolerance, " must be in (0, 1)");
  }

  const Grid& grid() const { return grid_; }
  const FluidProperties& fluid() const { return fluid_; }
  const FlowOptions& options() const { return options_; }

  /// What bounds the flow at the lower (end 0) or upper (end 1) side of a direction that is not
  /// periodic; a wall at rest unless set.
  void set_side(int direction, int end, const FlowSide& side) { sides_.set(direction, end, side); }

  /// @name The state, on faces of each direction and in cells
  /// @{
  Field& velocity(int d) { return u_[at(d)]; }  // [m/s] interstitial
  const Field& velocity(int d) const { return u_[at(d)]; }
  Field& pressure() { return p_; }  // [Pa] of the middle of the last step
  const Field& pressure() const { return p_; }
  /// @}

  /// @name What the particles do, in cells; to be set before a step, kept from step to step
  /// @{
  Field& voidage() { return voidage_; }  // [-] eps at the end of the step
  const Field& voidage() const { return voidage_; }
  Field& drag() { return drag_; }                         // [kg/(m3 s)] K
  Field& drag_velocity(int d) { return drag_v_[at(d)]; }  // [N/m3] K v
  Field& force(int d) { return force_[at(d)]; }           // [N/m3] s
  /// @}

  /// Makes the velocities as set the state from which steps go on: at rest, at first.
  void start(const Team& team = {}) {
    take_voidage();
    older_eps_ = old_eps_ = mass_ = eps_;
    for (int d = 0; d < 3; ++d) sides_.fill_velocity(d, u_[at(d)]);
    superficial(u_, flow_, team);
    old_flow_ = flow_;
    old_dt_ = 0, started_ = true;
  }

  /// The momentum of the fluid [kg m/s] that steps keep: of what is in the volumes of velocities.
  Vec3d momentum(const Team& team = {}) const {
    double of[3];
    for (int d = 0; d < 3; ++d) {
      const std::ptrdiff_t s = stride(d);
      const int first = sides_.first(d), last = sides_.last(d);
      of[d] = over_planes(
          team,
          [&](int k) {
            double all = 0;
            for (int j = 0; j < grid_.ny(); ++j)
              for (int i = 0; i < grid_.nx(); ++i) {
                const int face = d == 0 ? i : d == 1 ? j : k;
                const double *m = &mass_.row(j, k)[i], u = u_[at(d)](i, j, k);
                if (face >= first && face < last) all += 0.5 * (m[-s] + m[0]) * u;
              }
            return all;
          },
          sum);
      of[d] *= fluid_.density * grid_.cell_volume();
    }
    return {of[0], of[1], of[2]};
  }

  /// The longest step [s] for which the explicit terms are stable, with a margin.
  double stable_step(const Team& team = {}) const {
    const Vec3d h = grid_.h();
    const double speeds = courant(1, team),
                 squares = 1 / (h.x * h.x) + 1 / (h.y * h.y) + 1 / (h.z * h.z);
    const double by_flow = speeds > 0 ? 0.5 / speeds : std::numeric_limits<double>::infinity();
    const double nu = fluid_.viscosity / fluid_.density;
    return std::min(by_flow, 0.35 / (nu * squares));
  }

  FlowStep step(double dt, const Team& team = {}) {
    require(std::isfinite(dt) && dt > 0, "FlowSolver: a step of ", dt, " s is none");
    if (!started_) start(team);
    FlowStep done;
    done.courant = courant(dt, team);
    refuse_unstable(dt, done.courant);
    take_voidage();
    for (Field* f :
         {&drag_, &drag_v_[0], &drag_v_[1], &drag_v_[2], &force_[0], &force_[1], &force_[2]})
      sides_.fill_cells(*f);
    sides_.fill_pressure(p_, false);
    carry(dt, team);
    find_spread(team);
    stage(u_, false, dt, first_, team);
    for (int d = 0; d < 3; ++d) sides_.fill_velocity(d, first_[at(d)]);
    stage(first_, true, dt, next_, team);
    for (int d = 0; d < 3; ++d) sides_.fill_velocity(d, next_[at(d)]);
    project(dt, done, team);
    std::swap(mass_, next_mass_), std::swap(older_eps_, old_eps_);
    old_eps_ = eps_, old_dt_ = dt;
    return done;
  }

 private:
  using Three = std::array<Field, 3>;
  static std::size_t at(int d) { return static_cast<std::size_t>(d); }
  Three three() const { return {Field(grid_), Field(grid_), Field(grid_)}; }
  std::ptrdiff_t stride(int d) const {
    return d == 0 ? 1
                  : static_cast<std::ptrdiff_t>(d == 1 ? grid_.row_stride() : grid_.plane_stride());
  }
  double h(int d) const { return d == 0 ? grid_.h().x : d == 1 ? grid_.h().y : grid_.h().z; }

  /// Calls visit(j, k, from, to) for the rows of the unknown velocities of direction d, planes in
  /// threads.
  template <class Visit>
  void for_faces(int d, const Team& team, const Visit& visit) const {
    const auto& n = grid_.cells();
    int from[3] = {0, 0, 0}, to[3] = {n[0], n[1], n[2]};
    from[d] = sides_.first(d), to[d] = sides_.last(d);
    team.for_parts(static_cast<std::size_t>(std::max(0, to[2] - from[2])), [&](std::size_t part) {
      const int k = from[2] + static_cast<int>(part);
      for (int j = from[1]; j < to[1]; ++j) visit(j, k, from[0], to[0]);
    });
  }
  template <class Visit>
  void for_cells(const Team& team, const Visit& visit) const {
    team.for_parts(at(grid_.nz()), [&](std::size_t k) {
      for (int j = 0; j < grid_.ny(); ++j) visit(j, static_cast<int>(k));
    });
  }

  void take_voidage() {
    if (options_.model == MomentumModel::Simplified) return;  // 1 as from the first
    for (int k = 0; k < grid_.nz(); ++k)
      for (int j = 0; j < grid_.ny(); ++j) {
        const double* const e = voidage_.row(j, k);
        for (int i = 0; i < grid_.nx(); ++i)
          if (!(e[i] > 0 && e[i] <= 1 + 1e-9)) [[unlikely]]
            throw Error(text("FlowSolver: cell (", i, ", ", j, ", ", k, ") has a voidage of ", e[i],
                             "; it must be above 0 and at most 1: spread the particles' volume "
                             "over more cells, or use larger cells"));
      }
    eps_ = voidage_;
    sides_.fill_voidage(eps_);
  }

  /// to = eps u on all faces, boundary faces too.
  void superficial(const Three& u, Three& to, const Team& team) const {
    for (int d = 0; d < 3; ++d) {
      const std::ptrdiff_t s = stride(d);
      const int more[3] = {d == 0, d == 1, d == 2};
      team.for_parts(at(grid_.nz() + more[2]), [&](std::size_t part) {
        const int k = static_cast<int>(part);
        for (int j = 0; j < grid_.ny() + more[1]; ++j) {
          const double *e = eps_.row(j, k), *v = u[at(d)].row(j, k);
          double* out = to[at(d)].row(j, k);
          fluid_detail::for_row(0, grid_.nx() + more[0], [&]<class Real>(int i) {
            const Real mean = Real(0.5) * (load_any<Real>(e + i - s) + load_any<Real>(e + i));
            fluid_detail::store_any(out + i, mean * load_any<Real>(v + i));
          });
        }
      });
      sides_.fill_flux(d, to[at(d)]);
    }
  }

  /// The sum of what of_plane(k) returns, or, with std::max for `join`, the largest.
  template <class OfPlane, class Join>
  double over_planes(const Team& team, const OfPlane& of_plane, const Join& join) const {
    std::vector<double> of(at(grid_.nz()), 0.0);
    team.for_parts(of.size(), [&](std::size_t k) { of[k] = of_plane(static_cast<int>(k)); });
    double all = 0;
    for (const double one : of) all = join(all, one);
    return all;
  }
  static double larger(double a, double b) { return !(b <= a) ? b : a; }  // also what is no number
  static double sum(double a, double b) { return a + b; }

  double courant(double dt, const Team& team) const {
    const double over[3] = {dt / h(0), dt / h(1), dt / h(2)};
    return over_planes(
        team,
        [&](int k) {
          double most = 0;
          for (int j = 0; j < grid_.ny(); ++j)
            for (int i = 0; i < grid_.nx(); ++i) {
              double one = 0;
              for (int d = 0; d < 3; ++d) {
                const double* const v = &u_[at(d)].row(j, k)[i];
                one += over[d] * std::max(std::abs(v[0]), std::abs(v[stride(d)]));
              }
              most = larger(most, one);
            }
          return most;
        },
        larger);
  }
  void refuse_unstable(double dt, double courant) const {
    if (!(courant <= 1))
      throw Error(text("FlowSolver: the flow crosses ", courant, " cells in a step of ", dt,
                       " s; it must be at most 1: make the fluid's step shorter"));
    const Vec3d size = grid_.h();
    const double spread = fluid_.viscosity / fluid_.density * dt *
                          (1 / (size.x * size.x) + 1 / (size.y * size.y) + 1 / (size.z * size.z));
    if (spread > 0.45)
      throw Error(
          text("FlowSolver: viscosity spreads over mu dt / rho (1/hx^2 + "
               "1/hy^2 + 1/hz^2) = ",
               spread, " of a cell in a step of ", dt,
               " s; it must be at most 0.45: make the fluid's step shorter"));
  }

  /// The fluxes in the middle of the step, and the fluid that they carry.
  void carry(double dt, const Team& team) {
    const double ahead = old_dt_ > 0 ? 0.5 * dt / old_dt_ : 0;
    for (int d = 0; d < 3; ++d) {
      const int more[3] = {d == 0, d == 1, d == 2};
      team.for_parts(at(grid_.nz() + more[2]), [&](std::size_t part) {
        for (int j = 0; j < grid_.ny() + more[1]; ++j) {
          const int k = static_cast<int>(part);
          const double *now = flow_[at(d)].row(j, k), *old = old_flow_[at(d)].row(j, k);
          double* out = carried_[at(d)].row(j, k);
          fluid_detail::for_row(0, grid_.nx() + more[0], [&]<class Real>(int i) {
            const Real f = load_any<Real>(now + i);
            fluid_detail::store_any(out + i, f + Real(ahead) * (f - load_any<Real>(old + i)));
          });
        }
      });
      sides_.fill_flux(d, carried_[at(d)]);
    }
    const double lacking = over_planes(
        team,
        [&](int k) {
          double most = 0;
          for (int j = 0; j < grid_.ny(); ++j) {
            const double *m = mass_.row(j, k), *e = eps_.row(j, k);
            double* const out = next_mass_.row(j, k);
            for (int i = 0; i < grid_.nx(); ++i) {
              out[i] = m[i] - dt * divergence(carried_, i, j, k);
              most = larger(most, 0.5 * e[i] - out[i]);
            }
          }
          return most;
        },
        larger);
    if (lacking > 0) {  // eps jumps: follow it a step late, without looking ahead
      carried_ = flow_, mass_ = older_eps_, next_mass_ = old_eps_;
    }
    sides_.fill_voidage(mass_), sides_.fill_voidage(next_mass_);
  }
  double divergence(const Three& f, int i, int j, int k) const {
    double sum = 0;
    for (int d = 0; d < 3; ++d) {
      const double* const v = &f[at(d)].row(j, k)[i];
      sum += (v[stride(d)] - v[0]) / h(d);
    }
    return sum;
  }
  void find_spread(const Team& team) {
    for_cells(team, [&](int j, int k) {
      double* const out = spread_.row(j, k);
      for (int i = 0; i < grid_.nx(); ++i) out[i] = divergence(u_, i, j, k);
    });
    sides_.fill_cells(spread_);
  }

  /// One stage: `out` is u* of (4) with the tendency of q, or, in the second stage, the mean of it
  /// and the first one's.
  void stage(const Three& q, bool second, double dt, Three& out, const Team& team) {
    const bool averaged = options_.model == MomentumModel::A;
    for (int d = 0; d < 3; ++d) {
      const std::ptrdiff_t s = stride(d);
      for_faces(d, team, [&](int j, int k, int from, int to) {
        const auto row = [&](const Field& f) { return f.row(j, k); };
        fluid_detail::MomentumRow r{row(q[at(d)]),
                                    {row(carried_[0]), row(carried_[1]), row(carried_[2])},
                                    row(spread_),
                                    {stride(0), stride(1), stride(2)},
                                    s,
                                    {1 / h(0), 1 / h(1), 1 / h(2)},
                                    1 / h(d),
                                    fluid_.density,
                                    fluid_.viscosity};
        const double *u = row(u_[at(d)]), *eps = row(eps_), *m = row(mass_), *m1 = row(next_mass_),
                     *K = row(drag_), *Kv = row(drag_v_[at(d)]), *f = row(force_[at(d)]),
                     *p = row(p_);
        double *const to_row = out[at(d)].row(j, k), *const t_row = tendency_[at(d)].row(j, k),
                      *const w_row = weight_[at(d)].row(j, k);
        const double per_step = fluid_.density / dt;
        fluid_detail::for_row(from, to, [&]<class Real>(int i) {
          const Real half(0.5);
          const auto mean = [&](const double* c) {
            return half * (load_any<Real>(c + i - s) + load_any<Real>(c + i));
          };
          const Real eps_f = averaged ? mean(eps) : Real(1);
          Real advection, viscous;
          fluid_detail::explicit_terms(r, i, advection, viscous);
          Real t = advection + eps_f * viscous;
          if (second)
            t = half * (load_any<Real>(t_row + i) + t);
          else
            fluid_detail::store_any(t_row + i, t);
          const Real over_D = Real(1) / (Real(per_step) * mean(m1) + mean(K));
          const Real slope = Real(1 / h(d)) * (load_any<Real>(p + i) - load_any<Real>(p + i - s));
          const Real driven = Real(per_step) * mean(m) * load_any<Real>(u + i) + t - eps_f * slope +
                              mean(Kv) + mean(f);
          fluid_detail::store_any(to_row + i, over_D * driven);
          if (second) fluid_detail::store_any(w_row + i, eps_f * over_D);
        });
      });
    }
  }

  /// (5).
  void project(double dt, FlowStep& done, const Team& team) {
    old_flow_ = flow_;
    superficial(next_, flow_, team);
    for (int d = 0; d < 3; ++d) {
      const std::ptrdiff_t s = stride(d);
      const double over = 1 / (h(d) * h(d));
      for_faces(d, team, [&](int j, int k, int from, int to) {
        const double *eps = eps_.row(j, k), *w = weight_[at(d)].row(j, k);
        double* const a = coefficient_[at(d)].row(j, k);
        fluid_detail::for_row(from, to, [&]<class Real>(int i) {
          const Real mean = Real(0.5) * (load_any<Real>(eps + i - s) + load_any<Real>(eps + i));
          fluid_detail::store_any(a + i, Real(over) * mean * load_any<Real>(w + i));
        });
      });
    }
    hold_outlets();
    const double excess = over_planes(
        team,
        [&](int k) {
          double all = 0;
          for (int j = 0; j < grid_.ny(); ++j) {
            const double *now = eps_.row(j, k), *old = old_eps_.row(j, k);
            double* const b = right_.row(j, k);
            for (int i = 0; i < grid_.nx(); ++i) {
              b[i] = -(divergence(flow_, i, j, k) + (now[i] - old[i]) / dt);
              all += b[i];
            }
          }
          return all;
        },
        sum);
    const double mean = excess * dt / static_cast<double>(grid_.size());
    if (!sides_.any_open() && std::abs(mean) > 1e-6)
      throw Error(
          text("FlowSolver: ", mean > 0 ? "more" : "less", " fluid comes in than goes out, by ",
               std::abs(mean),
               " of the volume in a step, and no side is an Outflow; make one an "
               "Outflow, or balance the sides' velocities and the particles that come and go"));
    solver_.set(coefficient_[0], coefficient_[1], coefficient_[2], held_, team);
    change_.fill(0);
    const auto solved = solver_.solve(
        right_, change_,
        {.relative = options_.tolerance, .most_iterations = options_.most_iterations}, team);
    if (!solved.converged)
      throw Error(text("FlowSolver: the pressure of a step of ", dt,
                       " s cannot be found: ", solved.reason));
    done.iterations = solved.iterations, done.removed = solved.removed;
    sides_.fill_pressure(change_, true);
    for (int d = 0; d < 3; ++d) {
      const std::ptrdiff_t s = stride(d);
      for_faces(d, team, [&](int j, int k, int from, int to) {
        const double *star = next_[at(d)].row(j, k), *w = weight_[at(d)].row(j, k),
                     *dp = change_.row(j, k);
        double* const u = u_[at(d)].row(j, k);
        fluid_detail::for_row(from, to, [&]<class Real>(int i) {
          const Real slope = Real(1 / h(d)) * (load_any<Real>(dp + i) - load_any<Real>(dp + i - s));
          fluid_detail::store_any(u + i, load_any<Real>(star + i) - load_any<Real>(w + i) * slope);
        });
      });
      sides_.fill_velocity(d, u_[at(d)]);
    }
    for_cells(team, [&](int j, int k) {
      double* const p = p_.row(j, k);
      const double* const dp = change_.row(j, k);
      for (int i = 0; i < grid_.nx(); ++i) p[i] += dp[i];
    });
    superficial(u_, flow_, team);
  }
  /// Outlets hold the pressure half a cell from the last centre.
  void hold_outlets() {
    held_.fill(0);
    const auto& n = grid_.cells();
    for (int d = 0; d < 3; ++d)
      for (int end = 0; end < 2; ++end) {
        if (!sides_.open(d, end)) continue;
        const int a = (d + 1) % 3, b = (d + 2) % 3;
        for (int y = 0; y < n[at(b)]; ++y)
          for (int x = 0; x < n[at(a)]; ++x) {
            int cell[3], face[3];
            cell[a] = face[a] = x, cell[b] = face[b] = y;
            cell[d] = end == 0 ? 0 : n[at(d)] - 1, face[d] = end == 0 ? 0 : n[at(d)];
            held_(cell[0], cell[1], cell[2]) += 2 * coefficient_[at(d)](face[0], face[1], face[2]);
          }
      }
  }

  Grid grid_;
  FluidProperties fluid_;
  FlowOptions options_;
  fluid_detail::FlowSides sides_;
  PressureSolver solver_;
  bool started_ = false;
  double old_dt_ = 0;                                              // [s] of the last step; 0: none
  Three u_ = three(), first_ = three(), next_ = three();           // [m/s] u, after a stage, u*
  Three flow_ = three(), old_flow_ = three(), carried_ = three();  // [m/s] eps u; F
  Three tendency_ = three();                                       // [N/m3] of the first stage
  Three weight_ = three(), coefficient_ = three();                 // e/D; eps e/D/h^2
  Field p_{grid_}, change_{grid_}, right_{grid_}, held_{grid_};    // p, dp and its equation
  Field voidage_{grid_, 1}, eps_{grid_, 1}, old_eps_{grid_, 1}, older_eps_{grid_, 1};
  Field mass_{grid_, 1}, next_mass_{grid_, 1};  // [-] m, m'
  Field spread_{grid_};                         // [1/s] div u
  Field drag_{grid_};
  Three drag_v_ = three(), force_ = three();
};

}  // namespace silt
