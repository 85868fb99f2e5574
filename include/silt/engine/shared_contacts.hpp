// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include <silt/core/storage.hpp>
#include <silt/core/threads.hpp>
#include <silt/engine/guard.hpp>

namespace silt::inline SILT_TARGET::detail {

/// How bodies of several parts share the stiffness of a contact. Where n parts of a body press on
/// the same partner side by side, n springs would act where the material has one, and n dashpots.
/// Each contact k gives the share 1/n_k of its force, with n_k the number of contacts that press
/// the same way as it does, each counted by how deep it is:
///
///   n_k = (sum_j c_kj d_j)^2 / sum_j c_kj d_j^2,   c_kj = max(0, n_k.n_j)^2                    (1)
///
/// over the overlaps d_j and normals n_j of the contacts with the same partner: another body, or
/// all walls together. n of equal depth and direction count n; one that has just begun counts 0, so
/// that forces are continuous; contacts across each other, as in a corner, do not share. Friction
/// and damping go with the normal force. The forces have no potential: bodies rock at a cost or
/// gain of energy, tests/engine/shared_contacts.cpp says how much.
/// Shapes: shares by place in the inner list; 1 where a pair of bodies has one pair of parts.
/// Source: Kodam et al., Chem. Eng. Sci. 64 (2009) 3466, divide by the plain number of contacts.
template <class Scalar>
class SharedContacts {
 public:
  /// A contact as its partners share it.
  struct Touch {
    double depth;  // [m]
    Vec3d normal;
  };

  /// After the inner list is new: finds the pairs of bodies that have several pairs of parts.
  template <class List, class State>
  void renew(const List& list, const State& particles, std::size_t bodies) {
    const auto body = [&](std::uint32_t row) { return particles.part[row].body; };
    begin_.assign(bodies + 1, 0);
    list.for_each([&](std::size_t k) {
      ++begin_[std::min(body(list.first()[k]), body(list.second()[k])) + 1];
    });
    for (std::size_t b = 0; b < bodies; ++b) begin_[b + 1] += begin_[b];
    entries_.resize(begin_[bodies]);
    std::vector<std::uint32_t> next(begin_.begin(), begin_.end() - 1);
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
        if (to - from > 1) groups_.push_back({from, to});
      }
    }
  }

  /// The shares of all pairs now.
  template <class List, class State, class Domain>
  void share_pairs(const List& list, const State& particles, const Domain& domain,
                   const Team& team) {
    shares_.assign(list.padded_size(), 1);
    constexpr std::size_t piece = 64;
    team.for_parts((groups_.size() + piece - 1) / piece, [&](std::size_t p) {
      std::vector<Touch> touching;
      std::vector<std::uint32_t> places;
      for (std::size_t g = p * piece; g < std::min(groups_.size(), (p + 1) * piece); ++g) {
        touching.clear(), places.clear();
        for (std::uint32_t e = groups_[g].from; e < groups_[g].to; ++e) {
          const std::uint32_t k = entries_[e].place;
          const PositionRow &a = particles.position[list.first()[k]],
                            &b = particles.position[list.second()[k]];
          Vec3d d = a.centre() - b.centre();
          if constexpr (Domain::periodic) d = domain.shortest(d);
          const double reach = a.r + b.r, distance2 = dot(d, d);
          if (!(distance2 < reach * reach)) continue;
          const double distance = std::sqrt(distance2);
          touching.push_back({reach - distance, d * (1 / distance)}), places.push_back(k);
        }
        if (touching.size() > 1)
          for (std::size_t k = 0; k < places.size(); ++k)
            shares_[places[k]] = static_cast<Scalar>(1 / count(touching[k], touching));
      }
    });
  }
  const Scalar* shares() const { return shares_.data(); }

  /// Looks at all contacts with walls.
  template <class EngineType>
  void share_walls(const EngineType& e) {
    found_.clear();
    std::uint32_t row = no_particle;
    std::size_t first_of_row = 0;
    for_each_wall_contact(e, 0, [&](const WallCandidate& c, const SurfacePoint& point) {
      const double depth = e.particles.position[c.particle].r - point.distance;
      if (!(depth > 0)) return;
      if (c.particle != row) row = c.particle, first_of_row = found_.size();
      // A part that touches two surfaces where they join has one contact there.
      for (std::size_t k = first_of_row; k < found_.size(); ++k)
        if (dot(found_[k].touch.normal, point.normal) > same_contact) {
          found_[k].touch.depth = std::max(found_[k].touch.depth, depth);
          return;
        }
      found_.push_back({e.particles.part[c.particle].body, {depth, point.normal}});
    });
    wall_begin_.assign(e.mover.bodies.size() + 1, 0);
    for (const auto& f : found_) ++wall_begin_[f.body + 1];
    for (std::size_t b = 0; b + 1 < wall_begin_.size(); ++b) wall_begin_[b + 1] += wall_begin_[b];
    wall_touches_.resize(found_.size());
    std::vector<std::uint32_t> next(wall_begin_.begin(), wall_begin_.end() - 1);
    for (const auto& f : found_) wall_touches_[next[f.body]++] = f.touch;
  }
  /// The share of a contact of a part of `body` with a wall.
  double of_wall(std::uint32_t body, const Touch& contact) const {
    const std::span<const Touch> all(wall_touches_.data() + wall_begin_[body],
                                     wall_begin_[body + 1] - wall_begin_[body]);
    return all.size() < 2 ? 1 : 1 / count(contact, all);
  }

  /// n_k of (1), at least 1.
  static double count(const Touch& k, std::span<const Touch> all) {
    double sum = 0, squares = 0;
    for (const Touch& j : all) {
      const double cosine = std::max(0.0, dot(k.normal, j.normal)), c = cosine * cosine;
      sum += c * j.depth, squares += c * j.depth * j.depth;
    }
    return squares > 0 ? std::max(1.0, sum * sum / squares) : 1;
  }

 private:
  static constexpr double same_contact = 0.95;  // cosine
  struct Entry {
    std::uint32_t partner, place;
    auto operator<=>(const Entry&) const = default;
  };
  struct Group {
    std::uint32_t from, to;  // of entries
  };
  struct Found {
    std::uint32_t body;
    Touch touch;
  };

  std::vector<std::uint32_t> begin_;  // of each body's entries, as the one with the lower place
  std::vector<Entry> entries_;
  std::vector<Group> groups_;
  AlignedVector<Scalar> shares_;
  std::vector<Found> found_;
  std::vector<std::uint32_t> wall_begin_;
  std::vector<Touch> wall_touches_;
};

}  // namespace silt::detail
