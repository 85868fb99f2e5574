// silt - BSD-3-Clause, see LICENSE
#pragma once

// BodyMotion in SIMD lanes: packs of bodies that consist of one part.

#include <silt/engine/advance/body_motion.hpp>

namespace silt::inline SILT_TARGET::detail {

/// The state of W bodies; missing ones are copies of the last.
template <class Composition, class State>
struct BodyMotion<Composition, State>::Pack {
  using V = Vec3<Real>;
  V centre, velocity, momentum, inertia;  // of Body
  Real inv_m, radius, scale;
  Real q[4];

  explicit Pack(std::span<const Body> bodies) {
    static_assert(offsetof(Body, inertia) == 16 * sizeof(double) &&
                  offsetof(Body, lever) == 21 * sizeof(double));
    Real b[20];  // in the order of Body's members
    gather<5>([&](std::size_t lane) { return &bodies[lane].centre.x; }, bodies.size(), b);
    centre = {b[0], b[1], b[2]}, inv_m = b[3], velocity = {b[4], b[5], b[6]}, radius = b[7];
    for (std::size_t c = 0; c < 4; ++c) q[c] = b[8 + c];
    momentum = {b[12], b[13], b[14]}, scale = b[15], inertia = {b[16], b[17], b[18]};
  }
  template <std::size_t Rows, class At>
  static SILT_INLINE void gather(const At& at, std::size_t count, Real (&out)[4 * Rows]) {
    const double* rows[W];
    SILT_UNROLL
    for (std::size_t lane = 0; lane < W; ++lane) rows[lane] = at(std::min(lane, count - 1));
    gather_columns<Arch, Rows>(rows, out);
  }
  /// [rad/s] about the principal axes
  SILT_INLINE V rate(const V& of) const {
    return {of.x / inertia.x, of.y / inertia.y, of.z / inertia.z};
  }
  SILT_INLINE auto axes() const { return body_axes<Real>(q[0], q[1], q[2], q[3]); }
};

template <class Composition, class State>
void BodyMotion<Composition, State>::carry_pack(const Scene& scene, const Kick* kick, double time,
                                                std::span<Body> pack, Measured& most) {
  using V = Vec3<Real>;
  Pack now(pack);
  const bool record = kick != nullptr && time == 0;
  const V velocity_before = now.velocity, momentum_before = now.momentum;
  if (kick != nullptr) kick_pack(scene, *kick, pack, now);
  if (record) {
    // Velocities at the whole step are the means of the two half steps around it.
    const bool of_now = kick->first || Integrator::first_kick != 0.5;
    const V v = of_now ? velocity_before : Real(0.5) * (velocity_before + now.velocity);
    const V L = of_now ? momentum_before : Real(0.5) * (momentum_before + now.momentum);
    record_pack(pack, v, now.axes().to_space(now.rate(L)));
  }
  const V rate = now.rate(now.momentum);  // before the drift, as in steps that are observed
  if (time != 0) {
    now.centre += Real(time) * now.velocity;
    Rotation::drift(now.q, now.momentum, now.inertia, Real(time));
  }
  place_pack(scene, now, rate, time != 0, pack, most);
}

template <class Composition, class State>
void BodyMotion<Composition, State>::kick_pack(const Scene& scene, const Kick& kick,
                                               std::span<const Body> pack, Pack& now) const {
  using V = Vec3<Real>;
  Real load[8];
  Pack::template gather<2>([&](std::size_t lane) { return scene.sums + load_of(pack[lane]); },
                           pack.size(), load);
  for (const Body& body : pack) std::fill_n(scene.sums + load_of(body), 4 * chunks, 0.0);
  if constexpr (decltype(fluid)::any || Modules::push) add_others(pack, load);
  const auto free = now.inv_m > Real(0);
  const Real kick_time(kick.time);
  const V g{Real(kick.gravity.x), Real(kick.gravity.y), Real(kick.gravity.z)};
  const V force{load[0], load[1], load[2]}, torque{load[4], load[5], load[6]};
  const V turning = now.axes().to_body(torque);
  now.velocity = select(free, now.velocity + kick_time * (now.inv_m * force + g), now.velocity);
  V kicked = now.momentum;
  Rotation::kick(kicked, turning, now.inertia, kick_time);
  now.momentum = select(free, kicked, now.momentum);
}

/// Stores velocities [m/s] and angular velocities [rad/s] as those of the whole step.
template <class Composition, class State>
void BodyMotion<Composition, State>::record_pack(std::span<const Body> pack, const Vec3<Real>& v,
                                                 const Vec3<Real>& w) {
  alignas(64) double whole[6][W];
  store(whole[0], v.x), store(whole[1], v.y), store(whole[2], v.z);
  store(whole[3], w.x), store(whole[4], w.y), store(whole[5], w.z);
  const auto first = static_cast<std::size_t>(pack.data() - bodies.data());
  for (std::size_t lane = 0; lane < pack.size(); ++lane)
    if (pack[lane].id != no_particle)
      synchronous[first + lane] = {{whole[0][lane], whole[1][lane], whole[2][lane]},
                                   {whole[3][lane], whole[4][lane], whole[5][lane]}};
}

/// Writes a pack back, and the motion of its rows; `moved`: their positions too. `kicked` [rad/s]:
/// about the principal axes, of which the speeds are measured.
template <class Composition, class State>
void BodyMotion<Composition, State>::place_pack(const Scene& scene, const Pack& now,
                                                const Vec3<Real>& kicked, bool moved,
                                                std::span<Body> pack, Measured& most) {
  using V = Vec3<Real>;
  Row4<Arch> moving[4][W], spin[W];
  const auto turned = [&](const V& v, const Real& last, Row4<Arch>(&out)[W]) {
    const Real columns[4] = {v.x, v.y, v.z, last};
    columns_to_rows<Arch>(columns, out);
  };
  turned(now.centre, now.inv_m, moving[0]), turned(now.velocity, now.radius, moving[1]);
  columns_to_rows<Arch>(now.q, moving[2]), turned(now.momentum, now.scale, moving[3]);
  const V rate = now.rate(now.momentum);
  // The row's radius is the body's.
  turned(now.radius * now.axes().to_space(rate), Real(0), spin);
  Real lever[4];  // last row of Body
  Pack::template gather<1>([&](std::size_t lane) { return &pack[lane].centre.x + 20; }, pack.size(),
                           lever);
  const Real v2 = dot(now.velocity, now.velocity);
  alignas(64) double speed[W], squared[W];
  store(squared, v2);
  store(speed,
        sqrt(v2) + abs(kicked.x) * lever[1] + abs(kicked.y) * lever[2] + abs(kicked.z) * lever[3]);
  for (std::size_t lane = 0; lane < pack.size(); ++lane) {
    Body& body = pack[lane];
    if (body.id == no_particle) continue;
    for (std::size_t r = 0; r < 4; ++r) moving[r][lane].store(&body.centre.x + 4 * r);
    const std::size_t row = row_of(body);
    auto& motion = scene.particles.motion[row];
    const double inv_r = motion.inv_r;
    moving[1][lane].store(&motion.vx), spin[lane].store(&motion.wx);
    motion.inv_m = body.inv_m, motion.inv_r = inv_r;
    if (moved) {
      PositionRow& position = scene.particles.position[row];
      if constexpr (flows) {
        const Vec3d own = body.velocity - flow.at(position.centre());
        squared[lane] = dot(own, own);
      }
      const Vec3d at = body.centre + scene.particles.part[row].image;
      position.x = at.x, position.y = at.y, position.z = at.z;
    }
    if (row < convex_rows.pose.size()) convex_rows.pose[row].q = body.orientation;
    most.include(speed[lane]);
    if (scene.per_inner2 != nullptr)
      most.share2 = std::max(most.share2, squared[lane] * scene.per_inner2[row]);
  }
}

template <class Composition, class State>
void BodyMotion<Composition, State>::add_others(std::span<const Body> pack, Real (&load)[8]) const {
  const auto first = static_cast<std::size_t>(pack.data() - bodies.data());
  const auto add = [&](const AlignedVector<VectorRow>& column, std::size_t to) {
    const double* at[W];
    for (std::size_t lane = 0; lane < W; ++lane)
      at[lane] = &column[first + std::min(lane, pack.size() - 1)].x;
    Real more[4];
    gather_columns<Arch, 1>(at, more);
    for (std::size_t c = 0; c < 3; ++c) load[to + c] += more[c];
  };
  if constexpr (decltype(fluid)::any) add(fluid.force, 0);
  if constexpr (decltype(fluid)::turns) add(fluid.torque, 4);
  if constexpr (Modules::push) add(modules.force, 0);
  if constexpr (Modules::turn) add(modules.torque, 4);
}

template <class Composition, class State>
void BodyMotion<Composition, State>::turn(std::span<Body> pack, double time) {
  Real q[4], momentum[4], inertia[4];
  if constexpr (turns_in_lanes) {
    const double* at[3][W];
    for (std::size_t lane = 0; lane < W; ++lane) {
      const Body& b = pack[std::min(lane, pack.size() - 1)];
      at[0][lane] = &b.orientation.w, at[1][lane] = &b.momentum.x, at[2][lane] = &b.inertia.x;
    }
    gather_columns<Arch, 1>(at[0], q);
    gather_columns<Arch, 1>(at[1], momentum), gather_columns<Arch, 1>(at[2], inertia);
    Vec3<Real> L{momentum[0], momentum[1], momentum[2]};
    Rotation::drift(q, L, Vec3<Real>{inertia[0], inertia[1], inertia[2]}, Real(time));
    alignas(64) double out[7][W];
    for (int c = 0; c < 4; ++c) store(out[c], q[c]);
    store(out[4], L.x), store(out[5], L.y), store(out[6], L.z);
    for (std::size_t lane = 0; lane < pack.size(); ++lane) {
      pack[lane].orientation = {out[0][lane], out[1][lane], out[2][lane], out[3][lane]};
      pack[lane].momentum = {out[4][lane], out[5][lane], out[6][lane]};
    }
  } else {
    for (Body& b : pack) Rotation::drift(b.orientation, b.momentum, b.inertia, time);
  }
}

}  // namespace silt::detail
