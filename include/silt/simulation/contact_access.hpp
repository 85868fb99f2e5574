// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numeric>
#include <span>
#include <tuple>
#include <utility>

#include <silt/boundary/wall.hpp>
#include <silt/core/dyn_array.hpp>
#include <silt/core/error.hpp>
#include <silt/engine/checks/guard_overlap.hpp>
#include <silt/engine/contact/contact_events.hpp>
#include <silt/engine/contact/contact_record.hpp>
#include <silt/engine/lists/wall_candidate.hpp>
#include <silt/engine/lists/wall_seams.hpp>

namespace silt::inline SILT_TARGET {

inline constexpr std::size_t no_facet = std::numeric_limits<std::size_t>::max();

/// A contact as for_each_contact() shows it: of two particles, or of a particle and a wall. Bodies
/// have one contact for each pair of parts; at a wall there is one for each place where the
/// particle touches a surface. Forces are those of the step at time(): computed from the positions
/// at time() and, for damping and friction, from the velocities half a step before (Leapfrog).
struct ContactSeen {
  ParticleId a = no_particle;          // the one with the lower id of two particles
  ParticleId b = no_particle;          // no_particle: the partner is a wall
  std::size_t place_a = 0;             // index of a: 0 ... rows()-1
  std::size_t place_b = 0;             // index of b; rows() at a wall
  std::size_t part_a = 0, part_b = 0;  // number of the part of a body
  std::size_t wall = no_wall;          // the wall's number, or no_wall
  std::size_t surface = 0;             // of the wall's surfaces
  std::size_t facet =
      no_facet;               // of a mesh: the triangle nearest to the point, the lowest of equals
  Vec3d point{0, 0, 0};       // [m] where the force acts, in the image of a
  Vec3d wall_point{0, 0, 0};  // [m] the same on the wall; differs if a touches an image
  Vec3d normal{0, 0, 0};      // [-] from b, or the wall, to a
  Vec3d branch{0, 0, 0};      // [m] from the centre of b (or the point at a wall) to that of a
  double overlap = 0;         // [m] negative where a law acts at a distance
  double normal_force = 0;    // [N] > 0: repulsive
  Vec3d tangential_force{0, 0, 0};             // [N] on a
  Vec3d force{0, 0, 0};                        // [N] on a: the sum of both
  Vec3d torque_a{0, 0, 0}, torque_b{0, 0, 0};  // [N m] about the centres of mass; b: 0 for walls
  Vec3d couple{0, 0, 0};  // [N m] on a, in addition to the moment of `force`: rolling, areas
  Vec3d spring{0, 0, 0};  // [N] of the tangential spring on a, without its dashpot
  double cohesion = 0;    // [N] >= 0, attractive part of the normal force (Cohesive)
  /// The history of law and rolling model in their own order (of the first point of an area). In a
  /// Mix of two shapes, the shape named first is i there.
  std::span<const double> history;
};

namespace detail {

/// Whether a program reads the contacts of this type of simulation anywhere: instantiating
/// for_each_contact() sets it before main().
template <class Sim>
inline bool asks_for_contacts = false;
template <class Sim>
struct ContactsAsked {
  static inline const bool noted = (asks_for_contacts<Sim> = true);
};

/// Converts the record of a step to ContactSeen, in the order of ids.
template <class Engine, class Domain>
class ContactReader {
 public:
  ContactReader(const Engine& engine, const Domain& domain) : e_(engine), domain_(domain) {
    put_in_order();
    list_candidates();
  }

  template <class F>
  void for_each(F&& f) const {
    const auto& all = e_.record.contacts;
    const std::size_t kept = all.empty() ? 0 : e_.record.numbers.size() / all.size();
    for (std::size_t k = 0; k < order_.size(); ++k) {
      if (k + 2 * ahead < order_.size()) fetch(&all[order_[k + 2 * ahead].index]);
      if (k + ahead < order_.size()) fetch_rows(all[order_[k + ahead].index]);
      const Place& at = order_[k];
      ContactSeen c = seen(all[at.index], at.index, at.swapped);
      c.a = at.a, c.b = at.b;
      c.history = {e_.record.numbers.data() + kept * at.index, kept};
      f(static_cast<const ContactSeen&>(c));
    }
  }

 private:
  struct Place {
    ParticleId a, b;
    std::uint32_t index;
    bool swapped;
  };
  // The order of ids is not that of memory, so the data of later contacts are prefetched.
  static constexpr std::size_t ahead = 8;
  template <class T>
  static void fetch(const T* of) {
    const char* const bytes = reinterpret_cast<const char*>(of);
    for (std::size_t line = 0; line < sizeof(T); line += 64) __builtin_prefetch(bytes + line);
    __builtin_prefetch(bytes + sizeof(T) - 1);
  }
  void fetch_rows(const RecordedForce& c) const {
    fetch(&e_.particles.position[c.first]);
    if (!c.at_wall()) fetch(&e_.particles.position[c.second]);
  }
  using Candidate = typename decltype(Engine::lists.walls)::Candidate;
  struct Listed {
    std::uint32_t particle;
    std::uint16_t wall, surface;
    const Candidate* candidate;
    auto key() const { return std::tie(particle, wall, surface); }
  };

  ParticleId id_of(std::uint32_t row) const {
    return e_.particles.is_parked(row) ? no_particle : e_.id_of(row);
  }
  /// Sorts by a, b, then by what distinguishes several contacts of the same two: buckets of
  /// consecutive ids, each sorted. Contacts of particles that have left since are dropped.
  void put_in_order() {
    const DynArray<Place> found = those_present();
    if (found.empty()) return;
    const auto [low, high] = std::minmax_element(
        found.begin(), found.end(), [](const Place& p, const Place& q) { return p.a < q.a; });
    const ParticleId from = low->a;
    int shift = 0;  // 2^shift ids per bucket, fewer buckets than contacts
    while ((high->a - from) >> shift >= found.size()) ++shift;
    const std::size_t buckets = ((high->a - from) >> shift) + 1;
    // begin[k + 1] is the next free place of bucket k, and its end when all are filled.
    DynArray<std::uint32_t> begin(buckets + 2, 0);
    for (const Place& p : found) ++begin[((p.a - from) >> shift) + 2];
    std::partial_sum(begin.begin(), begin.end(), begin.begin());
    order_.resize(found.size());
    for (const Place& p : found) order_[begin[((p.a - from) >> shift) + 1]++] = p;
    for (std::size_t k = 0; k < buckets; ++k) sort(begin[k], begin[k + 1]);
  }
  DynArray<Place> those_present() const {
    const auto& all = e_.record.contacts;
    DynArray<Place> found;
    found.reserve(all.size());
    for (std::uint32_t k = 0; k < all.size(); ++k) {
      const RecordedForce& c = all[k];
      const bool at_wall = c.at_wall();
      const ParticleId first = id_of(c.first), second = at_wall ? no_particle : id_of(c.second);
      if (first == no_particle || (!at_wall && second == no_particle)) continue;
      const bool swapped = second < first;
      if constexpr (Engine::of_ranks)  // reported by the owner of the lower id
        if ((swapped ? c.second : c.first) >= e_.particles.owned()) continue;
      found.push_back({swapped ? second : first, swapped ? first : second, k, swapped});
    }
    return found;
  }
  bool comes_before(const Place& p, const Place& q) const {
    if (p.a != q.a) return p.a < q.a;
    if (p.b != q.b) return p.b < q.b;
    return among_two(p) < among_two(q);
  }
  /// Buckets usually hold two or three contacts, for which insertion sort is the fastest.
  void sort(std::size_t from, std::size_t to) {
    const auto before = [this](const Place& p, const Place& q) { return comes_before(p, q); };
    if (to - from > 16) {
      const auto at = order_.begin();
      return std::sort(at + static_cast<std::ptrdiff_t>(from), at + static_cast<std::ptrdiff_t>(to),
                       before);
    }
    for (std::size_t k = from + 1; k < to; ++k) {
      const Place one = order_[k];
      std::size_t at = k;
      for (; at > from && before(one, order_[at - 1]); --at) order_[at] = order_[at - 1];
      order_[at] = one;
    }
  }
  /// What distinguishes contacts of the same two partners.
  auto among_two(const Place& p) const {
    const RecordedForce& c = e_.record.contacts[p.index];
    return std::tuple(c.wall, c.surface, part_of(p.swapped ? c.second : c.first),
                      part_of(p.swapped ? c.first : c.second), c.order);
  }
  std::uint32_t part_of(std::uint32_t row) const {
    return row & RecordedForce::wall_bit ? 0 : e_.part_of(row);
  }

  /// `swapped`: the first row's particle is b. Inline, so that values that a caller does not read
  /// are not computed.
  SILT_INLINE ContactSeen seen(const RecordedForce& r, std::size_t index, bool swapped) const {
    const auto& rows = e_.particles.position;
    const PositionRow& first = rows[r.first];
    const bool at_wall = r.at_wall();
    RecordedTurn turn;
    if (!e_.record.turns.empty()) turn = e_.record.turns[index];
    // For spheres the overlap is shared in proportion to the radii, as for the law's lever arms.
    if constexpr (!Engine::convex) {
      const double reach = first.r + (at_wall ? 0 : rows[r.second].r);
      turn.arm = -(first.r * (reach - r.overlap) / reach) * r.normal;
    }
    const Vec3d centre = e_.centre_beside(r.first), point = first.centre() + turn.arm;
    ContactSeen c;
    c.overlap = r.overlap, c.normal = r.normal, c.force = r.force, c.couple = turn.couple_i;
    if (!e_.record.parts.empty())
      c.spring = e_.record.parts[index].spring, c.cohesion = e_.record.parts[index].cohesion;
    c.point = point;
    c.torque_a = cross(point - centre, r.force) + turn.couple_i;
    set_end(r.first, c.place_a, c.part_a);
    if (at_wall) {
      c.place_b = e_.owners(), c.branch = centre - point;
      c.wall = r.wall, c.surface = r.surface;
      c.wall_point = point;
      if (!listed_.empty()) look_at_wall(r, c);
    } else {
      Vec3d between = rows[r.second].centre() - first.centre();
      if constexpr (Domain::periodic) between = domain_.shortest(between);
      const Vec3d own = e_.centre_beside(r.second);  // the second is an image near the first
      const Vec3d other = first.centre() + between + (own - rows[r.second].centre());
      c.branch = centre - other;
      c.torque_b = cross(point - other, -r.force) + turn.couple_j;
      set_end(r.second, c.place_b, c.part_b);
      if (swapped) {
        std::swap(c.place_a, c.place_b), std::swap(c.part_a, c.part_b);
        std::swap(c.torque_a, c.torque_b);
        c.normal = -c.normal, c.branch = -c.branch, c.force = -c.force, c.spring = -c.spring;
        c.couple = turn.couple_j, c.point = point + (own - other);
      }
    }
    c.normal_force = dot(c.force, c.normal);
    c.tangential_force = c.force - c.normal_force * c.normal;
    return c;
  }
  void set_end(std::uint32_t row, std::size_t& place, std::size_t& part) const {
    place = e_.owner_of(row), part = e_.part_of(row);
  }

  static constexpr bool walls_repeat = std::remove_cvref_t<decltype(Engine::lists.walls)>::repeats;

  /// Candidates at meshes (all candidates if walls have images), to be looked up by row, wall and
  /// surface.
  void list_candidates() {
    const auto candidates = e_.lists.walls.candidates();
    bool all = false;
    if constexpr (walls_repeat)
      all = std::any_of(candidates.begin(), candidates.end(),
                        [](const Candidate& c) { return c.image != 0; });
    for (const Candidate& c : candidates)
      if (c.surface < e_.walls[c.wall].surfaces.size() && (all || mesh_of(c) != nullptr))
        listed_.push_back({c.particle, c.wall, c.surface, &c});
    std::sort(listed_.begin(), listed_.end(), [](const Listed& p, const Listed& q) {
      return p.candidate->key() < q.candidate->key();
    });
  }
  template <class Of>
  const TriangleMesh* mesh_of(const Of& c) const {
    const auto* const mesh =
        std::get_if<std::shared_ptr<const TriangleMesh>>(&e_.walls[c.wall].surfaces[c.surface]);
    return mesh != nullptr ? mesh->get() : nullptr;
  }
  /// Which facet is touched, and the point relative to the wall. (The images of a wall that a
  /// particle may touch are adjacent in the list.)
  void look_at_wall(const RecordedForce& r, ContactSeen& c) const {
    const Listed wanted{r.first, r.wall, r.surface, nullptr};
    const auto [from, to] =
        std::equal_range(listed_.begin(), listed_.end(), wanted,
                         [](const Listed& p, const Listed& q) { return p.key() < q.key(); });
    if (from == to) return;
    const Candidate* touched = from->candidate;
    if constexpr (walls_repeat) {
      if (const auto known = r.image()) {
        for (auto image = from; image != to; ++image)
          if (image->candidate->image == *known) touched = image->candidate;
      } else {
        const std::span<const Candidate> images(touched, static_cast<std::size_t>(to - from));
        touched = &nearest_image(c.point, images, e_.walls[r.wall], e_.lists.walls);
      }
    }
    c.wall_point = e_.lists.walls.seen(*touched, c.point);
    const TriangleMesh* const mesh = mesh_of(r);
    if (mesh == nullptr) return;
    // From slightly above the point, to find the face that points to the particle.
    const double above = 1e-3 * e_.particles.position[r.first].r;
    const Vec3d eye =
        in_wall(e_.walls[r.wall], e_.lists.walls.seen(*touched, c.point + above * c.normal));
    double least = std::numeric_limits<double>::infinity();
    for (const std::uint32_t t : e_.lists.walls.facets(*touched)) {
      const double distance = mesh->distance_to(t, eye);
      if (distance < least - mesh->round_off()) least = distance, c.facet = t;
    }
  }

  const Engine& e_;
  const Domain& domain_;
  DynArray<Place> order_;
  DynArray<Listed> listed_;
};

/// Read access to the contacts of a Simulation; member functions of Simulation.
template <class Sim>
class ContactAccess {
 public:
  /// Number of pairs of particles that touch [-]; for bodies, of their parts. Cost O(pairs);
  /// collective with several ranks (RankAccess).
  std::size_t touching_pairs() const {
    const std::size_t own = sim().engine_.touching_pairs(sim().domain_);
    if constexpr (Sim::has_ranks)
      return static_cast<std::size_t>(sim().sum_over_ranks(static_cast<double>(own)));
    return own;
  }
  /// The deepest contact of the forces of step 0, and how many overlap by more than `limit` [-] of
  /// the smaller radius: before anything has moved. Empty later, and in a run that continues.
  DeepContact overlap_at_start(double limit) const {
    const Sim& s = sim();
    if (s.step_ > 0 || s.continued_ || s.scene_changed_ || !(s.engine_.largest_overlap > limit))
      return {};
    return deepest_contact(s.engine_, s.domain_, s.kicked_ ? 0 : s.dt_, limit, {});
  }
  /// Number of contacts that the law's safeguard has ended since the start [-] (Softened).
  template <class S = Sim>
  std::uint64_t safeguarded() const requires has_safeguard<typename S::ContactsType::Law> {
    static_assert(!S::has_ranks,
                  "safeguarded() counts on one process alone: a contact between two "
                  "ranks would count twice; leave Ranks out");
    return sim().engine_.safeguards;
  }
  /// Calls f(const ContactSeen&) for each contact of the step at time(), in the order of ids. It
  /// can be called in observers and between runs: steps with an observer written by the user, and
  /// the last step of each run, are recorded (keep_contacts). Cost O(contacts); changes nothing.
  /// With several ranks each contact is visited on the rank that owns a; if another rank owns b,
  /// place_b is not a place of this rank.
  /// Errors: InputError if the present step was not recorded.
  template <class F>
  void for_each_contact(F&& f) const {
    static_cast<void>(&ContactsAsked<Sim>::noted);
    visit(f, "Simulation::for_each_contact", has_contacts());
  }
  /// Whether for_each_contact() can be called now.
  bool has_contacts() const { return is_recorded() && sim().engine_.record.is_whole(); }
  /// Whether the present step was done without being recorded, as before a run that continues:
  /// observers that read contacts are then called one step later.
  bool awaits_contacts() const { return sim().kicked_ && !is_recorded(); }
  /// The same for observers that declare that they read contacts (reads_contacts); spring, cohesion
  /// and history are missing if none of them needs more than forces.
  template <class F>
  void visit_contacts(F&& f, const char* who) const {
    visit(f, who, is_recorded());
  }

 private:
  const Sim& sim() const { return static_cast<const Sim&>(*this); }
  bool is_recorded() const {
    const Sim& s = sim();
    return s.kicked_ && s.engine_.record.is_of(s.step_);
  }
  template <class F>
  void visit(F&& f, const char* who, bool can) const {
    const Sim& s = sim();
    require(
        can, who, ": the contacts of step ", s.step_,
        " were not recorded; ask in an observer or after run(), with keep_contacts = true (after "
        "a checkpoint was loaded: after run())");
    ContactReader(s.engine_, s.domain_).for_each(f);
  }
};

}  // namespace detail
}  // namespace silt
