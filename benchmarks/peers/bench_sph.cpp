// silt - BSD-3-Clause, see LICENSE
// SIDE SUPPORT WARMUP STEPS KERNEL PRECISION THREADS FILE: a cube of SIDE^3 water particles in a
// vacuum, with vortices; the kernel's support is SUPPORT spacings (peers/sph.py).
// KERNEL is lucy, with LAMMPS' viscosity, or wendland; PRECISION double or mixed. FILE gets
// place, velocity, density, acceleration and density rate of each particle in the first step.

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <numbers>
#include <string>
#include <vector>

#include <silt/core/random.hpp>
#include <silt/sph.hpp>

namespace {

using silt::Vec3d;

/// LAMMPS' kernel: w = (1 + 3 s)(1 - s)^3, s = r/support = q/2.
/// Source: L. B. Lucy, Astron. J. 82 (1977) 1013, as in LAMMPS' pair_sph_taitwater.cpp.
struct Lucy {
  static constexpr auto sph_axis = silt::SphAxis::Kernel;
  static double normalisation(int dimensions, double h) {
    const double H = 2 * h, pi = std::numbers::pi;
    return dimensions == 2 ? 5 / (pi * H * H) : 105 / (16 * pi * H * H * H);
  }
  template <class Real>
  static SILT_INLINE Real weight(const Real& q) {
    const Real t = silt::max(Real(1) - Real(0.5) * q, Real(0));
    return (Real(1) + Real(1.5) * q) * t * t * t;
  }
  template <class Real>
  static SILT_INLINE Real slope(const Real& q) {
    const Real t = silt::max(Real(1) - Real(0.5) * q, Real(0));
    return Real(-3) * t * t;
  }
};

/// LAMMPS uses the support as h: mu = H v.r/(r^2 + 0.01 H^2).
struct LammpsViscosity {
  double alpha;  // [-] of silt's h: twice that of LAMMPS
  static constexpr auto sph_axis = silt::SphAxis::Viscosity;
  static constexpr bool artificial = true, laminar = false;
  static constexpr double softening = 0.04;  // [-] of h^2
  void check() const {}
  double longest_step(double) const { return INFINITY; }
};

struct Scene {
  int side;
  double support;
  double spacing = 0.01, density = 1000, sound = 20, speed = 1, alpha = 0.1;
  double length() const { return side * spacing; }
  double h() const { return 0.5 * support * spacing; }
  double step() const { return 0.18 * h() / sound; }
  silt::Liquid liquid() const { return {.density = density, .sound_speed = sound}; }
  silt::SphSetup setup() const {
    const double L = length(), b = 20 * spacing;
    return {.spacing = spacing,
            .region = {{-b, -b, -b}, {L + b, L + b, L + b}},
            .smoothing = 0.5 * support / std::sqrt(3.0)};
  }
  bool inside(const Vec3d& x) const {
    const double L = length();
    return std::min({x.x, x.y, x.z}) > 0 && std::max({x.x, x.y, x.z}) < L;
  }
};

double seconds_of(clockid_t clock) {
  timespec t;
  clock_gettime(clock, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

double peak_memory() {  // [MiB]
  std::ifstream in("/proc/self/status");
  for (std::string line; std::getline(in, line);)
    if (line.rfind("VmHWM:", 0) == 0) return std::atof(line.c_str() + 6) / 1024;
  return 0;
}

/// Share of lanes with a pair, and sizes of the lists, from lists built like silt's own.
struct Listed {
  double neighbours, entries, lanes;  // a particle
};
Listed count(const Scene& scene, const std::vector<Vec3d>& places, std::size_t width) {
  using namespace silt::detail;
  ClusterLists lists;
  lists.width = width, lists.spacing = scene.spacing;
  SphColumns columns;
  for (std::uint32_t k = 0; k < places.size(); ++k) {
    SphRow r{};
    r.place(places[k]), columns.add(r, ClusterLists::Liquid, k);
  }
  const silt::Team team(1);
  columns.arrange(lists.sort(
                      columns.rows, [](std::size_t) { return int{ClusterLists::Liquid}; }, team),
                  team);
  const double reach = 2 * scene.h();
  lists.find(columns.rows, reach + 0.2 * scene.spacing, team);
  double pairs = 0, entries = 0;
  for (std::size_t p = 0; p < lists.first_pack(ClusterLists::Wall); ++p) {
    const auto listed = lists.liquid(p);
    entries += static_cast<double>(listed.size());
    for (std::size_t a = p * width; a < (p + 1) * width; ++a)
      for (const auto e : listed) {
        const Vec3d d = columns.rows[a].position() - columns.rows[e.row()].position();
        if (dot(d, d) < reach * reach && e.row() != a) ++pairs;
      }
  }
  const auto n = static_cast<double>(places.size());
  return {pairs / n, entries / n, entries * static_cast<double>(width) / n};
}

template <class... Policies>
int run(const Scene& scene, int warmup, int steps, const silt::Team& team, const char* file,
        const Policies&... policies) {
  silt::Sph water{scene.liquid(),     scene.setup(),      silt::NoDiffusion{},
                  silt::NoShifting{}, silt::VerletTime{}, policies...};
  const double k = 2 * std::numbers::pi / scene.length(), dt = scene.step();
  silt::Random random(1);
  water.fill([&](const Vec3d& x) { return scene.inside(x); },
             [&](const Vec3d& x) {
               const auto any = [&] { return 0.1 * scene.speed * random.uniform(-1, 1); };
               const double u = scene.speed * std::sin(k * x.x) * std::cos(k * x.y),
                            v = -scene.speed * std::cos(k * x.x) * std::sin(k * x.y);
               const double a = any(), b = any(), c = any();
               return Vec3d{u + a, v + b, c};
             },
             [&](const Vec3d&) { return scene.liquid().pressure(1.002 * scene.density); });
  struct State {
    Vec3d x, v;
    double density;
  };
  const auto state = [&] {
    std::vector<State> all(water.size());
    water.for_each([&](std::uint32_t n, const Vec3d& x, const Vec3d& v, double density, double) {
      all[n] = {x, v, density};
    });
    return all;
  };
  Listed listed{};
  if (std::string(file) != "-") {
    const auto start = state();
    water.step(dt, team);
    const auto next = state();
    std::FILE* out = std::fopen(file, "w");
    if (out == nullptr) return 2;
    for (std::size_t n = 0; n < start.size(); ++n) {
      const State &s = start[n], &t = next[n];
      const Vec3d a = (1 / dt) * (t.v - s.v);
      std::fprintf(out, "%.17g %.17g %.17g %.17g %.17g %.17g %.17g %.17g %.17g %.17g %.17g\n",
                   s.x.x, s.x.y, s.x.z, s.v.x, s.v.y, s.v.z, s.density, a.x, a.y, a.z,
                   (t.density - s.density) / dt);
    }
    std::fclose(out);
    std::vector<Vec3d> places;
    for (const State& s : start) places.push_back(s.x);
    listed = count(scene, places, silt::Lanes<silt::DefaultArch>::width);
    --warmup;
  }
  for (int n = 0; n < warmup; ++n) water.step(dt, team);
  const double cpu = seconds_of(CLOCK_PROCESS_CPUTIME_ID), wall = seconds_of(CLOCK_MONOTONIC);
  for (int n = 0; n < steps; ++n) water.step(dt, team);
  std::printf(
      "seconds %.6g wall %.6g kinetic %.12g particles %zu bytes %zu peak %.1f mass %.17g "
      "step %.17g neighbours %.17g entries %.6g lanes %.6g\n",
      seconds_of(CLOCK_PROCESS_CPUTIME_ID) - cpu, seconds_of(CLOCK_MONOTONIC) - wall,
      water.kinetic_energy(), water.size(), water.bytes(), peak_memory(), water.particle_mass(), dt,
      listed.neighbours, listed.entries, listed.lanes);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 9) return 2;
  const Scene scene{std::atoi(argv[1]), std::atof(argv[2])};
  const int warmup = std::atoi(argv[3]), steps = std::atoi(argv[4]);
  const std::string kernel = argv[5], precision = argv[6];
  const silt::Team team(static_cast<unsigned>(std::atoi(argv[7])));
  const auto with = [&](const auto&... more) {
    return kernel == "lucy" ? run(scene, warmup, steps, team, argv[8], Lucy{},
                                  LammpsViscosity{scene.alpha}, more...)
                            : run(scene, warmup, steps, team, argv[8],
                                  silt::ArtificialViscosity{.alpha = scene.alpha}, more...);
  };
  return precision == "mixed" ? with(silt::Mixed{}) : with();
}
