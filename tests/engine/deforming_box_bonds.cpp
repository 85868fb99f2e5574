// silt - BSD-3-Clause, see LICENSE
// Bonded spheres in a box that deforms: stress of a lattice by hand, books, equal places, bits,
// tension.
//   images that miss the flow of the box in the dashpots; a stress without bonds, or with their
//   forces at wrong places; a servo without a damper where nothing is pressed together
#include <engine/deforming_box.hpp>

#include <filesystem>
#include <numbers>

#include <silt/bond/build.hpp>
#include <silt/bond/parallel_bond.hpp>
#include <silt/io/checkpoint.hpp>

namespace deforming_box_test {
namespace {

constexpr double d = 1e-3;  // [m]
using Glue = silt::Bonds<silt::ParallelBond>;
auto bonded(const silt::Particles<Sphere>& of, const DeformingBox& box,
            const silt::ParallelBond& glue, double gap) {
  silt::Simulation sim{of, silt::Contacts<HertzMindlin>{rubber}, box, Glue{glue},
                       silt::EnergyLedger{}};
  sim.threads = 1, sim.time_step = 1e-6;
  silt::bond_near(sim, gap);
  return sim;
}
using Sim = decltype(bonded(cloud(1, 1), cube(1), {.youngs_modulus = 1}, 0));

/// Spheres that just do not touch, n in each row.
silt::Particles<Sphere> lattice(int n) {
  silt::Particles<Sphere> all;
  for (int k = 0; k < n * n * n; ++k)
    all.add({.position = d * Vec3d{k % n + 0.5, k / n % n + 0.5, k / (n * n) + 0.5},
             .radius = 0.49 * d,
             .density = 2500});
  return all;
}
constexpr silt::ParallelBond rod{.youngs_modulus = 1e6, .stiffness_ratio = 2, .damping = 0.5};

TEST_CASE(
    "deforming_box: a lattice of bonds has the moduli E A/a^2 in tension and half of k_s/a in "
    "simple shear, its energy is the work of the box") {
  // Six bonds of length a = d at each sphere, A = pi (0.49 d)^2, k_n = E A/a, k_s = k_n/2; the
  // dashpots 2 (0.5) sqrt(k m/2) add a stress of 0.3 %.
  const double kn = 1e6 * std::numbers::pi * 0.49 * 0.49 * d;
  const double m = 2500 * std::numbers::pi / 6 * std::pow(0.98 * d, 3), cn = std::sqrt(kn * m / 2);
  Sim pulled = bonded(lattice(4), cube(4 * d, {.x = {.rate = 0.1}}), rod, 0.03 * d);
  CHECK(pulled.bonds() == 3 * 64);
  pulled.run(10e-3);  // a strain of 0.001, 25 periods of a bond
  const double strain = pulled.domain().length(0) / (4 * d) - 1;
  CHECK(pulled.domain().stress().x == doctest::Approx(-(kn * strain + cn * 0.1) / d).epsilon(1e-4));
  CHECK(std::abs(pulled.domain().stress().y) < 1e-6 * kn / d * strain);
  CHECK(pulled.domain().work() ==
        doctest::Approx(0.5 * 64 * kn * d * d * strain * strain).epsilon(3e-3));
  // All spheres rotate by half of the shear: bonds along x and along y have the shear force
  // k_s a gamma/2 each. Without this rotation the stress would be twice as large.
  Sim sheared_one = bonded(lattice(4), cube(4 * d, {.xy = {.rate = 0.1}}), rod, 0.03 * d);
  sheared_one.run(10e-3);
  const double gamma = sheared_one.domain().strain().xy;
  CHECK(sheared_one.domain().stress().xy ==
        doctest::Approx(0.5 * (0.5 * kn * gamma + std::sqrt(0.5) * cn * 0.1) / d).epsilon(1e-4));
  for (const Sim* sim : {&pulled, &sheared_one}) {
    const auto e = sim->energy();
    CHECK(std::abs(e.residual()) < 1e-5 * e.box);
  }
}

/// A crowd that a glue holds, across all faces.
Sim crowd(const Deformation& how, const Vec3d& shift = {0, 0, 0}, int threads = 1, int n = 5) {
  Sim sim = bonded(cloud(n, 1.04 * d, 0.02, shift), cube(n * 1.04 * d), rod, 0.1 * d);
  sim.threads = threads;
  sim.deform(how);
  return sim;
}
const Deformation squeezed{.x = {.rate = -5}, .z = {.rate = 1}, .xy = {.rate = 15}};

TEST_CASE(
    "deforming_box: a bonded crowd moved as a whole does the same to 1e-7, its stress is that of "
    "its contacts and bonds, the ledger closes") {
  std::vector<ParticleBits> first;
  for (const Vec3d& shift : {Vec3d{0, 0, 0}, Vec3d{1.3e-3, 2.9e-3, -2.2e-3}}) {
    Sim sim = crowd(squeezed, shift);
    CHECK(sim.bonds() > 200);
    sim.run(10e-3);
    std::vector<ParticleBits> all;
    for (silt::ParticleId id = 0; id < 125; ++id) {
      const std::size_t k = sim.find(id);
      const Vec3d v = sim.velocity(k) - sim.domain().flow_at(sim.position(k)),
                  w = sim.angular_velocity(k);
      all.push_back({id, {v.x, v.y, v.z, w.x, w.y, w.z}});
    }
    if (first.empty()) first = all;
    double most = 0;
    for (std::size_t k = 0; k < all.size(); ++k)
      for (std::size_t c = 0; c < 6; ++c)
        most =
            std::max(most, std::abs(all[k].values[c] - first[k].values[c]) / (c < 3 ? 0.05 : 50));
    CHECK(most < 1e-7);  // dashpots without the flow of images: of order 1
    const auto e = sim.energy();
    CHECK(std::abs(e.residual()) < 1e-3 * e.box);
    CHECK(e.bond_damping > 0.005 * e.box);
  }
  // Without dashpots what can be read of contacts and bonds is all their force.
  auto loose = rod;
  loose.damping = 0;
  silt::HertzMindlin::Material elastic = rubber;
  elastic.restitution = 1;
  silt::Simulation sim{cloud(5, 1.04 * d, 0), silt::Contacts<HertzMindlin>{elastic},
                       cube(5.2 * d, squeezed), Glue{loose}};
  sim.threads = 1, sim.time_step = 1e-6;
  silt::bond_near(sim, 0.1 * d);
  sim.run(10e-3);
  double sum = 0, sum_xy = 0, of_bonds = 0;
  sim.for_each_bond([&](const silt::BondSeen& b) {
    sum += b.force.x * (b.to - b.from).x, sum_xy += b.force.x * (b.to - b.from).y;
    of_bonds += std::abs(b.force.x * (b.to - b.from).x);
  });
  sim.for_each_contact([&](const auto& c) {
    sum += c.force.x * c.branch.x, sum_xy += c.force.x * c.branch.y;
  });
  const auto& stress = sim.domain().stress();
  const double V = sim.domain().volume();
  CHECK(of_bonds / V > 0.2 * stress.x);
  // The motion adds m c c/V, and the box has moved for one step since.
  CHECK(stress.x == doctest::Approx(sum / V).epsilon(0.01));
  CHECK(stress.xy == doctest::Approx(-sum_xy / V).epsilon(0.02));
}

TEST_CASE("deforming_box: bonds in it give the same bits on more threads and after a restart") {
  const Deformation how{.x = {.stress = 400, .most_rate = 10}, .xy = {.rate = 20}};
  Sim one = crowd(how, {0, 0, 0}, 1, 8);
  const auto file = (std::filesystem::temp_directory_path() / "silt_box_bonds.silt").string();
  one.run(2e-3);
  silt::save_checkpoint(one, file);
  one.run(2e-3);
  Sim two = crowd(how, {0, 0, 0}, 2, 8);
  two.run(2e-3), two.run(2e-3);
  Sim again = crowd(how, {0, 0, 0}, 1, 8);
  silt::load_checkpoint(again, file);
  again.run(2e-3);
  for (const Sim* other : {&two, &again}) {
    CHECK(bits(*other) == bits(one));
    CHECK(other->domain().state() == one.domain().state());
  }
  std::filesystem::remove(file);
}

TEST_CASE(
    "deforming_box: a servo pulls a bonded crowd at a tension within 1 %, compresses it at a "
    "pressure, and a lattice breaks at its bonds' strength") {
  // No contact is pressed: without the stiffness of the bonds the servo would have no damper, and
  // swing by its whole target.
  for (const double p : {-500.0, 500.0}) {
    const silt::BoxDrive kept{.stress = p, .most_rate = 5};
    Sim sim = bonded(lattice(5), cube(5 * d, {.x = kept, .y = kept, .z = kept}), rod, 0.03 * d);
    double most = 0;
    sim.run(20e-3, [&](const auto& now) { most = std::max(most, now.domain().stress().x / p); });
    CHECK(sim.domain().stress().x == doctest::Approx(p).epsilon(0.01));
    CHECK(sim.domain().stress().z == doctest::Approx(p).epsilon(0.01));
    CHECK(most < 1.5);
    const auto e = sim.energy();
    CHECK(std::abs(e.residual()) < 1e-3 * e.elastic());
  }
  auto weak = rod;
  weak.tensile_strength = 1000;  // [Pa], of the bond's area: pi 0.49^2 of a lattice's face
  const double strength = 1000 * std::numbers::pi * 0.49 * 0.49;
  Sim torn = bonded(lattice(4), cube(4 * d, {.x = {.rate = 0.2}}), weak, 0.03 * d);
  double most = 0;
  torn.run(20e-3, [&](const auto& now) { most = std::max(most, -now.domain().stress().x); });
  CHECK(torn.bonds() == 2 * 64);  // those along x are gone
  CHECK(most == doctest::Approx(strength).epsilon(0.01));
}

}  // namespace
}  // namespace deforming_box_test
