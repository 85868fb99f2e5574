// silt - BSD-3-Clause, see LICENSE
//
// The exchange of a fluid step is stable for any density ratio and void fraction in every form:
// models, modes of averaging, open sides, bodies. Particles by a loop of its own, without contacts.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include <doctest/doctest.h>

#include <silt/fluid.hpp>

#include "near.hpp"

namespace light_forms_test {

using silt::FlowSolver;
using silt::Grid;
using silt::Vec3d;

namespace {

constexpr double water = 1000, mu = 1e-3, g = 9.81, d = 0.5e-3;  // [kg/m3], [Pa s], [m/s2], [m]
const double volume = silt::Sphere::volume(d / 2);

/// Particles of one kind and a fluid, step by step.
template <class Fluid>
struct Crowd {
  Fluid fluid;
  std::vector<Vec3d> position, velocity, force;
  std::vector<double> radius, volumes, mass;
  std::vector<silt::Quaternion> orientation;
  std::vector<std::uint32_t> form;
  std::vector<silt::AveragedForm> forms;

  Crowd(Fluid in, double density, std::vector<Vec3d> at)
      : fluid(std::move(in)),
        position(std::move(at)),
        velocity(position.size()),
        force(position.size()),
        radius(position.size(), d / 2),
        volumes(position.size(), volume),
        mass(position.size(), density * volume) {
    fluid.gravity = {0, 0, -g};
  }
  void step(double dt) {
    const std::vector<Vec3d> weight(position.size(), {0, 0, -g});
    fluid.advance({.shape = {position, radius, orientation, form, forms},
                   .velocity = velocity,
                   .volume = volumes,
                   .mass = mass,
                   .acceleration = weight},
                  dt, force);
    for (std::size_t k = 0; k < position.size(); ++k) {
      velocity[k] += dt * ((1 / mass[k]) * force[k] + weight[k]);
      position[k] += dt * velocity[k];
    }
  }
};

struct Form {
  silt::MomentumModel model = silt::MomentumModel::A;
  bool open = false;  // inflow below, outlet above; else a floor and a lid
  bool bodies = false;
};

struct Motion {
  double mean;  // [-] of the middle, beyond the inflow, over the law's at the voidage that is seen
  double fastest;  // [-] in the second half, over a lone particle's
  double closure;  // [-] of momentum
};

/// A disturbed lattice of 4 x 4 x 10 from rest, in fluid steps of half its relaxation time, or as
/// long as the flow allows.
template <class Mode, class... Forces>
Motion rise(double ratio, double voidage, const Mode& mode, const Form& how,
            const Forces&... forces) {
  const int n = 4, layers = 10;
  const double density = ratio * water;
  const double pitch = std::cbrt(volume / (1 - voidage)), W = n * pitch, H = (layers + 4) * pitch;
  const double law =
      silt::minimum_fluidisation_velocity(silt::Gidaspow{}, voidage, d, density, water, mu);
  FlowSolver flow(Grid({{0, 0, 0}, {W, W, H}}, {4, 4, 14}, {true, true, false}), {water, mu},
                  {.model = how.model, .tolerance = 1e-8});
  const double inflow = how.open ? 0.5 * law : 0;
  if (how.open) {
    flow.set_side(2, 0, silt::Inflow{{0, 0, inflow}});
    flow.set_side(2, 1, silt::Outflow{});
  }
  std::vector<Vec3d> at;
  silt::Random random(1);
  for (int k = 0; k < n * n * layers; ++k) {
    const auto place = [&](int i) { return (i + 0.5 + 0.05 * random.uniform(-1, 1)) * pitch; };
    at.push_back({place(k % n), place(k / n % n), place(k / (n * n) + 2)});
  }
  const double K = silt::drag_coefficient(silt::Gidaspow{}, voidage, law * water * d / mu, d, mu);
  const double relaxation = voidage * voidage * (density + water) * volume / K;
  const double longest = 0.5 * pitch / law;  // the lattice stays one
  const double dt = std::min({0.5 * relaxation, 0.9 * flow.stable_step(), longest / 40});
  Crowd crowd(silt::CoupledFlow{silt::Gidaspow{}, mode, std::move(flow), forces...}, density, at);
  if (how.bodies) {
    // An ellipsoid of the sphere's volume.
    crowd.forms.push_back(silt::averaged_form(silt::SuperEllipsoid{1, 1, 1.5}));
    crowd.form.assign(at.size(), 0);
    crowd.orientation.assign(at.size(), silt::Quaternion{});
  }
  Motion done{0, 0, 0};
  const double lone = silt::terminal_velocity(silt::Gidaspow{}, d, density, water, mu);
  const double end = std::min(std::max(8 * relaxation, 40 * dt), longest);
  for (double t = 0; t < end; t += dt) {
    crowd.step(dt);
    for (std::size_t k = 0; k < at.size() && t > 0.5 * end; ++k)
      done.fastest = std::max(done.fastest, norm(crowd.velocity[k] - Vec3d{0, 0, inflow}) / lone);
  }
  double seen = 0;
  int count = 0;
  for (std::size_t k = 0; k < at.size(); ++k)
    if (std::abs(crowd.position[k].z / H - 0.5) < 0.1) {
      done.mean += crowd.velocity[k].z - inflow, ++count;
      seen += crowd.fluid.voidage_at_particles()[k];
    }
  done.mean *=
      (ratio < 1 ? 1.0 : -1.0) / count /
      silt::minimum_fluidisation_velocity(silt::Gidaspow{}, seen / count, d, density, water, mu);
  done.closure = crowd.fluid.closure().momentum;
  return done;
}

/// `blur`: error of the velocity, as the short lattice is not quite uniform where the mode looks;
/// 1: it is not looked at.
template <class Mode, class... Forces>
void sweep(const Mode& mode, const Form& how, double blur, const Forces&... forces) {
  for (const double ratio : {1e-6, 0.02, 0.5, 2.0, 1e6})
    for (const double voidage : {0.4, 0.85, 0.99}) {
      CAPTURE(ratio);
      CAPTURE(voidage);
      const Motion m = rise(ratio, voidage, mode, how, forces...);
      CHECK(m.closure < 1e-12);
      CHECK(m.fastest < 1.2);
      // Heavy ones are still on their way.
      if (ratio < 1 && blur < 1) CHECK(m.mean == near(1).epsilon(blur));
    }
}

}  // namespace

TEST_CASE("particles of any density in every form: models and sides") {
  for (const auto model : {silt::MomentumModel::A, silt::MomentumModel::B})
    for (const bool open : {false, true}) {
      CAPTURE(static_cast<int>(model));
      CAPTURE(open);
      sweep(silt::Kernel{}, {model, open}, 0.15);
    }
}

TEST_CASE("particles of any density in every form: modes of averaging") {
  SUBCASE("Unresolved, exact") { sweep(silt::Unresolved{}, {}, 1); }
  SUBCASE("TwoGrid") { sweep(silt::TwoGrid{}, {}, 1); }
  SUBCASE("Diffusion") { sweep(silt::Diffusion{.width = 3}, {}, 1); }
}

TEST_CASE("particles of any density in every form: virtual mass, bodies") {
  SUBCASE("virtual mass") { sweep(silt::Kernel{}, {}, 0.15, silt::VirtualMass{}); }
  SUBCASE("virtual mass, model B, open") {
    sweep(silt::Kernel{}, {silt::MomentumModel::B, true}, 0.15, silt::VirtualMass{});
  }
  SUBCASE("ellipsoids") { sweep(silt::Kernel{}, {.bodies = true}, 0.3); }
}

TEST_CASE(
    "one grain of a millionth of the water's density: no noise that grows with shorter steps") {
  // Stokes' regime: Re = 0.04. It crosses half a cell.
  const double viscosity = 0.01, W = 8 * d, v = d * d * (water - 1e-3) * g / (18 * viscosity);
  const auto noise = [&](int shorter) {
    FlowSolver flow(Grid({{0, 0, 0}, {W, W, W}}, {8, 8, 8}), {water, viscosity},
                    {.tolerance = 1e-8});
    const double dt = 0.5 * flow.stable_step() / shorter;
    Crowd grain(silt::CoupledFlow{silt::Stokes{}, silt::Kernel{}, std::move(flow)}, 1e-3,
                {{0.51 * W, 0.47 * W, 0.45 * W}});
    double most = 0, least = 1e30;
    const double end = 0.5 * d / v;
    for (double t = 0; t < end; t += dt) {
      grain.step(dt);
      if (t < 0.5 * end) continue;
      most = std::max(most, grain.velocity[0].z / v),
      least = std::min(least, grain.velocity[0].z / v);
    }
    CHECK(least > 0.98);
    CHECK(most < 1.05);  // the water that it drags along
    return most - least;
  };
  // By its place in the cells; the same for every step.
  for (const int shorter : {1, 4, 16}) CHECK(noise(shorter) < 0.015);
}

}  // namespace light_forms_test
