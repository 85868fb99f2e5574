// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

#include <silt/core/dyn_array.hpp>
#include <silt/core/error.hpp>
#include <silt/core/threads.hpp>
#include <silt/sph/cluster_lists.hpp>
#include <silt/sph/columns.hpp>
#include <silt/sph/opening_layout.hpp>
#include <silt/sph/setup.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Openings of an Sph. Behind each there are layers of particles to the depth of the kernel's
/// support, its buffer. For the liquid they are liquid particles. Their velocity and pressure are
/// prescribed, or taken from the liquid at their mirror images (probes) in front of the opening.
///
/// A buffer particle that passes the opening becomes liquid, and a new one is added at the far end
/// behind it. A liquid particle that passes the opening becomes a buffer particle, which is removed
/// at the far end. Both happen at every opening, for either flow direction.
///
/// Source: A. Tafuni, J. M. Dominguez, R. Vacondio, A. J. C. Crespo, Comput. Methods Appl. Mech.
///         Eng. 342 (2018) 604 (recalled); here velocities are those on the opening, for the whole
///         depth.
/// Tests:  tests/sph/openings.cpp, openings_flows.cpp.
class SphOpenings {
 public:
  static constexpr std::size_t most = 30;
  static constexpr double late = 0.1;     // [-] of the spacing: delay of conversions
  static constexpr double nearest = 1.5;  // [-] of the spacing: largest distance of probes in front

  using One = SphOpening;
  using Seen = One::Seen;

  bool empty() const { return all_.empty(); }
  std::size_t size() const { return all_.size(); }
  const One& operator[](std::size_t k) const { return all_[k]; }
  double depth() const { return layers_ * spacing_; }  // [m]
  /// Liquid particles that have left through them.
  std::size_t went() const {
    std::size_t sum = 0;
    for (const One& one : all_) sum += one.books.out.particles;
    return sum;
  }

  std::size_t add(One one, const SphSetup& sph, const Liquid& liquid, const Repeats& repeats) {
    spacing_ = sph.spacing, repeats_ = repeats;
    layers_ = std::ceil(2 * sph.h() / sph.spacing + 0.5);
    require(all_.size() < most, "Sph: more than ", most, " openings");
    one.lay_out(sph), one.check(liquid);
    for (const One& other : all_)
      require(!meet(one, other) && !meet(other, one), "Sph: ", one.called(), " and ",
              other.called(), " overlap, with the ", depth(),
              " m behind each, which their buffers need; move them apart");
    all_.push_back(std::move(one));
    return all_.size() - 1;
  }

  Seen seen(const One& one, const Vec3d& x) const {
    const Vec3d way = repeats_.shortest(x - one.middle);
    return {dot(way, one.normal), {dot(way, one.along[0]), dot(way, one.along[1])}};
  }
  /// Whether a buffer may extend to a point: not into walls or the initial liquid.
  bool hold(const Vec3d& x) const {
    for (const One& one : all_)
      if (const Seen at = seen(one, x); at.front < 0.499 * spacing_ &&
                                        at.front > -depth() - 0.25 * spacing_ &&
                                        one.within(at, 0.25 * spacing_))
        return true;
    return false;
  }

  /// @name Rows
  /// @{

  /// Before sorting: adds numbers of the particles, and their probes.
  template <class Distance>
  void put_into(SphColumns& columns, const Vec3d& gravity, double density,
                const Distance& from_walls) {
    const double g = norm(gravity);
    up_ = g > 0 ? (-1 / g) * gravity : Vec3d{0, 0, 1};
    if (!filled_) fill(columns, density, from_walls), filled_ = true;
    const std::size_t n = columns.size();
    std::uint32_t slot = 0;
    for (std::size_t k = 0; k < n; ++k) {
      if (!columns.is_of_opening(k)) continue;
      if (columns.kind[k] != ClusterLists::Liquid) {
        columns.take_out(k);
        continue;
      }
      const std::size_t of = opening_of(columns.label[k]);
      require(slot < slots, "Sph: more than ", slots, " particles are in buffers of openings");
      columns.label[k] = label(of, slot++);
      SphRow probe{};
      probe.density = density;
      probe.place(image(all_[of], columns.rows[k].position()));
      columns.add(probe, ClusterLists::Probe, columns.label[k]);
    }
  }
  /// After sorting: finds their rows.
  void find_rows(const SphColumns& columns) {
    if (empty()) return;
    row_.clear(), probe_.clear();
    for (std::size_t k = 0; k < columns.size(); ++k) {
      if (!columns.is_of_opening(k)) continue;
      require(opening_of(columns.label[k]) < size(), "Sph: a state has an opening ",
              opening_of(columns.label[k]), " of ", size());
      auto& rows = columns.kind[k] == ClusterLists::Liquid ? row_ : probe_;
      const std::size_t slot = columns.label[k] & (slots - 1);
      if (rows.size() <= slot) rows.resize(slot + 1, ClusterLists::none);
      rows[slot] = static_cast<std::uint32_t>(k);
    }
    require(row_.size() == probe_.size() &&
                std::find(row_.begin(), row_.end(), ClusterLists::none) == row_.end() &&
                std::find(probe_.begin(), probe_.end(), ClusterLists::none) == probe_.end(),
            "Sph: the buffers of a state's openings lack particles");
  }
  std::span<const std::uint32_t> rows() const { return row_; }
  std::span<const std::uint32_t> probes() const { return probe_; }
  static std::size_t opening_of(std::uint32_t of) { return (of - SphColumns::of_openings) / slots; }
  const One& of(const SphColumns& columns, std::uint32_t row) const {
    return all_[opening_of(columns.label[row])];
  }
  /// Probe position of a particle: its mirror image, but near the opening. (Flow that converges to
  /// a hole is slow at the images of the far end; the outflow of a hole was half as large.)
  Vec3d image(const One& one, const Vec3d& x) const {
    const double front = seen(one, x).front;
    return x + (std::clamp(-front, 0.0, nearest * spacing_) - front) * one.normal;
  }
  /// Moves the buffers for dt [s] with their velocity; `start` keeps the positions of the step's
  /// start.
  void move(SphColumns& columns, double dt, bool start) const {
    for (const std::uint32_t k : row_) {
      SphRow& r = columns.rows[k];
      if (start) columns.start[k] = r;
      const Vec3d& n = of(columns, k).normal;
      r.place(r.position() + dt * dot(r.velocity(), n) * n);
    }
  }
  /// At the end of a step: converts particles that passed an opening. True if rows were added or
  /// removed. `number`: next number of the liquid; `mass` [kg] of a particle.
  bool pass(SphColumns& columns, std::size_t liquid, double mass, std::uint32_t& number,
            const Team& team) {
    if (!is_due(columns, liquid, team)) return false;
    bool changed = false;
    for (std::size_t k = 0; k < liquid; ++k) {
      if (columns.label[k] == ClusterLists::none) continue;
      if (columns.is_of_opening(k)) {
        const std::size_t o = opening_of(columns.label[k]);
        One& one = all_[o];
        const double front = seen(one, columns.rows[k].position()).front;
        if (front < -depth() * (1 + 1e-9)) columns.take_out(k), changed = true;
        if (front < 0 || columns.label[k] == ClusterLists::none) continue;
        book(one.books.in, columns.rows[k], mass);
        require(number < SphColumns::of_openings, "Sph: more than ", SphColumns::of_openings,
                " particles have been liquid");
        columns.label[k] = number++;
        changed = true;
        SphRow behind = columns.rows[k];
        if (is_above(one, behind.position())) continue;  // was thrown back into the buffer
        behind.place(behind.position() - depth() * one.normal);
        columns.add(behind, ClusterLists::Liquid, label(o, 0));
      } else if (const std::size_t o = through(columns.rows[k].position(), 0); o < size()) {
        book(all_[o].books.out, columns.rows[k], mass);
        columns.label[k] = label(o, 0), changed = true;
      }
    }
    return changed;
  }
  /// @}

  /// visit(row, opening) for the particles of buffers.
  template <class Visit>
  static void for_each(const SphColumns& columns, const Visit& visit) {
    for (std::size_t k = 0; k < columns.size(); ++k)
      if (columns.kind[k] == ClusterLists::Liquid && columns.is_of_opening(k))
        visit(columns.rows[k], opening_of(columns.label[k]));
  }
  /// [kg/s] present inflow: that of the buffer, divided by its depth.
  double flow_rate(const SphColumns& columns, std::size_t which, double mass) const {
    double sum = 0;
    for_each(columns, [&](const SphRow& r, std::size_t opening) {
      if (opening == which) sum += dot(r.velocity(), all_[which].normal);
    });
    return mass * sum / depth();
  }

  /// For a state: whether buffers exist, and the flow counters.
  DynArray<double> state() const {
    DynArray<double> all{filled_ ? 1.0 : 0.0};
    for (const One& one : all_)
      for (const OpeningFlow* const f : {&one.books.in, &one.books.out}) {
        const Vec3d& p = f->momentum;
        all.insert(all.end(), {static_cast<double>(f->particles), f->mass, p.x, p.y, p.z,
                               f->kinetic_energy, f->pressure_work});
      }
    return all;
  }
  void restore(std::span<const double> all) {
    require(all.size() == 1 + 14 * size(), "Sph: a state has ", (all.size() - 1) / 14,
            " openings, but there are ", size());
    filled_ = all[0] != 0;
    std::size_t k = 1;
    for (One& one : all_)
      for (OpeningFlow* const f : {&one.books.in, &one.books.out}) {
        const double* const p = all.data() + k;
        *f = {static_cast<std::size_t>(p[0]), p[1], {p[2], p[3], p[4]}, p[5], p[6]};
        k += 7;
      }
  }

 private:
  static constexpr std::uint32_t slots = 1u << 26;  // particles of buffers
  static std::uint32_t label(std::size_t opening, std::uint32_t slot) {
    return SphColumns::of_openings + static_cast<std::uint32_t>(opening) * slots + slot;
  }

  /// Whether the buffers overlap.
  bool meet(const One& one, const One& other) const {
    bool yes = false;
    one.for_each_site(spacing_, [&](std::size_t, std::size_t, const Vec3d& face) {
      for (int layer = 0; layer < static_cast<int>(layers_); ++layer) {
        const Seen at = seen(other, face - (layer + 0.5) * spacing_ * one.normal);
        yes = yes || (at.front < 0 && at.front > -depth() && other.within(at, -0.25 * spacing_));
      }
    });
    return yes;
  }
  /// Whether a place is above the surface of what enters.
  bool is_above(const One& one, const Vec3d& x) const {
    return one.setup.surface && dot(x, up_) > *one.setup.surface;
  }
  /// Initial particles: for an inlet all below its surface, for an outlet those with liquid
  /// directly in front.
  template <class Distance>
  void fill(SphColumns& columns, double density, const Distance& from_walls) {
    for (std::size_t o = 0; o < size(); ++o) {
      const One& one = all_[o];
      DynArray<char> wet(one.sites[0] * one.sites[1], one.inlet);
      const auto site = [&](const Seen& at, std::size_t e) {
        const double k = std::floor((at.along[e] + 0.5 * one.length[e]) / spacing_);
        return static_cast<std::size_t>(std::clamp(k, 0.0, static_cast<double>(one.sites[e] - 1)));
      };
      if (!one.inlet)
        for (std::size_t k = 0; k < columns.size(); ++k) {
          if (!columns.is_liquid(k)) continue;
          const Seen at = seen(one, columns.rows[k].position());
          if (at.front > 0 && at.front < 1.01 * spacing_ && one.within(at, 0))
            wet[site(at, 0) * one.sites[1] + site(at, 1)] = 1;
        }
      one.for_each_site(spacing_, [&](std::size_t i, std::size_t j, const Vec3d& face) {
        const Vec3d front = face + 0.5 * spacing_ * one.normal;
        require(from_walls(front) > 0.499 * spacing_, "Sph: in front of ", one.called(), " at ",
                front,
                " m there is a wall, or one nearer than half a spacing; keep the opening's "
                "edges a whole number of spacings from walls, and its `into` on the free side");
        if (!wet[i * one.sites[1] + j]) return;
        if (is_above(one, face)) return;
        SphRow r{};
        r.density = density;
        for (int layer = 0; layer < static_cast<int>(layers_); ++layer) {
          r.place(face - (layer + 0.5) * spacing_ * one.normal);
          columns.add(r, ClusterLists::Liquid, label(o, 0));
        }
      });
    }
  }
  /// The opening whose buffer contains a point of the liquid by more than `by` [m]; size(): none.
  std::size_t through(const Vec3d& x, double by) const {
    for (std::size_t o = 0; o < size(); ++o)
      if (const Seen at = seen(all_[o], x);
          at.front < -by && at.front > -depth() && all_[o].within(at, 0.5 * spacing_))
        return o;
    return size();
  }
  /// Whether the conversion of a particle is due.
  bool is_due(const SphColumns& columns, std::size_t liquid, const Team& team) const {
    std::atomic<bool> due{false};
    const double by = late * spacing_;
    team.for_ranges(liquid, [&](std::size_t, std::size_t from, std::size_t to) {
      bool any = false;
      for (std::size_t k = from; k < to && !any; ++k) {
        if (columns.label[k] == ClusterLists::none) continue;
        const Vec3d x = columns.rows[k].position();
        if (columns.is_of_opening(k)) {
          const double front = seen(all_[opening_of(columns.label[k])], x).front;
          any = front > by || front < -depth() - by;
        } else {
          any = through(x, by) < size();
        }
      }
      if (any) due = true;
    });
    return due;
  }
  static void book(OpeningFlow& to, const SphRow& r, double mass) {
    const Vec3d v = r.velocity();
    ++to.particles, to.mass += mass, to.momentum += mass * v;
    to.kinetic_energy += 0.5 * mass * dot(v, v), to.pressure_work += mass * r.pressure / r.density;
  }

  DynArray<One> all_;
  DynArray<std::uint32_t> row_, probe_;
  double spacing_ = 0, layers_ = 0;
  Repeats repeats_{};
  Vec3d up_{0, 0, 1};
  bool filled_ = false;
};

}  // namespace silt::detail
