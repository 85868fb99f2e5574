// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <numeric>
#include <vector>

#include <silt/engine/list_upkeep.hpp>
#include <silt/engine/pair_pipeline.hpp>
#include <silt/engine/particle_state.hpp>
#include <silt/engine/wall_pipeline.hpp>
#include <silt/motion/leapfrog.hpp>

namespace silt::detail {

/// The state of a simulation and the stages of its step, each a plain function of state. Knows the
/// policies, but neither observers nor files nor the order of the stages: that is Simulation's.
template <class ShapeType, class ContactsType, class Search, class Domain, class Arch>
class Engine {
 public:
  static constexpr bool rotates = ContactsType::rotates;
  static constexpr std::size_t chunks = load_chunks<ContactsType>;
  using State = ParticleState<rotates, ContactsType::several_materials>;
  using Motion = typename State::Motion;
  using Pairs = PairList<ContactsType::history>;
  using WallPairs = WallContacts<ContactsType::history>;

  /// State of one particle at a whole step [m/s].
  struct Synchronous {
    Vec3d velocity, spin_velocity;
  };

  State particles;
  std::vector<Wall> walls;
  Pairs pairs;
  WallPairs wall_pairs;
  ListUpkeep upkeep;
  AlignedVector<Vec3d> reference;          // [m] positions at the last search
  WallMarks searched_walls, pruned_walls;  // poses at the last search and pruning
  std::vector<Synchronous> synchronous;    // of the last observed step
  CoefficientTable<ContactsType> coefficients;
  double largest_radius = 0;   // [m]
  double mean_diameter = 0;    // [m]
  double largest_speed = 0;    // [m/s]
  double largest_overlap = 0;  // [-] over the smaller radius, in the last step
  bool finite = true;          // all velocities, after the last kick

  void set_threads(int threads) {
    if (!team_ || team_->threads() != threads) team_ = std::make_unique<Team>(threads);
  }

  void set_coefficients(const ContactsType& contacts) {
    const std::size_t n = contacts.materials();
    const std::size_t of_particles = ContactsType::several_materials ? n : 1;
    coefficients = {n, {}, {}};
    for (std::size_t a = 0; a < of_particles; ++a)
      for (std::size_t b = 0; b < n; ++b) {
        coefficients.law.push_back(contacts.coefficients(a, b));
        coefficients.rolling.push_back(contacts.rolling_coefficients(a, b));
      }
  }

  // --- search -------------------------------------------------------------------------------

  /// Renews what is stale of the lists; `closing` [m] bounds how far a sphere moves in a step.
  void renew_lists(Search& search, const Domain& domain, std::int64_t step, double closing) {
    if (inner_list_holds()) return;
    if (!outer_list_holds(search, domain)) find_pairs(search, domain, step, closing);
    prune(domain, step);
  }

  bool inner_list_holds() const {
    return upkeep.pruned_at >= 0 && upkeep.inner_holds(pruned_walls.travel(walls));
  }
  /// Makes the next step search anew, whatever has moved.
  void forget_lists() { upkeep.searched_at = upkeep.pruned_at = -1; }

  // --- forces -------------------------------------------------------------------------------

  void pair_forces(const Domain& domain, double time_step) {
    using Pipeline = PairPipeline<ContactsType, Domain, Arch>;
    largest_overlap = Pipeline::run(
        {particles.position.data(), particles.motion.data(), kinds_.data(), time_step}, pairs,
        coefficients, domain, shares_, {sums_.data(), rows_.data()}, *team_);
  }

  void wall_forces(double time_step) {
    if (walls.empty()) return;
    const double overlap = wall_pipeline_.run(
        {particles.position.data(), particles.motion.data(), particles.material.data(), time_step},
        wall_pairs, coefficients, walls, rows_.data() + wall_row_ * 4 * chunks, *team_);
    largest_overlap = std::max(largest_overlap, overlap);
  }

  void move_walls(double time) {
    for (auto& wall : walls) {
      if (!wall.moves()) continue;
      wall.last_pose = wall.pose;
      wall.pose = wall.motion(time);
    }
  }
  /// Before the very first step: the last pose is as if the first step had come before it too, so
  /// that walls have their velocity from the start. (Motions need not be defined before time 0.)
  void start_walls(double time, double time_step) {
    for (auto& wall : walls) {
      if (!wall.moves()) continue;
      const Pose next = wall.motion(time + time_step);
      const Quaternion back = wall.pose.rotation * conjugate(next.rotation);
      wall.last_pose = {
          back * wall.pose.rotation,
          wall.pose.translation + silt::rotate(back, wall.pose.translation - next.translation)};
    }
  }

  // --- integration --------------------------------------------------------------------------

  enum class Advance { KickAndDrift, KickAndRecord };

  /// Sums the rows of each particle, kicks for `kick_time` [s] and drifts for `time_step` [s]; or
  /// stops between kick and drift and records the state at the whole step (kick_time: since then).
  void integrate(Advance how, const Vec3d& gravity, double kick_time, double time_step,
                 bool first_kick) {
    if (how == Advance::KickAndRecord) synchronous.resize(particles.size());
    std::array<double, parts> fastest{}, check{};
    team_->for_parts(parts, [&](std::size_t p) {
      const std::size_t from = particles.size() * p / parts,
                        to = particles.size() * (p + 1) / parts;
      std::size_t extra = table_.extra_from(from);
      double speed2 = 0, sum = 0;
      for (std::size_t k = from; k < to; ++k) {
        double* const load = sums_.data() + k * 4 * chunks;
        add_table_rows<RowPack<Arch>, chunks>(table_, rows_.data(), k, extra, load);
        Motion& m = particles.motion[k];
        const Motion before = m;
        kick(m, load, gravity, kick_time);
        std::fill_n(load, 4 * chunks, 0.0);
        const double v2 = m.vx * m.vx + m.vy * m.vy + m.vz * m.vz;
        speed2 = std::max(speed2, v2), sum += v2;
        if (how == Advance::KickAndRecord)
          record(k, before, m, first_kick);
        else
          Leapfrog::drift(particles.position[k], m, time_step);
      }
      fastest[p] = speed2, check[p] = sum;
    });
    largest_speed = std::sqrt(*std::max_element(fastest.begin(), fastest.end()));
    finite = std::isfinite(std::accumulate(check.begin(), check.end(), 0.0));
    if (how == Advance::KickAndDrift) upkeep.travelled += largest_speed * time_step;
  }

  void drift(double time_step) {
    team_->for_parts(parts, [&](std::size_t p) {
      for (std::size_t k = particles.size() * p / parts; k < particles.size() * (p + 1) / parts;
           ++k)
        Leapfrog::drift(particles.position[k], particles.motion[k], time_step);
    });
    upkeep.travelled += largest_speed * time_step;
  }

  // --- particles that leave -----------------------------------------------------------------

  /// Takes particle k out of all contacts at once; the next search drops it.
  void park(std::size_t k) {
    constexpr double nowhere = std::numeric_limits<double>::quiet_NaN();
    particles.position[k] = {nowhere, nowhere, nowhere, 0};
    particles.motion[k] = Motion{};
    particles.id[k] = no_particle;
    ++parked_;
  }
  std::size_t parked() const { return parked_; }
  static bool is_parked(std::uint32_t id) { return id == no_particle; }

  /// Measures sizes anew after particles were added.
  void measure() {
    largest_radius = 0, mean_diameter = 0;
    for (const auto& p : particles.rows()) {
      largest_radius = std::max(largest_radius, p.r);
      mean_diameter += 2 * p.r;
    }
    if (particles.size() > 0) mean_diameter /= static_cast<double>(particles.size());
  }

  /// Completes a restored state: sizes as they were measured, and what follows from the lists.
  void restored(double radius, double diameter, double speed, double overlap) {
    largest_radius = radius, mean_diameter = diameter;
    largest_speed = speed, largest_overlap = overlap;
    parked_ =
        static_cast<std::size_t>(std::count(particles.id.begin(), particles.id.end(), no_particle));
    first_pruning_ = false;
    if (upkeep.pruned_at >= 0) renew_tables();  // else the next step makes lists and tables
  }

  std::size_t touching_pairs(const Domain& domain) const {
    std::size_t count = 0;
    for (std::size_t k = 0; k < pairs.size(); ++k)
      count += within_reach(particles.position[pairs.first()[k]],
                            particles.position[pairs.second()[k]], 0, domain);
    return count;
  }

  std::size_t bytes() const {
    return particles.position.capacity() * sizeof(PositionRow) +
           particles.motion.capacity() * sizeof(Motion) + reference.capacity() * sizeof(Vec3d) +
           (rows_.capacity() + sums_.capacity()) * sizeof(double) + pairs.bytes() + table_.bytes() +
           found_.capacity() * sizeof(IndexPair);
  }

 private:
  void renew_tables() {
    make_kinds();
    make_table();
  }

  static constexpr std::size_t parts = 64;  // pieces of the particle loop, whatever the threads

  static constexpr bool keeps_list = requires(Search & s) { s.finder; };
  static auto& finder(Search& search) {
    if constexpr (keeps_list)
      return search.finder;
    else
      return search;
  }

  bool outer_list_holds(const Search&, const Domain& domain) const {
    if (upkeep.searched_at < 0) return false;
    return upkeep.outer_holds(largest_displacement_since_search(domain),
                              searched_walls.travel(walls));
  }

  double largest_displacement_since_search(const Domain&) const {
    double most = 0;
    for (std::size_t k = 0; k < particles.size(); ++k) {
      if (is_parked(particles.id[k])) continue;
      const Vec3d d = particles.position[k].centre() - reference[k];
      most = std::max(most, dot(d, d));
    }
    return std::sqrt(most);
  }

  void find_pairs(Search& search, const Domain& domain, std::int64_t step, double closing) {
    previous_.resize(particles.size());
    std::iota(previous_.begin(), previous_.end(), 0u);
    if (parked_ > 0) drop_parked();
    if constexpr (Domain::periodic)
      for (std::size_t k = 0; k < particles.size(); ++k) {
        const Vec3d p = domain.wrapped(particles.position[k].centre());
        particles.position[k] = {p.x, p.y, p.z, particles.position[k].r};
      }
    if constexpr (keeps_list) {
      if (search.skin)
        upkeep.set_skin(*search.skin);
      else
        upkeep.choose_skins(mean_diameter, 2 * closing);
    }
    auto& find = finder(search);
    const auto spheres = [&] { return SphereSet{particles.rows(), largest_radius}; };
    if constexpr (keeps_list) {
      if constexpr (requires { find.order(spheres(), 1.0, domain, order_); })
        if (search.sort) {
          find.order(spheres(), upkeep.outer_skin, domain, order_);
          apply_order();
        }
    }
    find.find(spheres(), upkeep.outer_skin, domain, *team_, found_);
    pairs.set_outer(found_, particles.id, particles.motion.data(), previous_);
    wall_pairs.search(walls, particles.rows(), upkeep.outer_skin, previous_);

    reference.resize(particles.size());
    Box region;
    for (std::size_t k = 0; k < particles.size(); ++k) {
      reference[k] = particles.position[k].centre();
      region.include(reference[k]);
    }
    searched_walls.set(walls, region.grown(largest_radius + upkeep.outer_skin));
    upkeep.searched_at = step;
    first_pruning_ = true;
  }

  void prune(const Domain& domain, std::int64_t step) {
    const std::span<const std::uint32_t> none;
    pairs.prune(particles.position.data(), particles.size(), upkeep.inner_skin, domain,
                first_pruning_ ? std::span<const std::uint32_t>(previous_) : none, *team_);
    wall_pairs.prune(walls, particles.position.data(), upkeep.inner_skin);
    pruned_walls.set(walls, searched_walls.region());
    upkeep.travelled = 0;
    upkeep.pruned_at = step;
    first_pruning_ = false;
    renew_tables();
  }

  void make_kinds() {
    if constexpr (ContactsType::several_materials) {
      kinds_.assign(pairs.padded_size(), 0);
      for (std::size_t k = 0; k < pairs.size(); ++k)
        kinds_[k] = static_cast<std::uint16_t>(particles.material[pairs.first()[k]] *
                                                   coefficients.materials +
                                               particles.material[pairs.second()[k]]);
    }
  }

  /// Shares out the pairs, and finds the rows that act on each particle from elsewhere.
  void make_table() {
    make_shares();
    table_.clear(particles.size());
    std::uint32_t next = 1;
    for (auto& share : shares_) {
      share.first_row = next;
      for (std::size_t k = share.from; k < std::min(share.to, pairs.size()); ++k) {
        const std::uint32_t a = pairs.first()[k], b = pairs.second()[k];
        if (share.owns(a) && share.owns(b)) continue;
        if (!share.owns(a)) table_.add_plus(a, next);
        if (!share.owns(b)) table_.add_minus(b, next);
        ++next;
      }
    }
    wall_row_ = next;
    for (const auto& c : wall_pairs.candidates()) {
      const std::size_t count = WallPairs::slots_of(walls[c.wall].surfaces[c.surface]);
      for (std::uint32_t s = 0; s < count; ++s) table_.add_plus(c.particle, next + c.slot + s);
    }
    table_.finish();
    const std::size_t size = (wall_row_ + wall_pairs.slots()) * 4 * chunks;
    if (rows_.size() < size) rows_.resize(size + size / 8);
    std::fill_n(rows_.begin(), 4 * chunks, 0.0);
    sums_.assign(particles.size() * 4 * chunks, 0.0);
  }

  /// Shares of as many pairs each; a particle belongs to the share where its own pairs begin, which
  /// holds most of its neighbours if particles are sorted.
  void make_shares() {
    const std::size_t count = std::clamp<std::size_t>(particles.size() / 2048, 1, 16);
    shares_.assign(count, {});
    const auto owner = [&](std::size_t k) { return std::min(pairs.first()[k], pairs.second()[k]); };
    for (std::size_t s = 0; s < count; ++s) {
      const std::size_t from = pairs.padded_size() * s / count / Pairs::padding * Pairs::padding;
      shares_[s].from = from;
      if (s == 0) continue;
      std::uint32_t low = shares_[s - 1].low;
      if (from > 0 && from < pairs.size())
        low = std::max(low, owner(from) == owner(from - 1) ? owner(from) + 1 : owner(from));
      shares_[s].low = low;
    }
    for (std::size_t s = 0; s < count; ++s) {
      const bool last = s + 1 == count;
      shares_[s].to = last ? pairs.padded_size() : shares_[s + 1].from;
      shares_[s].high = last ? static_cast<std::uint32_t>(particles.size()) : shares_[s + 1].low;
    }
  }

  void drop_parked() {
    order_.clear();
    for (std::uint32_t k = 0; k < particles.size(); ++k)
      if (!is_parked(particles.id[k])) order_.push_back(k);
    apply_order();
    parked_ = 0;
    measure();
  }

  void apply_order() {
    particles.reorder(order_);
    std::vector<std::uint32_t> before(order_.size());
    for (std::size_t k = 0; k < order_.size(); ++k) before[k] = previous_[order_[k]];
    previous_.swap(before);
  }

  static void kick(Motion& m, const double* load, const Vec3d& gravity, double time) {
    Leapfrog::kick(m, load, gravity, time);
    if constexpr (rotates)
      Leapfrog::template spin<ContactsType::has_rolling>(m, load, ShapeType::inertia_factor(),
                                                         time);
  }

  /// At the whole step the velocity is the mean of the two half steps around it.
  void record(std::size_t k, const Motion& before, const Motion& after, bool first_kick) {
    auto& s = synchronous[k];
    s.velocity = first_kick ? before.velocity() : 0.5 * (before.velocity() + after.velocity());
    if constexpr (rotates)
      s.spin_velocity = first_kick ? before.spin_velocity()
                                   : 0.5 * (before.spin_velocity() + after.spin_velocity());
  }

  std::unique_ptr<Team> team_ = std::make_unique<Team>(1);
  WallPipeline<ContactsType, Arch> wall_pipeline_;
  ReductionTable table_;
  std::vector<PairShare> shares_;
  AlignedVector<double> sums_;  // [N] load on each particle, zero between the steps
  AlignedVector<double> rows_;  // row 0 is zero, then pairs of two shares, then wall slots
  std::size_t wall_row_ = 1;    // where those of the walls begin
  std::vector<std::uint16_t> kinds_;
  std::vector<IndexPair> found_;
  std::vector<std::uint32_t> order_, previous_;
  bool first_pruning_ = true;
  std::size_t parked_ = 0;  // particles that left since the last search
};

}  // namespace silt::detail
