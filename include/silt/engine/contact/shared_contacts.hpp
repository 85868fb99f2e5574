// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>

#include <silt/core/dyn_array.hpp>
#include <silt/core/storage.hpp>
#include <silt/core/threads.hpp>
#include <silt/engine/lists/wall_look.hpp>

namespace silt::inline SILT_TARGET::detail {

/// The exponent of the overlap in the contact energy: 5/2 unless the law provides it.
template <class ContactsType>
inline constexpr double energy_exponent = [] {
  if constexpr (requires { ContactsType::Law::energy_exponent; })
    return ContactsType::Law::energy_exponent;
  else
    return 2.5;
}();

/// How bodies of several parts share the stiffness of a contact. Where n parts of a body press side
/// by side on the same partner, n springs and n dashpots would act where the material has one. Here
/// all contacts with one partner store the energy of a single one, about as deep as their deepest:
///
///   U = D^a,   D = (sum_j e_j^p)^(1/p)   for a law that holds K_j d_j^a =: e_j^a, p = 10       (1)
///   F_k = -dU/dd_k = (e_k/D)^(p - a) F(d_k)                                                    (2)
///
/// with F(d_k) = a K_k d_k^(a - 1) the law's own force (Hertz: a = 5/2, e ~ R*^(1/5) d), of which
/// contact k applies the share (2); friction and damping scale with it. n contacts of equal depth
/// have n^(a/p) times the force of one, that is n^(1/4) for the Hertz law: 1.4 for four, 3.2 for a
/// hundred. A larger p would share more equally, but makes bodies that rock on several parts
/// stiffer against tilting, which needs shorter steps. Shares of exactly 1/n have no potential;
/// with them an elastic plate gained up to 12 % of its energy. The partner is another body, or one
/// surface of a wall.
///
/// Contacts with a wall at right angles, as in the corner of a mesh, are no contact of several
/// parts: each acts alone. Contact j takes part in the sharing of the deepest contact s by the
/// weight v_j = f(n_s . n_j), f(x) = y^2 (3 - 2 y), y = 2 x between 0 and 1; that is 1 up to 60
/// degrees, and 0 for another contact of the same part (a sphere in a valley is pressed by both
/// sides). What is left of the others is shared in the same way by the deepest of them, and so on:
///
///   U = sum_s w_s (sum_j v_j e_j^p)^(a/p),   sum of the weights w_s v_j of a contact: 1        (3)
///
/// Between two bodies all contacts count as side by side, so that two hooked ones at right angles
/// each apply 0.6 of their force alone: their normals rotate, and weights that follow them would do
/// work (two colliding bodies gained or lost 8e-4 of their energy).
/// Shapes: shares by place in the inner list; 1 where a pair of bodies has one pair of parts.
/// Source: Kodam et al., Chem. Eng. Sci. 64 (2009) 3466, divide by the plain number of contacts;
/// (1) is silt's own. Tests: tests/engine/shared_contacts.cpp.
template <class Scalar>
class SharedContacts {
 public:
  /// Call after the inner list was renewed: finds the pairs of bodies with several pairs of parts.
  template <class List, class State>
  void renew(const List& list, const State& particles, std::size_t bodies) {
    const auto body = [&](std::uint32_t row) { return particles.part[row].body; };
    begin_.assign(bodies + 1, 0);
    list.for_each([&](std::size_t k) {
      ++begin_[std::min(body(list.first()[k]), body(list.second()[k])) + 1];
    });
    for (std::size_t b = 0; b < bodies; ++b) begin_[b + 1] += begin_[b];
    entries_.resize(begin_[bodies]);
    DynArray<std::uint32_t> next(begin_.begin(), begin_.end() - 1);
    list.for_each([&](std::size_t k) {
      const std::uint32_t a = body(list.first()[k]), b = body(list.second()[k]);
      const std::uint32_t low = std::min(a, b), high = std::max(a, b);
      entries_[next[low]++] = {high, static_cast<std::uint32_t>(k)};
    });
    groups_.clear();
    for (std::size_t b = 0; b < bodies; ++b) {
      std::sort(entries_.begin() + begin_[b], entries_.begin() + begin_[b + 1]);
      for (std::uint32_t from = begin_[b], to = from; from < begin_[b + 1]; from = to) {
        while (to < begin_[b + 1] && entries_[to].partner == entries_[from].partner) ++to;
        if (to - from > 1) groups_.push_back({from, to}), set_order(list, particles, from, to);
      }
    }
  }

  /// Computes the shares of all pairs at the present positions.
  template <class List, class State, class Domain>
  void share_pairs(const List& list, const State& particles, const Domain& domain, double exponent,
                   const Team& team) {
    shares_.assign(list.padded_size(), 1);
    constexpr std::size_t piece = 64;
    team.for_parts((groups_.size() + piece - 1) / piece, [&](std::size_t p) {
      DynArray<double> strengths;
      DynArray<std::uint32_t> places;
      for (std::size_t g = p * piece; g < std::min(groups_.size(), (p + 1) * piece); ++g) {
        strengths.clear(), places.clear();
        for (std::uint32_t e = groups_[g].from; e < groups_[g].to; ++e) {
          const std::uint32_t k = entries_[e].place;
          const PositionRow &a = particles.position[list.first()[k]],
                            &b = particles.position[list.second()[k]];
          Vec3d d = a.centre() - b.centre();
          if constexpr (Domain::periodic) d = domain.shortest(d);
          const double reach = a.r + b.r, distance2 = dot(d, d);
          if (!(distance2 < reach * reach)) continue;
          strengths.push_back(strength(reach - std::sqrt(distance2), a.r * b.r / reach, exponent));
          places.push_back(k);
        }
        double squares = 0;
        for (const double e : strengths) squares += e * e;
        for (std::size_t k = 0; k < places.size() && places.size() > 1; ++k)
          shares_[places[k]] =
              static_cast<Scalar>(share_of(strengths[k] * strengths[k], squares, exponent));
      }
    });
  }
  const Scalar* shares() const { return shares_.data(); }

  /// The same for all contacts with walls.
  template <class EngineType>
  void share_walls(const EngineType& e, double exponent) {
    found_.clear(), at_walls_.clear();
    for_each_wall_contact(e, 0, [&](const WallCandidate& c, const SurfacePoint& point) {
      const double depth = e.particles.position[c.particle].r - point.distance;
      if (depth > 0)
        found_.push_back({e.particles.part[c.particle].body,
                          c.wall,
                          c.surface,
                          {strength(depth, e.particles.position[c.particle].r, exponent),
                           point.normal, c.particle}});
    });
    std::stable_sort(found_.begin(), found_.end(),
                     [](const Found& a, const Found& b) { return a.key() < b.key(); });
    for (const Found& f : found_) at_walls_.push_back(f.one);
    for (std::size_t from = 0, to = 0; from < found_.size(); from = to) {
      while (to < found_.size() && found_[to].key() == found_[from].key()) ++to;
      share({at_walls_.data() + from, to - from}, exponent);
    }
  }
  /// The share of a contact of part `c.particle` of `body` at a surface.
  double of_wall(std::uint32_t body, const WallCandidate& c, const Vec3d& normal) const {
    const Found wanted{body, c.wall, c.surface, {}};
    const auto [from, to] =
        std::equal_range(found_.begin(), found_.end(), wanted,
                         [](const Found& a, const Found& b) { return a.key() < b.key(); });
    double share = 1, nearest = -2;
    for (auto at = from; at != to && to - from > 1; ++at) {
      const One& one = at_walls_[static_cast<std::size_t>(at - found_.begin())];
      const double cosine = dot(one.normal, normal);
      if (one.part == c.particle && cosine > nearest) nearest = cosine, share = one.share;
    }
    return share;
  }

  /// e^5 of (1), without the factors common to all contacts: R* d^5 for the Hertz law.
  static double strength(double depth, double R_eff, double exponent) {
    const double depth2 = depth * depth, depth5 = depth2 * depth2 * depth;
    if (exponent == 2.5) return R_eff * depth5;
    return exponent == 2 ? depth5 : depth5 * std::pow(R_eff, 5 * (exponent - 2) / exponent);
  }
  /// One contact among those of a body with one partner.
  struct One {
    double strength = 0;
    Vec3d normal{0, 0, 0};
    std::uint32_t part = no_part;
    double share = 1, left = 1;  // [-] of its force; the weight that no sharing has taken so far
  };
  static constexpr std::uint32_t no_part = ~std::uint32_t{0};
  /// Sets the shares of all contacts with one partner: (2), (3).
  static void share(std::span<One> all, double exponent) {
    if (all.size() < 2) return;
    const One* deepest = all.data();
    for (One& one : all) {
      one.share = 0, one.left = 1;
      if (one.strength > deepest->strength) deepest = &one;
    }
    if (std::all_of(all.begin(), all.end(), [&](const One& one) {
          return &one == deepest ||
                 (one.part != deepest->part && 2 * dot(one.normal, deepest->normal) >= 1);
        })) {
      double squares = 0;
      for (const One& one : all) squares += one.strength * one.strength;
      for (One& one : all) one.share = share_of(one.strength * one.strength, squares, exponent);
      return;
    }
    for (std::size_t done = 0; done < all.size(); ++done) {
      const One* first = nullptr;
      for (const One& one : all)
        if (one.left > 0 &&
            (first == nullptr || one.left * one.strength > first->left * first->strength))
          first = &one;
      if (first == nullptr) return;
      const double weight = first->left;
      const auto part = [&](const One& one) {
        if (&one == first) return 1.0;
        if (one.part == first->part && one.part != no_part) return 0.0;
        const double y = std::clamp(2 * dot(one.normal, first->normal), 0.0, 1.0);
        return std::min(y * y * (3 - 2 * y), one.left / weight);
      };
      double squares = 0;
      for (const One& one : all) squares += part(one) * one.strength * one.strength;
      // In this order: part() needs what is left of the first.
      for (One& one : all)
        if (&one != first) take(one, weight, part(one), squares, exponent);
      take(all[static_cast<std::size_t>(first - all.data())], weight, 1, squares, exponent);
    }
  }

 private:
  static double share_of(double square, double squares, double exponent) {
    if (!(squares > 0)) return 1;       // no contact, or all underflow
    const double x = square / squares;  // (e_k/D)^p
    if (exponent == 2.5) return std::sqrt(x) * std::sqrt(std::sqrt(x));
    return std::pow(x, 1 - exponent / power);
  }
  static void take(One& one, double weight, double part, double squares, double exponent) {
    one.share += weight * part * share_of(one.strength * one.strength, squares, exponent);
    one.left -= weight * part;
    if (one.left < 1e-9) one.left = 0;
  }
  /// Two ranks that both have a group add its strengths in the same order, by the ids of the parts.
  template <class List, class State>
  void set_order([[maybe_unused]] const List& list, [[maybe_unused]] const State& particles,
                 [[maybe_unused]] std::uint32_t from, [[maybe_unused]] std::uint32_t to) {
    if constexpr (State::of_ranks) {
      if (particles.ghosts == 0) return;  // order as in one process
      const auto ids = [&](const Entry& e) {
        return std::pair{particles.id[list.first()[e.place]], particles.id[list.second()[e.place]]};
      };
      std::sort(entries_.begin() + from, entries_.begin() + to,
                [&](const Entry& a, const Entry& b) { return ids(a) < ids(b); });
    }
  }

  static constexpr double power = 10;  // p
  struct Entry {
    std::uint32_t partner, place;
    auto operator<=>(const Entry&) const = default;
  };
  struct Group {
    std::uint32_t from, to;  // of entries
  };
  struct Found {
    std::uint32_t body;
    std::uint16_t wall, surface;
    One one;
    std::uint64_t key() const {
      return std::uint64_t{body} << 32 | std::uint32_t{wall} << 16 | surface;
    }
  };

  DynArray<std::uint32_t> begin_;  // entries of each body, at the body with the lower place
  DynArray<Entry> entries_;
  DynArray<Group> groups_;
  AlignedVector<Scalar> shares_;
  DynArray<Found> found_;
  DynArray<One> at_walls_;  // of found_
};

}  // namespace silt::detail
