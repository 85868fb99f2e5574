// silt - BSD-3-Clause, see LICENSE
// SPH liquids, small and in 2D: sloshing at resonance, jets thinner than the kernel, bodies far
// lighter and far heavier than the liquid, fast walls, long rest, tension, high speed of sound.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <silt/core/random.hpp>
#include <silt/silt.hpp>
#include <silt/sph.hpp>

#include "stability/table.hpp"

namespace stability {

namespace sph_rows {

using namespace silt;

constexpr double g = 9.81, rho = 1000;  // [m/s2], [kg/m3]
constexpr double shallow = 0.5;         // [spacings] behind a wall, where its first particles are

/// For a liquid in a tank open at the top, from x to x + width: deepest penetration of a wall, over
/// the spacing; particles that left the region; largest speed [m/s]; energies [J/m].
struct Seen {
  double behind = 0, lost = 0, fastest = 0, energy = 0;
};
template <class Water>
Seen look(const Water& water, double x, double width) {
  Seen s;
  const Liquid& of = water.liquid();
  const double m = water.particle_mass(), n = of.exponent;
  water.for_each([&](std::uint32_t, const Vec3d& at, const Vec3d& v, double density, double) {
    s.behind = std::max({s.behind, x - at.x, at.x - x - width, -at.z});
    s.fastest = std::max(s.fastest, norm(v));
    // Compression energy, from the equation of state.
    const double r = density / of.density,
                 stored =
                     of.stiffness() / of.density * ((std::pow(r, n - 1) - 1) / (n - 1) + 1 / r - 1);
    s.energy += m * (0.5 * dot(v, v) - dot(water.gravity, at) + stored);
  });
  s.behind /= water.setup().spacing;
  s.lost = static_cast<double>(water.left());
  return s;
}

/// A tank is shaken at its first resonance, from rest, for some periods: the liquid hits the walls
/// and waves break. The fastest drop of a breaking wave has 0.13 to 0.25 of c by chance, for
/// amplitudes from 0.03 to 0.05 m, so that 99 of 100 particles are looked at.
template <class... Policies>
Measures shaken(bool quick, double amplitude, const Policies&... policies) {
  const double L = 0.5, d = 0.1, s = quick ? 0.0125 : 0.01, k = std::numbers::pi / L;
  const double omega = std::sqrt(g * k * std::tanh(k * d)), period = 2 * std::numbers::pi / omega;
  Sph water{Liquid{.density = rho, .sound_speed = 10 * std::sqrt(2 * g * 0.3)},
            {.spacing = s,
             .region = {{-0.3, 0, -0.1}, {0.8, 0, 2}},
             .dimensions = 2,
             .gravity = {0, 0, -g}},
            policies...};
  const Motion motion = [=](double t) {
    return Pose{{}, {amplitude * (1 - std::cos(omega * t)), 0, 0}};
  };
  water.add_wall(Plane{{0, 0, 0}, {0, 0, 1}}, {.name = "floor", .motion = motion});
  water.add_wall(Plane{{0, 0, 0}, {1, 0, 0}}, {.name = "wall", .motion = motion});
  water.add_wall(Plane{{L, 0, 0}, {-1, 0, 0}}, {.name = "far wall", .motion = motion});
  water.fill([=](const Vec3d& x) { return x.z < d; });
  double behind = 0, fast = 0;
  std::vector<double> speeds;
  for (int n = 0; n < 75; ++n) {
    water.run(period / 25);
    behind = std::max(behind, look(water, motion(water.time()).translation.x, L).behind);
    speeds.clear();
    water.for_each([&](std::uint32_t, const Vec3d&, const Vec3d& v, double, double) {
      speeds.push_back(norm(v));
    });
    const auto most = speeds.begin() + static_cast<std::ptrdiff_t>(speeds.size() * 99 / 100);
    std::nth_element(speeds.begin(), most, speeds.end());
    fast = std::max(fast, *most);
  }
  return {{"behind walls, in spacings", behind, shallow},
          {"lost", static_cast<double>(water.left()), 0},
          {"99 of 100 speeds over c", fast / water.liquid().sound_speed, 0.2}};
}

/// A jet some particles wide hits a plane at a tenth of c: the plane takes its momentum, and the
/// liquid spreads along it. It starts beyond the plane's reach: a jet released within it would at
/// once gain 5 % of its energy from the wall, as it starts without the pressure of that position.
template <class... Policies>
Measures jet(int wide, const Policies&... policies) {
  const double s = 0.01, v = 1, length = 30 * s, away = 4 * s;
  Sph water{Liquid{.density = rho, .sound_speed = 10 * v},
            {.spacing = s, .region = {{-4, 0, -0.1}, {4, 0, 4}}, .dimensions = 2},
            policies...};
  water.add_wall(Plane{{0, 0, 0}, {0, 0, 1}}, {.name = "floor"});
  water.fill(
      [=](const Vec3d& x) {
        return x.x > 0 && x.x < wide * s && x.z > away && x.z < away + length;
      },
      [=](const Vec3d&) {
        return Vec3d{0, 0, -v};
      },
      [](const Vec3d&) { return 0.0; });
  water.least_density = 0.5;  // of drops alone
  const double before = look(water, -4, 8).energy, momentum = norm(water.momentum());
  double gained = 0, fastest = 0, behind = 0;
  while (water.time() < (away + 1.2 * length) / v) {
    water.run(0.02 * length / v);
    const Seen seen = look(water, -4, 8);
    gained = std::max(gained, seen.energy / before - 1);
    fastest = std::max(fastest, seen.fastest), behind = std::max(behind, seen.behind);
  }
  Measures all{{"behind the plane, in spacings", behind, shallow},
               {"lost", static_cast<double>(water.left()), 0},
               {"energy gained", gained, 0.01},
               {"speed over the jet's", fastest / v, 2.5}};
  // In jets one or two particles wide the last ones bounce, with DynamicWalls in those of three
  // too: 0.33 (and 0.14 of four).
  constexpr bool dynamic = (std::is_same_v<Policies, DynamicWalls> || ...);
  if (wide > (dynamic ? 3 : 2))
    all.push_back({"momentum not taken", std::abs(water.momentum().z) / momentum, 0.25});
  return all;
}

/// A block in a tank, initially half submerged: light ones float, heavy ones sink to the floor. On
/// the way the energy never exceeds the initial one; at the end the block is at rest, floating or
/// on the floor.
Measures with_block(bool quick, double density, double alpha) {
  const double s = quick ? 0.02 : 0.01, L = 0.48, d = 0.2, a = 0.16, b = 0.08;
  Sph water{Liquid{.density = rho, .sound_speed = 10 * std::sqrt(2 * g * d)},
            {.spacing = s, .region = {{0, 0, 0}, {L, 0, 1}}, .dimensions = 2},
            ArtificialViscosity{.alpha = alpha}};
  water.gravity = {0, 0, -g};
  std::vector<Vec3d> corners;
  for (const double x : {-a / 2, a / 2})
    for (const double y : {-0.5, 0.5})
      for (const double z : {-b / 2, b / 2}) corners.push_back({x, y, z});
  Particles<Polyhedron> blocks;
  const auto form = blocks.add_form(Polyhedron::from_points(corners));
  blocks.add({.form = form, .position = {L / 2, 0, d}, .density = density});
  const Contacts<HertzMindlin> contacts{
      {.youngs_modulus = 1e7, .poisson_ratio = 0.3, .restitution = 0.3, .friction = 0.3}};
  water.fill([=](const Vec3d& x) {
    return x.z < d && !(std::abs(x.x - L / 2) < a / 2 && x.z > d - b / 2);
  });
  Simulation sim{std::move(blocks), contacts, std::move(water)};
  sim.gravity = {0, 0, -g};
  sim.threads = 1;
  sim.add_wall(Plane{{0, 0, 0}, {0, 0, 1}}, contacts.material(0), {.name = "floor"});
  sim.add_wall(Plane{{0, 0, 0}, {1, 0, 0}}, contacts.material(0), {.name = "wall"});
  sim.add_wall(Plane{{L, 0, 0}, {-1, 0, 0}}, contacts.material(0), {.name = "far wall"});
  const double m = density * a * b, scale = rho * g * a * b * d;
  const auto energy = [&] {
    const Vec3d v = sim.velocity(0), w = sim.angular_velocity(0);
    return look(sim.fluid(), 0, L).energy + m * g * sim.position(0).z + 0.5 * m * dot(v, v) +
           m * (a * a + b * b) / 24 * w.y * w.y;
  };
  const double before = energy();
  double gained = 0;
  for (int k = 0; k < (quick ? 40 : 100); ++k) {
    sim.run(0.04);
    gained = std::max(gained, (energy() - before) / std::max(scale, m * g * d));
  }
  const double in_the_end = (energy() - before) / std::max(scale, m * g * d);
  const Seen seen = look(sim.fluid(), 0, L);
  const double surface = d + (std::min(density / rho, 1.0) - 0.5) * a * b / L;
  const double rest = density < rho ? surface + b * (0.5 - density / rho) : b / 2;
  return {{"behind walls, in spacings", seen.behind, shallow},
          {"lost", seen.lost, 0},
          {"energy gained", gained, 0.02},
          {"energy gained in the end", in_the_end, 2e-3},
          {"off its place, in spacings", std::abs(sim.position(0).z - rest) / s, 1.5},
          {"speed over sqrt(g d)", norm(sim.velocity(0)) / std::sqrt(g * d), 0.1}};
}

/// A cylinder (in 2D a sphere with the mass of 1 m of it) moves through liquid under pressure that
/// fills a periodic box: the total momentum is constant, and no energy is gained.
Measures thrown(double density) {
  const double s = 0.01, L = 0.4, R = 0.04, c = 20, speed = c / 20;
  Sph water{Liquid{.density = rho, .sound_speed = c},
            {.spacing = s,
             .region = {{0, 0, 0}, {L, 0, L}},
             .dimensions = 2,
             .periodic = {true, false, true}},
            ArtificialViscosity{.alpha = 0.1}};
  Particles<Sphere> cylinder;
  cylinder.add({.position = {L / 2, 0, L / 2},
                .radius = R,
                .density = 0.75 * density / R,
                .velocity = {speed, 0, 0.3 * speed}});
  water.fill([](const Vec3d&) { return true; },
             [](const Vec3d&) {
               return Vec3d{0, 0, 0};
             },
             [=](const Vec3d&) { return 0.02 * rho * c * c; });
  Simulation sim{
      std::move(cylinder),
      Contacts<HertzMindlin>{
          {.youngs_modulus = 1e7, .poisson_ratio = 0.3, .restitution = 0.3, .friction = 0.3}},
      std::move(water), PeriodicBox{{{0, -1, 0}, {L, 1, L}}, {true, false, true}}};
  sim.threads = 1;
  sim.time_step = 2e-5;
  const double m = sim.mass(0);
  const Vec3d start = sim.velocity(0);
  const auto energy = [&] {
    const Vec3d v = sim.velocity(0);
    return look(sim.fluid(), -L, 3 * L).energy + 0.5 * m * dot(v, v);
  };
  sim.run(2e-5);  // which takes out the liquid where the cylinder is
  const double before = energy(), kinetic = 0.5 * m * dot(start, start);
  double gained = 0, fastest = 0;
  for (int k = 0; k < 20; ++k) {
    sim.run(0.005);
    gained = std::max(gained, (energy() - before) / kinetic);
    fastest = std::max(fastest, norm(sim.velocity(0)) / norm(start));
  }
  const Vec3d all = m * sim.velocity(0) + sim.fluid().momentum();
  return {{"momentum", norm(all - m * start) / (m * norm(start)), 0.01}  // what is held over a step
          ,
          {"energy gained", gained, 0.01},
          {"speed over the first", fastest, 1.01}};
}

/// A wall of a tank moves in, or out, by a third of its length.
Measures piston(double speed, double way) {
  const double s = 0.01, L = 0.4, d = 0.1, c = 10 * std::sqrt(2 * g * d);
  Sph water{Liquid{.density = rho, .sound_speed = c},
            {.spacing = s,
             .region = {{-0.3, 0, -0.1}, {L, 0, 3}},
             .dimensions = 2,
             .gravity = {0, 0, -g}},
            ArtificialViscosity{.alpha = 0.1}};
  const Motion motion = [=](double t) {
    return Pose{{}, {std::clamp(speed * c * t, 0.0, std::abs(way)) * (way > 0 ? 1 : -1), 0, 0}};
  };
  water.add_wall(Plane{{0, 0, 0}, {0, 0, 1}}, {.name = "floor"});
  water.add_wall(Plane{{0, 0, 0}, {1, 0, 0}}, {.name = "piston", .motion = motion});
  water.add_wall(Plane{{L, 0, 0}, {-1, 0, 0}}, {.name = "wall"});
  water.fill([=](const Vec3d& x) { return x.z < d; });
  double behind = 0, fastest = 0;
  const double end = std::abs(way) / (speed * c) + 0.1;
  for (int n = 0; n < 20; ++n) {
    water.run(end / 20);
    const double x = motion(water.time()).translation.x;
    const Seen seen = look(water, x, L - x);
    behind = std::max(behind, seen.behind), fastest = std::max(fastest, seen.fastest);
  }
  return {{"behind walls, in spacings", behind, shallow},
          {"lost", static_cast<double>(water.left()), 0},
          {"speed over c", fastest / c, 3 * std::max(speed, 0.15)}};
}

/// 64 particles at rest on a floor: their state after so many steps; `most`: error of the pressure.
template <class... Policies>
Measures at_rest(std::int64_t steps, double most, const Policies&... policies) {
  // Without diffusion nothing damps the particles' noise: 0.01 to 0.1, at any time step.
  constexpr bool noisy = (std::is_same_v<Policies, NoDiffusion> || ...);
  const double s = 0.01, H = 8 * s, c = 10 * std::sqrt(2 * g * H);
  Sph water{Liquid{.density = rho, .sound_speed = c},
            {.spacing = s,
             .region = {{0, 0, 0}, {8 * s, 0, 2 * H}},
             .dimensions = 2,
             .periodic = {true, false, false},
             .gravity = {0, 0, -g}},
            policies...};
  water.add_wall(Plane{{0, 0, 0}, {0, 0, 1}}, {.name = "floor"});
  water.fill([=](const Vec3d& x) { return x.z < H; });
  const auto height = [&] {
    double sum = 0;
    water.for_each(
        [&](std::uint32_t, const Vec3d& x, const Vec3d&, double, double) { sum += x.z; });
    return sum / static_cast<double>(water.size());
  };
  const double before = height();
  while (water.steps() < steps) water.step(water.longest_step());
  const Seen seen = look(water, -1, 3);
  double squares = 0;
  water.for_each([&](std::uint32_t, const Vec3d& x, const Vec3d&, double, double p) {
    const double off = p / (rho * g * H) - (1 - x.z / H);
    squares += off * off;
  });
  return {{"behind the floor, in spacings", seen.behind, shallow},
          {"lost", seen.lost, 0},
          {"height", std::abs(height() / before - 1), 0.03},
          {"pressure", std::sqrt(squares / static_cast<double>(water.size())), most},
          {"speed over sqrt(g H)", seen.fastest / std::sqrt(g * H), noisy ? 0.15 : 0.01}};
}

/// Nearest neighbours, over the spacing: the smallest and the mean distance.
template <class Water>
std::pair<double, double> nearest_neighbours(const Water& water) {
  std::vector<Vec3d> x;
  water.for_each(
      [&](std::uint32_t, const Vec3d& at, const Vec3d&, double, double) { x.push_back(at); });
  const Vec3d e = water.setup().region.extent();
  double least = std::numeric_limits<double>::infinity(), sum = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    double own = std::numeric_limits<double>::infinity();
    for (std::size_t j = 0; j < x.size(); ++j) {
      if (i == j) continue;
      Vec3d r = x[i] - x[j];
      if (water.setup().periodic[0]) r.x -= e.x * std::round(r.x / e.x);
      if (water.setup().periodic[2]) r.z -= e.z * std::round(r.z / e.z);
      own = std::min(own, norm(r));
    }
    least = std::min(least, own), sum += own;
  }
  const double s = water.setup().spacing;
  return {least / s, sum / s / static_cast<double>(x.size())};
}

/// A liquid that fills a periodic box, at a pressure of that fraction of rho_0 c^2, slightly
/// perturbed: under tension, clumping particles approach each other in pairs.
template <class... Policies>
Measures under_pressure(double pressure, double smoothing, const Policies&... policies) {
  const double s = 0.01, c = 10, speed = 0.02;
  Sph water{Liquid{.density = rho, .sound_speed = c},
            {.spacing = s,
             .region = {{0, 0, 0}, {20 * s, 0, 20 * s}},
             .smoothing = smoothing,
             .dimensions = 2,
             .periodic = {true, false, true}},
            policies...};
  Random random(7);
  water.fill(
      [](const Vec3d&) { return true; },
      [&](const Vec3d&) {
        return Vec3d{speed * c * random.uniform(-1, 1), 0, speed * c * random.uniform(-1, 1)};
      },
      [=](const Vec3d&) { return pressure * rho * c * c; });
  const double before = water.kinetic_energy();
  water.run(2000 * s / c);  // 100 times through the box, as sound goes
  const auto [least, mean] = nearest_neighbours(water);
  return {{"1 over nearest neighbours", 1 / least, 2},
          {"mean of them below 0.8", std::max(0.8 - mean, 0.0), 0},
          {"energy gained", std::max(water.kinetic_energy() / before - 1, 0.0), 0}};
}

/// A round drop stretched at the rate `strain` [1/s], 0.5 or 1 % of the speed of sound over its
/// radius: a sheet that gets thin and tears. No pair of particles approaches.
template <class... Policies>
Measures pulled(double strain, const Policies&... policies) {
  const double s = 0.05, c = 20;
  Sph water{Liquid{.density = rho, .sound_speed = c},
            {.spacing = s, .region = {{-40, 0, -40}, {40, 0, 40}}, .dimensions = 2},
            policies...};
  water.fill([](const Vec3d& x) { return dot(x, x) < 1; },
             [&](const Vec3d& x) {
               return strain * Vec3d{x.x, 0, x.z};
             },
             [](const Vec3d&) { return 0.0; });
  water.least_density = 0.01;
  const double before = water.kinetic_energy();
  water.run(3 / strain);
  const auto [least, mean] = nearest_neighbours(water);
  return {{"1 over nearest neighbours", 1 / least, 3},
          {"mean of them below 0.6", std::max(0.6 - mean, 0.0), 0},
          {"energy gained", std::max(water.kinetic_energy() / before - 1, 0.0), 1e-3},
          {"momentum", norm(water.momentum()) / std::sqrt(2 * water.mass() * before), 1e-12}};
}

/// A collapsing column; the speed of sound is a multiple of that of free fall from its height.
/// Catches parting from walls that lowers densities after contact has ended: from 50 times on the
/// column gained 2 to 27 %.
Measures stiff(double sound) {
  const double s = 0.01, H = 0.2, fall = std::sqrt(2 * g * H);
  Sph water{
      Liquid{.density = rho, .sound_speed = sound * fall},
      {.spacing = s, .region = {{0, 0, 0}, {1, 0, 0.4}}, .dimensions = 2, .gravity = {0, 0, -g}}};
  water.add_wall(Plane{{0, 0, 0}, {0, 0, 1}}, {.name = "floor"});
  water.add_wall(Plane{{0, 0, 0}, {1, 0, 0}}, {.name = "wall"});
  water.fill([=](const Vec3d& x) { return x.x < 0.1 && x.z < H; });
  const Seen first = look(water, 0, 2);
  double gained = 0, fastest = 0;
  for (int k = 0; k < 15; ++k) {
    water.run(0.02);
    const Seen seen = look(water, 0, 2);
    gained = std::max(gained, seen.energy / first.energy - 1);
    fastest = std::max(fastest, seen.fastest);
  }
  const Seen seen = look(water, 0, 2);
  return {{"behind walls, in spacings", seen.behind, shallow},
          {"lost", seen.lost, 0},
          {"energy gained", gained, 0.005},
          {"energy lost", 1 - seen.energy / first.energy, 0.2},
          {"speed over 2 sqrt(g H)", fastest / (2 * std::sqrt(g * H)), 1.1}};
}

}  // namespace sph_rows

void sph(Table& table) {
  using namespace sph_rows;
  const bool quick = table.quick;
  const LaminarViscosity water_like{.kinematic = 1e-6};

  table.scene("SPH: a tank is shaken at its resonance, three periods",
              "nothing behind walls or lost, 99 of 100 speeds below a fifth of c");
  for (const double amplitude : {0.005, 0.02, 0.04}) {
    const std::string by = text("by ", amplitude, " m, ");
    if (!quick)
      table.row(by + "alpha = 0.02", Setting::Tame,
                [&] { return shaken(quick, amplitude, ArtificialViscosity{}); });
    table.row(by + "alpha = 0.1", Setting::Tame,
              [&] { return shaken(quick, amplitude, ArtificialViscosity{.alpha = 0.1}); });
    table.row(by + "laminar, 1e-6 m2/s", Setting::Tame,
              [&] { return shaken(quick, amplitude, water_like); });
  }

  table.scene("SPH: a jet of few particles hits a plane at a tenth of c",
              "nothing behind it, no energy gained, momentum taken, nothing twice as fast");
  for (const int wide : {1, 2, 3, 4, 8}) {
    if (quick && wide == 3) continue;
    const std::string by = text(wide, wide == 1 ? " particle" : " particles", " wide, ");
    for (const double alpha : {0.02, 0.1})
      table.row(by + text("alpha = ", alpha), Setting::Tame,
                [&] { return jet(wide, ArtificialViscosity{.alpha = alpha}); });
    table.row(by + "alpha = 0.1, DynamicWalls", Setting::Tame,
              [&] { return jet(wide, ArtificialViscosity{.alpha = 0.1}, DynamicWalls{}); });
  }

  table.scene("SPH: a block 100 times lighter to 100 times heavier than the liquid",
              "no energy gained, at rest afloat or on the floor in the end");
  for (const double density : {10.0, 100.0, 500.0, 2000.0, 1e4, 1e5})
    if (!quick || (density != 100 && density != 1e4))
      // At impact the liquid under the block is pressed out faster than the block moves.
      table.row(text(density, " kg/m3"), density > 5000 ? Setting::Extreme : Setting::Tame,
                [&] { return with_block(quick, density, 0.1); });

  table.scene("SPH: a cylinder is thrown at c/20 through liquid that fills a box which repeats",
              "momentum of both kept, no energy gained");
  for (const double density : {10.0, 100.0, 1000.0, 1e4, 1e5})
    if (!quick || density == 10 || density == 1e5)
      table.row(text(density, " kg/m3"), Setting::Tame, [&] { return thrown(density); });

  table.scene(
      "SPH: a wall of a tank moves fast, 12 spacings in or out",
      "nothing behind walls or lost; faster out than sqrt(g d) it may be stopped; beyond c/5 it is "
      "refused at the start");
  for (const double way : {0.12, -0.12})
    for (const double speed : {0.02, 0.05, 0.1, 0.3, 1.0, 3.0}) {
      const std::string name = text(speed, " of c, ", way > 0 ? "in" : "out");
      const auto run = [speed, way] { return piston(speed, way); };
      if (speed > 0.2)
        table.stops(name, "times the speed of wall 'piston'", run);
      else
        table.row(name, way < 0 && speed > 0.06 ? Setting::Extreme : Setting::Tame, run);
    }

  const std::int64_t many = quick ? 20'000 : 1'000'000, some = quick ? 20'000 : 100'000;
  table.scene(
      "SPH: 64 particles at rest on a floor for many steps",
      "speeds below a hundredth of sqrt(g H), pressure and height within 3 % (without diffusion "
      "0.15 and 50 %: noise)");
  table.row(text(many, " steps"), Setting::Tame, [&] { return at_rest(many, 0.03); });
  table.row(text(some, " steps, VerletTime"), Setting::Tame,
            [&] { return at_rest(some, 0.03, VerletTime{}); });
  table.row(text(some, " steps, NoShifting"), Setting::Tame,
            [&] { return at_rest(some, 0.03, NoShifting{}); });
  // Noise v has the pressure rho c v. After some 30 s, with any step, it lifts the liquid by 14 %.
  table.row(text(some / 4, " steps, NoDiffusion"), Setting::Tame,
            [&] { return at_rest(some / 4, 0.5, NoDiffusion{}); });
  table.row(text(some, " steps, laminar, 1e-6 m2/s"), Setting::Tame,
            [&] { return at_rest(some, 0.03, water_like); });

  table.scene("SPH: a liquid under pressure and tension, stirred, and a drop that is pulled apart",
              "no neighbours nearer than half a spacing, no energy gained");
  for (const double pressure : {0.03, 0.0, -0.01, -0.05, -0.1}) {
    const std::string at = text("P = ", pressure, " rho c^2, ");
    const auto run = [pressure] { return under_pressure(pressure, 1.2); };
    if (pressure > -0.02)
      table.row(at + "WendlandC2", Setting::Tame, run);
    else  // below -B/10 (docs/sph.md)
      table.stops(at + "WendlandC2", "Pa must be above", run);
    if (pressure >= 0)  // under tension it clumps
      table.row(at + "WendlandC2, NoShifting", Setting::Tame,
                [&] { return under_pressure(pressure, 1.2, NoShifting{}); });
    if (pressure >= 0)  // and so does this one; above a smoothing of 0.85 at any pressure
      table.row(at + "CubicSpline, smoothing 0.8", Setting::Tame,
                [&] { return under_pressure(pressure, 0.8, CubicSpline{}); });
  }
  for (const double strain : {0.1, 0.2})  // faster, its shreds clump
    table.row(text("drop pulled at ", strain, " R/s, c = 20 R/s"), Setting::Tame,
              [&] { return pulled(strain); });

  table.scene("SPH: a column collapses, stiff sound",
              "no energy gained, nothing behind walls, front not faster than 2 sqrt(g H)");
  for (const double sound : {10.0, 30.0, 100.0})
    if (!quick || sound != 30)
      table.row(text("c = ", sound, " times the fall's speed"), Setting::Tame,
                [&] { return stiff(sound); });
}

}  // namespace stability
