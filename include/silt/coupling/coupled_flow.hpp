// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include <silt/coupling/averaging/concept.hpp>
#include <silt/coupling/cell_values.hpp>
#include <silt/coupling/drag/concept.hpp>
#include <silt/coupling/drag/oriented.hpp>
#include <silt/coupling/fluid_force.hpp>
#include <silt/coupling/fluid_needs.hpp>
#include <silt/coupling/momentum_exchange.hpp>
#include <silt/coupling/particles_in_fluid.hpp>
#include <silt/fluid/flow_vtk.hpp>

namespace silt::inline SILT_TARGET {

/// What a coupling step did.
struct CoupledStep {
  FlowStep flow;
  AveragingReport averaging;
  double clipped = 0;       // [m3] solids that the least voidage leaves no room for
  double volume_error = 0;  // [-] solids in cells over the particles' volume, less 1
  Vec3d
      momentum_error{};  // [N] forces on particles and on the fluid: their sum, 0 but for rounding
};

/// Particles and a flow, each of which feels the other, unresolved or by two grids, a kernel or
/// diffusion: the fluid of a Simulation, or of a loop of one's own.
///
///   silt::FlowSolver flow(grid, air, {.model = silt::MomentumModel::A});
///   silt::Simulation sim{std::move(grains), silt::Contacts<silt::HertzMindlin>{glass},
///                        silt::CoupledFlow{silt::Gidaspow{}, silt::Kernel{}, flow}};
///
/// A fluid step:
///
///   weights of the particles' places -> eps = 1 - sum w V/V_cell                              (1)
///   u, eps at the particles -> K (drag law) and other forces L -> b, c of MomentumExchange    (2)
///   fluid: sum w b, sum w (b v + c - L), each over V_cell; FlowSolver::step                   (3)
///   particles: F = b (u' - v) - c + L - V grad p' + V div tau - rho V g                       (4)
///
/// with the same weights in all of them; in model B without grad p and tau, with K/eps. L is that
/// of `Forces` (coupling/fluid_force.hpp); a virtual mass m' makes it
/// F m/(m + m') + m' (Du/Dt - a'), with b, c and a' of m + m'. F is held over the particles' own
/// steps until the next one. The last term is there as p is without the fluid's weight. Particles
/// beyond the grid feel no fluid.
///
/// Source: Z. Y. Zhou et al., J. Fluid Mech. 661 (2010) 482 (models); MomentumExchange.
/// Errors: those of FlowSolver and the averaging mode; InputError for spans that do not fit.
/// Tests:  tests/coupling/coupled_flow.cpp, tests/coupling/simulation.cpp.
template <class Drag, AveragingMode Mode, FluidForce... Forces>
class CoupledFlow {
  template <class F>
  static constexpr bool wants_curl = requires {
    requires F::needs_curl;
  };
  template <class F>
  static constexpr bool adds_mass = requires(const F& f, const InFluid& p) {
    f.added_mass(p);
  };
  template <class F>
  static constexpr bool pushes = requires(const F& f, const InFluid& p) {
    f.force_on(p);
  };
  template <class F>
  static constexpr bool turns_particles = requires(const F& f, const InFluid& p) {
    f.torque_on(p);
  };

 public:
  static constexpr bool active = true;
  static constexpr bool turns = (false || ... || turns_particles<Forces>);
  static constexpr bool needs_strain = (false || ... || detail::wants_strain<Forces>);
  static constexpr bool needs_curl = needs_strain || (false || ... || wants_curl<Forces>);
  static constexpr bool sees_forms =
      detail::wants_forms<Drag> || (false || ... || detail::wants_forms<Forces>);
  static constexpr bool has_history = (false || ... || detail::remembers<Forces>);
  static constexpr bool has_added_mass = (false || ... || adds_mass<Forces>);
  static_assert(
      DragLaw<Drag> || OrientedDragLaw<Drag>,
      "CoupledFlow takes a drag law first (silt/coupling/drag/concept.hpp, oriented.hpp)");

  CoupledFlow(const Drag& drag, const Mode& mode, FlowSolver flow, const Forces&... forces)
      : flow_(std::move(flow)),
        drag_(drag),
        mode_(mode),
        forces_(forces...),
        solids_(flow_.grid()),
        cells_(flow_.grid()) {
    mode_.check();
    if (in_pressure()) flow_.keep_stress();
  }

  FlowSolver& flow() { return flow_; }
  const FlowSolver& flow() const { return flow_; }
  double least_voidage = 0.3;      // [-] of a cell; what it leaves out is counted
  Vec3d gravity{0, 0, 0};          // [m/s2]; a Simulation sets its own
  std::optional<double> diameter;  // [m] in which the mode's widths are; left out: the largest

  /// @name In a Simulation
  /// @{
  /// Particle steps a fluid step; left out: as many as keep the flow stable (at half its limit) and
  /// no particle crosses a fifth of a cell in, at most `most_steps`.
  std::optional<int> steps;
  int most_steps = 50;
  double time() const { return time_; }                // [s] up to which the flow is known
  std::int64_t fluid_steps() const { return count_; }  // [-] since the start
  const CoupledStep& last_step() const { return last_; }
  /// @}

  /// Advances the flow by dt [s]; gives the force on each particle [N], and the torque [N m] if any
  /// of Forces has one.
  CoupledStep advance(const CoupledParticles& particles, double dt, std::span<Vec3d> force,
                      const Team& team = {}, std::span<Vec3d> torque = {}) {
    const std::size_t n = particles.velocity.size();
    check(particles, force.size(), torque.size());
    make_averaging(particles);
    CoupledStep done;
    if (!averaging_) {  // there has been no particle yet
      done.flow = flow_.step(dt, team);
      time_ += dt, ++count_, last_dt_ = dt, last_ = done;
      return done;
    }
    averaging_->place(particles.shape, team);
    done.averaging = averaging_->report();
    spread_volume(particles, done, team);
    find_cells(team);
    gather(n, team, true);
    remember(particles, dt, team);
    find_exchange(particles, dt, torque, team);
    spread_exchange(particles, n, team);
    done.flow = flow_.step(dt, team);
    cells_.find_velocity(flow_, team);
    find_loads(team);
    gather(n, team, false);
    Vec3d on_particles{0, 0, 0};
    for (std::size_t p = 0; p < n; ++p) {
      if (is_outside(p)) {
        force[p] = {0, 0, 0};
        continue;
      }
      const Vec3d exchanged = exchange_[p].force(value(u_at, p), particles.velocity[p]);
      on_particles += exchanged;
      force[p] = exchanged + static_force(particles.volume[p], p);
    }
    done.momentum_error = on_particles - force_of_fluid();
    time_ += dt, ++count_, last_dt_ = dt, last_ = done;
    return done;
  }

  /// [-] at each particle of the last step; 0 beyond the grid.
  std::span<const double> voidage_at_particles() const { return values_[eps_at]; }
  /// The longest fluid step [s] for particles of that speed [m/s]; see `steps`.
  double longest_step(double speed, const Team& team) const {
    const Vec3d h = flow_.grid().h();
    const double stable = flow_.stable_step(team), least = std::min({h.x, h.y, h.z});
    return speed > 0 ? std::min(stable, 0.2 * least / speed) : stable;
  }
  /// The state, part by part, for a checkpoint: visit(name, span of doubles).
  template <class Visit>
  void for_each_state(const Visit& visit) {
    flow_.for_each_state(visit);
    const auto counted = static_cast<double>(count_);
    std::array<double, 4> clock{time_, counted, last_dt_, diameter.value_or(0)};
    visit("fluid.clock", std::span<double>(clock));
    time_ = clock[0], count_ = static_cast<std::int64_t>(clock[1]), last_dt_ = clock[2];
    if (clock[3] > 0) diameter = clock[3];
    if constexpr (has_added_mass) cells_.for_each_state(flow_.grid(), visit);
    if constexpr (has_history) detail::visit_histories(forces_, visit);
  }
  /// Where a particle is for the fluid: its centre, or, if that has left the grid by less than its
  /// radius, as a contact with a wall at the side lets it, the place at the side.
  Vec3d at_the_side(const Vec3d& centre, double radius) const {
    const Grid& g = flow_.grid();
    const auto inside = [&](double x, double low, double high, int d) {
      if (g.periodic(d) || x < low - radius || x > high + radius) return x;
      const double margin = 1e-9 * (high - low);
      return std::clamp(x, low + margin, high - margin);
    };
    const Vec3d &a = g.box().min, &b = g.box().max;
    return {inside(centre.x, a.x, b.x, 0), inside(centre.y, a.y, b.y, 1),
            inside(centre.z, a.z, b.z, 2)};
  }
  void start_at(double time) { time_ = time; }
  double last_step_length() const { return last_dt_; }  // [s] 0: none yet
  using Particles = detail::ParticlesInFluid;

 private:
  static constexpr std::size_t u_at = 0, eps_at = 3, slope_at = 4, stress_at = 7, curl_at = 10,
                               Du_at = 13, b_at = 16, strain_at = 17, quantities = 23;
  bool in_pressure() const { return flow_.options().model == MomentumModel::A; }
  Vec3d value(std::size_t column, std::size_t p) const {
    return {values_[column][p], values_[column + 1][p], values_[column + 2][p]};
  }
  /// Of no cell: there is no fluid.
  bool is_outside(std::size_t p) const { return values_[eps_at][p] == 0; }
  /// Of pressure, viscous stress and the fluid's weight [N].
  Vec3d static_force(double volume, std::size_t p) const {
    Vec3d push = -flow_.fluid().density * gravity;
    if (in_pressure()) push += value(stress_at, p) - value(slope_at, p);
    return volume * push;
  }

  void check(const CoupledParticles& of, std::size_t forces, std::size_t torques) const {
    const std::size_t n = of.velocity.size();
    const auto same = [n](std::size_t count, const char* what) {
      require(count == n, "CoupledParticles: ", count, " ", what, " for ", n,
              " velocities; give one each");
    };
    same(of.shape.position.size(), "positions"), same(of.volume.size(), "volumes");
    same(of.mass.size(), "masses"), same(forces, "forces");
    if (!of.acceleration.empty()) same(of.acceleration.size(), "accelerations");
    if (!of.angular_velocity.empty()) same(of.angular_velocity.size(), "angular velocities");
    if (torques > 0) same(torques, "torques");
    if constexpr (has_history) same(of.id.size(), "ids, which a history needs,");
    if constexpr (sees_forms) detail::check_forms(of, drag_, forces_);
    require(least_voidage > 0 && least_voidage < 1, "CoupledFlow.least_voidage = ", least_voidage,
            " must be in (0, 1)");
  }

  void make_averaging(const CoupledParticles& of) {
    if (averaging_ || of.velocity.empty()) return;
    if (!diameter) diameter = 2 * *std::max_element(of.shape.radius.begin(), of.shape.radius.end());
    averaging_.emplace(mode_, flow_.grid(), *diameter);
    if (const Field* open = flow_.open_cells()) averaging_->open(*open);
  }
  void spread_volume(const CoupledParticles& of, CoupledStep& done, const Team& team) {
    Field* const to[] = {&solids_};
    const std::span<const double> volume[] = {of.volume};
    averaging_->spread(volume, to, team);
    const Grid& g = flow_.grid();
    double particles = 0;
    for (const double v : of.volume) particles += v;
    if (particles > 0 && done.averaging.outside == 0)
      done.volume_error = total(solids_) / particles - 1;
    done.clipped = clipped_solids(solids_, least_voidage);
    const double over = 1 / g.cell_volume();
    CellValues::for_rows(flow_, team, [&](int j, int k) {
      const double* const s = solids_.row(j, k);
      double* const eps = flow_.voidage().row(j, k);
      for (int i = 0; i < g.nx(); ++i) eps[i] = std::max(1 - s[i] * over, least_voidage);
    });
  }
  void find_loads(const Team& team) {
    if (in_pressure()) cells_.find_slope(flow_, team), cells_.find_stress(flow_, team);
  }
  void find_cells(const Team& team) {
    cells_.find_velocity(flow_, team);
    find_loads(team);
    if constexpr (needs_curl) cells_.find_curl(flow_, team);
    if constexpr (needs_strain) cells_.find_strain(flow_, team);
    if constexpr (has_added_mass) cells_.find_acceleration(flow_, last_dt_, team);
  }
  /// Cell values at the particles: all, or those that a flow step has changed.
  void gather(std::size_t n, const Team& team, bool all) {
    std::array<const Field*, quantities> from;
    std::array<std::span<double>, quantities> to;
    std::size_t count = 0;
    const auto take = [&](const Field& field, std::size_t column) {
      values_[column].resize(n);
      from[count] = &field, to[count++] = values_[column];
    };
    const auto take3 = [&](const auto& fields, std::size_t column) {
      for (std::size_t d = 0; d < 3; ++d) take(fields[d], column + d);
    };
    take3(cells_.velocity, u_at);
    if (in_pressure()) take3(cells_.slope, slope_at), take3(cells_.stress, stress_at);
    if (all) take(flow_.voidage(), eps_at);
    if constexpr (needs_curl)
      if (all) take3(cells_.curl, curl_at);
    if constexpr (needs_strain)
      if (all) take3(cells_.stretch, strain_at), take3(cells_.strain, strain_at + 3);
    if constexpr (has_added_mass)
      if (all) take3(cells_.acceleration, Du_at);
    averaging_->gather(ConstCellFields(from.data(), count), GatheredValues(to.data(), count), team);
  }
  /// Forces with a history learn of the slips of now.
  void remember([[maybe_unused]] const CoupledParticles& of, [[maybe_unused]] double dt,
                [[maybe_unused]] const Team& team) {
    if constexpr (has_history) {
      slips_.resize(of.velocity.size());
      for (std::size_t p = 0; p < slips_.size(); ++p)
        slips_[p] = is_outside(p) ? Vec3d{NAN, NAN, NAN} : value(u_at, p) - of.velocity[p];
      detail::remember_slips(forces_, of.id, slips_, dt, team);
    }
  }
  void find_exchange(const CoupledParticles& of, double dt, std::span<Vec3d> torque,
                     const Team& team) {
    exchange_.resize(of.velocity.size());
    team.for_ranges(exchange_.size(), [&](std::size_t, std::size_t from, std::size_t to) {
      for (std::size_t p = from; p < to; ++p) {
        exchange_[p] = {0, {0, 0, 0}};
        if constexpr (turns)
          if (!torque.empty()) torque[p] = {0, 0, 0};
        if (is_outside(p)) continue;
        const InFluid at = particle(of, p, dt);
        exchange_[p] = exchange_of(of, at, p);
        if constexpr (turns)
          if (!torque.empty()) torque[p] = torque_on(at);
      }
    });
  }
  InFluid particle(const CoupledParticles& of, std::size_t p, double dt) const {
    InFluid at{};
    at.density = flow_.fluid().density, at.viscosity = flow_.fluid().viscosity;
    const bool alone = flow_.options().model == MomentumModel::Simplified;
    at.voidage = alone ? 1 : std::clamp(values_[eps_at][p], least_voidage, 1.0);
    at.diameter = 2 * of.shape.radius[p], at.volume = of.volume[p], at.mass = of.mass[p];
    at.dt = dt, at.slip = value(u_at, p) - of.velocity[p];
    at.place = p;
    if constexpr (needs_curl) at.curl = value(curl_at, p);
    if constexpr (needs_strain)
      at.stretch = value(strain_at, p), at.strain = value(strain_at + 3, p);
    if (!of.angular_velocity.empty()) at.angular_velocity = of.angular_velocity[p];
    if (!of.shape.orientation.empty()) at.orientation = of.shape.orientation[p];
    if (!of.shape.form.empty()) at.form = of.shape.form[p];
    if constexpr (sees_forms)
      if (!of.forms.empty()) at.body = &of.forms[at.form];
    return at;
  }
  double coefficient(const InFluid& at) const {
    const double Re =
        slip_reynolds(at.voidage, at.density, norm(at.slip), at.diameter, at.viscosity);
    const double K = detail::drag_on(drag_, at, Re);
    return flow_.options().model == MomentumModel::B ? model_b(K, at.voidage) : K;
  }
  MomentumExchange<double> exchange_of(const CoupledParticles& of, const InFluid& at,
                                       std::size_t p) const {
    const double K = coefficient(at);
    Vec3d push{0, 0, 0};
    double added = 0;
    const auto ask = [&](const auto& force) {
      using F = std::decay_t<decltype(force)>;
      if constexpr (pushes<F>) push += force.force_on(at);
      if constexpr (adds_mass<F>) added += force.added_mass(at);
    };
    std::apply([&](const auto&... force) { (ask(force), ...); }, forces_);
    Vec3d Du{0, 0, 0};
    if constexpr (has_added_mass) Du = value(Du_at, p);
    if (!std::isfinite(at.mass)) return {K, -(push + added * Du)};
    const Vec3d others = static_force(at.volume, p) + push;
    Vec3d a = (1 / at.mass) * others;
    if (!of.acceleration.empty()) a += of.acceleration[p];
    const double all = at.mass + added, share = at.mass / all;
    a = share * a + (added / all) * Du;
    const auto e = momentum_exchange(all, K, at.dt, a);
    return {share * e.coefficient, share * e.offset - push - added * (Du - a)};
  }
  Vec3d torque_on(const InFluid& at) const {
    Vec3d sum{0, 0, 0};
    const auto ask = [&](const auto& force) {
      if constexpr (turns_particles<std::decay_t<decltype(force)>>) sum += force.torque_on(at);
    };
    std::apply([&](const auto&... force) { (ask(force), ...); }, forces_);
    return sum;
  }
  void spread_exchange(const CoupledParticles& of, std::size_t n, const Team& team) {
    values_[b_at].resize(n);
    for (std::size_t p = 0; p < n; ++p) {
      const auto& e = exchange_[p];
      const Vec3d push = e.coefficient * of.velocity[p] + e.offset;
      values_[0][p] = push.x, values_[1][p] = push.y, values_[2][p] = push.z;
      values_[b_at][p] = e.coefficient;
    }
    Field* const to[] = {&flow_.drag_velocity(0), &flow_.drag_velocity(1), &flow_.drag_velocity(2),
                         &flow_.drag()};
    const std::span<const double> from[] = {values_[0], values_[1], values_[2], values_[b_at]};
    averaging_->spread(from, to, team);
    const double over = 1 / flow_.grid().cell_volume();
    CellValues::for_rows(flow_, team, [&](int j, int k) {
      for (Field* f : to) {
        double* const row = f->row(j, k);
        for (int i = 0; i < flow_.grid().nx(); ++i) row[i] *= over;
      }
    });
  }
  /// The exchanged force on the particles as the fluid felt it [N].
  Vec3d force_of_fluid() {
    Vec3d sum{0, 0, 0};
    const Grid& g = flow_.grid();
    for (int k = 0; k < g.nz(); ++k)
      for (int j = 0; j < g.ny(); ++j)
        for (int i = 0; i < g.nx(); ++i) {
          const double K = flow_.drag()(i, j, k);
          const auto of = [&](int d) {
            return K * cells_.velocity[static_cast<std::size_t>(d)](i, j, k) -
                   flow_.drag_velocity(d)(i, j, k);
          };
          sum += Vec3d{of(0), of(1), of(2)};
        }
    return g.cell_volume() * sum;
  }

  using CellValues = detail::CellValues;
  FlowSolver flow_;
  Drag drag_;
  Mode mode_;
  std::tuple<Forces...> forces_;
  std::optional<typename Mode::Averaging> averaging_;
  Field solids_;  // [m3]
  CellValues cells_;
  std::array<std::vector<double>, quantities> values_;  // of each particle, by column
  std::vector<MomentumExchange<double>> exchange_;
  std::vector<Vec3d> slips_;       // [m/s] of forces with a history
  double time_ = 0, last_dt_ = 0;  // [s]
  std::int64_t count_ = 0;
  CoupledStep last_;
};

}  // namespace silt
