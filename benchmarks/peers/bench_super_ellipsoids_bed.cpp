// silt - BSD-3-Clause, see LICENSE
//
// Settled beds of 1 476 superellipsoids, as LIGGGHTS' superquadrics in shapes.py, or of as many
// spheres; see there.
//   bench_super_ellipsoids_bed settle FORM FILE
//     lets a lattice collapse in a box for 30 000 steps; writes where it comes to rest
//   bench_super_ellipsoids_bed time FORM FILE WARMUP STEPS END
//     goes on from FILE on one thread, WARMUP steps untimed; prints one line of results; writes END
//   bench_super_ellipsoids_bed measure FORM FILE
//     particles in FILE, their contacts by silt's geometry and their mean height
// FILE, END: a line a particle, position, orientation (w x y z), velocity, angular velocity.
// FORM: 2, 4, 8: super-ellipsoids of 2 x 2 x 4 mm with this exponent; ball: of 2.5 mm with equal
// axes and exponent 2; sphere: the same as silt::Sphere.

#include <chrono>
#include <cstdio>
#include <exception>
#include <fstream>
#include <string>
#include <vector>

#include <silt/boundary/wall.hpp>
#include <silt/contact/hertz_mindlin.hpp>
#include <silt/files/atomic_file.hpp>
#include <silt/shape/sphere.hpp>
#include <silt/shape/super_ellipsoid.hpp>
#include <silt/simulation.hpp>

namespace {

constexpr double time_step = 1e-5, density = 2500;  // [s], [kg/m3]

struct Row {
  silt::Vec3d place;
  silt::Quaternion orientation;
  silt::Vec3d velocity, spin;
};

/// Rows on the lattice of LIGGGHTS; balls and spheres with a lateral displacement, as their columns
/// would not collapse.
std::vector<Row> lattice(bool pushed) {
  silt::Random random(1);
  std::vector<Row> rows;
  for (int k = 0; k < 41; ++k)
    for (int j = 0; j < 6; ++j)
      for (int i = 0; i < 6; ++i) {
        const silt::Vec3d place = 0.0085 * silt::Vec3d{i + 1.0, j + 1.0, k + 1.0};
        const auto push = [&] { return pushed ? random.uniform(-0.3, 0.3) : 0.0; };
        const silt::Vec3d velocity{push(), push(), 0};
        rows.push_back({place, silt::random_orientation(random), velocity, {0, 0, 0}});
      }
  return rows;
}

std::vector<Row> read(const std::string& path) {
  std::ifstream in(path);
  silt::require(in.good(), "cannot read ", path);
  std::vector<Row> rows;
  Row r;
  auto &p = r.place, &v = r.velocity, &w = r.spin;
  auto& q = r.orientation;
  while (in >> p.x >> p.y >> p.z >> q.w >> q.x >> q.y >> q.z >> v.x >> v.y >> v.z >> w.x >> w.y >>
         w.z)
    rows.push_back(r);
  silt::require(!rows.empty(), "no particles in ", path);
  return rows;
}

template <class Particles, class Add>
auto bed(Particles particles, const std::vector<Row>& rows, const Add& add) {
  for (const Row& row : rows) add(particles, row);
  const silt::HertzMindlin::Material m{
      .youngs_modulus = 1e7, .poisson_ratio = 0.3, .restitution = 0.5, .friction = 0.4};
  silt::Simulation sim{std::move(particles), silt::Contacts<silt::HertzMindlin>{m}};
  sim.gravity = {0, 0, -9.81};
  sim.time_step = time_step;
  sim.threads = 1;
  sim.guard.max_overlap = 1, sim.guard.max_time_step = 1;
  sim.add_wall(silt::box({0, 0, 0}, {0.06, 0.06, 0.5}), m);
  return sim;
}

auto super_ellipsoids(const std::string& name, const std::vector<Row>& rows) {
  silt::Particles<silt::SuperEllipsoid> particles;
  if (name == "ball") {
    particles.add_form({.a = 2.5e-3, .b = 2.5e-3, .c = 2.5e-3});
  } else {
    const double s = std::stod(name);
    particles.add_form({.a = 2e-3, .b = 2e-3, .c = 4e-3, .s1 = s, .s2 = s});
  }
  return bed(std::move(particles), rows, [](auto& all, const Row& row) {
    all.add({.position = row.place,
             .orientation = row.orientation,
             .density = density,
             .velocity = row.velocity,
             .angular_velocity = row.spin});
  });
}
auto spheres(const std::vector<Row>& rows) {
  return bed(silt::Particles<silt::Sphere>{}, rows, [](auto& all, const Row& row) {
    all.add({.position = row.place,
             .radius = 2.5e-3,
             .density = density,
             .velocity = row.velocity,
             .angular_velocity = row.spin});
  });
}

template <class Sim>
void write(const Sim& sim, const std::string& path) {
  std::string out;
  for (std::size_t id = 0; id < sim.size(); ++id) {
    const std::size_t k = sim.find(static_cast<std::uint32_t>(id));
    const auto p = sim.position(k), v = sim.velocity(k), w = sim.angular_velocity(k);
    silt::Quaternion q{1, 0, 0, 0};
    if constexpr (requires { sim.orientation(k); }) q = sim.orientation(k);
    out += silt::text(p.x, ' ', p.y, ' ', p.z, ' ', q.w, ' ', q.x, ' ', q.y, ' ', q.z, ' ', v.x,
                      ' ', v.y, ' ', v.z, ' ', w.x, ' ', w.y, ' ', w.z, '\n');
  }
  silt::AtomicFile file(path);
  file.write(out);
  file.commit();
}

/// The task for a bed, see above.
struct Task {
  std::string mode, form, file, end;
  double warmup = 0, steps = 0;
};

template <class Sim>
int run(Sim sim, const Task& task) {
  if (task.mode == "settle") {
    sim.run(30000 * time_step);
    write(sim, task.file);
    return 0;
  }
  if (task.mode == "measure") {
    sim.run(0);
    double height = 0;
    for (std::size_t k = 0; k < sim.rows(); ++k)
      height += sim.position(k).z / static_cast<double>(sim.rows());
    std::printf("particles %zu contacts %.6g height %.8g\n", sim.size(),
                2.0 * static_cast<double>(sim.touching_pairs()) / static_cast<double>(sim.size()),
                height);
    return 0;
  }
  sim.run(task.warmup * time_step);
  const auto start = std::chrono::steady_clock::now();
  sim.run(task.steps * time_step);
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  std::printf("seconds %.6g\n", seconds);
  write(sim, task.end);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    Task task;
    if (argc > 3) task.mode = argv[1], task.form = argv[2], task.file = argv[3];
    if (task.mode == "time" && argc == 7)
      task.warmup = std::stod(argv[4]), task.steps = std::stod(argv[5]), task.end = argv[6];
    if ((argc == 4 && (task.mode == "settle" || task.mode == "measure")) || !task.end.empty()) {
      const bool is_sphere = task.form == "sphere";
      const auto rows =
          task.mode == "settle" ? lattice(is_sphere || task.form == "ball") : read(task.file);
      return is_sphere ? run(spheres(rows), task) : run(super_ellipsoids(task.form, rows), task);
    }
    std::fprintf(stderr,
                 "bench_super_ellipsoids_bed settle FORM FILE | time FORM FILE WARMUP STEPS END | "
                 "measure FORM FILE; FORM: 2, 4, 8, ball, sphere\n");
    return 2;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 2;
  }
}
