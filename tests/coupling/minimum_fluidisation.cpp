// silt - BSD-3-Clause, see LICENSE

#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <vector>

#include <doctest/doctest.h>

#include <silt/coupling/averaging/diffusion.hpp>
#include <silt/coupling/averaging/kernel.hpp>
#include <silt/coupling/averaging/unresolved.hpp>
#include <silt/coupling/coupled_flow.hpp>
#include <silt/coupling/drag/laws.hpp>
#include <silt/coupling/formulas.hpp>

namespace minimum_fluidisation_test {

using silt::CoupledFlow;
using silt::MomentumModel;
using silt::Vec3d;

namespace {

// Grains of 1 mm and 2500 kg/m3 in air, 0.4 of the bed void: Ar = 9.08e4, Re = 37.4, 0.561 m/s.
constexpr double d = 1e-3, rho_p = 2500, voidage = 0.4, g = 9.81;
constexpr silt::FluidProperties air{1.2, 1.8e-5};

/// The fluid's force on a bed at rest, over its weight.
struct Borne {
  double whole;   // [-] of all grains
  double middle;  // [-] of the four layers in the middle, of which no mode sees the bed's ends
};

/// A body-centred lattice, of which 0.4 is void and whose grains do not touch (they would at 0.32),
/// in cells that hold two grains each, between clear gas below and above.
template <class Mode>
class Bed {
 public:
  Bed(const Mode& mode, int layers, MomentumModel model = MomentumModel::A)
      : grid_({{0, 0, 0}, {across * a_, across * a_, (layers + 2 * clear) * a_}},
              {across, across, layers + 2 * clear}, {true, true, false}),
        flow_(silt::Gidaspow{}, mode,
              silt::FlowSolver(grid_, air, {.model = model, .tolerance = 1e-8})) {
    flow_.gravity = {0, 0, -g};
    flow_.flow().set_side(2, 1, silt::Outflow{});
    for (int k = 0; k < layers; ++k)
      for (int j = 0; j < across; ++j)
        for (int i = 0; i < across; ++i)
          for (const double part : {0.25, 0.75})
            position_.push_back({(i + part) * a_, (j + part) * a_, (clear + k + part) * a_});
    const std::size_t n = position_.size();
    radius_.assign(n, d / 2), volume_.assign(n, V), still_.assign(n, {0, 0, 0});
    mass_.assign(n, std::numeric_limits<double>::infinity());  // held, and weighed
    force_.resize(n);
  }

  /// In gas of that superficial velocity [m/s]. The gas takes 0.1 ms to follow: eps rho u over its
  /// drag, the bed's weight a volume.
  Borne borne(double U) {
    flow_.flow().set_side(2, 0, silt::Inflow{{0, 0, U}});
    for (int s = 0; s < 10; ++s)
      flow_.advance({{position_, radius_}, still_, volume_, mass_}, 3e-4, force_);
    Borne sum{0, 0};
    int some = 0;
    for (std::size_t p = 0; p < position_.size(); ++p) {
      const double of_weight = force_[p].z / (rho_p * V * g);  // buoyancy is in the force
      sum.whole += of_weight;
      if (std::abs(position_[p].z - 0.5 * grid_.box().max.z) < 2 * a_)
        sum.middle += of_weight, ++some;
    }
    return {sum.whole / static_cast<double>(position_.size()), sum.middle / some};
  }

  /// The velocity [m/s] that bears the middle: the gas is made faster in steps of 0.01 m/s, between
  /// which the force is taken as linear.
  double bearing_velocity() {
    double below = borne(0.53).middle;
    for (double U = 0.54; U < 0.6; U += 0.01) {
      const double here = borne(U).middle;
      if (below < 1 && here >= 1) return U - 0.01 * (here - 1) / (here - below);
      below = here;
    }
    return std::numeric_limits<double>::quiet_NaN();
  }

 private:
  static constexpr int across = 4, clear = 15;  // cells
  const double V = std::numbers::pi / 6 * d * d * d, a_ = std::cbrt(2 * V / (1 - voidage));
  silt::Grid grid_;
  CoupledFlow<silt::Gidaspow, Mode> flow_;
  std::vector<Vec3d> position_, still_, force_;
  std::vector<double> radius_, volume_, mass_;
};

double closed_form() {
  return silt::minimum_fluidisation_velocity(silt::Ergun{}, voidage, d, rho_p, air.density,
                                             air.viscosity, g);
}

}  // namespace

TEST_CASE("the gas velocity that bears a bed of given voidage is 0.561 m/s, by Ergun's law") {
  const double U = closed_form();
  CHECK(std::abs(U - 0.561) < 0.0005);
  // Where no mode sees the bed's ends all cells have its voidage: what is left is the line between
  // two velocities, b dU^2 / (8 F') = 1.2e-5 of U at the most, where F = a U + b U^2 is Ergun's.
  const auto is_borne = [&](auto bed) {
    CHECK(std::abs(bed.bearing_velocity() / U - 1) < 1.5e-5);
    CHECK(std::abs(bed.borne(U).middle - 1) < 1e-6);
  };
  is_borne(Bed(silt::Unresolved{}, 20));
  is_borne(Bed(silt::Kernel{}, 28));
  is_borne(Bed(silt::Kernel{}, 28, MomentumModel::B));
  is_borne(Bed(silt::Diffusion{.width = 3}, 48));
  is_borne(Bed(silt::Diffusion{.width = 3}, 48, MomentumModel::B));
  is_borne(Bed(silt::Diffusion{}, 96));  // 6 diameters wide
}

TEST_CASE("a bed's blurred ends bear less: the weight of some layers, however high it is") {
  // So a bed of 40 layers (48 diameters) seems to need 2, 5 or 20 % more gas.
  const double U = closed_form();
  const auto lacking = [&](const auto& mode, int layers) {
    return layers * (1 - Bed(mode, layers).borne(U).whole);
  };
  double least = 0;  // the wider the mode, the more
  const auto grows = [&](const auto& mode, int layers) {
    const double low = lacking(mode, layers), high = lacking(mode, 2 * layers);
    CHECK(std::abs(high - low) < 1e-3);  // layers: the ends do not meet
    CHECK(low > least);
    least = low;
  };
  grows(silt::Unresolved{}, 20);           // 1.1 layers of 1.2 diameters
  grows(silt::Kernel{}, 20);               // 2.8
  grows(silt::Diffusion{.width = 3}, 24);  // 4.9
  grows(silt::Diffusion{.width = 6}, 48);  // 9.5
}

}  // namespace minimum_fluidisation_test
