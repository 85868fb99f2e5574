// silt - BSD-3-Clause, see LICENSE
#pragma once

// BodyMotion in lanes: packs of bodies that are one part each.

#include <silt/engine/advance/body_motion.hpp>

namespace silt::inline SILT_TARGET::detail {

template <class Composition, class State>
void BodyMotion<Composition, State>::carry_pack(const Scene& scene, const Kick* kick, double time,
                                                std::span<Body> pack, Measured& most) {
  using V = Vec3<Real>;
  static_assert(offsetof(Body, inertia) == 16 * sizeof(double) &&
                offsetof(Body, lever) == 21 * sizeof(double));
  const double* at[W];
  for (std::size_t lane = 0; lane < W; ++lane)
    at[lane] = &pack[std::min(lane, pack.size() - 1)].centre.x;
  Real b[20];  // the numbers of Body, in their order
  gather_columns<Arch, 5>(at, b);
  V centre{b[0], b[1], b[2]}, velocity{b[4], b[5], b[6]}, L{b[12], b[13], b[14]};
  const V inertia{b[16], b[17], b[18]};
  const Real inv_m = b[3], radius = b[7], scale = b[15], zero(0);
  Real q[4] = {b[8], b[9], b[10], b[11]};
  const auto angular = [&](const V& momentum) {
    return body_axes<Real>(q[0], q[1], q[2], q[3])
        .to_space({momentum.x / inertia.x, momentum.y / inertia.y, momentum.z / inertia.z});
  };
  const V velocity_before = velocity, L_before = L;
  if (kick != nullptr) {
    for (std::size_t lane = 0; lane < W; ++lane)
      at[lane] = scene.sums + load_of(pack[std::min(lane, pack.size() - 1)]);
    Real load[8];
    gather_columns<Arch, 2>(at, load);
    for (const Body& body : pack) std::fill_n(scene.sums + load_of(body), 4 * chunks, 0.0);
    if constexpr (decltype(fluid)::any || Modules::push) add_others(pack, load);
    const auto free = inv_m > zero;
    const Real kick_time(kick->time);
    const V g{Real(kick->gravity.x), Real(kick->gravity.y), Real(kick->gravity.z)};
    const V force{load[0], load[1], load[2]}, torque{load[4], load[5], load[6]};
    const V turning = body_axes<Real>(q[0], q[1], q[2], q[3]).to_body(torque);
    velocity = select(free, velocity + kick_time * (inv_m * force + g), velocity);
    V kicked = L;
    Rotation::kick(kicked, turning, inertia, kick_time);
    L = select(free, kicked, L);
  }
  if (time != 0) {
    centre += Real(time) * velocity;
    Rotation::drift(q, L, inertia, Real(time));
  }

  Row4<Arch> moved[4][W], spin[W];
  const auto turned = [&](const V& v, const Real& last, Row4<Arch>(&out)[W]) {
    const Real columns[4] = {v.x, v.y, v.z, last};
    columns_to_rows<Arch>(columns, out);
  };
  turned(centre, inv_m, moved[0]), turned(velocity, radius, moved[1]);
  columns_to_rows<Arch>(q, moved[2]), turned(L, scale, moved[3]);
  const V rate{L.x / inertia.x, L.y / inertia.y, L.z / inertia.z};  // principal
  const auto frame = body_axes<Real>(q[0], q[1], q[2], q[3]);
  turned(radius * frame.to_space(rate), zero, spin);  // the row's radius is the body's
  alignas(64) double speed[W], squared[W];
  {
    for (std::size_t lane = 0; lane < W; ++lane)
      at[lane] = &pack[std::min(lane, pack.size() - 1)].centre.x + 20;  // its last row
    Real lever[4];
    gather_columns<Arch, 1>(at, lever);
    const Real v2 = dot(velocity, velocity);
    store(squared, v2);
    store(speed,
          sqrt(v2) + abs(rate.x) * lever[1] + abs(rate.y) * lever[2] + abs(rate.z) * lever[3]);
  }
  const bool record = kick != nullptr && time == 0;
  alignas(64) double whole[6][W];  // velocity, angular velocity
  if (record) {
    // At the whole step velocities are the means of the two half steps around it.
    const bool of_now = kick->first || Integrator::first_kick != 0.5;
    const V v = of_now ? velocity_before : Real(0.5) * (velocity_before + velocity);
    const V w = angular(of_now ? L_before : Real(0.5) * (L_before + L));
    store(whole[0], v.x), store(whole[1], v.y), store(whole[2], v.z);
    store(whole[3], w.x), store(whole[4], w.y), store(whole[5], w.z);
  }
  for (std::size_t lane = 0; lane < pack.size(); ++lane) {
    Body& body = pack[lane];
    if (body.id == no_particle) continue;
    for (std::size_t r = 0; r < 4; ++r) moved[r][lane].store(&body.centre.x + 4 * r);
    const std::size_t row = row_of(body);
    auto& motion = scene.particles.motion[row];
    const double inv_r = motion.inv_r;
    moved[1][lane].store(&motion.vx), spin[lane].store(&motion.wx);
    motion.inv_m = body.inv_m, motion.inv_r = inv_r;
    if (time != 0) {
      PositionRow& position = scene.particles.position[row];
      const Vec3d now = body.centre + scene.particles.part[row].image;
      position.x = now.x, position.y = now.y, position.z = now.z;
    }
    if (row < convex_rows.pose.size()) convex_rows.pose[row].q = body.orientation;
    most.include(speed[lane]);
    if (scene.per_inner2 != nullptr)
      most.share2 = std::max(most.share2, squared[lane] * scene.per_inner2[row]);
    if (record)
      synchronous[static_cast<std::size_t>(&body - bodies.data())] = {
          {whole[0][lane], whole[1][lane], whole[2][lane]},
          {whole[3][lane], whole[4][lane], whole[5][lane]}};
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
