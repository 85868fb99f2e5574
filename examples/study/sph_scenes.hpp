// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <silt/sph.hpp>

#include "study/studies.hpp"

/// Liquids with closed forms, all in 2D: the references of the SPH study.
namespace studies::sph {

constexpr double g = 9.81, rho = 1000;  // [m/s2], [kg/m3]

/// Varied parameters other than policies.
struct Choice {
  double fine = 1;  // [-] particles a length, over those of the coarsest
  double smoothing = 1.2, courant = 0, alpha = 0.02;
  double sound = 10;  // [-] over the largest speed that the scene may have
};
inline int count(double coarsest, const Choice& choice) {
  return std::max(4, static_cast<int>(std::lround(coarsest * choice.fine)));
}

/// A column 0.3 m high on a floor, periodic along x, 1 s after filling: rms pressure error over the
/// pressure at the floor, and the largest speed over sqrt(g H), mean of the last 0.2 s [%].
struct Column {
  double pressure = 0, speed = 0;
};
template <class... Policies>
Column column(silt::StudyRun& run, const Choice& of, const Policies&... policies) {
  const double H = 0.3, s = H / count(16, of);
  silt::Sph water{silt::Liquid{.density = rho, .sound_speed = of.sound * std::sqrt(2 * g * H)},
                  {.spacing = s,
                   .region = {{0, 0, 0}, {12 * s, 0, 1.5 * H}},
                   .smoothing = of.smoothing,
                   .dimensions = 2,
                   .periodic = {true, false, false},
                   .gravity = {0, 0, -g},
                   .courant = of.courant},
                  silt::ArtificialViscosity{.alpha = of.alpha},
                  policies...};
  water.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}});
  water.fill([=](const silt::Vec3d& x) { return x.z < H; });
  Column seen;
  run.time([&] {
    water.run(0.8);
    for (int k = 0; k < 10; ++k) {
      water.run(0.02);
      double squares = 0, fastest = 0;
      water.for_each(
          [&](std::uint32_t, const silt::Vec3d& x, const silt::Vec3d& v, double, double p) {
            const double off = p / (rho * g * H) - (1 - x.z / H);
            squares += off * off, fastest = std::max(fastest, norm(v));
          });
      seen.pressure += 10 * std::sqrt(squares / static_cast<double>(water.size()));
      seen.speed += 10 * fastest / std::sqrt(g * H);
    }
  });
  return seen;
}

/// Flow between plates driven by a body force from rest, at a tenth of the viscous diffusion time
/// across the gap, Re = 10: rms error over the largest velocity [%].
template <class... Policies>
double plates(silt::StudyRun& run, const Choice& of, const Policies&... policies) {
  const double H = 0.01, U = 0.01, nu = 1e-5, s = H / count(12, of), end = 0.1 * H * H / nu;
  silt::Sph oil{silt::Liquid{.density = rho, .sound_speed = of.sound * U},
                {.spacing = s,
                 .region = {{0, 0, 0}, {12 * s, 0, H}},
                 .smoothing = of.smoothing,
                 .dimensions = 2,
                 .periodic = {true, false, false},
                 .gravity = {8 * nu * U / (H * H), 0, 0},
                 .courant = of.courant},
                silt::LaminarViscosity{.kinematic = nu, .alpha = 0},
                policies...};
  oil.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}});
  oil.add_wall(silt::Plane{{0, 0, H}, {0, 0, -1}});
  oil.fill([](const silt::Vec3d&) { return true; });
  run.time([&] { oil.run(end); });
  double squares = 0;
  oil.for_each([&](std::uint32_t, const silt::Vec3d& x, const silt::Vec3d& v, double, double) {
    const double z = x.z / H;
    double u = 4 * U * z * (1 - z);
    for (int k = 1; k < 80; ++k) {
      const double a = (2 * k - 1) * std::numbers::pi;
      u -= 32 * U / (a * a * a) * std::sin(a * z) * std::exp(-a * a * nu * end / (H * H));
    }
    squares += (v.x - u) * (v.x - u);
  });
  return 100 * std::sqrt(squares / static_cast<double>(oil.size())) / U;
}

/// A round drop with an initial strain rate deforms into an ellipse (tests/sph/elliptic_drop.cpp),
/// until it is four times as long as wide: its axes and its energy against Euler's equations [%].
struct Drop {
  double axes = 0, energy = 0;
};
template <class... Policies>
Drop drop(silt::StudyRun& run, const Choice& of, const Policies&... policies) {
  const double end = 0.8, a_end = 1.99916, b_end = 0.50021;
  const silt::Vec3d along{std::cos(std::numbers::pi / 9), 0, std::sin(std::numbers::pi / 9)},
      across{-along.z, 0, along.x};
  silt::Sph water{silt::Liquid{.density = rho, .sound_speed = of.sound},
                  {.spacing = 1.0 / count(20, of),
                   .region = {{-3, 0, -3}, {3, 0, 3}},
                   .smoothing = of.smoothing,
                   .dimensions = 2,
                   .courant = of.courant},
                  silt::ArtificialViscosity{.alpha = of.alpha},
                  policies...};
  water.fill([](const silt::Vec3d& x) { return dot(x, x) < 1; },
             [&](const silt::Vec3d& x) { return dot(along, x) * along - dot(across, x) * across; },
             [](const silt::Vec3d& x) { return 0.5 * rho * (1 - dot(x, x)); });
  const double before = water.kinetic_energy();
  run.time([&] { water.run(end); });
  double a = 0, b = 0;
  water.for_each([&](std::uint32_t, const silt::Vec3d& x, const silt::Vec3d&, double, double) {
    const double u = dot(along, x), w = dot(across, x);
    a += 4 * u * u, b += 4 * w * w;
  });
  const double n = static_cast<double>(water.size());
  return {100 * std::max(std::abs(std::sqrt(a / n) / a_end - 1),
                         std::abs(std::sqrt(b / n) / b_end - 1)),
          100 * (water.kinetic_energy() / before - 1)};
}

/// The first standing wave in a tank 1 m long, 0.5 m deep, 20 mm high. It starts with the
/// velocities of linear theory and a flat surface. Errors: the period, against omega^2 = g k tanh(k
/// d), and the amplitude lost per period [%]. The amplitude is the projection of the velocities
/// onto those of the theory.
struct Wave {
  double period = 0, decay = 0;
};
template <class... Policies>
Wave wave(silt::StudyRun& run, const Choice& of, const Policies&... policies) {
  const double L = 1, d = 0.5, amplitude = 0.02, k = std::numbers::pi / L;
  const double omega = std::sqrt(g * k * std::tanh(k * d)), period = 2 * std::numbers::pi / omega;
  silt::Sph water{silt::Liquid{.density = rho, .sound_speed = of.sound * std::sqrt(2 * g * d)},
                  {.spacing = d / count(15, of),
                   .region = {{0, 0, 0}, {L, 0, 0.7}},
                   .smoothing = of.smoothing,
                   .dimensions = 2,
                   .gravity = {0, 0, -g},
                   .courant = of.courant},
                  silt::ArtificialViscosity{.alpha = of.alpha},
                  policies...};
  water.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}});
  water.add_wall(silt::Plane{{0, 0, 0}, {1, 0, 0}});
  water.add_wall(silt::Plane{{L, 0, 0}, {-1, 0, 0}});
  const auto theory = [&](const silt::Vec3d& x) {
    const double most = amplitude * omega / std::sinh(k * d);
    return most * silt::Vec3d{-std::cosh(k * x.z) * std::sin(k * x.x), 0,
                              std::sinh(k * x.z) * std::cos(k * x.x)};
  };
  water.fill([=](const silt::Vec3d& x) { return x.z < d; }, theory,
             [=](const silt::Vec3d& x) { return rho * g * (d - x.z); });
  std::vector<double> part{1};
  const int samples = 50, periods = 2;
  run.time([&] {
    for (int n = 0; n < periods * samples; ++n) {
      water.run(period / samples);
      double with = 0, all = 0;
      water.for_each([&](std::uint32_t, const silt::Vec3d& x, const silt::Vec3d& v, double,
                         double) { with += dot(v, theory(x)), all += dot(theory(x), theory(x)); });
      part.push_back(with / all);
    }
  });
  std::vector<double> crossings;
  for (std::size_t n = 1; n < part.size(); ++n)
    if (part[n - 1] * part[n] < 0)
      crossings.push_back(static_cast<double>(n - 1) + part[n - 1] / (part[n - 1] - part[n]));
  if (crossings.size() < 3) return {100, 100};
  // From the first to the last zero crossing; extremes near the middle between them.
  const double half =
      (crossings.back() - crossings.front()) / static_cast<double>(crossings.size() - 1) / samples;
  const auto most = [&](double from, double to) {
    double largest = 0;
    for (double n = std::ceil(from); n <= to; ++n)
      largest = std::max(largest, std::abs(part[static_cast<std::size_t>(n)]));
    return largest;
  };
  const std::size_t last = crossings.size() - 1;
  const double first = most(crossings[0], crossings[1]),
               end = most(crossings[last - 1], crossings[last]);
  return {100 * (2 * half - 1),
          100 * (1 - std::pow(end / first, 2.0 / static_cast<double>(last - 1)))};
}

/// Shear modulus over the pressure [-] of particles on a square lattice; a liquid has none. From
/// the energy P V sum W of a stretch along the lattice that keeps the area: sums of a kernel are
/// not integrals. Waves are faster by half of it, as long as the lattice persists.
template <class Kernel>
double lattice_stiffness(double smoothing) {
  const double h = smoothing * std::numbers::sqrt2;
  const auto sum = [h](double strain) {
    double all = 0;
    for (int i = -8; i <= 8; ++i)
      for (int j = -8; j <= 8; ++j)
        if (i != 0 || j != 0)
          all += Kernel::weight(
              std::hypot(i * std::exp(0.5 * strain), j * std::exp(-0.5 * strain)) / h);
    return Kernel::normalisation(2, h) * all;
  };
  const double e = 0.01;
  return (sum(e) - 2 * sum(0) + sum(-e)) / (e * e);
}

/// All scenes.
template <class... Policies>
silt::Study::Variant all_of(const Choice& choice, const Policies&... policies) {
  return [=](silt::StudyRun& run) {
    const Column at_rest = column(run, choice, policies...);
    const double profile = plates(run, choice, policies...);
    const Drop drawn = drop(run, choice, policies...);
    const Wave swings = wave(run, choice, policies...);
    run.error("pressure at rest", at_rest.pressure, "%");
    run.error("speed at rest", at_rest.speed, "%");
    run.error("flow between plates", profile, "%");
    run.error("axes of the drop", drawn.axes, "%");
    run.error("energy of the drop", drawn.energy, "%");
    run.error("period of the wave", swings.period, "%");
    run.error("wave lost a period", swings.decay, "%");
    run.note("period", swings.period, "%");
  };
}

}  // namespace studies::sph
