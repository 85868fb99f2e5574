// silt - BSD-3-Clause, see LICENSE
// Particles and a mesh that is not silt's Grid, of docs/own_fluid.md: gas through slabs of unequal
// height.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <span>
#include <utility>
#include <vector>

#include <silt/fluid.hpp>

// The mesh: slabs of a column of cross-section `area`, from floors[c] to floors[c + 1].
struct Slabs {
  double area;                 // [m2]
  std::vector<double> floors;  // [m] ascending

  std::size_t cells() const { return floors.size() - 1; }
  double height(std::size_t c) const { return floors[c + 1] - floors[c]; }
  double volume(std::size_t c) const { return area * height(c); }
  std::size_t locate(const silt::Vec3d& x) const {
    if (!(x.z >= floors.front() && x.z < floors.back())) return silt::no_cell;
    return static_cast<std::size_t>(std::upper_bound(floors.begin(), floors.end(), x.z) -
                                    floors.begin() - 1);
  }
};

// The flow: gas without inertia that enters at the bottom. Upwards it is what continuity makes of
// it, and the drag in each slab sets the pressure's slope.
class GasInSlabs {
 public:
  GasInSlabs(const Slabs& mesh, const silt::FluidProperties& gas, double superficial)
      : inflow(superficial), mesh_(mesh), gas_(gas) {
    u_.assign(mesh.cells(), superficial), slope_.assign(mesh.cells(), 0);
  }
  double inflow;  // [m/s] superficial velocity at the bottom

  const silt::FluidProperties& fluid() const { return gas_; }
  std::span<const double> velocity(int d) const { return d == 2 ? u_ : nothing_; }
  std::span<const double> slope(int d) const { return d == 2 ? slope_ : nothing_; }
  void step(const silt::CellLoads& of, double dt) {
    double flux = inflow;  // [m/s] superficial, at the floor of slab c
    if (eps_.empty()) eps_.assign(of.voidage.begin(), of.voidage.end());
    for (std::size_t c = 0; c < u_.size(); ++c) {
      const double above = flux - mesh_.height(c) * (of.voidage[c] - eps_[c]) / dt;
      u_[c] = 0.5 * (flux + above) / of.voidage[c];
      slope_[c] = (of.push[2][c] - of.drag[c] * u_[c]) / of.voidage[c];
      flux = above;
    }
    eps_.assign(of.voidage.begin(), of.voidage.end());
  }
  double stable_step(double speed) const {
    double step = 1e-3;  // [s]
    for (std::size_t c = 0; c < u_.size(); ++c)
      step = std::min(step, 0.2 * mesh_.height(c) / std::max(speed, 1e-3));
    return step;
  }
  template <class Visit>
  void for_each_state(const Visit& visit) {
    visit("gas.velocity", u_), visit("gas.slope", slope_), visit("gas.voidage", eps_);
  }

  double pressure_drop() const {
    double sum = 0;
    for (std::size_t c = 0; c < u_.size(); ++c) sum -= slope_[c] * mesh_.height(c);
    return sum;
  }

 private:
  Slabs mesh_;
  silt::FluidProperties gas_;
  std::vector<double> u_, slope_, eps_, nothing_;
};

int main() {
  const double width = 6e-3, d = 1e-3, density = 1500;  // [m], [m], [kg/m3]
  const silt::FluidProperties air{.density = 1.2, .viscosity = 1.8e-5};
  silt::Particles<silt::Sphere> grains;
  grains.fill({{0, 0, 0}, {width, width, 0.06}},
              {.radius = 0.5 * d, .density = density, .count = 600});
  const silt::HertzMindlin::Material glass{
      .youngs_modulus = 1e6, .poisson_ratio = 0.3, .restitution = 0.6};

  const Slabs slabs{width * width, {0, 0.003, 0.005, 0.008, 0.012, 0.017, 0.023, 0.03, 0.05, 0.08}};
  const GasInSlabs gas(slabs, air, 0.15);
  silt::Simulation sim{std::move(grains), silt::Contacts<silt::HertzMindlin>{glass},
                       silt::CoupledMesh{silt::PointWeights{slabs}, gas, silt::Ergun{}}};
  sim.add_wall(silt::box({0, 0, 0}, {width, width, 0.08}), glass);
  sim.gravity = {0, 0, -9.81};
  sim.run(0.25);  // the grains fall and come to rest

  double weight = 0, volume = 0;  // [N], [m3]
  for (std::size_t k = 0; k < sim.rows(); ++k)
    weight += 9.81 * sim.mass(k), volume += sim.mass(k) / density;
  const double borne = weight - 9.81 * air.density * volume;

  // At rest: Ergun's pressure drop of each slab, for the voidage that it has.
  double ergun = 0;
  const auto eps = sim.fluid().voidage();
  for (std::size_t c = 0; c < slabs.cells(); ++c)
    if (eps[c] < 1)
      ergun += slabs.height(c) *
               silt::ergun_pressure_gradient(eps[c], d, air.density, air.viscosity, 0.15);
  const double at_rest = sim.fluid().flow().pressure_drop() / ergun;

  // Fluidised: the gas carries the weight, on average.
  sim.fluid().flow().inflow = 0.6;
  sim.run(0.1);
  double sum = 0;
  std::size_t samples = 0;
  sim.run(0.3, silt::at(silt::every(1e-3), [&](const auto& now) {
            sum += now.fluid().flow().pressure_drop(), ++samples;
          }));
  const double fluidised = sum / static_cast<double>(samples) * slabs.area / borne;
  const double lost = sim.fluid().closure().momentum;

  // Fails if weights for spreading and gathering differ (momentum), if drag uses the voidage of
  // another cell (Ergun), or if the pressure is missing in the forces (the bed is not carried).
  std::printf("pressure drop at rest over Ergun's: %.4f; fluidised, over the weight: %.4f\n",
              at_rest, fluidised);
  std::printf("momentum of grains and gas: off by %.1e of what is exchanged\n", lost);
  const bool right = std::abs(at_rest - 1) < 0.03 && std::abs(fluidised - 1) < 0.03 && lost < 1e-12;
  if (!right) std::printf("wrong: must be 1 within 0.03, twice, and below 1e-12\n");
  return right ? 0 : 1;
}
