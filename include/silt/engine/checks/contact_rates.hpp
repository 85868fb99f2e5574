// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include <silt/contact/concept.hpp>
#include <silt/core/dyn_array.hpp>
#include <silt/engine/checks/guard.hpp>
#include <silt/engine/contact/offset.hpp>
#include <silt/engine/contact/shape_inertia.hpp>
#include <silt/motion/concept.hpp>

namespace silt::inline SILT_TARGET::detail {

/// The rates at which spheres oscillate and are damped in their present contacts, times the step.
///
///   K_i = sum_j k (1/m_i + 1/sqrt(m_i m_j)) n n^T, C_i likewise of c; at a wall 1/m_i alone    (1)
///   rate_i = dt (sqrt|K_i| + |C_i|/2), of Gear another: see its rate()                         (2)
///
/// k and c are stiffness and damping of a contact along its normal, obtained from the law's force.
/// The largest |K_i| bounds the square of the highest frequency of the whole packing, since
///
///   k (a - b)^2 <= k (1 + s) a^2 + k (1 + 1/s) b^2,  s = sqrt(m_i/m_j)
///
/// and a lattice whose neighbours oscillate in antiphase reaches the bound. Leapfrog becomes
/// unstable where dt times the frequency is 2; an impact has an error of some 10 % at a rate of
/// 1.25, and gains energy above (docs/stability.md).
///
/// The same holds for rolling and twisting, with the couple per relative rotation, and the inertia
/// I of a sphere whose contact slides, without n n^T.
///
/// The time step limit at the start considers speeds only. This check also detects particles that
/// are compressed or stick, contacts resolved by too few steps, and rolling resistance that is too
/// stiff or too strongly damped. Positions are those of `back` [s] ago.
///
/// Tests: tests/engine/contact_rates.cpp.
struct LinearContact {
  double k;  // [N/m]
  double c;  // [N s/m]
};

/// Stiffness and damping from differences of the law's force at rest, at the present overlap.
template <class Law>
LinearContact linearised(Contact<double> at, const typename Law::template Coefficients<double>& p) {
  const auto force = [&](double overlap, double speed) {
    at.overlap = overlap, at.normal_velocity = speed;
    typename HistoryOf<Law, double>::type none{};
    if constexpr (is_frictional<Law>)
      return law_force<Law, double>(at, p, none).normal;
    else
      return law_force<Law, double>(at, p, none);
  };
  const double d = at.overlap, h = 1e-3 * d;
  at.time_step *= 1e-3;  // c of the law, before leapfrog_damping
  const double k = (force(d + h, 0) - force(d - h, 0)) / (2 * h);
  // Slow enough that the dashpot force stays far below the spring force and no law clips it.
  const double parting = 1e-4 * d * std::sqrt(std::abs(k) * at.inverse_m_eff);  // [m/s]
  const double c = (force(d, 0) - force(d, parting)) / parting;
  return {std::isfinite(k) ? std::max(k, 0.0) : 0.0, std::isfinite(c) ? std::max(c, 0.0) : 0.0};
}

/// The same for the couple of a rolling model [N m/rad], [N m s/rad]; the larger of rolling and
/// twisting. It is evaluated with one, two and four time steps: a spring's contribution grows with
/// the step, a dashpot's does not, and what decreases with the step is excluded. That is
/// RollingContact::against(), which removes an eighth of a slow rotation in each step of any
/// length. With many contacts it may overshoot, but only for rotations so slow that they are
/// damped, as the couple never exceeds the model's.
template <class Law, class Rolling>
LinearContact linearised_rolling(const Contact<double>& at, double normal_force, double inertia,
                                 const typename Law::template Coefficients<double>& law,
                                 const typename Rolling::template Coefficients<double>& p,
                                 double share_of_rolling = 2.0 / 7.0) {
  const Vec3d n = at.normal;
  const Vec3d across = normalised(std::abs(n.x) < 0.7 ? cross(n, {1, 0, 0}) : cross(n, {0, 1, 0}));
  const double slow = 1e-9 / at.time_step;  // [rad/s] too slow to slide
  double stiffness = 0;
  if constexpr (requires { Law::stiffness(at, law); }) stiffness = Law::stiffness(at, law);
  const auto resistance = [&](double step, bool twists) {  // [N m s/rad]
    const RollingContact<double> c{n,
                                   twists ? Vec3d{0, 0, 0} : slow * across,
                                   twists ? slow : 0,
                                   {0, 0, 0},
                                   at.overlap,
                                   normal_force,
                                   stiffness,
                                   at.R_eff,
                                   inertia,
                                   {0, 0, 0},
                                   step,
                                   share_of_rolling};
    Vec3d couple;
    if constexpr (HasHistory<Rolling>) {
      typename Rolling::template History<double> none{};
      couple = Rolling::torque(c, p, none);
    } else {
      couple = Rolling::torque(c, p);
    }
    const double r = -dot(couple, twists ? n : across) / slow;
    return std::isfinite(r) ? r : 0.0;
  };
  LinearContact most{0, 0};
  for (const bool twists : {false, true}) {
    const double one = resistance(at.time_step, twists), two = resistance(2 * at.time_step, twists),
                 four = resistance(4 * at.time_step, twists);
    const double falling = std::max(4 * (four - 3 * two + 2 * one) / 3, 0.0);
    const double k = std::max(two - one + falling / 2, 0.0);
    most.k = std::max(most.k, k / at.time_step), most.c = std::max(most.c, one - k - falling);
  }
  return most;
}

/// Sum of w n n^T of one sphere.
struct NormalSum {
  double xx = 0, yy = 0, zz = 0, xy = 0, yz = 0, zx = 0;
  void add(double w, const Vec3d& n) {
    xx += w * n.x * n.x, yy += w * n.y * n.y, zz += w * n.z * n.z;
    xy += w * n.x * n.y, yz += w * n.y * n.z, zx += w * n.z * n.x;
  }
  /// Upper bound of the largest eigenvalue: the largest row sum.
  double bound() const {
    const double a = std::abs(xy), b = std::abs(yz), c = std::abs(zx);
    return std::max({xx + a + c, yy + a + b, zz + b + c});
  }
};

/// The sums (1) of all particles. For bodies, K bounds translation and rotation together: a contact
/// whose normal has the lever r x n about the centre of mass adds k (r x n) I^-1 (r x n).
template <class EngineType, class Domain>
class ContactRates {
 public:
  ContactRates(const EngineType& e, const Domain& domain, double back, double time_step)
      : e_(e),
        back_(back),
        time_step_(time_step),
        sums_(EngineType::of_ranks ? e.particles.size() : e.owners()) {
    if constexpr (EngineType::convex)
      add_convex(domain);
    else
      add_spheres(domain);
  }

  /// Throws SimulationError if a sphere's rate is above the limit.
  void check(std::int64_t step, double time, double limit) const {
    std::size_t worst = 0;
    double most = 0;
    for (std::size_t k = 0; k < e_.owners(); ++k)  // ghosts are checked on their own ranks
      if (const double r = rate(k); r > most) most = r, worst = k;
    if (most <= limit) return;
    const std::size_t row = sums_[worst].row;
    const Vec3d where = place_before(e_, row, back_);
    throw SimulationError(
        sentence("step ", step, ", t = ", time, " s: the contacts of particle ", e_.id_of(row),
                 " near ", where, " m are too stiff or too strongly damped for the time step ",
                 time_step_, " s: rate ", most, ", above guard.max_rate = ", limit,
                 "; set Simulation::time_step to less than ", below(step_for(worst, limit)),
                 " s, or soften the material"),
        step, {e_.id_of(row)}, where);
  }
  double rate(std::size_t k) const { return rate_in(k, time_step_); }

 private:
  double rate_in(std::size_t k, double step) const {
    using I = typename EngineType::IntegratorType;
    const Sums& s = sums_[k];
    return std::max(
        rate_of<I>(step * std::sqrt(s.k.bound() + s.turning.k), step * (s.c.bound() + s.turning.c)),
        rate_of<I>(step * std::sqrt(s.rolling.k), step * s.rolling.c));
  }
  /// [s] time step at which the rate equals the limit.
  double step_for(std::size_t k, double limit) const {
    double low = 0, high = time_step_;
    for (int halving = 0; halving < 60; ++halving) {
      const double middle = 0.5 * (low + high);
      (rate_in(k, middle) > limit ? high : low) = middle;
    }
    return low;
  }
  using Inertia = InertiaOf<typename EngineType::Contacts>;
  using Law = typename EngineType::Contacts::Law;
  using Rolling = typename EngineType::Contacts::Rolling;
  static constexpr bool rolls = EngineType::Contacts::has_rolling && !of_own_rotation<Rolling>;
  struct Sums {
    NormalSum k, c;
    LinearContact turning{0, 0};  // of bodies, divided by the inertia
    LinearContact rolling{0, 0};  // divided by the inertia
    std::uint32_t row = 0;        // one of the particle's rows
  };
  struct Pair {
    LinearContact normal, rolling;
  };

  void add_spheres(const Domain& domain) {
    e_.lists.pairs.for_each([&](std::size_t k) { add_pair(k, domain); });
    for_each_wall_contact(e_, back_, [&](const WallCandidate& c, const SurfacePoint& point) {
      const double r = e_.particles.position[c.particle].r, depth = r - point.distance;
      const double inv_m = e_.particles.motion[c.particle].inv_m;
      if (inv_m > 0 && depth > 0)
        add(c.particle, inv_m, 0, point.normal, e_.turning(c.particle, point.normal), 0,
            linear(c.particle, e_.walls[c.wall].material, point.normal, depth, {r, 0}, inv_m,
                   inv_m / (Inertia::rolling() * r * r)));
    });
  }
  void add_convex([[maybe_unused]] const Domain& domain) {
    if constexpr (EngineType::convex)
      for_each_convex_contact(e_, domain, back_, [&](const SeenContact& c) {
        const double R = 2 * c.R_eff, a = e_.particles.motion[c.i].inv_m;
        const double all = c.inverse_mass_i + c.inverse_mass_j;
        if (all == 0) return;  // a fixed body at a driven wall
        if (c.j == no_place)
          return add(
              c.i, a, 0, c.normal, c.inverse_mass_i - a, 0,
              linear(c.i, e_.walls[c.wall].material, c.normal, c.overlap, {c.R_eff, 0}, all, all));
        const double b = e_.particles.motion[c.j].inv_m;
        std::size_t other = 0;
        if constexpr (EngineType::Contacts::several_materials) other = e_.particles.material[c.j];
        const Pair contact = linear(c.i, other, c.normal, c.overlap, {R, R}, all, all);
        const double both = std::sqrt(a * b);
        const double turn_both = std::sqrt(c.inverse_mass_i * c.inverse_mass_j) - both;
        add(c.i, a, both, c.normal, c.inverse_mass_i - a, turn_both, contact);
        add(c.j, b, both, c.normal, c.inverse_mass_j - b, turn_both, contact);
      });
  }
  void add_pair(std::size_t k, [[maybe_unused]] const Domain& domain) {
    const std::uint32_t i = e_.lists.pairs.first()[k], j = e_.lists.pairs.second()[k];
    const double r = e_.particles.position[i].r, q = e_.particles.position[j].r;
    const double a = e_.particles.motion[i].inv_m, b = e_.particles.motion[j].inv_m;
    Vec3d d = place_before(e_, i, back_) - place_before(e_, j, back_);
    if constexpr (Domain::periodic) d = domain.shortest(d);
    const double distance = norm(d), depth = r + q - distance - offset_of_pair(e_, k);
    if (!(depth > 0 && distance > 0 && a + b > 0)) return;
    const Vec3d n = d * (1 / distance);
    std::size_t other = 0;
    if constexpr (EngineType::Contacts::several_materials) other = e_.particles.material[j];
    const auto contact =
        linear(i, other, n, depth, {r, q}, a + b, (a / (r * r) + b / (q * q)) / Inertia::rolling());
    const double both = std::sqrt(a * b);
    const double turn_i = e_.turning(i, n), turn_j = e_.turning(j, n);
    const double turn_both = std::sqrt((a + turn_i) * (b + turn_j)) - both;
    add(i, a, both, n, turn_i, turn_both, contact), add(j, b, both, n, turn_j, turn_both, contact);
  }
  /// `radii` [m]; the second is 0 for a wall.
  Pair linear(std::size_t i, std::size_t other, const Vec3d& n, double depth,
              std::array<double, 2> radii, double inv_m,
              [[maybe_unused]] double inv_inertia) const {
    std::size_t own = 0;
    if constexpr (EngineType::Contacts::several_materials) own = e_.particles.material[i];
    const auto& table = e_.coefficients;
    const std::size_t kind = own * table.materials + other;
    Contact<double> c{};
    const auto [r, q] = radii;
    c.normal = n, c.overlap = depth, c.R_eff = q > 0 ? r * q / (r + q) : r;
    c.m_eff = 1 / inv_m, c.inverse_m_eff = inv_m, c.radius_i = r, c.radius_j = q;
    c.time_step = time_step_, c.slip_mobility = Inertia::slip_mobility();
    Pair out{linearised<Law>(c, table.law[kind]), {0, 0}};
    if constexpr (rolls)
      out.rolling = linearised_rolling<Law, Rolling>(c, out.normal.k * depth, 1 / inv_inertia,
                                                     table.law[kind], table.rolling[kind],
                                                     Inertia::share_of_rolling());
    return out;
  }
  void add(std::size_t i, double inv_m, double both, const Vec3d& n, double turn, double turn_both,
           const Pair& pair) {
    const double r = e_.particles.position[i].r, w = inv_m + both;
    Sums& s = sums_[e_.owner_of(i)];
    s.row = static_cast<std::uint32_t>(i);
    s.k.add(pair.normal.k * w, n), s.c.add(pair.normal.c * w, n);
    s.turning.k += pair.normal.k * (turn + turn_both);
    s.turning.c += pair.normal.c * (turn + turn_both);
    // Both spheres of a pair receive the couple: as in (1), with inertia in place of mass.
    const double inertia = Inertia::factor() * r * r;  // [m2] divided by the mass
    s.rolling.k += pair.rolling.k * w / inertia;
    s.rolling.c += pair.rolling.c * w / inertia;
  }

  const EngineType& e_;
  double back_, time_step_;
  DynArray<Sums> sums_;
};

}  // namespace silt::detail
