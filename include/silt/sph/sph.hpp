// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <unordered_set>
#include <utility>
#include <vector>

#include <silt/core/error.hpp>
#include <silt/core/threads.hpp>
#include <silt/coupling/concept.hpp>
#include <silt/coupling/particles_in_fluid.hpp>
#include <silt/files/vtk.hpp>
#include <silt/sph/body_points.hpp>
#include <silt/sph/cluster_lists.hpp>
#include <silt/sph/columns.hpp>
#include <silt/sph/pair_sums.hpp>
#include <silt/sph/policies.hpp>
#include <silt/sph/setup.hpp>
#include <silt/sph/wall_particles.hpp>

namespace silt::inline SILT_TARGET {

/// A liquid with a free surface, by weakly compressible smoothed particle hydrodynamics:
///
///   d rho_a/dt = rho_a sum V_b v_ab.grad W + diffusion
///   d v_a/dt   = -sum m_b (P_a + P_b)/(rho_a rho_b) grad W + viscosity + g
///   P = B ((rho/rho_0)^gamma - 1),  d x_a/dt = v_a + shifting
///
///   silt::Sph water{silt::Liquid{.density = 1000, .sound_speed = 34},
///                   {.spacing = 0.01, .region = {{0, 0, 0}, {0.4, 0.2, 0.5}},
///                    .gravity = {0, 0, -9.81}}};
///   water.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}});
///   water.fill([](const silt::Vec3d& x) { return x.z < 0.3; });
///   water.run(1.0);
///
/// Policies follow in any order: a kernel, a viscosity, a diffusion of density, Shifting or
/// NoShifting, a time integration. Left out: WendlandC2, ArtificialViscosity, Fourtakas, Shifting,
/// SymplecticTime.
///
/// Walls are layers of particles behind surfaces, which have the density that the liquid has at
/// their mirror images (mDBC) and a velocity such that the liquid slides along the surface or, with
/// LaminarViscosity, sticks to it (SphSetup::slip).
///
/// Source: J. J. Monaghan, Rep. Prog. Phys. 68 (2005) 1703 (recalled); each term where it stands.
/// Valid:  where speeds are below a tenth of `sound_speed`.
/// Errors: InputError for settings that cannot be; SimulationError where a density leaves
///         `least_density` to `most_density`, or a number is none.
/// Tests:  tests/sph/.
template <class... Policies>
class Sph {
  using Axes = detail::SphPolicies<Policies...>;
  using Kernel = typename Axes::Kernel;
  using Viscosity = typename Axes::Viscosity;
  using Diffusion = typename Axes::Diffusion;
  using Shift = typename Axes::Shift;
  using Time = typename Axes::Time;
  using Pairs =
      detail::SphPairs<Kernel, Viscosity, Diffusion, Shift, typename Axes::Precision::PairScalar>;
  using Lists = detail::ClusterLists;
  using Row = detail::SphRow;

 public:
  Sph(const Liquid& liquid, const SphSetup& setup, const Policies&... policies)
      : liquid_(liquid),
        setup_(setup),
        viscosity_(Axes::viscosity(policies...)),
        diffusion_(Axes::diffusion(policies...)),
        shift_(Axes::shifting(policies...)),
        scheme_(Axes::time(policies...)) {
    gravity = setup.gravity;
    liquid.check(), setup.check(), viscosity_.check(), diffusion_.check(), shift_.check(),
        scheme_.check();
    lists_.width = Pairs::W, lists_.spacing = setup.spacing, lists_.dimensions = setup.dimensions;
    const Vec3d e = setup.region.extent();
    lists_.repeats = {
        setup.region.min,
        {setup.periodic[0] ? e.x : 0, setup.periodic[1] ? e.y : 0, setup.periodic[2] ? e.z : 0}};
  }

  double least_density = 0.7, most_density = 1.3;  // [-] of liquid().density
  Vec3d gravity{0, 0, 0};                          // [m/s2]; a Simulation sets its own

  /// @name In a Simulation
  /// @{
  static constexpr bool active = true, turns = true;
  FluidClock clock;
  void prepare(const FluidScene& scene) {
    for (std::size_t d = 0; d < 3; ++d)
      require(scene.periodic[d] == setup_.periodic[d], "Sph: its region ",
              setup_.periodic[d] ? "repeats" : "does not repeat", " in ", "xyz"[d],
              ", but the space of the particles ", scene.periodic[d] ? "does" : "does not",
              "; give both the same PeriodicBox");
    if (scene.walls != nullptr && !scene.walls->empty() && walls_.follow(*scene.walls)) {
      made_ = false, stale_ = true, known_ = false;
      take_out([this](const Vec3d& x) { return walls_.distance(x) < 0; });
    }
  }
  /// As many as sound leaves; advance() takes shorter steps where more is needed.
  int steps_wanted(const FluidPace& pace, const Team&) const {
    const double longest = setup_.courant * setup_.h() / liquid_.sound_speed;
    return std::max(1, static_cast<int>(longest / pace.step));
  }
  /// The liquid goes on by dt [s] beside spheres, in as many steps as it needs; sets what it does
  /// to them [N], [N m], on average.
  void advance(const CoupledParticles& of, double dt, std::span<Vec3d> force, const Team& team,
               std::span<Vec3d> torque) {
    require(of.forms.empty(), "Sph: only spheres can be in the liquid so far");
    if (bodies_.set(of.shape.position, of.shape.radius, of.velocity, of.angular_velocity, setup_))
      make_room_for_bodies();
    known_ = false;  // of where the spheres are now, whatever was read in between
    const std::size_t n = bodies_.bodies.size();
    for (double left = dt; left > 0;) {
      const double most = longest_step(team);
      const double one = left <= most * (1 + 1e-9) ? left : left < 2 * most ? 0.5 * left : most;
      step(one, team);
      left = one < left ? left - one : 0;
      for (std::size_t b = 0; b < n; ++b) {
        const auto& body = bodies_.bodies[b];
        if (one == dt || left + one == dt) force[b] = torque[b] = {0, 0, 0};
        force[b] += (one / dt) * body.force, torque[b] += (one / dt) * body.torque;
      }
    }
    clock.count(dt);
  }
  /// All that the liquid goes on from, to the last bit: also where particles were when the lists
  /// were made.
  template <class Visit>
  void for_each_state(const Visit& visit);
  template <class Describer>
  void describe(const Describer& is) const {
    is("density [kg/m3]", liquid_.density), is("sound speed [m/s]", liquid_.sound_speed);
    is("spacing [m]", setup_.spacing), is("smoothing [-]", setup_.smoothing);
    is("dimensions", static_cast<double>(setup_.dimensions));
    is("walls", static_cast<double>(walls_.walls()));
  }
  /// @}

  const SphSetup& setup() const { return setup_; }
  const Liquid& liquid() const { return liquid_; }
  double particle_mass() const { return liquid_.density * setup_.volume(); }  // [kg]; 2D: [kg/m]

  /// A wall; before any fill().
  void add_wall(const Surfaces& surfaces, const WallSetup& setup = {}) {
    require(next_ == 0,
            "Sph: add_wall() comes after fill(); add walls first, so that no liquid "
            "is put into them");
    walls_.add(surfaces, setup);
  }
  /// Puts liquid on the lattice where inside(x) holds and no wall is nearer than half a spacing;
  /// start(x) gives its velocity [m/s], pressure(x) its pressure [Pa]. Returns how many particles
  /// came.
  template <class Inside, class Start, class Pressure>
  std::size_t fill(const Inside& inside, const Start& start, const Pressure& pressure) {
    const std::uint32_t before = next_;
    const double half = 0.499 * setup_.spacing;
    std::unordered_set<std::uint64_t> taken;  // sites
    for (std::size_t k = 0; k < columns_.size(); ++k)
      if (columns_.is_liquid(k)) taken.insert(site_of(columns_.rows[k].position()));
    detail::for_each_site(setup_, 0, [&](const Vec3d& x) {
      if (!inside(x) || walls_.distance(x) < half) return;
      require(taken.count(site_of(x)) == 0, "Sph::fill: there is liquid at ", x,
              " m already; fill each place once");
      Row r{};
      const Vec3d v = start(x);
      const double p = pressure(x);
      require(is_finite(v) && std::isfinite(p), "Sph::fill: at ", x, " m velocity ", v,
              " m/s and pressure ", p, " Pa must be finite");
      r.place(x), r.move(v), r.density = liquid_.density_at(p);
      columns_.add(r, Lists::Liquid, next_++);
    });
    require(
        next_ > before, "Sph::fill: no place of the lattice of ", setup_.spacing,
        " m is inside; see that the region and the walls leave room, or take a smaller spacing");
    stale_ = true, known_ = false;
    return next_ - before;
  }
  /// At rest, with the pressure of a liquid at rest under gravity that reaches up to where
  /// inside(x) ends.
  template <class Inside>
  std::size_t fill(const Inside& inside) {
    double top = -INFINITY;  // [m2/s2] largest of -g.x
    const Vec3d g = gravity;
    const double edge = 0.5 * setup_.spacing * std::sqrt(dot(g, g));
    detail::for_each_site(setup_, 0, [&](const Vec3d& x) {
      if (inside(x)) top = std::max(top, -dot(g, x) + edge);
    });
    return fill(
        inside,
        [](const Vec3d&) {
          return Vec3d{0, 0, 0};
        },
        [&](const Vec3d& x) { return liquid_.density * (top + dot(g, x)); });
  }

  /// Goes on for `duration` [s], to the last digit.
  void run(double duration, const Team& team = {}) {
    require(std::isfinite(duration) && duration >= 0, "Sph::run: duration = ", duration,
            " s must be at least 0");
    const double end = time_ + duration;
    while (time_ < end - 1e-12 * duration) {
      const double left = end - time_, most = longest_step(team);
      step(left < 2 * most ? (left <= most ? left : 0.5 * left) : most, team);
    }
    time_ = now_ = end;
  }
  /// [s] by sound, speeds, accelerations and viscosity as they are now:
  ///   courant min(h/(c + max |h v.r/(r^2 + (0.1 h)^2)|), sqrt(h/max |a|)), h^2/(8 nu)
  double longest_step(const Team& team = {}) {
    find_rates(team);
    return stable_step();
  }
  void step(double dt, const Team& team = {}) {
    require(std::isfinite(dt) && dt > 0, "Sph::step: dt = ", dt, " s must be greater than 0");
    find_rates(team);
    if constexpr (Time::two_stages)
      symplectic(dt, team);
    else
      verlet(dt, team);
    time_ += dt, now_ = time_, ++steps_, last_ = dt, known_ = false;
  }

  double time() const { return time_; }                            // [s]
  std::int64_t steps() const { return steps_; }                    // [-]
  double last_step() const { return last_; }                       // [s]
  std::size_t size() const { return next_ - left_ - displaced_; }  // particles of the liquid
  std::size_t left() const { return left_; }                       // ... that have left the region
  std::size_t displaced() const { return displaced_; }  // ... that were where a body came
  std::size_t wall_particles() const { return walls_.size(); }

  /// Calls visit(number, position, velocity, density, pressure) for each particle of the liquid, in
  /// the order of their places in memory.
  template <class Visit>
  void for_each(const Visit& visit) const {
    for (std::size_t k = 0; k < columns_.size(); ++k)
      if (const Row& r = columns_.rows[k]; columns_.is_liquid(k))
        visit(columns_.label[k], r.position(), r.velocity(), r.density,
              liquid_.pressure(r.density));
  }
  Vec3d momentum() const {  // [kg m/s]
    Vec3d sum{0, 0, 0};
    for_each([&](std::uint32_t, const Vec3d&, const Vec3d& v, double, double) { sum += v; });
    return particle_mass() * sum;
  }
  double kinetic_energy() const {  // [J]
    double sum = 0;
    for_each(
        [&](std::uint32_t, const Vec3d&, const Vec3d& v, double, double) { sum += dot(v, v); });
    return 0.5 * particle_mass() * sum;
  }
  /// What the liquid does to a wall now: force [N] ([N/m] in 2D), torque [N m] about `about` [m].
  std::pair<Vec3d, Vec3d> wall_load(std::size_t wall, const Vec3d& about = {0, 0, 0},
                                    const Team& team = {}) {
    require(wall < walls_.walls(), "Sph::wall_load: there is no wall ", wall, "; there are ",
            walls_.walls());
    find_rates(team);
    find_solid_rates(team);
    Vec3d force{0, 0, 0}, torque{0, 0, 0};
    for (std::size_t k = 0; k < walls_.size(); ++k) {
      if (walls_.wall_of(k) != wall) continue;
      const std::size_t at = wall_row_[k];
      const Vec3d f = particle_mass() * columns_.rates[at].acceleration;
      force += f, torque += cross(solid_place(k) - about, f);
    }
    return {force, torque};
  }
  /// The liquid as points for ParaView (.vtp).
  void write(const std::string& path) const {
    std::vector<Vec3d> position, velocity;
    std::vector<double> density, pressure;
    for_each([&](std::uint32_t, const Vec3d& x, const Vec3d& v, double rho, double p) {
      position.push_back(x), velocity.push_back(v), density.push_back(rho), pressure.push_back(p);
    });
    VtkFields fields;
    fields.add("velocity [m/s]", velocity).add("density [kg/m3]", density);
    fields.add("pressure [Pa]", pressure);
    write_vtp_points(path, position, fields);
  }
  std::size_t bytes() const { return lists_.bytes() + columns_.bytes(); }

 private:
  struct Most {
    double pair = 0, acceleration = 0, speed = 0;  // [m/s], [m/s2], [m/s]
  };
  static constexpr double skin_share = 0.2;  // [-] of the spacing: what lists reach farther
  double skin() const { return skin_share * setup_.spacing; }
  Pairs pairs() const {
    const double h = setup_.h();
    return Pairs({particle_mass(), h, Kernel::normalisation(setup_.dimensions, h),
                  liquid_.sound_speed, liquid_.density, gravity},
                 viscosity_, diffusion_, lists_.extent());
  }
  void shorten(const Pairs& pairs, const Team& team) {
    if constexpr (Pairs::mixed) {
      detail::make_room(columns_.brief, columns_.size());
      team.for_ranges(columns_.size(), [&](std::size_t, std::size_t from, std::size_t to) {
        const auto part = [&](auto& of) { return std::span(of).subspan(from, to - from); };
        pairs.shorten(part(columns_.rows), part(columns_.volume), part(columns_.brief));
      });
    }
  }

  double stable_step() const {
    const double h = setup_.h();
    double dt = h / (liquid_.sound_speed + most_.pair);
    if (most_.acceleration > 0) dt = std::min(dt, std::sqrt(h / most_.acceleration));
    return std::min(setup_.courant * dt, viscosity_.longest_step(h));
  }

  /// What is solid: particles of walls, then those of bodies.
  std::size_t solids() const { return walls_.size() + bodies_.size(); }
  Vec3d solid_place(std::size_t k) const {
    return k < walls_.size() ? walls_.place(k) : bodies_.place(k - walls_.size());
  }
  Vec3d solid_ghost(std::size_t k) const {
    return k < walls_.size() ? walls_.ghost(k) : bodies_.ghost(k - walls_.size());
  }
  Vec3d solid_velocity(std::size_t k) const {
    return k < walls_.size() ? walls_.velocity(k) : bodies_.velocity(k - walls_.size());
  }
  void make_solids() {
    if (walls_.fresh()) walls_.make(setup_);
    for (std::size_t k = 0; k < columns_.size(); ++k)
      if (columns_.label[k] != Lists::none && columns_.kind[k] != Lists::Liquid)
        columns_.kind[k] = Lists::Gone, columns_.label[k] = Lists::none;
    for (std::uint32_t k = 0; k < solids(); ++k) {
      Row r{};
      r.density = liquid_.density;
      r.place(solid_place(k)), columns_.add(r, Lists::Wall, k);
      r.place(solid_ghost(k)), columns_.add(r, Lists::Probe, k);
    }
    made_ = true;
  }
  /// Takes out liquid whose centre is where something solid has come: as much as that displaces.
  template <class Inside>
  void take_out(const Inside& inside) {
    for (std::size_t k = 0; k < columns_.size(); ++k)
      if (columns_.is_liquid(k) && inside(columns_.rows[k].position()))
        columns_.kind[k] = Lists::Gone, columns_.label[k] = Lists::none, ++displaced_;
    made_ = false, stale_ = true, known_ = false;
  }
  void make_room_for_bodies() {
    take_out([this](const Vec3d& x) {
      for (const auto& body : bodies_.bodies)
        if (norm(lists_.repeats.shortest(x - body.centre)) < body.radius) return true;
      return false;
    });
  }
  /// Brings the particles into packs, with lists that hold until one has moved half the skin.
  void renew(const Team& team) {
    if (walls_.fresh() || !made_) make_solids();
    for (std::size_t k = 0; k < columns_.size(); ++k) {
      if (columns_.label[k] == Lists::none) continue;
      Row& r = columns_.rows[k];
      if (!columns_.is_liquid(k)) {
        r.place(lists_.repeats.wrapped(r.position()));
        continue;
      }
      check(r);
      // In the middle of a step its start goes along.
      const Vec3d way = lists_.repeats.wrapped(r.position()) - r.position();
      Row& start = columns_.start[k];
      r.place(r.position() + way), start.place(start.position() + way);
      if (is_out(r.position()))
        columns_.kind[k] = Lists::Gone, columns_.label[k] = Lists::none, ++left_;
    }
    columns_.arrange(make_order(columns_.rows, team), team);
    make_lists(columns_.rows, team, false);
    moved_ = 0, stale_ = false;
  }
  const std::vector<std::uint32_t>& make_order(std::span<const Row> rows, const Team& team) {
    return lists_.sort(
        rows,
        [this](std::size_t k) {
          return columns_.label[k] == Lists::none ? int{Lists::Gone} : int{columns_.kind[k]};
        },
        team);
  }
  /// The lists of columns that stand in order, as they were at `then`.
  void make_lists(std::span<const Row> then, const Team& team, bool restored = true) {
    if (restored) {
      const auto& order = make_order(then, team);
      require(order.size() == columns_.size(), "Sph: the particles of a state stand in no order");
      for (std::size_t k = 0; k < order.size(); ++k)
        require(order[k] == k || columns_.label[k] == Lists::none,
                "Sph: the particles of a state stand in no order");
      detail::make_room(columns_.volume, columns_.size());
      detail::make_room(columns_.rates, columns_.size());
    }
    wall_row_.assign(solids(), 0), probe_row_.assign(solids(), 0);
    for (std::size_t k = lists_.first_pack(Lists::Wall) * Pairs::W; k < columns_.size(); ++k)
      if (const std::uint32_t label = columns_.label[k]; label != Lists::none) {
        require(label < solids(), "Sph: a state has a solid particle ", label, " of ", solids());
        (columns_.kind[k] == Lists::Wall ? wall_row_ : probe_row_)[label] =
            static_cast<std::uint32_t>(k);
      }
    lists_.find(then, 2 * setup_.h() + skin(), team);
  }
  void check(const Row& r) const {
    const double share = r.density / liquid_.density;
    if (is_finite(r.position()) && is_finite(r.velocity()) && share >= least_density &&
        share <= most_density)
      return;
    throw SimulationError(
        text("step ", steps_, ", t = ", time_, " s: the liquid at ", r.position(),
             " m has density ", r.density, " kg/m3 and velocity ", r.velocity(), " m/s, beyond ",
             least_density, " to ", most_density, " of ", liquid_.density,
             " kg/m3; take a larger Liquid.sound_speed (at least ten times the largest velocity), "
             "a smaller spacing or a smaller SphSetup.courant"),
        steps_, {}, r.position());
  }
  /// A number for the lattice's cell at a place.
  std::uint64_t site_of(const Vec3d& x) const {
    const Vec3d at = (1 / setup_.spacing) * (x - setup_.region.min);
    const auto of = [](double a) { return static_cast<std::uint64_t>(std::floor(a) + 1e6); };
    return of(at.x) | of(setup_.dimensions == 2 ? 0 : at.y) << 21 | of(at.z) << 42;
  }
  bool is_out(const Vec3d& x) const {
    // What walls at its sides press into them is not out.
    const Box b = setup_.region.grown(setup_.spacing);
    return x.x < b.min.x || x.x > b.max.x || x.z < b.min.z || x.z > b.max.z ||
           (setup_.dimensions == 3 && (x.y < b.min.y || x.y > b.max.y));
  }

  /// The rates where the particles are now, unless they are known.
  void find_rates(const Team& team) {
    if (known_) return;
    if (made_ && wall_row_.size() == solids()) place_solids();
    if (stale_ || 2 * moved_ > skin()) renew(team), place_solids();
    const Pairs pairs = this->pairs();
    set_pressures(team), set_walls(pairs, team), shorten(pairs, team);
    constexpr std::size_t W = Pairs::W, per = 16;
    const std::size_t liquid = lists_.first_pack(Lists::Wall);
    std::vector<Most> most(detail::pieces(liquid, per));
    team.for_parts(most.size(), [&](std::size_t part) {
      Most& m = most[part];
      for (std::size_t p = part * per; p < std::min(liquid, (part + 1) * per); ++p) {
        m.pair = std::max(m.pair, pairs.of_liquid(p, columns_.rows, columns_.volume, lists_,
                                                  columns_.rates, columns_.brief));
        for (std::size_t k = p * W; k < (p + 1) * W; ++k) {
          if (columns_.label[k] == Lists::none) continue;
          Vec3d& a = columns_.rates[k].acceleration;
          a += gravity;
          m.acceleration = std::max(m.acceleration, norm(a));
          m.speed = std::max(m.speed, norm(columns_.rows[k].velocity()));
        }
      }
    });
    most_ = {};
    for (const Most& m : most) {
      most_.pair = std::max(most_.pair, m.pair), most_.speed = std::max(most_.speed, m.speed);
      most_.acceleration = std::max(most_.acceleration, m.acceleration);
    }
    known_ = true;
  }
  void set_pressures(const Team& team) {
    const double mass = particle_mass();
    team.for_ranges(columns_.size(), [&](std::size_t, std::size_t from, std::size_t to) {
      for (std::size_t k = from; k < to; ++k) {
        Row& r = columns_.rows[k];
        r.pressure = liquid_.pressure(r.density), columns_.volume[k] = mass / r.density;
      }
    });
  }
  /// Walls and bodies to where they are at the time of these rates, each particle in the image
  /// that its row is in; what they have moved counts for the lists.
  void place_solids() {
    const bool move = walls_.any_moves();
    if (move) walls_.move_to(now_, 0.1 * setup_.courant * setup_.h() / liquid_.sound_speed);
    double most = 0;
    const auto place = [&](Row& r, const Vec3d& to) {
      const Vec3d way = lists_.repeats.shortest(to - r.position());
      most = std::max(most, norm(way));
      r.place(r.position() + way);
    };
    for (std::size_t k = move ? 0 : walls_.size(); k < solids(); ++k) {
      place(columns_.rows[wall_row_[k]], solid_place(k));
      place(columns_.rows[probe_row_[k]], solid_ghost(k));
    }
    moved_ += most;
  }
  /// Density and velocity of walls' particles, from the liquid at their mirror images.
  void set_walls(const Pairs& pairs, const Team& team) {
    constexpr std::size_t W = Pairs::W;
    const std::size_t first = lists_.first_pack(Lists::Probe), n = lists_.packs() - first;
    team.for_ranges(n, [&](std::size_t, std::size_t from, std::size_t to) {
      for (std::size_t p = first + from; p < first + to; ++p) {
        std::array<detail::SphSeen, W> seen;
        pairs.look(p, columns_.rows, columns_.volume, lists_, seen);
        for (std::size_t l = 0; l < W; ++l) {
          const std::size_t k = p * W + l;
          if (columns_.label[k] == Lists::none) continue;
          const std::uint32_t of = columns_.label[k];
          const std::size_t at = wall_row_[of];
          Row& wall = columns_.rows[at];
          const Vec3d away = solid_place(of) - solid_ghost(of);
          const auto [density, velocity] = seen[l].at(away, liquid_, gravity, setup_.h());
          wall.density = density, wall.pressure = liquid_.pressure(density);
          wall.move(at_wall(velocity, solid_velocity(of), away));
          columns_.volume[at] = particle_mass() / density;
        }
      }
    });
  }

  /// The velocity of a wall's particle, `away` from its mirror image: such that on the surface
  /// between them the liquid goes with the wall, or along it.
  Vec3d at_wall(const Vec3d& liquid, const Vec3d& wall, const Vec3d& away) const {
    if (setup_.slip.value_or(Viscosity::laminar ? Slip::None : Slip::Free) == Slip::None)
      return 2 * wall - liquid;
    const double across = dot(liquid - wall, away) / dot(away, away);
    return across * across >= 0 ? liquid - 2 * across * away : liquid;
  }

  template <class Update>
  void for_liquid(const Team& team, const Update& update) {
    const std::size_t n = lists_.first_pack(Lists::Wall) * Pairs::W;
    team.for_ranges(n, [&](std::size_t, std::size_t from, std::size_t to) {
      for (std::size_t k = from; k < to; ++k)
        if (columns_.label[k] != Lists::none)
          update(k, columns_.rows[k], columns_.start[k], columns_.rates[k]);
    });
  }
  void symplectic(double dt, const Team& team) {
    for_liquid(team, [&](std::size_t, Row& r, Row& start, const detail::SphRates& rate) {
      start = r;
      r.place(r.position() + 0.5 * dt * r.velocity());
      r.move(r.velocity() + 0.5 * dt * rate.acceleration);
      r.density += 0.5 * dt * rate.density;
    });
    moved_ += 0.5 * dt * most_.speed;
    now_ = time_ + 0.5 * dt, known_ = false;
    bodies_.move(0.5 * dt);
    find_rates(team), find_body_loads(team);
    for_liquid(team, [&](std::size_t, Row& r, const Row& start, const detail::SphRates& rate) {
      const Vec3d v = start.velocity() + dt * rate.acceleration;
      const double eps = -dt * rate.density / r.density;
      r.place(start.position() + 0.5 * dt * (start.velocity() + v) + shift_of(rate, norm(v), dt));
      r.move(v), r.density = start.density * (2 - eps) / (2 + eps);
    });
    bodies_.move(0.5 * dt);
    moved_ += 0.5 * dt * (most_.speed + 2 * dt * most_.acceleration) + most_shift(dt);
  }
  void verlet(double dt, const Team& team) {
    const bool restart = steps_ % scheme_.restart == 0;
    find_body_loads(team);
    const double span = restart ? dt : dt + last_;
    for_liquid(team, [&](std::size_t, Row& r, Row& start, const detail::SphRates& rate) {
      const Row from = restart ? r : start;
      start = r;
      const Vec3d v = r.velocity(), &a = rate.acceleration;
      r.place(r.position() + dt * v + 0.5 * dt * dt * a + shift_of(rate, norm(v), dt));
      r.move(from.velocity() + span * a), r.density = from.density + span * rate.density;
    });
    bodies_.move(dt);
    moved_ += dt * (most_.speed + 0.5 * dt * most_.acceleration) + most_shift(dt);
  }
  /// What the liquid does to bodies: the opposite of what they do to it, pair by pair.
  void find_body_loads(const Team& team) {
    for (auto& b : bodies_.bodies) b.force = b.torque = {0, 0, 0};
    if (bodies_.empty()) return;
    find_solid_rates(team);
    for (std::size_t k = walls_.size(); k < solids(); ++k) {
      const std::size_t at = wall_row_[k];
      auto& body = bodies_.bodies[bodies_.body_of(k - walls_.size())];
      const Vec3d f = particle_mass() * columns_.rates[at].acceleration;
      body.force += f, body.torque += cross(solid_place(k) - body.centre, f);
    }
  }
  void find_solid_rates(const Team& team) {
    const Pairs pairs = this->pairs();
    const std::size_t first = lists_.first_pack(Lists::Wall),
                      n = lists_.first_pack(Lists::Probe) - first;
    team.for_ranges(n, [&](std::size_t, std::size_t from, std::size_t to) {
      for (std::size_t p = first + from; p < first + to; ++p)
        pairs.of_wall(p, columns_.rows, columns_.volume, lists_, columns_.rates, columns_.brief);
    });
  }
  Vec3d shift_of([[maybe_unused]] const detail::SphRates& rate, [[maybe_unused]] double speed,
                 [[maybe_unused]] double dt) const {
    if constexpr (Shift::shifts) {
      const double full = setup_.dimensions, none = shift_.threshold_in(setup_.dimensions);
      const double share = std::clamp((rate.divergence - none) / (full - none), 0.0, 1.0);
      const Vec3d way = (-shift_.strength * setup_.h() * speed * dt * share) * rate.slope;
      const double length = norm(way), most = longest_shift * setup_.spacing;
      return length > most ? (most / length) * way : way;
    }
    return {0, 0, 0};
  }
  static constexpr double longest_shift = 0.05;  // [-] of the spacing, in a step
  double most_shift(double dt) const {           // [m] of any; h grad C is below 1
    if constexpr (Shift::shifts)
      return std::min(longest_shift * setup_.spacing,
                      shift_.strength * (most_.speed + dt * most_.acceleration) * dt);
    return 0;
  }

  Liquid liquid_;
  SphSetup setup_;
  Viscosity viscosity_;
  Diffusion diffusion_;
  Shift shift_;
  Time scheme_;
  detail::WallParticles walls_;
  detail::BodyPoints bodies_;
  Lists lists_;
  detail::SphColumns columns_;
  std::vector<std::uint32_t> wall_row_, probe_row_;
  Most most_;
  std::uint32_t next_ = 0;
  std::size_t left_ = 0, displaced_ = 0;
  double time_ = 0, now_ = 0, last_ = 0;  // [s] now_: of the rates
  double moved_ = 0;                      // [m] at most, since the lists were made
  std::int64_t steps_ = 0;
  bool stale_ = true, known_ = false, made_ = false;
};

template <class... Policies>
Sph(const Liquid&, const SphSetup&, const Policies&...) -> Sph<Policies...>;

}  // namespace silt

#include <silt/sph/sph_state.hpp>
