// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cstddef>

#include <silt/core/lanes.hpp>
#include <silt/fluid/level_rows.hpp>

/// Loops over single rows of the flow solver's fields.
namespace silt::inline SILT_TARGET::fluid_detail {

/// Calls body.operator()<Real>(i) for i = from ... to-1: by packs, then one by one.
template <class Body>
SILT_INLINE void for_row(int from, int to, const Body& body) {
  using Packed = Lanes<DefaultArch>::Real;
  constexpr int width = static_cast<int>(Lanes<DefaultArch>::width);
  int i = from;
  if constexpr (width > 1)
    for (; i + width <= to; i += width) body.template operator()<Packed>(i);
  for (; i < to; ++i) body.template operator()<double>(i);
}

/// Velocity differences, over the advecting velocity, that count as smooth [-].
inline constexpr double smooth_difference = 0.1;

/// Flux of q through the face between `m` and `0`, with the flow `f` towards 0: upwind, with the
/// mean of both slopes (Fromm) where q is smooth, including extrema, and with van Albada's limited
/// slope at jumps. Source: G. D. van Albada, B. van Leer, W. W. Roberts, Astron. Astrophys. 108
/// (1982) 76.
template <class Real>
SILT_INLINE Real flux(const Real& f, const Real& mm, const Real& m, const Real& q0, const Real& p) {
  const auto forward = f > Real(0);
  const Real near = select(forward, m, q0), far = select(forward, q0, m);
  const Real a = far - near, b = near - select(forward, mm, p);
  const Real small = Real(smooth_difference * smooth_difference) * f * f + smallest<Real>();
  const Real slope = (max(a * b, Real(0)) + small) * (a + b) / (a * a + b * b + Real(2) * small);
  return f * (near + Real(0.5) * slope);
}

/// Data of a row of one velocity component for a stage: pointers to value i = 0 of the row.
struct StageRow {
  const double* q;         // [m/s] the component, of the stage
  const double* flow[3];   // [m/s] superficial velocities that carry it, on their faces
  const double* spread;    // [1/s] divergence of the velocity, in cells
  std::ptrdiff_t step[3];  // from a value to the next in each direction
  std::ptrdiff_t own;      // step in the direction of the component
  const double* flow_own;  // [m/s] `flow` in that direction
  double over_h[3];        // [1/m]
  double over_own;         // [1/m] in that direction
  double density, viscosity, per_step;  // [kg/m3], [Pa s], [kg/(m3 s)] density over time step
  bool averaged, second;                // model A; the second stage
  // At the start of the step; eps, m, m', K, K v, s, p.
  const double *u, *eps, *mass, *next_mass, *drag, *drag_v, *force, *pressure;
  const double* borne;  // [-] of ParticleResponse; null: 0
  // In a box with solids: see FlowSolids.
  const double *area, *inside, *thin, *wall_drag, *wall_push, *wall_velocity;
  // In turbulence: eddy viscosity in cells [Pa s], velocities of all components, faces where eddies
  // act, and the drag of walls beyond the laminar one.
  const double* eddy;
  const double *all[3], *reached[3], *edges[3];
  const double *turbulent_drag, *turbulent_push;
  double *to, *tendency, *weight;
  double* stress;  // [N/m3] div tau, mean of the stages; null if not stored
};

/// Advection and viscosity of value i [N/m3]: -rho div(F q), and mu (lap q + 1/3 grad div u). In
/// solids there is no advected velocity: the nearest value of q is used.
template <class Real, bool Walled>
SILT_INLINE void explicit_terms(const StageRow& r, int i, Real& advection, Real& viscous) {
  const auto at = [&](const double* c, std::ptrdiff_t s) { return load_any<Real>(c + i + s); };
  const auto q = [&](std::ptrdiff_t s) { return at(r.q, s); };
  const Real q0 = q(0), half(0.5);
  Real div(0), lap(0), net(0);
  for (int e = 0; e < 3; ++e) {
    const std::ptrdiff_t s = r.step[e];
    const auto flow = [&](std::ptrdiff_t to) {
      return half * (at(r.flow[e], to - r.own) + at(r.flow[e], to));
    };
    Real mm = q(-2 * s), m = q(-s), p = q(s), pp = q(2 * s);
    const Real over(r.over_h[e]), in = flow(0), out = flow(s);
    if constexpr (Walled) {
      const auto beside = [&](std::ptrdiff_t to, const Real& value) {  // for viscosity
        return select(at(r.inside, to) > Real(0), value, at(r.wall_velocity, to));
      };
      lap += (over * over) * ((beside(s, p) - q0) - (q0 - beside(-s, m)));
      const auto carried = [&](std::ptrdiff_t to, const Real& value, const Real& before) {
        return select(at(r.area, to) > Real(0), value, before);
      };
      p = carried(s, p, q0), m = carried(-s, m, q0);
      pp = carried(2 * s, pp, p), mm = carried(-2 * s, mm, m);
      net += over * (out - in);
    } else {
      lap += (over * over) * ((p - q0) - (q0 - m));
    }
    div += over * (flux(out, m, q0, p, pp) - flux(in, mm, m, q0, p));
  }
  const Real squeeze = Real(r.over_own / 3) * (at(r.spread, 0) - at(r.spread, -r.own));
  if constexpr (Walled) {
    const auto mean = [&](const double* c) { return half * (at(c, -r.own) + at(c, 0)); };
    const Real less = Real(r.per_step / r.density) * (mean(r.mass) - mean(r.next_mass));
    div = (Real(1) + at(r.thin, 0)) * (div - q0 * net) + q0 * less;
  }
  advection = Real(-r.density) * div;
  viscous = Real(r.viscosity) * (lap + squeeze);
}

/// div (mu_t (grad u + grad u')) of value i [N/m3].
template <class Real>
SILT_INLINE Real eddy_term(const StageRow& r, int i) {
  const auto at = [&](const double* c, std::ptrdiff_t s) { return load_any<Real>(c + i + s); };
  const auto q = [&](std::ptrdiff_t s) { return at(r.q, s); };
  Real sum(0);
  for (int e = 0; e < 3; ++e) {
    const std::ptrdiff_t s = r.step[e];
    const Real over(r.over_h[e]);
    if (s == r.own) {
      const auto pull = [&](std::ptrdiff_t low) {  // of the cell above value `low`
        return Real(2) * at(r.eddy, low) * over * (q(low + s) - q(low));
      };
      sum += over * (at(r.reached[e], s) * pull(0) - at(r.reached[e], -s) * pull(-s));
      continue;
    }
    const double *const v = r.all[e], *const of = r.reached[e];
    const auto pull = [&](std::ptrdiff_t low) {  // of the edge between values `low` and next
      const std::ptrdiff_t high = low + s, back = high - r.own;
      const Real mu = Real(0.25) * ((at(r.eddy, low) + at(r.eddy, low - r.own)) +
                                    (at(r.eddy, high) + at(r.eddy, back)));
      const Real across = Real(r.over_own) * (at(v, high) - at(v, back));
      return mu * at(r.edges[e], low) *
             (over * (q(high) - q(low)) + at(of, high) * at(of, back) * across);
    };
    sum += over * (pull(0) - pull(-s));
  }
  return sum;
}

/// Values from ... to-1 of a stage: (4) of FlowSolver.
template <bool Walled, bool Turbulent>
SILT_ONE_COPY void stage_row(const StageRow& row, int from, int to) {
  const StageRow r = row;  // a local copy, not changed by stores
  for_row(from, to, [&]<class Real>(int i) {
    const Real half(0.5);
    const auto at = [&](const double* c) { return load_any<Real>(c + i); };
    const auto mean = [&](const double* c) {
      return half * (load_any<Real>(c + i - r.own) + at(c));
    };
    const Real eps_f = r.averaged ? mean(r.eps) : Real(1);
    Real advection, viscous;
    explicit_terms<Real, Walled>(r, i, advection, viscous);
    if constexpr (Turbulent) viscous += eddy_term<Real>(r, i);
    if constexpr (Walled) viscous = viscous * at(r.inside);  // slivers have their own
    const Real share = r.borne != nullptr ? eps_f + mean(r.borne) : eps_f;
    Real t = advection + share * viscous;
    if (r.second)
      t = half * (at(r.tendency) + t);
    else
      store_any(r.tendency + i, t);
    Real D = Real(r.per_step) * mean(r.next_mass) + mean(r.drag);
    const Real slope = Real(r.over_own) * (at(r.pressure) - load_any<Real>(r.pressure + i - r.own));
    Real driven = Real(r.per_step) * mean(r.mass) * at(r.u) + t - share * slope + mean(r.drag_v) +
                  mean(r.force);
    if constexpr (Walled) {
      D += eps_f * at(r.wall_drag);
      driven += eps_f * at(r.wall_push);
    }
    if constexpr (Turbulent) {
      D += eps_f * at(r.turbulent_drag);
      driven += eps_f * at(r.turbulent_push);
    }
    const Real over_D = Real(1) / D;
    if (r.stress != nullptr)
      store_any(r.stress + i, r.second ? half * (at(r.stress) + viscous) : viscous);
    Real u = over_D * driven, weight = share * over_D;
    if constexpr (Walled) {
      const auto open = at(r.area) > Real(0);
      u = select(open, u, at(r.wall_velocity)), weight = select(open, weight, Real(0));
    }
    store_any(r.to + i, u);
    if (r.second) store_any(r.weight + i, weight);
  });
}

/// Value i of a stage, on an Outflow: what flows in there comes from fluid at rest and carries no
/// momentum, as explicit_terms() has it. `way` 1: at the lower end, -1: at the upper one.
template <bool Walled, bool Turbulent>
SILT_ONE_COPY void enter_at_rest(const StageRow& r, int i, int way) {
  const double in = 0.5 * way * (r.flow_own[i - r.own] + r.flow_own[i]);
  if (!(in > 0) || (Walled && !(r.area[i] > 0))) return;
  const auto mean = [&](const double* c) { return 0.5 * (c[i - r.own] + c[i]); };
  const double eps_f = r.averaged ? mean(r.eps) : 1;
  double t = -r.density * r.over_own * in * r.q[i];
  double D = r.per_step * mean(r.next_mass) + mean(r.drag);
  if constexpr (Walled) t *= 1 + r.thin[i], D += eps_f * r.wall_drag[i];
  if constexpr (Turbulent) D += eps_f * r.turbulent_drag[i];
  if (!r.second) r.tendency[i] += t;
  r.to[i] += (r.second ? 0.5 : 1) * t / D;
}

/// Values from ... to-1 of a stage, all in solids.
inline void leave_closed(const StageRow& r, int from, int to) {
  for (int i = from; i < to; ++i) {
    r.to[i] = r.wall_velocity[i];
    if (r.second) r.weight[i] = 0;
    if (r.stress != nullptr) r.stress[i] = 0;
  }
}

}  // namespace silt::fluid_detail
