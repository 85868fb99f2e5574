// silt - BSD-3-Clause, see LICENSE
#include <doctest/doctest.h>

#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <silt/coupling/averaging/kernel.hpp>
#include <silt/coupling/coupled_flow.hpp>
#include <silt/coupling/drag/laws.hpp>

namespace any_order_test {

using silt::BasicCoupledFlow;
using silt::CoupledFlow;
using silt::FlowSolver;
using silt::Vec3d;

namespace {

FlowSolver rising() {
  FlowSolver flow(silt::Grid({{0, 0, 0}, {4e-3, 4e-3, 4e-3}}, {4, 4, 4}, {true, true, true}),
                  {1.2, 1.8e-5});
  flow.velocity(2).fill(0.4);
  return flow;
}

/// [N] on a grain at rest, in one step.
template <class Fluid>
Vec3d force_in(Fluid fluid) {
  const std::vector<Vec3d> position{{2.2e-3, 1.7e-3, 2e-3}}, velocity{{0, 0, 0}};
  const std::vector<double> radius{4e-4}, volume{2.7e-10}, mass{6.7e-7};
  silt::CoupledParticles grain{};
  grain.shape = {position, radius};
  grain.velocity = velocity, grain.volume = volume, grain.mass = mass;
  std::vector<Vec3d> force(1);
  fluid.advance(grain, 1e-4, force);
  return force[0];
}

}  // namespace

TEST_CASE("CoupledFlow: policies in any order make the same fluid, bit for bit") {
  const silt::Kernel wide{.width = 4};
  const silt::VirtualMass light{0.7};
  const Vec3d usual = force_in(CoupledFlow{silt::Gidaspow{}, wide, rising(), light});
  CHECK(norm(usual) > 0);
  CHECK(force_in(CoupledFlow{silt::Gidaspow{}, rising(), wide, light}) == usual);
  CHECK(force_in(CoupledFlow{light, rising(), wide, silt::Gidaspow{}}) == usual);
  const FlowSolver flow = rising();
  CoupledFlow reversed{flow, light, wide, silt::Gidaspow{}};
  CHECK(force_in(reversed) == usual);
  CHECK(force_in(CoupledFlow{reversed}) == usual);  // a copy
  // Another width is another fluid: what was given has been used.
  CHECK(force_in(CoupledFlow{silt::VirtualMass{}, rising(), wide, silt::Gidaspow{}}) != usual);
  CHECK(force_in(CoupledFlow{silt::Gidaspow{}, rising(), silt::Kernel{.width = 2}, light}) !=
        usual);
}

TEST_CASE("CoupledFlow: what is both drag and lift is the drag where no other is given") {
  const silt::SlowEllipsoid both;
  const CoupledFlow alone{both, silt::Kernel{}, rising(), both};
  using Slow =
      BasicCoupledFlow<silt::FlowSolver, silt::SlowEllipsoid, silt::Kernel, silt::SlowEllipsoid>;
  static_assert(std::is_base_of_v<Slow, decltype(alone)>);
  const CoupledFlow lift{both, silt::Kernel{}, rising(), silt::OrientedDrag<>{}};
  using Lift =
      BasicCoupledFlow<silt::FlowSolver, silt::OrientedDrag<>, silt::Kernel, silt::SlowEllipsoid>;
  static_assert(std::is_base_of_v<Lift, decltype(lift)>);
  CHECK(alone.active);
}

}  // namespace any_order_test
