// silt - BSD-3-Clause, see LICENSE
// What builders of bonded spheres make: how many bonds between whom, where, and what is refused.
//   pairs across a face of a periodic box are missed; a gap that counts from the centres
#include <cmath>
#include <numbers>
#include <set>
#include <utility>
#include <vector>

#include <doctest/doctest.h>

#include <silt/bond/build.hpp>
#include <silt/bond/parallel_bond.hpp>
#include <silt/boundary/finite_walls.hpp>
#include <silt/contact/hertz_mindlin.hpp>
#include <silt/simulation.hpp>

#include "near.hpp"
#include "refusal.hpp"

namespace bond_build_test {

using silt::Vec3d;
constexpr double R = 1e-3;
const silt::HertzMindlin::Material glass{
    .youngs_modulus = 1e7, .poisson_ratio = 0.25, .restitution = 0.5, .friction = 0.5};
const silt::Bonds glue{silt::ParallelBond{.youngs_modulus = 1e7}};
const silt::BondedGrain grain{.radius = R, .density = 2000};

TEST_CASE("bonds: fibres and sheets have the spheres and bonds that they say") {
  const auto f = silt::fibre({0, 0, 0}, {8 * R, 0, 0}, 5, grain);
  CHECK(f.spheres.size() == 5);
  CHECK(f.bonds.size() == 4);
  CHECK(f.spheres[4].position.x == near(8 * R));
  const auto s = silt::sheet({0, 0, 0}, {8 * R, 0, 0}, {0, 4 * R, 0}, 5, 3, grain);
  CHECK(s.spheres.size() == 15);
  CHECK(s.bonds.size() == 4 * 3 + 5 * 2);
  const auto braced = silt::sheet({0, 0, 0}, {8 * R, 0, 0}, {0, 4 * R, 0}, 5, 3, grain, true);
  CHECK(braced.bonds.size() == 4 * 3 + 5 * 2 + 2 * 4 * 2);
  for (const auto& [a, b] : s.bonds)
    CHECK(norm(s.spheres[a].position - s.spheres[b].position) == near(2 * R).epsilon(1e-12));
}

TEST_CASE("bonds: an agglomerate fills its region, and all within the gap are bonded") {
  const auto check = [](const silt::BondedSpheres& all, double gap) {
    std::set<std::pair<std::size_t, std::size_t>> made(all.bonds.begin(), all.bonds.end());
    CHECK(made.size() == all.bonds.size());
    for (std::size_t a = 0; a < all.spheres.size(); ++a)
      for (std::size_t b = a + 1; b < all.spheres.size(); ++b) {
        const auto &p = all.spheres[a], &q = all.spheres[b];
        const bool near_enough = norm(p.position - q.position) - p.radius - q.radius < gap;
        CHECK(near_enough == made.contains({a, b}));
      }
  };
  const silt::FillRequest request{.radius = silt::uniform(0.8 * R, R)};
  const auto box = agglomerate(silt::Box{{0, 0, 0}, {0.01, 0.01, 0.01}}, request, 0.5 * R, grain);
  CHECK(box.spheres.size() > 30);
  CHECK(box.bonds.size() > 2 * box.spheres.size());
  check(box, 0.5 * R);
  const auto ball = silt::sphere_mesh({0, 0, 0}, 0.008, 6);
  const auto round = agglomerate(silt::MeshRegion(ball), request, 0.4 * R, grain);
  check(round, 0.4 * R);
  for (const auto& p : round.spheres) CHECK(norm(p.position) + p.radius < 0.008);
  // Elsewhere, turned: the same distances.
  const auto moved = placed(round, {1, 2, 3}, silt::rotation_about({0, 0, 1}, 0.5), {0, 0, -1});
  CHECK(moved.bonds == round.bonds);
  check(moved, 0.4 * R);
  CHECK(moved.spheres[0].velocity.z == -1);
  CHECK(silt_test::has(silt_test::refusal([&] {
                         agglomerate(silt::Box{{0, 0, 0}, {R, R, R}}, request, 0, grain);
                       }),
                       "agglomerate: 0 of 1 spheres fitted into the box"));
}

TEST_CASE("bonds: a packed lattice is one piece with a gap of 0.3 radii; with 0.1 it is loose") {
  const auto pieces = [](const auto& region, double gap) {
    return pieces_of(agglomerate(region, {.radius = R}, gap * R, grain));
  };
  for (const double side : {8.0, 10.0, 12.0}) {
    const silt::Box box{{0, 0, 0}, {side * R, side * R, side * R}};
    CHECK(pieces(box, 0.3) == 1);
    CHECK(pieces(box, 0.1) > 40);
  }
  const auto ball = silt::sphere_mesh({0, 0, 0}, 6 * R, 6);
  CHECK(pieces(silt::MeshRegion(ball), 0.3) == 1);
  CHECK(pieces(silt::MeshRegion(ball), 0.2) == 1);  // docs/code/bonds.cpp
}

#ifdef SILT_LONG_TESTS
TEST_CASE("bonds: bond_near bonds each pair once, across periodic faces too, and who is chosen") {
  silt::Simulation sim{silt::Particles<silt::Sphere>{}, silt::Contacts<silt::HertzMindlin>{glass},
                       silt::PeriodicBox{{{0, 0, 0}, {10 * R, 10 * R, 10 * R}}, {true, true, true}},
                       glue};
  silt::Particles<silt::Sphere> all;
  for (int x = 0; x < 5; ++x)
    for (int y = 0; y < 5; ++y)
      for (int z = 0; z < 5; ++z)
        all.add({.position = {(2 * x + 0.5) * R, (2 * y + 0.5) * R, (2 * z + 0.5) * R},
                 .radius = R,
                 .density = 2000});
  sim.add(all);
  const auto odd = [](silt::ParticleId a, silt::ParticleId b) { return a % 2 == 1 && b % 2 == 1; };
  const std::size_t some = bond_near(sim, 0.01 * R, odd);
  sim.for_each_bond([&](const silt::BondSeen& b) {
    CHECK(odd(b.a, b.b));
    CHECK(norm(b.to - b.from) == near(2 * R).epsilon(1e-9));  // through the face
  });
  CHECK(bond_near(sim, 0.01 * R) == 3 * 125 - some);
  CHECK(bond_near(sim, 0.01 * R) == 0);
  CHECK(sim.bonds() == 3 * 125);
  // Held by bonds all around, it stays at rest: no bond pulls through the box.
  sim.time_step = 1e-6;
  sim.run(1e-4);
  CHECK(sim.bond_energy() < 1e-25);
  CHECK(silt::fragments(sim).spheres == std::vector<std::size_t>{125});
}
#endif

TEST_CASE("bonds: a sheet with a fixed rim; two fixed ones are not bonded, and nobody complains") {
  auto net = silt::sheet({0, 0, 0}, {8 * R, 0, 0}, {0, 8 * R, 0}, 5, 5, grain);
  for (auto& p : net.spheres)
    p.fixed = p.position.x < R || p.position.y < R || p.position.x > 7 * R || p.position.y > 7 * R;
  silt::Simulation sim{silt::Particles<silt::Sphere>{}, silt::Contacts<silt::HertzMindlin>{glass},
                       glue};
  add_bonded(sim, net);
  CHECK(sim.bonds() == 40 - 16);
  // The same by bond_near.
  silt::Simulation near_ones{silt::Particles<silt::Sphere>{},
                             silt::Contacts<silt::HertzMindlin>{glass}, glue};
  net.bonds.clear();
  add_bonded(near_ones, net);
  CHECK(bond_near(near_ones, 0.01 * R) == 40 - 16);
}

TEST_CASE("bonds: pieces before anything breaks, and the largest of them") {
  auto all = silt::fibre({0, 0, 0}, {4 * R, 0, 0}, 3, grain);
  for (int k = 0; k < 4; ++k) all.spheres.push_back(grain.at({2 * k * R, 0, 9 * R}));
  all.bonds.push_back({5, 6}), all.bonds.push_back({4, 3}), all.bonds.push_back({5, 3});
  all.spheres.push_back(grain.at({0, 9 * R, 0}));  // alone
  CHECK(silt::pieces_of(all) == 3);
  const auto piece = silt::largest_piece(all);
  CHECK(piece.spheres.size() == 4);
  CHECK(piece.bonds == std::vector<std::pair<std::size_t, std::size_t>>{{2, 3}, {1, 0}, {2, 0}});
  for (const auto& p : piece.spheres) CHECK(p.position.z == 9 * R);
  CHECK(silt::pieces_of(piece) == 1);
}

TEST_CASE("bonds: lists of bonded spheres that cannot be are refused, with nothing added") {
  silt::Simulation sim{silt::Particles<silt::Sphere>{}, silt::Contacts<silt::HertzMindlin>{glass},
                       glue};
  auto all = silt::fibre({0, 0, 0}, {4 * R, 0, 0}, 3, grain);
  all.bonds.push_back({2, 7});
  const char* const words =
      "bond 2 is between the spheres 2 and 7 (counted from 0), but there are 3";
  CHECK(silt_test::has(silt_test::refusal([&] { add_bonded(sim, all); }), words));
  CHECK(silt_test::has(silt_test::refusal([&] { silt::pieces_of(all); }), words));
  CHECK(silt_test::has(silt_test::refusal([&] { silt::largest_piece(all); }), words));
  all.bonds.back() = {1, 1};
  CHECK(silt_test::has(silt_test::refusal([&] { add_bonded(sim, all); }), "the spheres 1 and 1"));
  // The same pair twice, in whatever order: the simulation would see it after it has the spheres.
  all.bonds.back() = {1, 0};
  CHECK(silt_test::has(silt_test::refusal([&] { add_bonded(sim, all); }),
                       "spheres 0 and 1 (counted from 0) are bonded twice"));
  all.bonds.back() = {0, 2}, all.spheres[2].position = all.spheres[0].position;
  CHECK(silt_test::has(silt_test::refusal([&] { add_bonded(sim, all); }),
                       "spheres 0 and 2 (counted from 0) are at one place"));
  CHECK(sim.size() == 0);
  CHECK(sim.bonds() == 0);
  CHECK(silt_test::has(
      silt_test::refusal([&] {
        placed(silt::fibre({0, 0, 0}, {4 * R, 0, 0}, 3, grain), {0, 0, 0}, {1, 1, 0, 0});
      }),
      "is not a unit quaternion"));
}

/// A model of one's own: a spring that breaks at `strength` [N].
struct Thread {
  double stiffness, strength;  // [N/m], [N]
  template <class Real>
  struct Numbers {
    Real is_there;
  };
  Numbers<double> numbers(const silt::BondedPair&) const { return {1}; }
  template <class Real>
  silt::BondAnswer<Real> answer(const silt::BondStrain<Real>& s, const Numbers<Real>& p) const {
    const silt::Vec3<Real> none{Real(0), Real(0), Real(0)};
    return {s.shift * (p.is_there * Real(-stiffness)), none, none, none};
  }
  template <class Real>
  Real load(const silt::BondAnswer<Real>& a, const silt::Vec3<Real>&, const Numbers<Real>&) const {
    return sqrt(dot(a.force, a.force)) / Real(strength);
  }
  double energy(const silt::BondStrain<double>& s, const Numbers<double>&) const {
    return 0.5 * stiffness * dot(s.shift, s.shift);
  }
  silt::BondStiffness stiffest(const Numbers<double>&) const { return {stiffness, 0}; }
};
// Catches a bond that never breaks, as its load is 0/0, and one that limits no time step.
TEST_CASE("bonds: a model whose load or stiffness is not a number is refused as it bonds") {
  const auto refused = [](double stiffness, double strength, const char* words) {
    silt::Particles<silt::Sphere> p;
    p.add({.position = {0, 0, 0}, .radius = R, .density = 2000});
    p.add({.position = {2 * R, 0, 0}, .radius = R, .density = 2000});
    silt::Simulation sim{std::move(p), silt::Contacts<silt::HertzMindlin>{glass},
                         silt::Bonds{Thread{stiffness, strength}}};
    sim.add_wall(silt::Plane{{-R, 0, 0}, {1, 0, 0}}, glass, {.name = "hook"});
    CHECK(silt_test::has(silt_test::refusal([&] { sim.bond(0, 1); }), words));
    CHECK(silt_test::has(
        silt_test::refusal([&] {
          sim.bond_to_wall(0, "hook", {-R, 0, 0});
        }),
        words[0] == 'l' ? "load() of the unstrained bond of particle 0 to wall 0 'hook'" : words));
    CHECK(sim.bonds() == 0);
  };
  refused(100, 0, "load() of the unstrained bond of particles 0 and 1 is");
  refused(NAN, 1, "mend the model's numbers(), answer() or load()");
  refused(-1, 1, "they must be finite, at least 0, and not all 0");
  refused(0, 1, "they must be finite, at least 0, and not all 0");
}

TEST_CASE("bonds: makers and bond_near refuse what cannot be, with the number") {
  const auto refused = [](const auto& act, const char* words) {
    const auto said = silt_test::refusal(act);
    CAPTURE(said);
    CHECK(silt_test::has(said, words));
  };
  refused([] { silt::fibre({0, 0, 0}, {0, 0, 0}, 3, grain); }, "there is no distance");
  refused([] { silt::fibre({0, 0, 0}, {NAN, 0, 0}, 3, grain); }, "there is no distance");
  refused([] { silt::sheet({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 1, 3, grain); }, "1 x 3 spheres");
  const silt::Box box{{0, 0, 0}, {9 * R, 9 * R, 9 * R}};
  refused([&] { silt::agglomerate(box, {.radius = R}, NAN, grain); }, "gap = nan [m]");
  refused([&] { silt::agglomerate(box, {.radius = R}, -1e-4, grain); },
          "gap = -1e-04 [m] must be finite and not negative");
  refused([&] { silt::agglomerate(box, {.radius = R}, 0, grain); }, "spheres is within gap = 0 m");
  silt::Simulation sim{silt::Particles<silt::Sphere>{}, silt::Contacts<silt::HertzMindlin>{glass},
                       glue};
  silt::Particles<silt::Sphere> two;
  two.add(grain.at({0, 0, 0})), two.add(grain.at({0, 0, 0}));
  sim.add(two);
  refused([&] { bond_near(sim, INFINITY); }, "gap = inf [m]");
  refused([&] { sim.bond(0, 1); }, "particles 0 and 1 are at one place");
  CHECK(sim.bonds() == 0);
  refused(
      [] {
        silt::Simulation{silt::Particles<silt::Sphere>{}, silt::Contacts<silt::HertzMindlin>{glass},
                         silt::Bonds{silt::ParallelBond{.youngs_modulus = -1}}};
      },
      "ParallelBond.youngs_modulus = -1 [Pa]");
}

TEST_CASE("bonds: fibres whose next but one overlap, and negative gaps, are refused") {
  using silt_test::has;
  // They would be contacts that push from the start.
  const auto said = silt_test::refusal([] { silt::fibre({0, 0, 0}, {4.9 * R, 0, 0}, 6, grain); });
  has(said, "fibre: 6 spheres of radius 0.001 m");
  has(said, " m are 0.00098");
  has(said, "give fewer, or a smaller radius");
  CHECK(silt::fibre({0, 0, 0}, {5 * R, 0, 0}, 6, grain).spheres.size() == 6);
  CHECK(silt::fibre({0, 0, 0}, {0.5 * R, 0, 0}, 2, grain).bonds.size() == 1);
  silt::Simulation sim{silt::Particles<silt::Sphere>{}, silt::Contacts<silt::HertzMindlin>{glass},
                       glue};
  has(silt_test::refusal([&] { silt::bond_near(sim, -1e-6); }), "bond_near: gap = -1e-06 [m] must");
  CHECK(silt::bond_near(sim, 0) == 0);
}

}  // namespace bond_build_test
