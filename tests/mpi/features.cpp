// silt - BSD-3-Clause, see LICENSE
// What ranks.sh runs on several ranks: by MPI what tests/parallel checks with threads. Bonds and
// contact events, edits with heat and the books of energy, breakage, charges; each beside the same
// scene without Ranks, which every rank computes too. Planes between ranks move at each search.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include <silt/bond/build.hpp>
#include <silt/bond/parallel_bond.hpp>
#include <silt/io/bond_observers.hpp>
#include <silt/io/contact_observers.hpp>
#include <silt/module/charge/charge.hpp>
#include <silt/module/heat/surroundings.hpp>
#include <silt/mpi.hpp>

#include "../breakage/scene.hpp"
#include "../parallel/comm_checks.hpp"
#include "../parallel/rank_scenes.hpp"

namespace {

using silt::Vec3d;
using silt_test::expect;
using silt_test::glass;
using Law = silt::HertzMindlin;
using Ranks = silt::Ranks<silt::MpiComm, silt_test::WanderingSlabs>;

Ranks ranks(const silt::MpiComm& comm, double width) {
  return Ranks{comm, {0, width}, {.above = 1, .each = 0, .per_moved = 0}};
}

struct One {
  silt::ParticleId id;
  Vec3d position;
  double value;  // a field
};
/// What a scene ends with, of all ranks: particles in the order of ids, and sums.
struct End {
  std::vector<One> particles;
  std::vector<double> counts;  // which are the same
  std::vector<double> sums;    // to rounding
};
template <class Sim, class Value>
End end_of(const Sim& sim, const Value& value) {
  std::vector<One> own;
  for (std::size_t k = 0; k < sim.rows(); ++k)
    if (sim.is_present(k)) own.push_back({sim.id(k), sim.position(k), value(k)});
  return {own, {}, {}};
}
void gather_end(const silt::MpiComm& comm, End& end) {
  end.particles = silt::gather(comm, std::span<const One>(end.particles)).values;
}
void sort(End& end) {
  std::sort(end.particles.begin(), end.particles.end(),
            [](const One& a, const One& b) { return a.id < b.id; });
}
/// `place` [m], `rounding` [-] of values and sums.
void compare(const std::string& what, End many, End one, double place, double rounding) {
  sort(many), sort(one);
  expect(many.particles.size() == one.particles.size(), what + ": other particles");
  double off = 0, value_off = 0;
  for (std::size_t k = 0; k < one.particles.size(); ++k) {
    const One &m = many.particles[k], &o = one.particles[k];
    expect(m.id == o.id, what + ": other ids");
    off = std::max(off, norm(m.position - o.position));
    value_off = std::max(value_off, std::abs(m.value - o.value) / (1 + std::abs(o.value)));
  }
  expect(off < place, silt::text(what, ": places differ by ", off, " m"));
  expect(value_off < rounding, silt::text(what, ": values differ by ", value_off));
  expect(many.counts.size() == one.counts.size() && many.sums.size() == one.sums.size(), what);
  for (std::size_t k = 0; k < one.counts.size(); ++k)
    expect(many.counts[k] == one.counts[k],
           silt::text(what, ": count ", k, " is ", many.counts[k], ", not ", one.counts[k]));
  for (std::size_t k = 0; k < one.sums.size(); ++k)
    expect(std::abs(many.sums[k] - one.sums[k]) <= rounding * std::abs(one.sums[k]),
           silt::text(what, ": sum ", k, " is ", many.sums[k], ", not ", one.sums[k]));
}

/// Rods of four bonded spheres that fall, hit the floor and each other, and break.
template <class... Policies>
End rods(Policies... policies) {
  const silt::ParallelBond brittle{.youngs_modulus = 2e7,
                                   .tensile_strength = 4e3,
                                   .shear_strength = 4e3,
                                   .damping = 0.05,
                                   .weibull_modulus = 6};
  const double R = 2e-3;  // [m]
  silt::BondedSpheres all;
  for (int rod = 0; rod < 24; ++rod)
    for (int k = 0; k < 4; ++k) {
      silt::Particles<silt::Sphere>::Particle p;
      p.position = {0.004 + 0.0041 * rod + 1e-4 * k, 0.004 + 2 * R * k,
                    0.0025 + 0.0021 * (rod % 3)};
      p.radius = R, p.density = 2500, p.velocity = {0.5, 0.1 * (rod % 2), -1.5};
      all.spheres.push_back(p);
      const std::size_t n = all.spheres.size();
      if (k > 0) all.bonds.push_back({n - 2, n - 1});
    }
  silt::Simulation sim{silt::Particles<silt::Sphere>{}, silt::Contacts<Law>{glass},
                       silt::Bonds{brittle}, silt::ContactEvents{}, std::move(policies)...};
  sim.gravity = {0, 0, -9.81};
  sim.threads = 1;
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, glass);
  sim.add_wall(silt::Plane{{0.11, 0, 0}, {-1, 0, 0}}, glass);
  silt::add_bonded(sim, all);
  double broken = 0, ended = 0, lost = 0;
  sim.run(
      0.012, silt::on_bond_break([&](const silt::BondBreak&) { broken += 1; }),
      silt::on_contact_end([&](const silt::ContactEvent& e) { ended += 1, lost += e.lost_energy; }),
      silt::at(silt::every(0.004), [](auto& s) {
        if (s.time() < 0.002) return;
        for (std::size_t k = 0; k < s.rows(); ++k)
          if (s.is_present(k) && s.id(k) % 17 == (s.time() < 0.006 ? 5 : 6)) s.remove(s.id(k));
      }));
  broken = sim.sum_over_ranks(broken), ended = sim.sum_over_ranks(ended),
  lost = sim.sum_over_ranks(lost);
  expect(broken > 3 && ended > 50,
         silt::text("rods: ", broken, " bonds broke, ", ended, " contacts ended"));
  const auto pieces = silt::fragments(sim);
  End end = end_of(sim, [](std::size_t) { return 0.0; });
  end.counts = {broken, ended, static_cast<double>(sim.bonds()),
                static_cast<double>(sim.broken_bonds()),
                static_cast<double>(pieces.spheres.size())};
  end.sums = {lost, sim.bond_energy()};
  return end;
}

/// Spheres in a trough that exchange heat; some are removed, thrown and grown on the way.
template <class... Policies>
End edited(Policies... policies) {
  const silt::HeatConduction heat{
      .conductivity = 200, .heat_capacity = 10, .walls = {silt::held_at(400)}};
  auto sim = silt_test::trough(silt_test::cloud(12, 4, 3), silt::EnergyLedger{}, heat,
                               std::move(policies)...);
  for (std::size_t k = 0; k < sim.rows(); ++k)
    sim.template field<silt::Temperature>(k) = 290 + 10 * static_cast<double>(sim.id(k) % 5);
  int call = 0;
  sim.run(0.02, silt::at(silt::every(0.004), [&](auto& s) {
            s.set_velocity(17, {0.3, 0.1 * ++call, 0.5});
            for (std::size_t k = 0; k < s.rows(); ++k)
              if (s.is_present(k) && s.id(k) % 7 == 3) s.set_radius(s.id(k), 1.01 * s.radius(k));
            std::vector<silt::ParticleId> gone;
            for (std::size_t k = 0; k < s.rows(); ++k)
              if (s.is_present(k) && call == 3 && s.position(k).x > 0.07) gone.push_back(s.id(k));
            for (const auto id : gone) s.remove(id);
          }));
  sim.share_edits();
  const auto books = sim.energy();
  End end = end_of(sim, [&](std::size_t k) { return sim.template field<silt::Temperature>(k); });
  end.counts = {static_cast<double>(sim.size()), static_cast<double>(sim.touching_pairs())};
  end.sums = {sim.total_mass(), sim.kinetic_energy(), books.turned_over};
  return end;
}

/// Grains that are thrown into a corner and break.
template <class... Policies>
End broken(Policies... policies) {
  silt::Particles<silt::Sphere> feed;
  silt::Random random(3);
  for (std::size_t k = 0; k < 144; ++k) {
    const auto at = [](std::size_t n) { return 0.003 + 0.0025 * static_cast<double>(n); };
    feed.add({.position = {at(k % 6), at(k / 6 % 6), at(k / 36) - 0.0018},
              .radius = random.uniform(0.8e-3, 1e-3),
              .density = 2165,
              .velocity = {-random.uniform(0, 4), random.uniform(-2, 2), -random.uniform(6, 10)},
              .angular_velocity = {random.uniform(-500, 500), 0, 300}});
  }
  silt::Simulation sim{std::move(feed), silt::Contacts<Law>{breakage_scene::salt},
                       breakage_scene::policy(), std::move(policies)...};
  sim.threads = 1;
  sim.time_step = 1.2e-7;
  for (const Vec3d normal : {Vec3d{0, 0, 1}, Vec3d{1, 0, 0}, Vec3d{0, 1, 0}})
    sim.add_wall(silt::Plane{{0, 0, 0}, normal}, breakage_scene::salt);
  double told = 0;
  sim.run(2e-4, silt::on_break([&](const silt::BreakEvent&) { told += 1; }));
  told = sim.sum_over_ranks(told);
  expect(told > 20, silt::text("broken: ", told, " grains broke"));
  const auto mass = sim.mass_balance();
  End end = end_of(sim, [](std::size_t) { return 0.0; });
  end.counts = {told, static_cast<double>(sim.broken()), static_cast<double>(sim.size())};
  end.sums = {mass.present, mass.dust, sim.dust().mass()};
  return end;
}

/// Charges of both signs, which each grain sees of some 40 others.
template <class... Policies>
End charged(Policies... policies) {
  auto sim = silt_test::trough(silt_test::cloud(12, 4, 3), silt::Charge{.cutoff = 0.022},
                               std::move(policies)...);
  for (std::size_t k = 0; k < sim.rows(); ++k)
    sim.template field<silt::ElectricCharge>(k) = (sim.id(k) % 3 == 0 ? -2 : 1) * 1e-8;
  sim.run(0.02);
  End end = end_of(sim, [&](std::size_t k) { return norm(sim.module_force(k)); });
  end.sums = {sim.step_length(), sim.kinetic_energy()};
  return end;
}

}  // namespace

int main(int argc, char** argv) {
  silt::Mpi mpi(argc, argv);
  const silt::MpiComm comm = mpi.comm();
  const auto check = [&](const std::string& what, End many, const End& one, double place,
                         double rounding) {
    gather_end(comm, many);
    silt::together(comm, what, [&] { compare(what, many, one, place, rounding); });
  };
  check("rods", rods(ranks(comm, 0.11)), rods(), 1e-10, 1e-6);
  check("edited", edited(ranks(comm, 0.11)), edited(), 1e-10, 1e-8);
  check("broken", broken(ranks(comm, 0.018)), broken(), 1e-8, 1e-8);
  check("charged", charged(ranks(comm, 0.11)), charged(), 1e-10, 1e-6);
  if (comm.rank() == 0) std::puts("fine");
}
