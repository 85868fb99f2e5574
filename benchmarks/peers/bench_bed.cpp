// silt - BSD-3-Clause, see LICENSE
//
// The dense bed and the hopper timed in silt, LAMMPS and LIGGGHTS (peers.py).
//   bench_bed settle N STEPS FILE
//     lets a lattice of N spheres collapse in a box for STEPS, from 0 on; writes FILE
//   bench_bed flow FROM STEPS FILE
//     tilts gravity by 45 degrees towards +x for STEPS, so that the settled bed in FROM flows
//     against a side wall; writes FILE
//   bench_bed discharge N FILE STL
//     lets N spheres settle in the hopper, opens it, and stops when a fifth of them has left its
//     orifice; writes FILE, and the funnel to STL
//   bench_bed time FILE WARMUP STEPS THREADS double|mixed END level|tilted|hopper
//     runs the spheres in FILE in that scene; prints one line of results; writes where they end to
//     END
//   bench_bed measure FILE
//     contacts, mean overlap and mean height of the spheres in FILE, how many there are, and how
//     many have left the orifice of the hopper
// FILE is a data file of LAMMPS (atom style sphere). Law: Hertz, Tsuji damping, Mindlin spring with
// the slip as history and Coulomb friction; peers.py has LAMMPS' numbers for it.

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>

#include <silt/boundary/stl.hpp>

#include "../bed.hpp"
#include "bed_files.hpp"
#include "bed_scenes.hpp"

namespace {

using namespace bench;

void measure(const std::string& file) {
  const auto spheres = read(file);
  std::vector<silt::PositionRow> rows;
  double largest = 0, overlap = 0, height = 0;  // [m]
  const double orifice = hopper_for(spheres.size()).orifice_height();
  std::size_t out = 0;
  for (std::size_t k = 0; k < spheres.size(); ++k) {
    const auto& p = spheres[k].position;
    rows.push_back({p.x, p.y, p.z, spheres[k].radius});
    largest = std::max(largest, spheres[k].radius);
    height += p.z;
    out += p.z < orifice;
  }
  std::vector<silt::IndexPair> touching;
  silt::CellGrid{}.find({rows, largest}, 0.0, silt::OpenDomain{}, silt::Team(1), touching);
  for (const auto& [a, b] : touching)
    overlap += rows[a].r + rows[b].r - norm(rows[a].centre() - rows[b].centre());
  const auto n = static_cast<double>(rows.size()), pairs = static_cast<double>(touching.size());
  std::printf("spheres %zu coordination %.6g mean_overlap_over_d %.4g mean_height_m %.8g out %zu\n",
              rows.size(), 2 * pairs / n, touching.empty() ? 0.0 : overlap / pairs / 4.3e-3,
              height / n, out);
}

void discharge(std::size_t n, const std::string& file, const std::string& stl) {
  const hopper::Scene scene = hopper_for(n);
  auto spheres = lattice(n);
  for (std::size_t k = 0; k < n; ++k) spheres[k].position.z += scene.funnel_top();
  auto sim = bed(std::move(spheres), silt::default_threads(), silt::Double{});
  set_scene(sim, "hopper", n);
  sim.add_wall(silt::Plane{{0, 0, scene.orifice_height()}, {0, 0, 1}}, material);
  sim.run(30000 * time_step);
  sim.remove_wall(hopper::lid);
  std::size_t out = 0;
  for (const double closed = sim.time(); 5 * out < n;) {
    sim.run(100 * time_step);
    out = 0;
    for (std::size_t k = 0; k < n; ++k) out += sim.position(k).z < scene.orifice_height();
    silt::require(sim.time() < closed + 10, "bench_bed discharge ", n, ": ", out,
                  " spheres have left the hopper in 10 s; a fifth must");
  }
  write(states_of(sim), file);
  silt::write_stl(stl, hopper::floor_triangles(scene), silt::StlFormat::Ascii);
}

struct Timed {
  std::string file;
  double warmup, steps;
  int threads;
  std::string end, scene;
};

template <class Precision>
void time(const Timed& of, Precision precision) {
  auto spheres = read(of.file);
  const std::size_t n = spheres.size();
  auto sim = bed(std::move(spheres), of.threads, precision);
  set_scene(sim, of.scene, n);
  sim.run(of.warmup * time_step);
  const auto start = std::chrono::steady_clock::now();
  sim.run(of.steps * time_step);
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  std::printf("seconds %.6g kinetic_energy %.6g contacts %zu overlap %.4g megabytes %.4g\n",
              seconds, kinetic_energy(sim), sim.touching_pairs(), sim.largest_overlap(),
              static_cast<double>(sim.engine().bytes()) / 1e6);
  write(states_of(sim), of.end);
}

int main_with(int argc, char** argv) {
  const std::string mode = argc > 1 ? argv[1] : "";
  if (mode == "settle" && argc == 5) {
    auto sim = bed(lattice(std::stoul(argv[2])), silt::default_threads(), silt::Double{});
    sim.run(std::stod(argv[3]) * time_step);
    write(states_of(sim), argv[4]);
    return 0;
  }
  if (mode == "flow" && argc == 5) {
    auto sim = bed(read(argv[2]), silt::default_threads(), silt::Double{});
    set_scene(sim, "tilted", sim.size());
    sim.run(std::stod(argv[3]) * time_step);
    write(states_of(sim), argv[4], 0.1);
    return 0;
  }
  if (mode == "discharge" && argc == 5) {
    discharge(std::stoul(argv[2]), argv[3], argv[4]);
    return 0;
  }
  if (mode == "time" && argc == 9 && is_scene(argv[8])) {
    const Timed of{argv[2], std::stod(argv[3]), std::stod(argv[4]), std::stoi(argv[5]), argv[7],
                   argv[8]};
    if (argv[6] == std::string("mixed"))
      time(of, silt::Mixed{});
    else
      time(of, silt::Double{});
    return 0;
  }
  if (mode == "measure" && argc == 3) {
    measure(argv[2]);
    return 0;
  }
  std::fprintf(stderr,
               "bench_bed settle N STEPS FILE | flow FROM STEPS FILE | discharge N FILE STL | "
               "measure FILE | "
               "time FILE WARMUP STEPS THREADS double|mixed END level|tilted|hopper\n");
  return 2;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return main_with(argc, argv);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 2;
  }
}
