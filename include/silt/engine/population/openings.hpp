// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include <silt/core/box.hpp>
#include <silt/core/dyn_array.hpp>
#include <silt/core/error.hpp>
#include <silt/core/random.hpp>
#include <silt/engine/population/occupied_places.hpp>
#include <silt/fill/packing.hpp>
#include <silt/fill/region.hpp>

namespace silt::inline SILT_TARGET {

/// An outlet removes particles whose centre is inside `region`. It is checked whenever a particle
/// may have moved by its inner reach (ListUpkeep: at most a quarter of the mean diameter, or a
/// tenth of a skin that the user set); the region must be thicker than that.
struct Outlet {
  Box region;               // [m]
  std::uint64_t count = 0;  // [-] left so far
  double mass = 0;          // [kg] left so far
};

/// A further kind of particles in the recipe of an inlet.
struct InletShare {
  double share;               // [-] number fraction; the rest is the inlet's own kind
  SizeDistribution radius{};  // [m] as InletFlow::radius
  double density = 0;         // [kg/m3]
  std::size_t material = 0, form = 0;
};

/// The flow of an inlet. Every `interval`, new spheres are placed at random free positions in its
/// region, where they touch neither particles nor walls; those without a free position wait for the
/// next insertion. With a `mass_rate`, the number follows from the mean mass of a particle.
struct InletFlow {
  SizeDistribution radius{};  // [m] for bodies, of the bounding sphere; left out: as the form was
                              // made
  double density = 0;         // [kg/m3]
  double rate = 0;            // [1/s] particles per second; or use mass_rate
  Vec3d velocity{0, 0, 0};    // [m/s]
  std::uint64_t total = 0;    // [-] stops after this number; 0: never
  std::size_t material = 0;   // [-] index in the contacts' table
  std::uint64_t seed = 1;
  std::size_t trials = 200;          // [-] occupied positions tried for one sphere
  double interval = 0;               // [s] between insertions; 0: time of flight over a diameter
  std::size_t form = 0;              // [-] for bodies, which get random orientations
  double mass_rate = 0;              // [kg/s] in place of `rate`
  DynArray<InletShare> recipe = {};  // further kinds of particles
  Vec3d angular_velocity{0, 0, 0};   // [rad/s]
  Vec3d scatter{0, 0, 0};  // [m/s] each component of a velocity differs by up to this, uniformly

  std::size_t kinds() const { return 1 + recipe.size(); }
  InletShare kind(std::size_t k) const {
    if (k > 0) return recipe[k - 1];
    double left = 1;
    for (const auto& other : recipe) left -= other.share;
    return {left, radius, density, material, form};
  }
  double largest_radius() const {  // [m]
    double most = radius.max();
    for (const auto& other : recipe) most = std::max(most, other.radius.max());
    return most;
  }
};

/// An inlet and its counters: Simulation::inlet().
struct Inlet {
  InletFlow flow;
  std::string region;            // in words
  Box bounds;                    // [m]
  double start = 0;              // [s] of the present rate
  double interval = 0;           // [s] in use
  std::uint64_t placed = 0;      // [-] so far
  std::uint64_t waiting = 0;     // [-] due, but without a free position at the last insertion
  std::uint64_t insertions = 0;  // [-] number of insertions
  Random random{1};
  std::string obstacle = {};  // why the first waiting particle was not placed, and what to change
  double mass = 0;            // [kg] of the particles placed so far
  double before = 0;          // [-] particles that were due at `start`, from earlier rates

  /// [-] particles due from the first rate until `time` [s], the one of the very start left out.
  double due(double time) const { return before + flow.rate * (time - start); }

  /// A sentence on the last insertion: what blocked it, particles (some by id), walls (by name), or
  /// the region itself; empty if all particles that were due have been placed.
  std::string why_waiting() const {
    if (waiting == 0) return {};
    return text("inlet into ", region, ": ", placed, " particles placed, ", waiting,
                " wait, because ", why());
  }
  /// Its second half. After a restart the reason is known from the next insertion on.
  std::string why() const {
    if (!obstacle.empty()) return obstacle;
    return text(flow.trials,
                " random places in a row were occupied; lower the rate, enlarge the region, or "
                "give a velocity that clears it");
  }
};

namespace detail {

/// Inlets and outlets of a simulation.
template <class ShapeType, class Domain>
class Openings {
 public:
  std::size_t add_outlet(const Box& region) {
    require(
        region.min.x < region.max.x && region.min.y < region.max.y && region.min.z < region.max.z,
        "add_outlet: the region from ", region.min, " to ", region.max, " m is empty");
    outlets_.push_back({region});
    return outlets_.size() - 1;
  }
  template <Region R>
  std::size_t add_inlet(const R& region, const InletFlow& flow, double time) {
    require_positive("InletFlow.density", flow.density, "kg/m3");
    require(flow.rate != 0,
            "InletFlow.rate = 0 [1/s] and mass_rate = 0 [kg/s]: give one of them, greater than 0");
    require_positive("InletFlow.rate", flow.rate, "1/s");
    for (std::size_t k = 1; k < flow.kinds(); ++k) {
      require_positive("InletShare.density", flow.kind(k).density, "kg/m3");
      require_positive("InletShare.share", flow.kind(k).share, "-");
    }
    require(flow.kind(0).share >= -1e-12, "InletFlow.recipe: its shares are ",
            1 - flow.kind(0).share, " [-] together; they must be at most 1");
    require_not_negative("InletFlow.interval", flow.interval, "s");
    require(is_finite(flow.velocity), "InletFlow.velocity = ", flow.velocity,
            " [m/s] must be finite");
    require(is_finite(flow.angular_velocity),
            "InletFlow.angular_velocity = ", flow.angular_velocity, " [rad/s] must be finite");
    const Vec3d& s = flow.scatter;
    require(is_finite(s) && std::min({s.x, s.y, s.z}) >= 0, "InletFlow.scatter = ", s,
            " [m/s] must be finite and not negative");
    require(flow.trials > 0, "InletFlow.trials = 0 [-] must be at least 1");
    const auto place = region_of(region);
    const Box bounds = place.bounds();
    const Vec3d e = bounds.extent();
    require(std::min({e.x, e.y, e.z}) >= 2 * flow.largest_radius(), "add_inlet: ", place.describe(),
            " is thinner than the largest sphere of radius ", flow.largest_radius(), " m");
    inlets_.push_back({flow, place.describe(), bounds, time, 0, 0, 0, 0, Random(flow.seed)});
    places_.push_back([place](const Occupied& occupied, const Placement& sphere, Random& random) {
      return try_place(place, occupied, sphere, random);
    });
    return inlets_.size() - 1;
  }
  /// From `time` [s] on inlet k has another rate [1/s]. What is due stays due; at 0 it is
  /// forgotten.
  void set_rate(std::size_t k, double rate, double time) {
    at("inlet", inlets_, k);
    require_not_negative("set_inlet_rate: rate", rate, "1/s");
    Inlet& inlet = inlets_[k];
    if (rate == inlet.flow.rate) return;
    if (inlet.flow.rate == 0)
      inlet.before = static_cast<double>(inlet.placed);
    else
      inlet.before = inlet.due(time);
    if (rate == 0) inlet.waiting = 0, inlet.obstacle.clear();
    inlet.flow.rate = rate, inlet.start = time, inlet.interval = 0, inlet.insertions = 0;
  }
  const Outlet& outlet(std::size_t k) const { return at("outlet", outlets_, k); }
  const Inlet& inlet(std::size_t k) const { return at("inlet", inlets_, k); }
  DynArray<Outlet>& outlets() { return outlets_; }
  /// The first inlet whose region contains this position [m].
  std::optional<std::size_t> inlet_at(const Vec3d& place) const {
    for (std::size_t k = 0; k < inlets_.size(); ++k)
      if (inlets_[k].bounds.contains(place)) return k;
    return std::nullopt;
  }
  DynArray<Inlet>& inlets() { return inlets_; }
  const DynArray<Outlet>& outlets() const { return outlets_; }
  const DynArray<Inlet>& inlets() const { return inlets_; }

  /// Before a step: removes particles at outlets if they may have moved, and inserts those that are
  /// due.
  template <class Engine, class Sim>
  void update(Engine& engine, Sim& sim) {
    if (!outlets_.empty() && !engine.lists.hold(engine.walls)) let_out(engine, sim);
    for (std::size_t k = 0; k < inlets_.size(); ++k) {
      if constexpr (Engine::of_ranks)  // the others wait for this rank's ghosts, if it fails too
        engine.ranks.until_later([&] { let_in(inlets_[k], places_[k], engine, sim); });
      else
        let_in(inlets_[k], places_[k], engine, sim);
    }
  }

 private:
  using Occupied = OccupiedPlaces<Domain>;
  using Place = std::function<std::optional<Vec3d>(const Occupied&, const Placement&, Random&)>;

  template <class Engine, class Sim>
  void let_out(Engine& engine, Sim& sim) {
    if constexpr (Engine::of_ranks) {
      const DynArray<Outlet> before = outlets_;
      let_out_own(engine, sim);
      engine.ranks.share_left(outlets_, before);
      if constexpr (Sim::has_bonds)  // other ranks have their bonds and ghosts
        for (std::size_t k = 0; k < outlets_.size() && engine.ranks.size() > 1; ++k)
          if (outlets_[k].count != before[k].count) engine.lists.forget();
    } else {
      let_out_own(engine, sim);
    }
  }
  template <class Engine, class Sim>
  void let_out_own(Engine& engine, Sim& sim) {
    for (std::size_t k = 0; k < sim.rows(); ++k) {
      if (!sim.is_present(k)) continue;
      const Vec3d p = sim.position(k);
      for (auto& o : outlets_) {
        if (!contains_image(o.region, sim.domain(), p)) continue;
        ++o.count;
        if (const double m = sim.mass(k); std::isfinite(m)) o.mass += m;
        sim.book_leaving(k);
        engine.park(k);
        break;
      }
    }
  }

  /// Whether the region contains the point [m] or an image of it in a periodic box.
  static bool contains_image(const Box& region, const Domain& domain, const Vec3d& p) {
    if (region.contains(p)) return true;
    if constexpr (Domain::periodic && !deforms<Domain>) {
      // Between searches a particle may be outside the box.
      if (region.contains(domain.wrapped(p))) return true;
      const auto lowest = [&](int d, double x, double min) {  // image behind the lower face
        const double L = domain.length(d);
        return L > 0 && std::isfinite(min) ? x - L * std::floor((x - min) / L) : x;
      };
      return region.contains({lowest(0, p.x, region.min.x), lowest(1, p.y, region.min.y),
                              lowest(2, p.z, region.min.z)});
    } else {
      return false;
    }
  }

  template <class Engine, class Sim>
  void let_in(Inlet& inlet, const Place& place, Engine& engine, Sim& sim) {
    if (inlet.flow.rate == 0) return;
    if (inlet.interval == 0) inlet.interval = choose_interval(inlet.flow, sim.gravity);
    const double since = sim.time() - inlet.start;
    if (since < static_cast<double>(inlet.insertions) * inlet.interval) return;
    ++inlet.insertions;
    auto due = static_cast<std::uint64_t>(inlet.due(sim.time())) + 1;
    if (inlet.flow.total > 0) due = std::min(due, inlet.flow.total);
    if (due <= inlet.placed) return;
    SphereGrid occupied;
    const Box near = inlet.bounds.grown(
        2 * std::max(engine.particles.largest_radius, inlet.flow.largest_radius()));
    const auto occupy = [&](const Vec3d& centre, double radius) {
      for_images(sim.domain(), centre, [&](const Vec3d& image) {
        if (near.contains(image)) occupied.insert({image, radius});
      });
    };
    if constexpr (Engine::of_ranks) {
      for (const auto& p : engine.ranks.all_in(near, engine.particles, sim.domain()))
        occupy(p.centre(), p.r);
    } else {
      for (const auto& p : engine.particles.rows())
        if (p.r > 0) occupy(p.centre(), p.r);
    }
    inlet.waiting = 0;
    DynArray<PlacedSphere> placed;
    DynArray<std::size_t> kinds;
    Obstacles met;
    const Occupied all{occupied, engine.walls, sim.domain(), met};
    while (inlet.placed < due) {
      const std::size_t kind = draw_kind(inlet);
      const auto& sizes = kind == 0 ? inlet.flow.radius : inlet.flow.recipe[kind - 1].radius;
      const double radius = sizes.sample(inlet.random);
      met = {};
      const auto centre = place(all, {radius, 0, inlet.flow.trials}, inlet.random);
      if (!centre) {
        inlet.waiting = due - inlet.placed;
        inlet.obstacle = why_no_place(engine, sim.domain(), met, inlet.flow.trials, radius);
        break;
      }
      occupy(*centre, radius);
      placed.push_back({*centre, radius}), kinds.push_back(kind);
      ++inlet.placed;
    }
    inlet.mass += sim.insert(placed, kinds, inlet.flow, inlet.random);
  }
  static std::size_t draw_kind(Inlet& inlet) {
    const auto& recipe = inlet.flow.recipe;
    if (recipe.empty()) return 0;
    double u = inlet.random.uniform();
    for (std::size_t k = 0; k < recipe.size(); ++k)
      if ((u -= recipe[k].share) < 0) return k + 1;
    return 0;
  }

  /// The time in which a sphere travels the largest diameter.
  static double choose_interval(const InletFlow& flow, const Vec3d& gravity) {
    if (flow.interval > 0) return flow.interval;
    const double d = 2 * flow.largest_radius();
    const double speed =
        std::max(norm(flow.velocity) + norm(flow.scatter), std::sqrt(norm(gravity) * d));
    return std::max(d / std::max(speed, 1e-9), 1 / flow.rate);
  }

  DynArray<Outlet> outlets_;
  DynArray<Inlet> inlets_;
  DynArray<Place> places_;
};

}  // namespace detail
}  // namespace silt
