// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <span>
#include <tuple>
#include <utility>

#include <silt/core/dyn_array.hpp>
#include <silt/core/error.hpp>
#include <silt/core/threads.hpp>
#include <silt/coupling/coupled_step.hpp>
#include <silt/coupling/mean_diameter.hpp>
#include <silt/coupling/particle_exchange.hpp>
#include <silt/sph/cluster_lists.hpp>
#include <silt/sph/columns.hpp>
#include <silt/sph/setup.hpp>
#include <silt/sph/terms.hpp>

namespace silt::inline SILT_TARGET {

/// Settings of UnresolvedGrains.
struct UnresolvedGrainsSetup {
  double viscosity = 0;        // [Pa s] of the liquid, for the drag law
  double least_voidage = 0.3;  // [-] at a liquid particle; the clipped volume is counted
  double resolved_from = 1.5;  // [-] spacings: spheres and bodies of at least this radius are
                               // resolved by particles of their own
  void check() const {
    require_positive("UnresolvedGrainsSetup.viscosity", viscosity, "Pa s");
    require(least_voidage > 0 && least_voidage < 1,
            "UnresolvedGrainsSetup.least_voidage = ", least_voidage, " [-] must be in (0, 1)");
    require(resolved_from >= 1.5, "UnresolvedGrainsSetup.resolved_from = ", resolved_from,
            " spacings must be at least 1.5");
  }
};

namespace detail {
template <class Drag, class... Forces>
class AveragedGrains;
}

/// Unresolved coupling with grains that are smaller than the liquid's particles: drag law and void
/// fraction as in the couplings with a mesh (docs/fluid.md), with liquid particles in place of
/// cells.
///
///   silt::Sph water{liquid, setup, silt::UnresolvedGrains{silt::DiFelice{}, {.viscosity = 1e-3}}};
///
/// Grain p has weights w_pa = V_a W(r_pa)/sum on the liquid particles a, with the liquid's kernel.
/// They are used to distribute its volume and forces to the liquid, and to interpolate velocity,
/// void fraction and pressure gradient. The exchange is conservative to rounding.
///
///   eps_a = V/(V + sum_p w_pa V_p),  V = m_a/rho_a                              void fraction
///   d v_a/dt = (pairs, with volumes m/(eps rho))/eps + g - (drag and pressure on grains)/m_a
///   F_p = V_p(-grad P + div tau) + drag(eps, slip)
///
/// rho is the density of the pure liquid. At the free surface a grain is coupled by the factor f =
/// (n - 0.2)/0.3, limited to 0 to 1, with n = sum V W of liquid and walls. f is 1 if its centre is
/// below the surface, and 0 from about h/2 above it. Its weights then sum to f, and the force on it
/// is f F.
///
/// Source: M. Robinson, M. Ramaioli, S. Luding, Int. J. Multiphase Flow 59 (2014) 121 (recalled),
///         in the discrete form above, which is silt's own.
/// Valid:  grains smaller than about a spacing; dense beds: as the drag law.
/// Errors: InputError for settings; Error if grains are too light for their number.
/// Tests:  tests/sph/grains.cpp.
/// Units:  SI.
template <class Drag, class... Forces>
struct UnresolvedGrains {
  static constexpr SphAxis sph_axis = SphAxis::Grains;
  static constexpr bool averaged = true;
  static constexpr const char* policy_name = "UnresolvedGrains";
  using State = detail::AveragedGrains<Drag, Forces...>;

  UnresolvedGrains(const Drag& law, const UnresolvedGrainsSetup& setup, const Forces&... more)
      : drag(law), settings(setup), forces(more...) {}

  Drag drag;
  UnresolvedGrainsSetup settings;
  std::tuple<Forces...> forces;
  void check() const { settings.check(); }
};

namespace detail {

/// Unresolved grains of an Sph: the particles, their weights on rows of the liquid, and the
/// exchange.
template <class Drag, class... Forces>
class AveragedGrains {
 public:
  using Exchange = ParticleExchange<Drag, Forces...>;
  static_assert(
      !Exchange::follows && !Exchange::needs_curl && !Exchange::has_added_mass &&
          !Exchange::has_history && !Exchange::sees_forms,
      "UnresolvedGrains has no derivatives of the liquid's velocity and no forms of "
      "bodies, and forces are constant over a step: leave lift, virtual mass, histories, drag "
      "laws of forms and FollowedDrag out");

  explicit AveragedGrains(const UnresolvedGrains<Drag, Forces...>& of)
      : settings(of.settings),
        exchange_(std::apply([&](const auto&... more) { return Exchange(of.drag, more...); },
                             of.forces)) {}

  UnresolvedGrainsSetup settings;
  DynArray<std::size_t> number;  // among the particles passed to the liquid
  DynArray<Vec3d> place;         // [m] of each
  DynArray<Vec3d> force;         // [N] of the last step
  CoupledStep last;
  FluidClosure closure;

  bool is_small(double radius, const SphSetup& setup) const {
    return radius < settings.resolved_from * setup.spacing;
  }
  /// Moves the particles of `among` that are too small to be resolved to this object; false if
  /// their number has changed.
  bool pick_small(const CoupledParticles& of, const SphSetup& setup, DynArray<std::size_t>& among) {
    const std::size_t before = number.size();
    number.clear();
    const auto picked = [&](std::size_t p) { return is_small(of.shape.radius[p], setup); };
    std::copy_if(among.begin(), among.end(), std::back_inserter(number), picked);
    erase_if(among, picked);
    const auto pick = [&](const auto& all, auto& mine) {
      mine.clear();
      if (!all.empty())
        for (const std::size_t p : number) mine.push_back(all[p]);
    };
    pick(of.shape.position, place), pick(of.shape.radius, radius_), pick(of.velocity, velocity_);
    pick(of.volume, volume_), pick(of.mass, mass_), pick(of.acceleration, acceleration_);
    pick(of.angular_velocity, spin_);
    force.assign(number.size(), {0, 0, 0});
    return number.size() == before;
  }
  /// For a state: seven numbers per grain, those that a reading needs; pick_small() gives the rest.
  DynArray<double> state() const {
    DynArray<double> all;
    for (std::size_t p = 0; p < place.size(); ++p)
      all.insert(all.end(), {place[p].x, place[p].y, place[p].z, velocity_[p].x, velocity_[p].y,
                             velocity_[p].z, volume_[p]});
    return all;
  }
  void restore(std::span<const double> state) {
    place.clear(), volume_.clear(), velocity_.clear();
    for (std::size_t k = 0; k < state.size(); k += 7) {
      place.push_back({state[k], state[k + 1], state[k + 2]});
      velocity_.push_back({state[k + 3], state[k + 4], state[k + 5]});
      volume_.push_back(state[k + 6]);
    }
    number.resize(place.size());
  }
  void move(double dt) {
    for (std::size_t p = 0; p < place.size(); ++p) place[p] += dt * velocity_[p];
  }

  /// Computes weights for the present positions, and the liquid's void fraction. Densities follow:
  /// each particle keeps its mass in the same space, except at the free surface, where it may take
  /// more space. `probe_row`: of each grain. At the first call the liquid particles get the mass
  /// that fits between the grains.
  template <class Kernel>
  void set(SphColumns& columns, const ClusterLists& lists, std::span<const std::uint32_t> probe_row,
           std::size_t width, double mass, double h, const Team& team) {
    find_weights<Kernel>(columns, lists, probe_row, width, mass, h, team);
    const std::size_t rows = lists.first_pack(ClusterLists::Wall) * width;
    turn_round(rows);
    const bool first = columns.voidage.empty();
    if (first)
      for (auto* const of : {&columns.voidage, &columns.share, &columns.fullness})
        of->assign(columns.size(), 1);
    DynArray<double> solids(rows, 0);
    spread(volume_, solids, team);
    last = {};
    for (std::size_t p = 0; p < place.size(); ++p) {
      last.solids += part_[p] * volume_[p];
      if (shares_[p].empty()) ++last.averaging.outside;
    }
    last.averaging.particles = place.size();
    double all = 0;
    for (std::size_t k = 0; k < rows; ++k) {
      if (columns.label[k] == ClusterLists::none) continue;
      SphRow& r = columns.rows[k];
      const double whole = mass / r.density, S = solids[k];
      double eps = first ? 1 - S / whole : 0;
      if (!first) {
        const double V = columns.share[k] * whole;
        eps = V / (V + S);
      }
      all += S;
      if (eps < settings.least_voidage) {
        const double V = first ? whole : columns.share[k] * whole / eps;  // with grains
        last.clipped += (settings.least_voidage - eps) * V;
        eps = settings.least_voidage;
      }
      if (first) {
        columns.share[k] = eps;
      } else {
        const double surface = std::clamp(10 * (columns.fullness[k] - 0.85), 0.0, 1.0);
        const double factor = 1 + surface * (columns.voidage[k] / eps - 1);
        r.density *= factor, columns.start[k].density *= factor;
      }
      columns.voidage[k] = eps;
    }
    if (last.solids > 0) last.volume_error = all / last.solids - 1;
  }

  /// Response of grains to the coming step of dt [s], and their action on each row of the liquid:
  /// -coefficient u' + push. `rates`: accelerations of the liquid by its own pairs and gravity g.
  void find(const SphColumns& columns, const FluidProperties& fluid, const Vec3d& g, double dt,
            const Team& team) {
    const std::size_t n = place.size(), rows = begin_.empty() ? 0 : begin_.size() - 1;
    exchange_.settings = {fluid, MomentumModel::A, g, settings.least_voidage};
    auto& at = exchange_.at;
    at.voidage.assign(n, 0);
    for (auto* of : {&at.velocity, &at.slope, &at.stress}) {
      resize(*of, n);
      for (auto& column : *of) std::fill(column.begin(), column.end(), 0.0);
    }
    team.for_ranges(n, [&](std::size_t, std::size_t from, std::size_t to) {
      for (std::size_t p = from; p < to; ++p) {
        Vec3d u{0, 0, 0}, slope{0, 0, 0};
        for (const Share& s : shares_[p]) {
          const SphRow& r = columns.rows[s.row];
          const double eps = columns.voidage[s.row];
          at.voidage[p] += s.weight * eps;
          u += s.weight * r.velocity();
          // Pressure without the liquid's own weight: the rest of -rho_bar du/dt.
          slope -= (s.weight * eps * r.density) * (columns.rates[s.row].acceleration - g);
        }
        if (!shares_[p].empty()) slope -= fluid.density * g;
        put(at.velocity, p, u), put(at.slope, p, slope);
      }
    });
    const CoupledParticles of = particles();
    if constexpr (Exchange::needs_mean_diameter) {
      DynArray<double> sum(rows);
      find_mean_diameters(of, at.mean_diameter,
                          [&](std::span<const double> from, std::span<double> to) {
                            std::fill(sum.begin(), sum.end(), 0.0);
                            spread(from, sum, team);
                            for (std::size_t p = 0; p < n; ++p) {
                              to[p] = 0;
                              for (const Share& s : shares_[p]) to[p] += s.weight * sum[s.row];
                            }
                          });
    }
    exchange_.check(of, n, 0);
    exchange_.find(of, dt, {}, team);
    if (!(exchange_.gain() < 1))
      throw Error(
          text("Sph: grains are so light, or so close, that the liquid's answer to them grows ",
               exchange_.gain(),
               " times a step; use a shorter step, or resolve them by a finer "
               "spacing"));
    exchange_.give(of, dt, false);
    coefficient.assign(rows, 0), push.assign(rows, {0, 0, 0});
    spread(exchange_.given.coefficient, coefficient, team);
    DynArray<double> one(n), to(rows);
    for (std::size_t d = 0; d < 3; ++d) {
      for (std::size_t p = 0; p < n; ++p) {
        const Vec3d slope = vector_of(at.slope, p) + fluid.density * g;  // of the whole pressure
        const double along[3] = {slope.x, slope.y, slope.z};
        one[p] =
            exchange_.given.offset[d][p] + (exchange_.is_outside(p) ? 0 : volume_[p] * along[d]);
      }
      std::fill(to.begin(), to.end(), 0.0);
      spread(one, to, team);
      for (std::size_t k = 0; k < rows; ++k)
        (d == 0 ? push[k].x : d == 1 ? push[k].y : push[k].z) = to[k];
    }
  }
  DynArray<double> coefficient;  // [kg/s] of each row
  DynArray<Vec3d> push;          // [N]

  /// After the step of the liquid, with the new velocities of its rows: forces on grains.
  void give_back(const SphColumns& columns, const Team& team) {
    const std::size_t n = place.size();
    team.for_ranges(n, [&](std::size_t, std::size_t from, std::size_t to) {
      for (std::size_t p = from; p < to; ++p) {
        Vec3d u{0, 0, 0};
        for (const Share& s : shares_[p]) u += s.weight * columns.rows[s.row].velocity();
        put(exchange_.at.velocity, p, u);
      }
    });
    const CoupledParticles of = particles();
    const Exchanged done = exchange_.take(of, 0, force);
    for (std::size_t p = 0; p < n; ++p) force[p] *= part_[p];
    Vec3d on_liquid{0, 0, 0}, on_grains{0, 0, 0};
    for (std::size_t k = 0; k < push.size(); ++k) {
      if (columns.label[k] == ClusterLists::none) continue;
      const Vec3d f = push[k] - coefficient[k] * columns.rows[k].velocity();
      on_liquid += f;
    }
    for (const Vec3d& f : force) on_grains += f;
    last.exchanged = done.magnitudes;
    for (const Vec3d& f : force) last.exchanged = std::max(last.exchanged, norm(f));
    last.momentum_error = on_grains + on_liquid;
    closure.add(last);
  }

  /// [m/s] of a grain, if known.
  double speed(std::size_t p) const { return p < velocity_.size() ? norm(velocity_[p]) : 0; }

 private:
  struct Share {
    std::uint32_t row;
    double weight;  // [-]
  };
  struct Part {
    std::uint32_t grain;
    double weight;
  };
  CoupledParticles particles() const {
    CoupledParticles of{};
    of.shape.position = place, of.shape.radius = radius_, of.velocity = velocity_;
    of.volume = volume_, of.mass = mass_, of.acceleration = acceleration_;
    of.angular_velocity = spin_;
    return of;
  }
  static void put(ParticleColumns& to, std::size_t p, const Vec3d& v) {
    to[0][p] = v.x, to[1][p] = v.y, to[2][p] = v.z;
  }
  /// [m3/kg] Volume including grains, per mass of a particle.
  static double space(const SphColumns& columns, std::size_t k) {
    return columns.share_of(k) / (columns.voidage_of(k) * columns.rows[k].density);
  }
  template <class Kernel>
  void find_weights(const SphColumns& columns, const ClusterLists& lists,
                    std::span<const std::uint32_t> probe_row, std::size_t width, double mass,
                    double h, const Team& team) {
    constexpr double none = 0.2, whole = 0.5;  // [-] for a full kernel
    shares_.resize(place.size()), part_.resize(place.size());
    const double normalisation = Kernel::normalisation(lists.dimensions, h);
    team.for_ranges(place.size(), [&](std::size_t, std::size_t from, std::size_t to) {
      for (std::size_t p = from; p < to; ++p) {
        auto& shares = shares_[p];
        shares.clear();
        const std::uint32_t row = probe_row[p];
        const Vec3d x = columns.rows[row].position();
        double seen = 0, full = 0;
        const auto weight = [&](const ClusterLists::Entry entry) {  // V W
          const std::size_t k = entry.row();
          if (columns.label[k] == ClusterLists::none) return 0.0;
          const Vec3d r = columns.rows[k].position() + lists.shift(entry.image()) - x;
          return mass * space(columns, k) * normalisation * Kernel::weight(norm(r) / h);
        };
        for (const auto entry : lists.liquid(row / width))
          if (const double w = weight(entry); w > 0) shares.push_back({entry.row(), w}), seen += w;
        for (const auto entry : lists.walls(row / width)) full += weight(entry);
        part_[p] = std::clamp((seen + full - none) / (whole - none), 0.0, 1.0);
        // Next to walls alone there is no liquid.
        part_[p] *= std::min(1.0, seen / (0.1 * none));
        if (!(part_[p] > 0)) shares.clear();
        for (Share& s : shares) s.weight /= seen;
      }
    });
  }
  /// Weights times f by rows; grains of a row are in order.
  void turn_round(std::size_t rows) {
    begin_.assign(rows + 1, 0);
    for (const auto& shares : shares_)
      for (const Share& s : shares) ++begin_[s.row + 1];
    for (std::size_t k = 0; k < rows; ++k) begin_[k + 1] += begin_[k];
    parts_.resize(begin_[rows]);
    DynArray<std::size_t> next(begin_.begin(), begin_.end() - 1);
    for (std::uint32_t p = 0; p < shares_.size(); ++p)
      for (const Share& s : shares_[p]) parts_[next[s.row]++] = {p, part_[p] * s.weight};
  }
  void spread(std::span<const double> of, std::span<double> to, const Team& team) const {
    team.for_ranges(to.size(), [&](std::size_t, std::size_t from, std::size_t end) {
      for (std::size_t k = from; k < end; ++k)
        for (std::size_t j = begin_[k]; j < begin_[k + 1]; ++j)
          to[k] += parts_[j].weight * of[parts_[j].grain];
    });
  }

  Exchange exchange_;
  DynArray<Vec3d> velocity_, acceleration_, spin_;
  DynArray<double> radius_, volume_, mass_;
  DynArray<DynArray<Share>> shares_;  // of each grain, with a sum of 1
  DynArray<double> part_;             // [-] coupling factor f
  DynArray<std::size_t> begin_;
  DynArray<Part> parts_;
};

}  // namespace detail
}  // namespace silt
