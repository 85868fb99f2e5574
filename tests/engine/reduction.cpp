// silt - BSD-3-Clause, see LICENSE
// What the state of a particle and of a contact takes, and how the loads of contacts are summed.
#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <vector>

#include <silt/contact/hertz_mindlin.hpp>
#include <silt/contact/linear_spring.hpp>
#include <silt/contact/rolling/epsd.hpp>
#include <silt/core/random.hpp>
#include <silt/simulation.hpp>

namespace reduction_test {

namespace {

using silt::Contacts;
using silt::HertzMindlin;
using silt::LinearSpring;
using silt::LinearSpringFriction;
using silt::RollingEpsd;
using silt::SeveralMaterials;
using silt::Sphere;
using silt::Vec3d;

template <class... Options>
using Sim = silt::Simulation<silt::Particles<Sphere>, Contacts<Options...>>;

}  // namespace

TEST_CASE("state: bytes of a particle and of a contact are those that the policies need") {
  // Centre and radius; velocity and 1/m, with rotation as much again; id.
  CHECK(Sim<HertzMindlin>::bytes_per_particle == 32 + 64 + 8);
  CHECK(Sim<LinearSpringFriction>::bytes_per_particle == 32 + 64 + 8);
  CHECK(Sim<LinearSpring>::bytes_per_particle == 32 + 32 + 8);
  CHECK(Sim<HertzMindlin, SeveralMaterials>::bytes_per_particle == 32 + 64 + 8 + 2);
  CHECK(Sim<LinearSpring, SeveralMaterials>::bytes_per_particle == 32 + 32 + 8 + 2);
  CHECK(Sim<LinearSpring, RollingEpsd>::bytes_per_particle == 32 + 64 + 8);
  // Two indices; three Reals of tangential and three of rolling history.
  CHECK(Sim<HertzMindlin>::bytes_per_contact == 8 + 24);
  CHECK(Sim<LinearSpringFriction>::bytes_per_contact == 8 + 24);
  CHECK(Sim<LinearSpring>::bytes_per_contact == 8);
  CHECK(Sim<HertzMindlin, RollingEpsd>::bytes_per_contact == 8 + 24 + 24);
  CHECK(Sim<LinearSpring, RollingEpsd>::bytes_per_contact == 8 + 24);
  CHECK(Sim<HertzMindlin, SeveralMaterials>::bytes_per_contact == 8 + 24);
  // The rows of memory that a load takes: force; torque; couple.
  CHECK(silt::detail::load_chunks<Contacts<LinearSpring>> == 1);
  CHECK(silt::detail::load_chunks<Contacts<HertzMindlin>> == 2);
  CHECK(silt::detail::load_chunks<Contacts<HertzMindlin, RollingEpsd>> == 3);
}

TEST_CASE("reduction: a row acts on both partners, torque with the same sign, in any width") {
  const auto check = [](auto arch) {
    using Arch = decltype(arch);
    alignas(64) double row[12], sums[2][12];
    for (int k = 0; k < 12; ++k) row[k] = k + 1, sums[0][k] = sums[1][k] = 100;
    silt::detail::add_row<Arch, 3, false>(sums[0], row);
    silt::detail::add_row<Arch, 3, true>(sums[1], row);
    for (int k = 0; k < 12; ++k) {
      CHECK(sums[0][k] == 101 + k);
      CHECK(sums[1][k] == (k / 4 == 1 ? 101 + k : 99 - k));
    }
  };
  check(silt::OneLane{}), check(silt::DefaultArch{});
}

TEST_CASE("reduction: a sphere in contact with 60 others feels the sum of their springs") {
  // Sixty spheres of 1 mm pressed into one of 10 mm by up to 20 um, the large one first and last.
  for (const bool first : {true, false}) {
    silt::Random random(5);
    const silt::Particles<Sphere>::Particle large{
        .position = {0, 0, 0}, .radius = 1e-2, .density = 1000};
    silt::Particles<Sphere> p;
    if (first) p.add(large);
    Vec3d force{0, 0, 0};
    constexpr double k = 100;  // [N/m]
    for (int n = 0; n < 60; ++n) {
      // A spiral of equal areas over the sphere: no two are nearer than 4 mm.
      const double z = 1 - (n + 0.5) / 30, around = 2.399963 * n, across = std::sqrt(1 - z * z);
      const Vec3d normal{across * std::cos(around), across * std::sin(around), z};
      const double overlap = random.uniform(0, 2e-5);
      p.add({.position = normal * (1.1e-2 - overlap), .radius = 1e-3, .density = 1000});
      force -= normal * (k * overlap);
    }
    if (!first) p.add(large);
    silt::Simulation sim{std::move(p), Contacts<LinearSpring>{{.stiffness = k}}};
    sim.time_step = 1e-6;
    sim.threads = 1;
    sim.run(0);  // one half kick from rest
    CHECK(sim.touching_pairs() == 60);
    const auto& motion = sim.engine().particles.motion[sim.find(first ? 0 : 60)];
    const Vec3d expected = force * (motion.inv_m * 0.5e-6);
    // The overlap, 1e-5 of 1.1e-2 m, has a relative round-off of 1e-13; sixty of them are summed.
    CHECK(norm(motion.velocity() - expected) < 1e-11 * norm(expected));
  }
}

}  // namespace reduction_test
