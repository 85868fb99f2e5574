// silt - BSD-3-Clause, see LICENSE
//
// The dense bed of eight-sphere bodies timed in silt, LIGGGHTS and Yade (shapes.py).
//   bench_bodies settle N STEPS FILE
//     lets a lattice of N bodies collapse in a box for STEPS; writes where they come to rest
//   bench_bodies time FILE WARMUP STEPS double|mixed shared|whole END
//     runs the bed in FILE on one thread; prints one line of results; writes its balls to END
//   bench_bodies measure BALLS
//     contacts of the bodies whose balls stand in BALLS, 'x y z r' a line, body by body
// FILE: a line a body, position, orientation (w x y z), velocity, angular velocity. The law is that
// of bench_bed. whole: every contact of two balls has all of its stiffness, as in LIGGGHTS and
// Yade; shared: engine/contact/shared_contacts.hpp.

#include <chrono>
#include <cstdio>
#include <fstream>
#include <set>
#include <string>
#include <utility>

#include <silt/shape/multi_sphere.hpp>

#include "../bed.hpp"

namespace {

using namespace bench;

constexpr double half_edge = 1e-3, ball_radius = 1.2e-3, density = 2500;  // [m] [m] [kg/m3]
constexpr std::size_t balls_per_body = 8;

silt::MultiSphere cube() {
  silt::MultiSphere form;
  for (const double x : {-half_edge, half_edge})
    for (const double y : {-half_edge, half_edge})
      for (const double z : {-half_edge, half_edge}) form.balls.push_back({{x, y, z}, ball_radius});
  return form;
}

/// Side of the square box [m]: up to 1 000 bodies the same, then beds of the same depth.
double width_of(std::size_t n) {
  return 0.06 * std::sqrt(std::max(1.0, static_cast<double>(n) / 1000));
}

silt::Particles<silt::MultiSphere> loose(std::size_t n) {
  silt::Random random(1);
  silt::Particles<silt::MultiSphere> bodies;
  const auto form = bodies.add_form(cube());
  const double width = width_of(n), spacing = 2 * bodies.forms()[form].radius * 1.02;
  const auto side = static_cast<std::size_t>(width / spacing);
  const double pitch = width / static_cast<double>(side);
  for (std::size_t k = 0; k < n; ++k)
    bodies.add({.form = form,
                .position = {(static_cast<double>(k % side) + 0.5) * pitch,
                             (static_cast<double>(k / side % side) + 0.5) * pitch,
                             (static_cast<double>(k / side / side) + 0.5) * spacing},
                .orientation = silt::random_orientation(random),
                .density = density});
  return bodies;
}

silt::Particles<silt::MultiSphere> read(const std::string& path) {
  std::ifstream in(path);
  silt::require(in.good(), "cannot read ", path);
  silt::Particles<silt::MultiSphere> bodies;
  const auto form = bodies.add_form(cube());
  silt::Vec3d p, v, w;
  silt::Quaternion q;
  while (in >> p.x >> p.y >> p.z >> q.w >> q.x >> q.y >> q.z >> v.x >> v.y >> v.z >> w.x >> w.y >>
         w.z)
    bodies.add({.form = form,
                .position = p,
                .orientation = q,
                .density = density,
                .velocity = v,
                .angular_velocity = w});
  return bodies;
}

template <class Sim>
void write_bodies(const Sim& sim, const std::string& path) {
  std::string out;
  for (std::size_t id = 0; id < sim.size(); ++id) {
    const std::size_t k = sim.find(static_cast<std::uint32_t>(id));
    const auto p = sim.position(k), v = sim.velocity(k), w = sim.angular_velocity(k);
    const auto q = sim.orientation(k);
    char line[400];
    std::snprintf(line, sizeof line,
                  "%.12g %.12g %.12g %.12g %.12g %.12g %.12g %.9g %.9g %.9g %.9g %.9g %.9g\n", p.x,
                  p.y, p.z, q.w, q.x, q.y, q.z, v.x, v.y, v.z, w.x, w.y, w.z);
    out += line;
  }
  silt::AtomicFile file(path);
  file.write(out);
  file.commit();
}

template <class Sim>
void write_balls(const Sim& sim, const std::string& path) {
  std::string out;
  for (std::size_t k = 0; k < sim.rows(); ++k)
    for (const auto& ball : cube().balls) {
      const auto p = sim.position(k) + silt::rotate(sim.orientation(k), ball.centre);
      out += silt::text(p.x, ' ', p.y, ' ', p.z, ' ', ball.radius, '\n');
    }
  silt::AtomicFile file(path);
  file.write(out);
  file.commit();
}

void measure(const std::string& path) {
  std::ifstream in(path);
  silt::require(in.good(), "cannot read ", path);
  std::vector<silt::PositionRow> rows;
  double x, y, z, r, height = 0, overlap = 0;  // [m]
  while (in >> x >> y >> z >> r) rows.push_back({x, y, z, r}), height += z;
  std::vector<silt::IndexPair> near;
  silt::CellGrid{}.find({rows, ball_radius}, 0.0, silt::OpenDomain{}, silt::Team(1), near);
  std::set<std::pair<std::size_t, std::size_t>> partners;
  double contacts = 0;
  for (const auto& [a, b] : near) {
    const std::size_t i = a / balls_per_body, j = b / balls_per_body;
    if (i == j) continue;
    contacts += 1;
    overlap += rows[a].r + rows[b].r - norm(rows[a].centre() - rows[b].centre());
    partners.insert(std::minmax(i, j));
  }
  const double bodies = static_cast<double>(rows.size()) / balls_per_body;
  std::printf("bodies %.6g contacts %.6g partners %.6g overlap %.4g height %.8g\n", bodies,
              2 * contacts / bodies, 2 * static_cast<double>(partners.size()) / bodies,
              contacts > 0 ? overlap / contacts / (2 * ball_radius) : 0.0,
              height / static_cast<double>(rows.size()));
}

template <class Precision>
void time(const std::string& file, double warmup, double steps, Precision precision, bool shared,
          const std::string& end) {
  auto bodies = read(file);
  const double width = width_of(bodies.size());
  auto sim = bed(std::move(bodies), width, 1, precision);
  sim.share_contacts(shared);
  sim.run(warmup * time_step);
  const auto start = std::chrono::steady_clock::now();
  sim.run(steps * time_step);
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  std::printf("seconds %.6g kinetic_energy %.6g\n", seconds, kinetic_energy(sim));
  write_balls(sim, end);
}

int main_with(int argc, char** argv) {
  const std::string mode = argc > 1 ? argv[1] : "";
  if (mode == "settle" && argc == 5) {
    const std::size_t n = std::stoul(argv[2]);
    auto sim = bed(loose(n), width_of(n), silt::default_threads(), silt::Double{});
    sim.share_contacts(false);
    sim.run(std::stod(argv[3]) * time_step);
    write_bodies(sim, argv[4]);
    return 0;
  }
  if (mode == "time" && argc == 8) {
    const double warmup = std::stod(argv[3]), steps = std::stod(argv[4]);
    const bool shared = argv[6] == std::string("shared");
    if (argv[5] == std::string("mixed"))
      time(argv[2], warmup, steps, silt::Mixed{}, shared, argv[7]);
    else
      time(argv[2], warmup, steps, silt::Double{}, shared, argv[7]);
    return 0;
  }
  if (mode == "measure" && argc == 3) {
    measure(argv[2]);
    return 0;
  }
  std::fprintf(stderr,
               "bench_bodies settle N STEPS FILE | measure BALLS | "
               "time FILE WARMUP STEPS double|mixed shared|whole END\n");
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
