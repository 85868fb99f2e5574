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
/// surface of a wall. Contacts at right angles, as between two hooked bodies, each apply 0.6 of
/// their force alone. Shapes: shares by place in the inner list; 1 where a pair of bodies has one
/// pair of parts.
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
        if (strengths.size() > 1)
          for (std::size_t k = 0; k < places.size(); ++k)
            shares_[places[k]] = static_cast<Scalar>(share(strengths[k], strengths, exponent));
      }
    });
  }
  const Scalar* shares() const { return shares_.data(); }

  /// The same for all contacts with walls.
  template <class EngineType>
  void share_walls(const EngineType& e, double exponent) {
    wall_exponent_ = exponent;
    found_.clear();
    for_each_wall_contact(e, 0, [&](const WallCandidate& c, const SurfacePoint& point) {
      const double depth = e.particles.position[c.particle].r - point.distance;
      if (depth > 0)
        found_.push_back({e.particles.part[c.particle].body, c.wall, c.surface,
                          strength(depth, e.particles.position[c.particle].r, exponent)});
    });
    std::stable_sort(found_.begin(), found_.end(),
                     [](const Found& a, const Found& b) { return a.key() < b.key(); });
    strengths_.clear();
    for (const Found& f : found_) strengths_.push_back(f.strength);
  }
  /// The share of a contact of a part of `body`, with this radius and depth [m], at a surface.
  double of_wall(std::uint32_t body, const WallCandidate& c, double radius, double depth) const {
    const Found wanted{body, c.wall, c.surface, 0};
    const auto [from, to] =
        std::equal_range(found_.begin(), found_.end(), wanted,
                         [](const Found& a, const Found& b) { return a.key() < b.key(); });
    const std::span<const double> all(strengths_.data() + (from - found_.begin()),
                                      static_cast<std::size_t>(to - from));
    return all.size() < 2 ? 1 : share(strength(depth, radius, wall_exponent_), all, wall_exponent_);
  }

  /// e^5 of (1), without the factors common to all contacts: R* d^5 for the Hertz law.
  static double strength(double depth, double R_eff, double exponent) {
    const double depth2 = depth * depth, depth5 = depth2 * depth2 * depth;
    if (exponent == 2.5) return R_eff * depth5;
    return exponent == 2 ? depth5 : depth5 * std::pow(R_eff, 5 * (exponent - 2) / exponent);
  }
  /// The share (2) of a contact of this strength among all that touch (itself included);
  /// `exponent`: a.
  static double share(double strength, std::span<const double> all, double exponent) {
    double squares = 0;
    for (const double e : all) squares += e * e;
    if (!(squares > 0)) return 1;                    // no contact, or all underflow
    const double x = strength * strength / squares;  // (e_k/D)^p
    if (exponent == 2.5) return std::sqrt(x) * std::sqrt(std::sqrt(x));
    return std::pow(x, 1 - exponent / power);
  }

 private:
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
    double strength;
    std::uint64_t key() const {
      return std::uint64_t{body} << 32 | std::uint32_t{wall} << 16 | surface;
    }
  };

  DynArray<std::uint32_t> begin_;  // entries of each body, at the body with the lower place
  DynArray<Entry> entries_;
  DynArray<Group> groups_;
  AlignedVector<Scalar> shares_;
  DynArray<Found> found_;
  DynArray<double> strengths_;  // for found_
  double wall_exponent_ = 2.5;
};

}  // namespace silt::detail
