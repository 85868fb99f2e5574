// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <unordered_set>
#include <utility>

#include <silt/core/dyn_array.hpp>
#include <silt/core/error.hpp>
#include <silt/core/random.hpp>
#include <silt/core/threads.hpp>
#include <silt/coupling/concept.hpp>
#include <silt/coupling/particles_in_fluid.hpp>
#include <silt/files/vtk.hpp>
#include <silt/sph/core.hpp>
#include <silt/sph/fill_check.hpp>
#include <silt/sph/lattice_fit.hpp>
#include <silt/sph/policies.hpp>
#include <silt/sph/setup.hpp>
#include <silt/sph/wall_reading.hpp>

namespace silt::inline SILT_TARGET {

/// Liquid with a free surface, by weakly compressible smoothed particle hydrodynamics (SPH):
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
/// Policies in any order: a kernel, a viscosity, a diffusion of density, Shifting,
/// ShiftingByFastest or NoShifting, a time integration, a kind of walls. Defaults: WendlandC2,
/// ArtificialViscosity, Fourtakas, Shifting, LeapfrogTime, MirroredWalls.
///
/// Walls are layers of particles behind surfaces; bodies are filled with particles. With
/// MirroredWalls these particles have the density of the liquid at their mirror images (mDBC), and
/// a velocity that makes the liquid slip along the surface or, with LaminarViscosity, stick to it
/// (SphSetup::slip).
///
/// Source: J. J. Monaghan, Rep. Prog. Phys. 68 (2005) 1703 (recalled); other terms: see their
///         headers.
/// Valid:  speeds below a tenth of `sound_speed`.
/// Errors: InputError for invalid settings; SimulationError if a density is outside `least_density`
///         to `most_density`, or a number is NaN.
/// Tests:  tests/sph/.
/// Units:  SI; in 2D per metre of depth.
template <class... Policies>
class Sph : private detail::SphCore<detail::SphPolicies<Policies...>> {
  using Axes = detail::SphPolicies<Policies...>;
  using Core = detail::SphCore<Axes>;
  using Row = detail::SphRow;

 public:
  Sph(const Liquid& liquid, const SphSetup& setup, const Policies&... policies)
      : Core{liquid,
             setup,
             Axes::viscosity(policies...),
             Axes::diffusion(policies...),
             Axes::shifting(policies...),
             Axes::time(policies...),
             Axes::walls(policies...),
             typename Axes::Grains::State(Axes::grains(policies...)),
             Axes::volume(policies...)} {
    Axes::grains(policies...).check();
    core().begin();
  }

  using Core::gravity;                            // [m/s2]; a Simulation sets its own
  using Core::least_density, Core::most_density;  // [-] of liquid().density, 0.7 and 1.3

  /// @name In a Simulation
  /// @{
  static constexpr bool active = true, turns = true;
  FluidClock clock;
  void prepare(const FluidScene& scene) {
    is_hosted_ = true, reading_.known = false;
    for (std::size_t d = 0; d < 3; ++d)
      require(scene.periodic[d] == setup().periodic[d], "Sph: its region ",
              setup().periodic[d] ? "repeats" : "does not repeat", " in ", "xyz"[d],
              ", but the space of the particles ", scene.periodic[d] ? "does" : "does not",
              "; give both the same PeriodicBox");
    auto& solid = core().solids.walls;
    if (scene.walls != nullptr && !scene.walls->empty() && solid.follow(*scene.walls)) {
      core().take_out([&solid](const Vec3d& x) { return solid.distance(x) < 0; });
      if (core().steps == 0) detail::refuse_misfit(solid, places(0), setup());
    }
  }
  /// Shape of bodies other than spheres: the form with number `form`.
  template <class Shape>
  void take_form(std::size_t form, const Shape& shape) {
    core().solids.bodies.take_form(form, shape);
  }
  /// Number of steps allowed by sound, the pairs of the last step, light bodies and light walls. A
  /// step slightly too long would be halved; advance() takes shorter steps where needed.
  int steps_wanted(const FluidPace& pace, const Team&) const {
    const double c = liquid().sound_speed;
    const double pairs =
        core().steps == 0 ? 0.25 * c : std::max(0.05 * c, 1.1 * core().most.pair);  // [m/s]
    const double longest = std::min({setup().courant * setup().h() / (c + pairs), core().exchange,
                                     core().longest_hold().first});
    return std::max(1, static_cast<int>(longest / pace.step));
  }
  /// [s] Longest step of the particles for which the loads on a body of this radius [m] and mass
  /// [kg] may be constant.
  double longest_particle_step(double radius, double mass) const {
    return core().resolves(radius) ? detail::sph_exchange_of(core(), radius, mass) : INFINITY;
  }
  /// Advances the liquid by dt [s] with bodies in it, in as many steps as needed; returns the mean
  /// loads on them [N], [N m].
  void advance(const CoupledParticles& of, double dt, std::span<Vec3d> force, const Team& team,
               std::span<Vec3d> torque) {
    if (const auto [longest, w] = core().longest_hold(); dt > 2 * longest)
      throw Error(detail::sentence(
          "wall ", w,
          core().solids.walls.wall(w).name.empty() ? "" : " " + core().solids.walls.called(w),
          " is too light compared with the liquid for steps of ", dt,
          " s; set Simulation::time_step to less than ", longest,
          " s, or give the wall a larger mass or inertia"));
    reading_.known = false;
    const double before = core().exchange;  // known to those who chose dt
    core().take_particles(of);
    if (before <= core().exchange) detail::refuse_light_bodies(core(), of, dt);
    std::fill(force.begin(), force.end(), Vec3d{0, 0, 0});
    std::fill(torque.begin(), torque.end(), Vec3d{0, 0, 0});
    for (double left = dt; left > 0;) {
      const double longest = longest_step(team);
      const double one = left <= longest * (1 + 1e-9) ? left
                         : left < 2 * longest         ? 0.5 * left
                                                      : longest;
      step(one, team);
      left = one < left ? left - one : 0;
      core().add_loads(one / dt, force, torque);
    }
    clock.count(dt);
  }
  /// Load on a driven wall of the Simulation, constant until the next advance().
  detail::LiquidOnWall load_on_driven(std::size_t wall) const {
    return wall < core().on_walls.size() ? core().on_walls[wall] : detail::LiquidOnWall{};
  }
  /// Complete state for a restart to the last bit, including the positions at which the lists were
  /// built.
  template <class Visit>
  void for_each_state(const Visit& visit);
  template <class Describer>
  void describe(const Describer& is) const {
    is("density [kg/m3]", liquid().density), is("sound speed [m/s]", liquid().sound_speed);
    is("spacing [m]", setup().spacing), is("smoothing [-]", setup().smoothing_used());
    is("dimensions", static_cast<double>(setup().dimensions));
    is("walls", static_cast<double>(core().solids.walls.own_walls()));
    if (openings() > 0) is("openings", static_cast<double>(openings()));
  }
  /// @}

  const SphSetup& setup() const { return core().setup; }
  const Liquid& liquid() const { return core().liquid; }
  using Core::particle_mass;  // [kg]; 2D: [kg/m]

  /// Adds a wall; before any fill().
  void add_wall(const Surfaces& surfaces, const WallSetup& setup = {}) {
    require(core().next_number == 0,
            "Sph: add_wall() comes after fill(); add walls first, then no liquid "
            "is put into them");
    core().solids.walls.add(surfaces, setup);
  }
  /// Adds an opening through which liquid enters or leaves; after walls, before any fill(). Returns
  /// its number. An inlet needs a velocity or a pressure; for an outlet both are optional. Other
  /// values are taken from the liquid at mirror images in front of the opening. If the flow
  /// reverses, an inlet becomes an outlet and vice versa.
  std::size_t add_inlet(const Opening& opening, const OpeningSetup& setup) {
    return add_opening(opening, setup, true);
  }
  std::size_t add_outlet(const Opening& opening, const OpeningSetup& setup = {}) {
    return add_opening(opening, setup, false);
  }
  /// Adds liquid on the lattice where inside(x) is true and no wall is too near: half a spacing
  /// from walls across an axis, in front of others; start(x) gives its velocity [m/s], at most c/5
  /// and in 2D without y, pressure(x) its pressure [Pa], above -B/10 (Liquid::stiffness()). Returns
  /// the number of particles. Those in bodies of the Simulation are removed, and counted by
  /// displaced().
  template <class Inside, class Start, class Pressure>
  std::size_t fill(const Inside& inside, const Start& start, const Pressure& pressure) {
    const std::uint32_t before = core().next_number;
    std::unordered_set<std::uint64_t> taken;  // sites
    for (std::size_t k = 0; k < core().columns.size(); ++k)
      if (core().columns.is_liquid(k)) taken.insert(site_of(core().columns.rows[k].position()));
    std::size_t lost_sites = 0;  // on walls
    detail::for_each_site(setup(), 0, [&](const Vec3d& site) {
      if (!inside(site) || core().openings.hold(site)) return;
      if (core().solids.walls.is_too_near(site, setup().spacing)) {
        lost_sites += core().solids.walls.lies_on(site, setup().spacing);
        return;
      }
      require(taken.count(site_of(site)) == 0, "Sph::fill: there is liquid at ", site,
              " m already; fill each place once");
      Row r{};
      const Vec3d x = scattered(site);
      const Vec3d v = start(x);
      const double p = pressure(x);
      check_start(x, v, p);
      r.place(x), r.move(v), r.density = liquid().density_at(p);
      core().columns.add(r, Core::Lists::Liquid, core().next_number++);
      detail::sph_comes(core(), core().columns.size() - 1);
    });
    if (core().next_number == before)
      throw InputError(text("Sph::fill: there is no place for liquid: ",
                            detail::sph_why_empty(setup(), core().solids.walls, inside)));
    if (core().steps == 0) {
      detail::refuse_misfit(core().solids.walls, places(before), setup());
      detail::refuse_sites_on_walls(lost_sites, core().next_number - before, setup());
    }
    core().renewed(), reading_.known = false;
    if (!core().solids.bodies.empty()) core().make_room_for_bodies();
    return core().next_number - before;
  }
  /// The same with hydrostatic pressure (without gravity along periodic directions) below the
  /// highest point of inside(x).
  template <class Inside, class Start>
  std::size_t fill(const Inside& inside, const Start& start) {
    setup().check_gravity(core().gravity);
    double top = -INFINITY;  // [m2/s2] largest of -g.x
    const Vec3d g = core().weight();
    const double edge = 0.5 * setup().spacing * std::sqrt(dot(g, g));
    detail::for_each_site(setup(), 0, [&](const Vec3d& x) {
      if (inside(x)) top = std::max(top, -dot(g, x) + edge);
    });
    return fill(inside, start,
                [&](const Vec3d& x) { return liquid().density * (top + dot(g, x)); });
  }
  /// The same at rest.
  template <class Inside>
  std::size_t fill(const Inside& inside) {
    return fill(inside, [](const Vec3d&) { return Vec3d{0, 0, 0}; });
  }

  /// Runs for `duration` [s], exactly.
  void run(double duration, const Team& team = {}) {
    require(std::isfinite(duration) && duration >= 0, "Sph::run: duration = ", duration,
            " s must be at least 0");
    require(core().next_number > 0 || openings() > 0 || duration == 0,
            "Sph::run: there is no liquid and no opening; call fill() or add_inlet() first");
    const double end = core().time + duration;
    while (core().time < end - 1e-12 * duration) {
      const double remains = end - core().time, longest = longest_step(team);
      step(remains < 2 * longest ? (remains <= longest ? remains : 0.5 * remains) : longest, team);
    }
    core().time = core().now = end;
  }
  /// [s] from sound, speeds, accelerations and viscosity of the present state:
  ///   courant min(h/(c + max |h v.r/(r^2 + (0.1 h)^2)|), sqrt(h/max |a|)), h/(alpha c), h^2/(8 nu)
  double longest_step(const Team& team = {}) {
    core().find_start(team);
    return core().stable_step();
  }
  /// One step of dt [s]. InputError for a dt beyond that of the largest Courant number for which
  /// the scheme was tested: the state would be destroyed.
  void step(double dt, const Team& team = {}) {
    require(std::isfinite(dt) && dt > 0, "Sph::step: dt = ", dt, " s must be greater than 0");
    const double usual = longest_step(team), longest = core().stable_step(Core::Time::most_courant);
    constexpr double any_courant = 1e6;
    const bool by_sound = core().stable_step(any_courant) > longest;
    require(dt <= longest * (1 + 1e-9), "Sph::step: dt = ", dt, " s is longer than ", longest,
            " s, which ",
            by_sound ? text("a Courant number of ", Core::Time::most_courant, " gives")
                     : "the viscosity or the acceleration of the liquid allows",
            " in the present state; use longest_step(), now ", usual,
            " s, or run(duration), which chooses its steps");
    core().step(dt, team), reading_.known = false;
  }

  double time() const { return core().time; }                     // [s]
  std::int64_t steps() const { return core().steps; }             // [-]
  double last_step() const { return core().last_step; }           // [s]
  std::size_t size() const { return core().liquid_particles(); }  // of the liquid
  std::size_t openings() const { return core().openings.size(); }
  /// Flow through an opening since the start.
  const OpeningBooks& opening_books(std::size_t which) const {
    check_opening("opening_books", which);
    return core().openings[which].books;
  }
  /// [kg/s] present inflow through an opening, [kg/(m s)] in 2D; negative: outflow. After a step.
  double flow_rate(std::size_t which) const {
    check_opening("flow_rate", which);
    return core().openings.flow_rate(core().columns, which, particle_mass());
  }
  /// Calls visit(opening, position, velocity, density, pressure) for the buffer particles of
  /// openings, which do not belong to the liquid.
  template <class Visit>
  void for_each_buffer(const Visit& visit) const {
    detail::SphOpenings::for_each(core().columns, [&](const Row& r, std::size_t opening) {
      visit(opening, r.position(), r.velocity(), r.density, liquid().pressure(r.density));
    });
  }
  std::size_t left() const { return core().left; }  // ... that left the region
  /// Sentences for what is probably a mistake: more than 5 % of the liquid has left the region, or
  /// it has few particles. In a Simulation progress() and on_warnings() pass them on at the end of
  /// each run.
  DynArray<std::string> warnings() const { return detail::sph_warnings(core()); }
  std::size_t displaced() const { return core().displaced; }  // ... displaced by a body
  std::size_t wall_particles() const { return core().solids.walls.size(); }

  /// Calls visit(number, position, velocity, density, pressure) for each liquid particle, in memory
  /// order.
  template <class Visit>
  void for_each(const Visit& visit) const {
    for (std::size_t k = 0; k < core().columns.size(); ++k)
      if (const Row& r = core().columns.rows[k]; core().columns.is_liquid(k))
        visit(core().columns.label[k], r.position(), r.velocity(), r.density,
              liquid().pressure(r.density));
  }
  double mass() const {  // [kg] of all; [kg/m] in 2D
    double sum = 0;
    for (std::size_t k = 0; k < core().columns.size(); ++k)
      if (core().columns.is_liquid(k)) sum += core().mass_of(k);
    return sum;
  }
  Vec3d momentum() const {  // [kg m/s]
    Vec3d sum{0, 0, 0};
    for (std::size_t k = 0; k < core().columns.size(); ++k)
      if (core().columns.is_liquid(k)) sum += core().mass_of(k) * core().columns.rows[k].velocity();
    return sum;
  }
  double kinetic_energy() const {  // [J]
    double sum = 0;
    for (std::size_t k = 0; k < core().columns.size(); ++k)
      if (const Vec3d v = core().columns.rows[k].velocity(); core().columns.is_liquid(k))
        sum += 0.5 * core().mass_of(k) * dot(v, v);
    return sum;
  }
  /// With an EnergyLedger: energy balance since the first step.
  LiquidBalance energy() const {
    static_assert(Axes::ledger,
                  "energy() needs the policy EnergyLedger, which is missing: give the Sph "
                  "silt::EnergyLedger{} among its policies");
    return detail::sph_balance(core());
  }
  /// With UnresolvedGrains: closure errors of the balances of liquid and grains, largest of any
  /// step, and those of the last step.
  const auto& closure() const requires(Axes::Grains::averaged) { return core().grains.closure; }
  const auto& last_exchange() const requires(Axes::Grains::averaged) { return core().grains.last; }
  /// Present load of the liquid on a wall: force [N] ([N/m] in 2D), torque [N m] about `about` [m].
  /// It changes nothing, to the last bit: in a Simulation or with LeapfrogTime the first reading
  /// between two steps computes on a copy of the liquid.
  std::pair<Vec3d, Vec3d> wall_load(std::size_t wall, const Vec3d& about = {0, 0, 0},
                                    const Team& team = {}) const {
    const auto& solid = core().solids.walls;
    require(wall < solid.walls(), "Sph::wall_load: there is no wall ", wall, "; there are ",
            solid.walls(),
            is_hosted_ || solid.walls() > 0 ? ""
                                            : "; those of a Simulation are known from its first "
                                              "run on");
    if (!is_hosted_ && !Core::Time::leaps) {
      reading_.find(const_cast<Sph&>(*this).core(), team);  // the next step starts with its rates
    } else if (!reading_.known || !(reading_.gravity == core().gravity)) {
      Core copy = core();
      reading_.find(copy, team);
      reading_.known = true, reading_.gravity = core().gravity;
    }
    return reading_.load(wall, about);
  }
  /// Ending and name of the liquid's files in vtk_series.
  static constexpr const char *file_kind = ".vtp", *series_name = "liquid";
  /// Writes the liquid as points for ParaView (.vtp).
  void write(const std::string& path) const {
    DynArray<Vec3d> position, velocity;
    DynArray<double> density, pressure;
    for_each([&](std::uint32_t, const Vec3d& x, const Vec3d& v, double rho, double p) {
      position.push_back(x), velocity.push_back(v), density.push_back(rho), pressure.push_back(p);
    });
    VtkFields fields;
    fields.add("velocity [m/s]", velocity).add("density [kg/m3]", density);
    fields.add("pressure [Pa]", pressure);
    write_vtp_points(path, position, fields);
  }
  std::size_t bytes() const { return core().lists.bytes() + core().columns.bytes(); }

 private:
  std::size_t add_opening(const Opening& opening, const OpeningSetup& setup_of, bool inlet) {
    require(core().next_number == 0 && core().steps == 0,
            "Sph: ", inlet ? "add_inlet" : "add_outlet",
            "() comes after fill(); add openings first, then no liquid is put behind them");
    require(!Core::Book::kept,
            "Sph: openings and an EnergyLedger cannot be combined yet; leave out the ledger, "
            "opening_books() has the energy that entered and left");
    require(!Axes::Grains::averaged,
            "Sph: openings and UnresolvedGrains cannot be combined yet; leave one out");
    const std::size_t which =
        core().openings.add({.opening = opening, .setup = setup_of, .inlet = inlet}, setup(),
                            liquid(), core().lists.repeats);
    core().renewed();
    return which;
  }
  /// InputError for a velocity [m/s] or a pressure [Pa] that liquid at x cannot start with.
  void check_start(const Vec3d& x, const Vec3d& v, double p) const {
    require(is_finite(v) && std::isfinite(p), "Sph::fill: at ", x, " m velocity ", v,
            " m/s and pressure ", p, " Pa must be finite");
    require(setup().lies_in_plane(v), "Sph::fill: at ", x, " m velocity ", v,
            " m/s has a part along y, but in 2D the liquid lies in x and z; give a velocity with "
            "y = 0");
    const double c = liquid().sound_speed, speed = norm(v);
    if (!(speed <= 0.2 * c))
      throw InputError(detail::sentence(
          "Sph::fill: at ", x, " m velocity ", v, " m/s is ", speed / c,
          " of Liquid.sound_speed = ", c, " m/s; the liquid would be compressed by ",
          100 * speed * speed / (c * c), " %; use ten times that speed, ", 10 * speed, " m/s"));
    const double rise = p / (liquid().density * c * c);
    if (!(rise < 0.05))
      throw InputError(detail::sentence(
          "Sph::fill: at ", x, " m the pressure of ", p, " Pa raises the density by about ",
          100 * rise, " %, as Liquid.sound_speed = ", c, " m/s is too low for it; use at least ",
          10 * std::sqrt(2 * p / liquid().density),
          " m/s, ten times the speed that such a pressure gives"));
    if (!(p > -0.1 * liquid().stiffness()))
      throw InputError(detail::sentence(
          "Sph::fill: at ", x, " m the pressure of ", p, " Pa must be above ",
          -0.1 * liquid().stiffness(),
          " Pa (a tenth of the liquid's stiffness); use a larger Liquid.sound_speed, or a "
          "smaller suction"));
  }
  void check_opening(const char* call, std::size_t which) const {
    require(which < openings(), "Sph::", call, ": there is no opening ", which, "; there are ",
            openings());
  }
  Core& core() { return *this; }
  const Core& core() const { return *this; }
  /// Lattice positions of the liquid from number `first` on, before it has moved.
  DynArray<Vec3d> places(std::uint32_t first) const {
    DynArray<Vec3d> all;
    for (std::size_t k = 0; k < core().columns.size(); ++k)
      if (core().columns.is_liquid(k) && core().columns.label[k] >= first)
        all.push_back(unscattered(core().columns.rows[k].position()));
    return all;
  }
  Vec3d unscattered(const Vec3d& x) const {
    if (!(setup().scatter > 0)) return x;
    const double s = setup().spacing;
    const Vec3d at = (1 / s) * (x - setup().region.min);
    const auto middle = [s](double a) { return s * (std::floor(a) + 0.5); };
    return setup().region.min +
           Vec3d{middle(at.x), setup().dimensions == 2 ? 0 : middle(at.y), middle(at.z)};
  }
  /// Initial position of a particle near its lattice site: the same in every fill.
  Vec3d scattered(const Vec3d& site) const {
    const double farthest = setup().scatter * setup().spacing;
    if (!(farthest > 0)) return site;
    Random random(site_of(site) + 1);
    const double x = random.uniform(-farthest, farthest), y = random.uniform(-farthest, farthest),
                 z = random.uniform(-farthest, farthest);
    return site + Vec3d{x, setup().dimensions == 2 ? 0 : y, z};
  }
  bool is_hosted_ = false;                    // by a Simulation
  mutable detail::SphWallReading reading_{};  // of the present state
  /// Number of the lattice cell at a point.
  std::uint64_t site_of(const Vec3d& x) const {
    const Vec3d at = (1 / setup().spacing) * (x - setup().region.min);
    const auto of = [](double a) { return static_cast<std::uint64_t>(std::floor(a) + 1e6); };
    return of(at.x) | of(setup().dimensions == 2 ? 0 : at.y) << 21 | of(at.z) << 42;
  }
};

template <class... Policies>
Sph(const Liquid&, const SphSetup&, const Policies&...) -> Sph<Policies...>;

}  // namespace silt

#include <silt/sph/sph_state.hpp>
