// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <type_traits>
#include <unordered_map>
#include <utility>

#include <silt/core/dyn_array.hpp>
#include <silt/core/position_row.hpp>
#include <silt/core/quaternion.hpp>
#include <silt/engine/ranks/packed.hpp>
#include <silt/engine/state/body.hpp>

// Bodies on several ranks. They are sent as a whole, with the rows of all their parts. All ranks
// have the same forms and therefore know the parts of a body.

namespace silt::inline SILT_TARGET::detail {

/// Number of owned particles present: spheres, or bodies.
template <class State>
std::size_t present_in(const State& particles) {
  if constexpr (State::of_bodies) {
    std::size_t count = 0;
    for (std::size_t k = 0; k < particles.owned(); ++k)
      count += !particles.is_parked(k) && particles.part[k].local == 0;
    return count;
  } else {
    return particles.owned() - particles.parked;
  }
}

/// Positions and work of owned particles, from the work of their rows.
template <class State, class Mover>
class OwnParticles {
 public:
  DynArray<Vec3d> points;    // [m]
  DynArray<double> weights;  // [-]

  OwnParticles(const State& particles, [[maybe_unused]] const Mover& mover,
               std::span<const double> of_rows)
      : particles_(particles) {
    if constexpr (State::of_bodies) {
      place_.assign(mover.owned(), 0);
      for (std::size_t b = 0; b < mover.owned(); ++b)
        if (mover.bodies[b].id != no_particle) add(b, mover.bodies[b].centre, 0);
      for (std::size_t k = 0; k < particles.owned(); ++k)
        if (!particles.is_parked(k)) weights[place_of(k)] += of_rows[k];
    } else {
      place_.assign(particles.owned(), 0);
      for (std::size_t k = 0; k < particles.owned(); ++k)
        if (!particles.is_parked(k)) add(k, particles.position[k].centre(), of_rows[k]);
    }
  }
  /// The index in points of the particle of a present row.
  std::size_t place_of(std::size_t row) const {
    if constexpr (State::of_bodies)
      return place_[particles_.part[row].body];
    else
      return place_[row];
  }

 private:
  void add(std::size_t k, const Vec3d& centre, double weight) {
    place_[k] = points.size();
    points.push_back(centre), weights.push_back(weight);
  }
  const State& particles_;
  DynArray<std::size_t> place_;
};

/// What ghosts receive of a row in each step. Quantities computed from a body's state are sent
/// rather than recomputed, so that they are bitwise equal whatever the compiler does.
template <class State, class Mover>
struct RowState {
  PositionRow position;
  typename State::ParticleMotion motion;

  static RowState of(const State& particles, const Mover&, std::uint32_t k) {
    return {particles.position[k], particles.motion[k]};
  }
  void give(State& particles, Mover&, std::uint32_t k) const {
    particles.position[k] = position, particles.motion[k] = motion;
    particles.renew_pair_motion(k);
  }
};
template <class State, class Mover>
requires(Mover::has_levers) struct RowState<State, Mover> {
  PositionRow position;
  typename State::ParticleMotion motion;
  Quaternion q;      // orientation in PoseRow
  Quaternion lever;  // orientation in LeverRow
  Vec3d offset;

  static RowState of(const State& particles, const Mover& mover, std::uint32_t k) {
    RowState row{particles.position[k], particles.motion[k], {}, {}, {0, 0, 0}};
    const auto& convex = mover.convex_rows;
    if (k < convex.pose.size())
      row.q = convex.pose[k].q, row.lever = convex.lever[k].q, row.offset = convex.lever[k].offset;
    return row;
  }
  void give(State& particles, Mover& mover, std::uint32_t k) const {
    particles.position[k] = position, particles.motion[k] = motion;
    auto& convex = mover.convex_rows;
    if (k < convex.pose.size())
      convex.pose[k].q = q, convex.lever[k].q = lever, convex.lever[k].offset = offset;
  }
};
template <class State, class Mover>
requires(State::bonded) struct RowState<State, Mover> {
  PositionRow position;
  typename State::ParticleMotion motion;
  Quaternion orientation;

  static RowState of(const State& particles, const Mover&, std::uint32_t k) {
    return {particles.position[k], particles.motion[k], particles.orientation[k]};
  }
  void give(State& particles, Mover&, std::uint32_t k) const {
    particles.position[k] = position, particles.motion[k] = motion;
    particles.orientation[k] = orientation;
    particles.renew_pair_motion(k);
  }
};
/// What ghosts receive of a body in each step.
struct BodyState {
  Vec3d centre, velocity;
  Quaternion orientation;
  Vec3d momentum;

  template <class Mover>
  static BodyState of(const Mover& mover, std::uint32_t k) {
    const Body& b = mover.bodies[k];
    return {b.centre, b.velocity, b.orientation, b.momentum};
  }
  template <class Mover>
  void give(Mover& mover, std::uint32_t k) const {
    Body& b = mover.bodies[k];
    b.centre = centre, b.velocity = velocity, b.orientation = orientation, b.momentum = momentum;
    if constexpr (Mover::convex && !Mover::has_levers)  // PoseRow of its only part
      if (const std::uint32_t row = mover.rows_of(b)[0]; row < mover.convex_rows.pose.size())
        mover.convex_rows.pose[row].q = orientation;
  }
};

/// Adds the rows of the other parts of their bodies to a sorted set of rows.
template <class State, class Mover>
void take_whole_bodies(const State& particles, const Mover& mover, DynArray<std::uint32_t>& rows) {
  if (rows.empty()) return;
  DynArray<bool> is_taken(mover.bodies.size(), false);
  for (const std::uint32_t k : rows) is_taken[particles.part[k].body] = true;
  rows.clear();
  for (std::uint32_t k = 0; k < particles.owned(); ++k)
    if (!particles.is_parked(k) && is_taken[particles.part[k].body]) rows.push_back(k);
}

/// The bodies of some rows, in the same order.
template <class State>
DynArray<std::uint32_t> bodies_of_rows(const State& particles,
                                       std::span<const std::uint32_t> rows) {
  DynArray<std::uint32_t> bodies;
  std::unordered_map<std::uint32_t, bool> is_known;
  for (const std::uint32_t k : rows)
    if (const std::uint32_t b = particles.part[k].body; !std::exchange(is_known[b], true))
      bodies.push_back(b);
  return bodies;
}

/// The bodies of the rows to be packed next.
template <class State, class Mover>
void pack_bodies(const State& particles, Mover& mover, std::span<const std::uint32_t> rows,
                 Packed& out) {
  const auto bodies = bodies_of_rows(particles, rows);
  out.put(bodies.size());
  for (const std::uint32_t b : bodies) {
    out.put(b), out.put(mover.bodies[b]);
    pack_row(mover.fluid, b, out), pack_row(mover.modules, b, out);
  }
}
/// Takes in bodies that have arrived, to which the following rows belong.
template <class Mover>
class BodiesThatCome {
 public:
  BodiesThatCome(Mover& mover, Unpacked& from) {
    for (auto n = from.get<std::size_t>(); n > 0; --n) {
      places_[from.get<std::uint32_t>()] = static_cast<std::uint32_t>(mover.bodies.size());
      mover.bodies.push_back(from.get<Body>());
      unpack_row(mover.fluid, from), unpack_row(mover.modules, from);
    }
  }
  std::uint32_t place_of(std::uint32_t body) const { return places_.at(body); }

 private:
  std::unordered_map<std::uint32_t, std::uint32_t> places_;  // by their places on the sending rank
};

/// Makes all ranks agree (collective) on values that kernels of convex parts derive from all rows,
/// so that two ranks treat a shared pair alike: the most general exponents; the mean velocity that
/// speeds are relative to; whether all bodies have one form.
template <class Stage, class State, class Mover>
void agree_on_convex_rows(Stage& ranks, const State& particles, Mover& mover) {
  auto& rows = mover.convex_rows;
  constexpr double none = -std::numeric_limits<double>::infinity();
  std::array<double, 6> most{
      none, none, none, none, static_cast<double>(rows.exponents), -rows.least_radius};
  if (!mover.bodies.empty()) {
    const Body& b = mover.bodies.front();
    const auto form = static_cast<double>(b.form);
    // A rank with several forms reports that with numbers that no form has.
    most[0] = rows.one_form() ? form : -none, most[1] = rows.one_form() ? -form : -none;
    most[2] = b.scale, most[3] = -b.scale;
  }
  ranks.max_of(most);
  rows.exponents =
      static_cast<std::remove_reference_t<decltype(rows.exponents)>>(static_cast<int>(most[4]));
  rows.least_radius = -most[5];
  if (rows.one_form() && (most[0] != -most[1] || most[2] != -most[3])) {
    const auto form = rows.form.front();
    rows.form.assign(particles.size(), form);
  }
  std::array<double, 4> sum{0, 0, 0, static_cast<double>(particles.owned())};
  for (std::size_t k = 0; k < particles.owned(); ++k) {
    const Vec3d v = particles.motion[k].velocity();
    sum[0] += v.x, sum[1] += v.y, sum[2] += v.z;
  }
  ranks.sum_of(sum);
  rows.agreed_mean = Vec3d{sum[0], sum[1], sum[2]} * (1 / std::max(sum[3], 1.0));
}

/// After a search: determines which bodies are sent in each step with their rows.
template <class Neighbours, class State>
void follow_bodies(Neighbours& neighbours, const State& particles) {
  for (auto& other : neighbours) {
    other.send_bodies = bodies_of_rows(particles, other.send);
    other.first_body = other.end_body = 0;
    if (other.first == other.end) continue;
    other.first_body = particles.part[other.first].body;
    for (std::uint32_t k = other.first; k < other.end; ++k)
      other.end_body = std::max(other.end_body, particles.part[k].body + 1);
  }
}

}  // namespace silt::detail
