// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <utility>
#include <vector>

#include <silt/bond/concept.hpp>
#include <silt/core/storage.hpp>
#include <silt/core/threads.hpp>
#include <silt/engine/contact/load_rows.hpp>
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

/// Bonds, and their stage of a step: what they do to their ends, and which of them break. Loads of
/// one particle are added up in the order in which its bonds were made, whatever the threads.
template <class Model, class Domain>
class BondStage {
 public:
  using Bond = silt::Bond<Model>;

  Model model;
  std::vector<Bond> bonds;  // unbroken ones, in the order in which they were made
  std::uint64_t made = 0, broken = 0, seed = 1;

  /// Adds what bonds do to the sums of their particles.
  template <class Engine>
  void push(Engine& e, const Domain& domain) {
    if (bonds.empty()) return;
    follow(e);
    loads_.resize(bonds.size());
    e.team().for_ranges(bonds.size(), [&](std::size_t, std::size_t from, std::size_t to) {
      for (std::size_t k = from; k < to; ++k) look(e, domain, k);
    });
    using Scalar = typename Engine::Scalar;
    Scalar* const sums = e.load_sums();
    e.team().for_ranges(touched_.size(), [&](std::size_t, std::size_t from, std::size_t to) {
      for (std::size_t n = from; n < to; ++n) {
        const std::uint32_t row = touched_[n];
        Vec3d force{0, 0, 0}, torque{0, 0, 0};
        for (std::size_t k = begin_[n]; k < begin_[n + 1]; ++k) {
          const Loads& l = loads_[ends_[k].bond];
          if (ends_[k].second)
            force -= l.force, torque += l.torque_j;
          else
            force += l.force, torque += l.torque_i;
        }
        const double inv_r = e.particles.motion[row].inv_r;
        Scalar* const sum = sums + row * 4 * Engine::chunks;
        add(sum, force, 1), add(sum + 4, torque, inv_r);
      }
    });
  }
  /// Takes out the bonds that the last step has overloaded; returns them.
  std::vector<Bond> take_broken() {
    std::vector<Bond> gone;
    std::size_t to = 0;
    for (std::size_t k = 0; k < bonds.size(); ++k) {
      if (k < loads_.size() && loads_[k].load > 1) {
        gone.push_back(bonds[k]);
        continue;
      }
      if (to != k) bonds[to] = bonds[k];
      ++to;
    }
    if (!gone.empty()) bonds.resize(to), stale_ = true, broken += gone.size();
    return gone;
  }
  void add(const Bond& bond) { bonds.push_back(bond), stale_ = true, ++made; }
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
    for (std::size_t k = 0; k < bonds.size(); ++k)
      sum += Model::energy(strain(e, domain, k), bonds[k].rest.normal, bonds[k].numbers);
    return sum;
  }
  template <class Engine>
  BondStrain<double> strain(const Engine& e, const Domain& domain, std::size_t k) const {
    const auto [a, b] = rows_[k];
    Vec3d d = e.particles.position[a].centre() - e.particles.position[b].centre();
    if constexpr (Domain::periodic) d = domain.shortest(d);
    return strain_of(bonds[k].rest, d, end(e, a), end(e, b));
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
        const Bond& bond = bonds[ends_[k].bond];
        const auto s = Model::stiffness(bond.numbers);
        const Vec3d& arm = ends_[k].second ? bond.rest.arm_j : bond.rest.arm_i;
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
  void forget_rows() { stale_ = true; }

 private:
  struct Loads {
    Vec3d force, torque_i, torque_j;  // [N], [N m]
    double load;                      // [-] it breaks above 1
  };
  struct EndOf {
    std::uint32_t bond;
    bool second;
  };

  template <class Scalar>
  static void add(Scalar* sum, const Vec3d& v, double factor) {
    sum[0] += static_cast<Scalar>(factor * v.x), sum[1] += static_cast<Scalar>(factor * v.y);
    sum[2] += static_cast<Scalar>(factor * v.z);
  }
  template <class Engine>
  static BondEnd<double> end(const Engine& e, std::uint32_t row) {
    const auto& m = e.particles.motion[row];
    return {e.particles.position[row].centre(), e.particles.orientation[row], m.velocity(),
            m.inv_r * m.spin_velocity()};
  }
  template <class Engine>
  void look(const Engine& e, const Domain& domain, std::size_t k) {
    const Bond& bond = bonds[k];
    const auto s = strain(e, domain, k);
    const auto a = Model::answer(s, bond.rest.normal, bond.numbers);
    const auto l = loads_of(s, a.force, a.couple, a.rate_force, a.rate_couple);
    loads_[k] = {l.force, l.torque_i, l.torque_j, Model::load(a, bond.rest.normal, bond.numbers)};
  }
  /// Finds the rows of the bonds' ends where places were given anew, or bonds have come or gone.
  template <class Engine>
  void follow(Engine& e) {
    if (!stale_ && changes_ == e.particles.changes) return;
    stale_ = false, changes_ = e.particles.changes;
    rows_.resize(bonds.size());
    std::vector<std::uint32_t> count(e.particles.size() + 1, 0);
    for (std::size_t k = 0; k < bonds.size(); ++k) {
      rows_[k] = {static_cast<std::uint32_t>(e.find(bonds[k].i)),
                  static_cast<std::uint32_t>(e.find(bonds[k].j))};
      ++count[rows_[k].first], ++count[rows_[k].second];
    }
    touched_.clear(), begin_.clear();
    std::uint32_t place = 0;
    for (std::uint32_t row = 0; row < e.particles.size(); ++row) {
      if (count[row] > 0) touched_.push_back(row), begin_.push_back(place);
      place += std::exchange(count[row], place);
    }
    begin_.push_back(place), ends_.resize(place);
    for (std::uint32_t k = 0; k < bonds.size(); ++k) {
      ends_[count[rows_[k].first]++] = {k, false};
      ends_[count[rows_[k].second]++] = {k, true};
    }
  }

  bool stale_ = true;
  std::uint64_t changes_ = 0;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> rows_;  // of each bond's ends
  std::vector<std::uint32_t> touched_, begin_;                 // rows with bonds; their first end
  std::vector<EndOf> ends_;
  std::vector<Loads> loads_;
};

/// The stage of a policy Bonds<Model>; without one nothing.
template <class Policy, class Domain>
struct BondsOf {
  struct type {};
};
template <class Model, class Domain>
struct BondsOf<Bonds<Model>, Domain> {
  using type = BondStage<Model, Domain>;
};

}  // namespace detail
}  // namespace silt
