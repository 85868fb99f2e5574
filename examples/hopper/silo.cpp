// silt - BSD-3-Clause, see LICENSE
//
// Wall pressure in a round silo above a cone, after filling and during discharge: on rings of the
// cylinder wall over height, beside Janssen's law, and on the cone's facets.

#include "hopper/silo.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>
#include <vector>

#include <silt/silt.hpp>

namespace silo {
namespace {

using silt::Vec3d;
using Law = silt::HertzMindlin;
constexpr double g = 9.81;  // [m/s2]

struct Scene {
  double wide = 16, outlet = 9;  // [grains] diameters of silo and outlet
  double high = 4;               // [silo's diameters] of the bed over the cone, about
  double emptying = 0.3;         // [s] of which the last two thirds are measured
  double wall_friction = 0.3;    // [-]
  static constexpr double grain = 2e-3, density = 2500;  // [m], [kg/m3]
  static constexpr double slope = 60;                    // [degrees] of the cone
  static constexpr int per_diameter = 4;                 // rings

  double diameter() const { return wide * grain; }                                // [m]
  double area() const { return std::numbers::pi / 4 * std::pow(diameter(), 2); }  // [m2]
  double cone() const {                                                           // [m] its height
    return 0.5 * (wide - outlet) * grain * std::tan(slope * std::numbers::pi / 180);
  }
  std::size_t rows() const {
    return static_cast<std::size_t>(cone() / (1.5 * grain));
  }                                                 // of facets
  double bed() const { return high * diameter(); }  // [m] over the cone
  std::size_t rings() const { return static_cast<std::size_t>(std::ceil(3 * high * per_diameter)); }
  double ring() const { return diameter() / per_diameter; }                      // [m] height
  double top() const { return cone() + static_cast<double>(rings()) * ring(); }  // [m] of the wall
  std::size_t grains() const {
    const double o = outlet / wide, in_cone = area() * cone() * (1 + o + o * o) / 3;
    return static_cast<std::size_t>(0.6 * (area() * bed() + in_cone) /
                                    silt::Sphere::volume(grain / 2));
  }
  double settling() const {
    return 0.1 + 1.6 * std::sqrt(2 * (top() - cone() - bed()) / g);
  }  // [s]
  /// Soft, for a long time step: at a few hundred Pa overlaps are 0.5 % of the diameter.
  Law::Material material(double mu) const {
    return {.youngs_modulus = 1e6, .poisson_ratio = 0.3, .restitution = 0.3, .friction = mu};
  }
  /// The cone in rows of facets.
  std::vector<std::array<Vec3d, 3>> facets() const {
    constexpr int around = 36;
    const auto at = [&](std::size_t row, int k) {
      const double up = static_cast<double>(row) / static_cast<double>(rows()),
                   turn = 2 * std::numbers::pi * k / around;
      const double r = 0.5 * grain * std::lerp(outlet, wide, up);
      return Vec3d{r * std::cos(turn), r * std::sin(turn), up * cone()};
    };
    std::vector<std::array<Vec3d, 3>> all;
    for (std::size_t i = 0; i < rows(); ++i)
      for (int k = 0; k < around; ++k) {
        all.push_back({at(i, k), at(i, k + 1), at(i + 1, k + 1)});
        all.push_back({at(i, k), at(i + 1, k + 1), at(i + 1, k)});
      }
    return all;
  }
};

auto make_simulation(const Scene& s) {
  silt::Particles<silt::Sphere> grains;
  grains.fill(silt::CylinderRegion{{0, 0, s.cone()}, {0, 0, s.top()}, s.diameter() / 2},
              {.radius = silt::uniform(0.9 * s.grain / 2, 1.1 * s.grain / 2),
               .density = s.density,
               .count = s.grains()});
  const auto wall = s.material(s.wall_friction);
  silt::Contacts<Law, silt::SeveralMaterials> contacts{{s.material(0.5), wall}};
  contacts.set_pair(s.material(0.5), wall, {.restitution = 0.3, .friction = s.wall_friction});
  silt::Simulation sim{std::move(grains), contacts};
  sim.gravity = {0, 0, -g};
  sim.add_wall(
      silt::Cylinder{{0, 0, s.cone()}, {0, 0, s.top()}, s.diameter() / 2, silt::Side::Inside}, wall,
      {.name = "mantle"});
  sim.add_wall(silt::TriangleMesh(s.facets()), wall, {.name = "cone"});
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, wall, {.name = "lid"});
  const double d = s.diameter();
  sim.add_outlet({{-d, -d, -0.2}, {d, d, -0.01}});
  return sim;
}

/// Mean loads on rings of the cylinder wall, from the cone up, and the weight of the grains beside
/// each.
class Rings {
 public:
  explicit Rings(const Scene& s)
      : s_(s), normal_(s.rings()), shear_(s.rings()), weight_(s.rings()) {}

  template <class Sim>
  void add(const Sim& sim) {
    const auto parts = silt::ring_loads(sim, sim.wall_number("mantle"), normal_.size());
    for (std::size_t k = 0; k < parts.size(); ++k)
      normal_[k] += parts[k].pressure(), shear_[k] -= parts[k].force.z / parts[k].area;
    for (std::size_t k = 0; k < sim.rows(); ++k) {
      if (!sim.is_present(k) || sim.position(k).z < s_.cone()) continue;
      const auto ring = static_cast<std::size_t>((sim.position(k).z - s_.cone()) / s_.ring());
      weight_[std::min(ring, weight_.size() - 1)] += g * sim.mass(k);
    }
    ++samples_;
  }
  double pressure(std::size_t k) const { return normal_[k] / samples_; }  // [Pa]
  double shear(std::size_t k) const { return shear_[k] / samples_; }      // [Pa] that holds grains
  /// [kg/m3] bulk density between the cone and one diameter below the surface.
  double density() const {
    double weight = 0;
    const std::size_t n = filled() - Scene::per_diameter;
    for (std::size_t k = 0; k < n; ++k) weight += weight_[k] / samples_;
    return weight / (g * s_.area() * s_.ring() * static_cast<double>(n));
  }
  /// [m] depth of the middle of ring k below the surface, the latter computed from the grains above
  /// and this bulk density.
  double depth(std::size_t k) const {
    double weight = 0.5 * weight_[k];
    for (std::size_t j = k + 1; j < weight_.size(); ++j) weight += weight_[j];
    return weight / samples_ / (g * s_.area() * density());
  }
  /// [Pa] vertical stress at the middle of ring k: the weight above minus the shear on the rings.
  double vertical(std::size_t k) const {
    double sum = 0.5 * carried(k);
    for (std::size_t j = k + 1; j < weight_.size(); ++j) sum += carried(j);
    return sum / s_.area();
  }
  std::size_t filled() const {  // [rings] with half a bed or more beside them
    std::size_t n = 0;
    const double bed = 0.5 * 0.6 * Scene::density * g * s_.area() * s_.ring();
    while (n < weight_.size() && weight_[n] / samples_ > bed) ++n;
    return n;
  }

 private:
  double carried(std::size_t k) const {  // [N] weight beside a ring less what it holds
    return weight_[k] / samples_ - shear(k) * std::numbers::pi * s_.diameter() * s_.ring();
  }
  const Scene& s_;
  std::vector<double> normal_, shear_, weight_;
  double samples_ = 0;
};

/// Janssen's law: the forces on a slice of the bed are its weight, the stresses above and below,
/// and wall shear, m times the pressure on the wall; that pressure is K times the vertical stress.
/// m and K are constants. H. A. Janssen, Z. VDI 39 (1895) 1045.
struct Janssen {
  double rho, D, m, K;               // [kg/m3], [m], [-], [-]
  double pressure(double z) const {  // [Pa] on the wall at depth z
    return rho * g * D / (4 * m) * (1 - std::exp(-4 * m * K * z / D));
  }
  /// Rms deviation of the pressures of the same rings from this law [-].
  double off(const Rings& rings) const {
    double sum = 0, n = 0;
    for (std::size_t k = Scene::per_diameter / 2; k + Scene::per_diameter < rings.filled(); ++k)
      sum += std::pow(rings.pressure(k) / pressure(rings.depth(k)) - 1, 2), n += 1;
    return std::sqrt(sum / n);
  }
  /// m and K from rings: sums of stresses from half a diameter above the cone to one below the
  /// surface.
  static Janssen of(const Rings& rings, const Scene& s) {
    double normal = 0, shear = 0, vertical = 0;
    for (std::size_t k = Scene::per_diameter / 2; k + Scene::per_diameter < rings.filled(); ++k)
      normal += rings.pressure(k), shear += rings.shear(k), vertical += rings.vertical(k);
    return {rings.density(), s.diameter(), shear / normal, normal / vertical};
  }
};

/// Mean pressures [Pa] on rows of the cone's facets, from the outlet up.
class Rows {
 public:
  explicit Rows(const Scene& s) : normal_(s.rows()), area_(s.rows()) {}

  template <class Sim>
  void add(const Sim& sim) {
    const auto loads = silt::facet_loads(sim, sim.wall_number("cone"));
    const std::size_t of_row = loads.size() / normal_.size();
    sum_ = {0, 0, 0};
    for (std::size_t t = 0; t < loads.size(); ++t) {
      normal_[t / of_row] += loads[t].normal, area_[t / of_row] += loads[t].area;
      sum_ += loads[t].force;
    }
  }
  double pressure(std::size_t row) const { return normal_[row] / area_[row]; }
  Vec3d sum() const { return sum_; }  // [N] of the last sample

 private:
  std::vector<double> normal_, area_;
  Vec3d sum_{};
};

/// Pressures over height, from the outlet up the cone and the cylinder. Janssen's curve is that of
/// the bed during discharge; the curve of the weight above is that of the bed at rest, which is
/// higher.
void write_walls(const std::string& path, const Scene& s, const std::array<Rings, 2>& rings,
                 const std::array<Rows, 2>& rows, const Janssen& law) {
  const auto& [rest, flow] = rings;
  silt::CsvTable table(
      path, {"height [m]", "at rest [Pa]", "while emptied [Pa]", "Janssen while emptied [Pa]",
             "weight above at rest [Pa]", "cone at rest [Pa]", "cone while emptied [Pa]"});
  const double none = std::nan("");
  for (std::size_t k = 0; k < s.rows(); ++k) {
    const double row = s.cone() / static_cast<double>(s.rows());  // [m]
    table.add_row({(static_cast<double>(k) + 0.5) * row, none, none, none, none,
                   rows[0].pressure(k), rows[1].pressure(k)});
  }
  for (std::size_t k = 0; k < std::min(rest.filled(), flow.filled()); ++k)
    table.add_row({s.cone() + (static_cast<double>(k) + 0.5) * s.ring(), rest.pressure(k),
                   flow.pressure(k), law.pressure(flow.depth(k)),
                   rest.density() * g * rest.depth(k), none, none});
}

}  // namespace

int load_walls(double wall_friction, const example::Options& options) {
  const example::Stopwatch watch;
  Scene s;
  s.wall_friction = wall_friction;
  if (options.quick) s.wide = 10, s.outlet = 6, s.emptying = 0.2;
  const std::string& out = options.out;
  silt::make_folder(out);
  auto sim = make_simulation(s);
  sim.threads = options.threads;
  std::printf("filling with %zu grains\n", sim.size());
  sim.run(s.settling(), silt::progress());

  std::array rings{Rings(s), Rings(s)};
  std::array rows{Rows(s), Rows(s)};
  rings[0].add(sim), rows[0].add(sim);
  const double weight = g * sim.total_mass();
  double borne = 0;
  for (std::size_t w = 0; w < sim.walls(); ++w) borne -= sim.wall(w).force.z;
  const double held = -sim.wall("mantle").force.z / weight;
  const double facets_off =
      silt::norm(rows[0].sum() - sim.wall("cone").force) / silt::norm(sim.wall("cone").force);
  silt::write_facet_loads(out + "/cone_at_rest.vtp", sim, sim.wall_number("cone"));
  silt::write_particles(out + "/silo_at_rest.vtp", sim);

  std::printf("emptying\n");
  sim.remove_wall(sim.wall_number("lid"));
  sim.run(s.emptying / 3, silt::progress());
  sim.run(2 * s.emptying / 3, silt::progress(), silt::at(silt::every(1e-3), [&](const auto& now) {
            rings[1].add(now), rows[1].add(now);
          }));
  const Rings& flow = rings[1];
  const Janssen law = Janssen::of(flow, s);
  write_walls(out + "/walls.csv", s, rings, rows, law);
  example::Summary summary;
  summary.input("grains", static_cast<double>(s.grains()));
  summary.input("diameter_m", s.diameter());
  summary.input("wall_friction", s.wall_friction);
  summary.result("bulk_density_kg_m3", law.rho);
  summary.result("shear_over_pressure_while_emptied", law.m);
  summary.result("pressure_over_vertical_stress_while_emptied", law.K);
  summary.result("held_by_the_mantle_at_rest_over_weight", held);
  summary.result("wall_time_s", watch.seconds());
  summary.check_within("borne_by_walls_at_rest_over_weight", borne / weight, 1, 0.03,
                       "what is left of the bed's bouncing");
  summary.check_at_most("facets_against_force_of_the_cone", facets_off, 1e-9);
  summary.check_at_most("shear_over_pressure_over_friction", law.m / s.wall_friction, 1);
  summary.check_at_least("shear_over_pressure_over_friction", law.m / s.wall_friction, 0.6);
  summary.check_at_most("pressure_while_emptied_off_janssen_rms", law.off(flow),
                        options.quick ? 0.2 : 0.15);
  summary.write(out + "/summary.json");
  const bool drawn = example::draw({"curves", out + "/walls.csv", "--x", "height", "--y",
                                    "weight above at rest,at rest,cone at rest,Janssen while "
                                    "emptied,while emptied,cone while emptied",
                                    "--y-label", "pressure on the wall [Pa]", "--title",
                                    "Mantle and cone of a silo", "--out", out + "/walls.png"});
  summary.print_checks();
  std::printf("Look at: %s%s/walls.csv, %s/cone_at_rest.vtp (ParaView), %s/summary.json; %.0f s\n",
              drawn ? (out + "/walls.png, ").c_str() : "", out.c_str(), out.c_str(), out.c_str(),
              watch.seconds());
  return summary.all_hold() ? 0 : 1;
}

}  // namespace silo
