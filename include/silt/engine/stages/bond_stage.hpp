// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include <silt/bond/concept.hpp>
#include <silt/core/lanes.hpp>
#include <silt/core/row4.hpp>
#include <silt/core/storage.hpp>
#include <silt/core/threads.hpp>
#include <silt/engine/state/rows.hpp>

namespace silt::inline SILT_TARGET {

/// A bond between the particles i and j, i < j.
template <class Model>
struct Bond {
  ParticleId i, j;
  BondRest<double> rest;
  typename Model::template Numbers<double> numbers;
};

namespace detail {

/// Numbers of many bonds, column by column, so that lanes load them as they lie; behind the last
/// bond a pack of zeros.
template <template <class> class Aggregate>
class BondColumns {
  static constexpr std::size_t count = sizeof(Aggregate<double>) / sizeof(double);

 public:
  static constexpr std::size_t padding = 16;

  void resize(std::size_t bonds) {
    for (auto& c : columns_) c.resize(bonds), c.resize(bonds + padding, 0.0);
    size_ = bonds;
  }
  std::size_t size() const { return size_; }
  void set(std::size_t k, const Aggregate<double>& values) {
    const auto numbers = std::bit_cast<std::array<double, count>>(values);
    for (std::size_t c = 0; c < count; ++c) columns_[c][k] = numbers[c];
  }
  Aggregate<double> get(std::size_t k) const {
    std::array<double, count> numbers;
    for (std::size_t c = 0; c < count; ++c) numbers[c] = columns_[c][k];
    return std::bit_cast<Aggregate<double>>(numbers);
  }
  /// Of a pack from bond k on.
  template <class Real>
  SILT_INLINE Aggregate<Real> load(std::size_t k) const {
    std::array<Real, count> numbers;
    for (std::size_t c = 0; c < count; ++c) numbers[c] = silt::load<Real>(columns_[c].data() + k);
    return std::bit_cast<Aggregate<Real>>(numbers);
  }

 private:
  std::array<AlignedVector<double>, count> columns_;
  std::size_t size_ = 0;
};

/// Bonds, and their stage of a step: what they do to their ends, and which of them break. Loads of
/// one particle are added up in the order in which its bonds were made, whatever the threads.
template <class Model, class Domain, class Arch>
class BondStage {
  using Real = typename Lanes<Arch>::Real;
  static constexpr std::size_t W = Lanes<Arch>::width;

 public:
  using Bond = silt::Bond<Model>;

  Model model;
  std::uint64_t seed = 1, made = 0, broken = 0;

  /// Unbroken bonds, in the order in which they were made.
  std::size_t size() const { return ids_.size(); }
  Bond bond(std::size_t k) const {
    return {ids_[k].first, ids_[k].second, rest_.get(k), numbers_.get(k)};
  }
  void add(const Bond& bond) {
    const std::size_t k = size();
    ids_.push_back({bond.i, bond.j});
    rest_.resize(k + 1), numbers_.resize(k + 1);
    rest_.set(k, bond.rest), numbers_.set(k, bond.numbers);
    stale_ = true, ++made;
  }

  /// Adds what bonds do to the sums of their particles.
  template <class Engine>
  void push(Engine& e, const Domain& domain) {
    overloaded_.clear();
    if (size() == 0) return;
    follow(e);
    make_room(loads_, pieces(size(), W) * W * row);
    std::array<std::vector<std::uint32_t>, Team::most_ranges> over;
    e.team().for_ranges(pieces(size(), W), [&](std::size_t r, std::size_t from, std::size_t to) {
      look(e, domain, from * W, to * W, over[r]);
    });
    for (const auto& part : over) overloaded_.insert(overloaded_.end(), part.begin(), part.end());
    add_up(e);
  }
  /// Takes out the bonds that the last step has overloaded; returns them.
  std::vector<Bond> take_broken() {
    std::vector<Bond> gone;
    if (overloaded_.empty()) return gone;
    std::size_t next = 0, to = 0;
    for (std::size_t k = 0; k < size(); ++k) {
      if (next < overloaded_.size() && overloaded_[next] == k) {
        gone.push_back(bond(k)), ++next;
        continue;
      }
      if (to != k)
        ids_[to] = ids_[k], rest_.set(to, rest_.get(k)), numbers_.set(to, numbers_.get(k));
      ++to;
    }
    ids_.resize(to), rest_.resize(to), numbers_.resize(to);
    stale_ = true, broken += gone.size(), overloaded_.clear();
    return gone;
  }
  /// Turns the particles for a step of `dt` [s].
  template <class Engine>
  static void turn(Engine& e, double dt) {
    auto& p = e.particles;
    e.team().for_ranges(p.size(), [&](std::size_t, std::size_t from, std::size_t to) {
      for (std::size_t k = from; k < to; ++k) {
        const auto& m = p.motion[k];
        // tan of a quarter of the turn to third order: 1e-9 off at 0.1 rad a step.
        const Vec3d half = (0.5 * dt * m.inv_r) * m.spin_velocity();
        const Vec3d t = (1 + dot(half, half) / 3) * half;
        const Quaternion q = Quaternion{1, t.x, t.y, t.z} * p.orientation[k];
        const double per = 1 / std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
        p.orientation[k] = {per * q.w, per * q.x, per * q.y, per * q.z};
      }
    });
  }
  /// [J] in the springs, at the present positions.
  template <class Engine>
  double energy(Engine& e, const Domain& domain) {
    follow(e);
    double sum = 0;
    for (std::size_t k = 0; k < size(); ++k) {
      const Bond b = bond(k);
      sum += Model::energy(strain(e, domain, k), b.rest.normal, b.numbers);
    }
    return sum;
  }
  template <class Engine>
  BondStrain<double> strain(const Engine& e, const Domain& domain, std::size_t k) const {
    const std::uint32_t a = first_[k], b = second_[k];
    const auto &p = e.particles.position[a], &q = e.particles.position[b];
    const auto &m = e.particles.motion[a], &n = e.particles.motion[b];
    Vec3d d = p.centre() - q.centre();
    if constexpr (Domain::periodic) d = domain.shortest(d);
    return strain_of<double>(
        rest_.get(k),
        {d, m.velocity() - n.velocity(), e.particles.orientation[a], e.particles.orientation[b],
         m.inv_r * m.spin_velocity(), n.inv_r * n.spin_velocity()});
  }
  /// The fastest that bonds make a particle swing [1/s], and which one: a bound, as if all its
  /// partners moved against it.
  struct Rate {
    double rate = 0;
    ParticleId particle = no_particle;
  };
  template <class Engine>
  Rate fastest(Engine& e) {
    follow(e);
    Rate most;
    for (std::size_t n = 0; n < touched_.size(); ++n) {
      double shift = 0, turn = 0;
      for (std::size_t k = begin_[n]; k < begin_[n + 1]; ++k) {
        const Bond b = bond(ends_[k].bond());
        const auto s = Model::stiffness(b.numbers);
        const Vec3d& arm = ends_[k].is_second() ? b.rest.arm_j : b.rest.arm_i;
        shift += s.shift, turn += s.turn + s.shift * dot(arm, arm);
      }
      const auto p = e.owner(touched_[n]);
      if (p.inverse_mass() == 0) continue;
      const double m = p.mass(),
                   I = Engine::ShapeType::inertia_factor() * m * p.radius() * p.radius();
      const double rate = std::sqrt(std::max(2 * shift / m, 2 * turn / I));
      if (rate > most.rate) most = {rate, p.id()};
    }
    return most;
  }

 private:
  static constexpr std::size_t row = 12;  // of a bond: force, torque on i, torque on j, four each
  /// An end of a bond: which one, and whether it is the second.
  struct EndOf {
    std::uint32_t code;
    std::uint32_t bond() const { return code >> 1; }
    bool is_second() const { return code & 1; }
  };
  using Row = Row4<Arch>;

  template <class Pose>
  SILT_INLINE static void put(const Vec3<Real>& v, Pose* to) {
    const Real columns[4] = {v.x, v.y, v.z, Real(0)};
    Row rows[W];
    columns_to_rows<Arch>(columns, rows);
    for (std::size_t lane = 0; lane < W; ++lane) rows[lane].store(to + lane * row);
  }
  /// The ends of a pack of bonds.
  template <class Engine>
  SILT_INLINE BondedEnds<Real> ends_of(const Engine& e, const Domain& domain, std::size_t k) const {
    const auto* const position = e.particles.position.data();
    const auto* const motion = e.particles.motion.data();
    const auto* const orientation = e.particles.orientation.data();
    const std::uint32_t *const a = first_.data() + k, *const b = second_.data() + k;
    const auto columns = [](const auto& row_of, Real(&c)[4]) {
      Row rows[W];
      for (std::size_t lane = 0; lane < W; ++lane) rows[lane] = row_of(lane);
      rows_to_columns<Arch>(rows, c);
    };
    BondedEnds<Real> ends;
    Real c[4];
    columns([&](auto l) { return Row::load(&position[a[l]].x) - Row::load(&position[b[l]].x); }, c);
    ends.apart = {c[0], c[1], c[2]};
    if constexpr (Domain::periodic) ends.apart = domain.shortest(ends.apart);
    columns([&](auto l) { return Row::load(&motion[a[l]].vx) - Row::load(&motion[b[l]].vx); }, c);
    ends.velocity = {c[0], c[1], c[2]};
    columns([&](auto l) { return Row::load(&motion[a[l]].wx); }, c);
    ends.spin_i = c[3] * Vec3<Real>{c[0], c[1], c[2]};
    columns([&](auto l) { return Row::load(&motion[b[l]].wx); }, c);
    ends.spin_j = c[3] * Vec3<Real>{c[0], c[1], c[2]};
    columns([&](auto l) { return Row::load(&orientation[a[l]].w); }, c);
    ends.orientation_i = {c[0], c[1], c[2], c[3]};
    columns([&](auto l) { return Row::load(&orientation[b[l]].w); }, c);
    ends.orientation_j = {c[0], c[1], c[2], c[3]};
    return ends;
  }
  template <class Engine>
  void look(const Engine& e, const Domain& domain, std::size_t from, std::size_t to,
            std::vector<std::uint32_t>& over) {
    for (std::size_t k = from; k < to; k += W) {
      const auto rest = rest_.template load<Real>(k);
      const auto numbers = numbers_.template load<Real>(k);
      const auto s = strain_of(rest, ends_of(e, domain, k));
      const auto a = Model::answer(s, rest.normal, numbers);
      const auto l = loads_of(s, a.force, a.couple, a.rate_force, a.rate_couple);
      double* const out = loads_.data() + k * row;
      put(l.force, out), put(l.torque_i, out + 4), put(l.torque_j, out + 8);
      if (std::uint32_t bits = lane_bits(Model::load(a, rest.normal, numbers) > Real(1))) {
        for (std::uint32_t lane = 0; lane < W; ++lane)
          if (bits >> lane & 1 && k + lane < size())
            over.push_back(static_cast<std::uint32_t>(k) + lane);
      }
    }
  }
  template <class Engine>
  void add_up(Engine& e) {
    using Scalar = typename Engine::Scalar;
    Scalar* const sums = e.load_sums();
    e.team().for_ranges(touched_.size(), [&](std::size_t, std::size_t from, std::size_t to) {
      const Row minus = Row::all(-1);
      for (std::size_t n = from; n < to; ++n) {
        Row force = Row::all(0), torque = Row::all(0);
        for (std::size_t k = begin_[n]; k < begin_[n + 1]; ++k) {
          const EndOf end = ends_[k];
          const double* const l = loads_.data() + end.bond() * row;
          const Row f = Row::load(l);
          force = end.is_second() ? force + minus * f : force + f;
          torque = torque + Row::load(l + (end.is_second() ? 8 : 4));
        }
        const std::uint32_t at = touched_[n];
        using SumRow = Row4<Arch, Scalar>;
        Scalar* const sum = sums + at * 4 * Engine::chunks;
        (SumRow::load(sum) + convert<Scalar>(force)).store(sum);
        torque = torque * Row::all(e.particles.motion[at].inv_r);
        (SumRow::load(sum + 4) + convert<Scalar>(torque)).store(sum + 4);
      }
    });
  }
  /// Finds the rows of the bonds' ends where places were given anew, or bonds have come or gone.
  template <class Engine>
  void follow(Engine& e) {
    auto& p = e.particles;
    if (!stale_ && changes_ == p.changes) return;
    stale_ = false, changes_ = p.changes;
    const auto nobody = static_cast<std::uint32_t>(p.size());
    const std::size_t padded = size() + BondColumns<BondRest>::padding;
    first_.assign(padded, nobody), second_.assign(padded, nobody + 1);
    std::vector<std::uint32_t> count(p.size() + 1, 0);
    for (std::size_t k = 0; k < size(); ++k) {
      first_[k] = static_cast<std::uint32_t>(e.find(ids_[k].first));
      second_[k] = static_cast<std::uint32_t>(e.find(ids_[k].second));
      ++count[first_[k]], ++count[second_[k]];
    }
    touched_.clear(), begin_.clear();
    std::uint32_t place = 0;
    for (std::uint32_t r = 0; r < p.size(); ++r) {
      if (count[r] > 0) touched_.push_back(r), begin_.push_back(place);
      place += std::exchange(count[r], place);
    }
    begin_.push_back(place), ends_.resize(place);
    for (std::uint32_t k = 0; k < size(); ++k)
      ends_[count[first_[k]]++] = {2 * k}, ends_[count[second_[k]]++] = {2 * k + 1};
  }

  std::vector<std::pair<ParticleId, ParticleId>> ids_;
  BondColumns<BondRest> rest_;
  BondColumns<Model::template Numbers> numbers_;
  bool stale_ = true;
  std::uint64_t changes_ = 0;
  std::vector<std::uint32_t> first_, second_;   // rows of the ends
  std::vector<std::uint32_t> touched_, begin_;  // rows with bonds; their first end
  std::vector<EndOf> ends_;
  AlignedVector<double> loads_;
  std::vector<std::uint32_t> overloaded_;
};

/// The stage of a policy Bonds<Model>; without one nothing.
template <class Policy, class Domain, class Arch>
struct BondsOf {
  struct type {};
};
template <class Model, class Domain, class Arch>
struct BondsOf<Bonds<Model>, Domain, Arch> {
  using type = BondStage<Model, Domain, Arch>;
};

}  // namespace detail
}  // namespace silt
