// silt - BSD-3-Clause, see LICENSE
//
// Eigen with silt (docs/eigen.md): principal stresses, and a plane through a surface.

#include <cmath>
#include <cstdio>
#include <vector>

#include <silt/eigen.hpp>

int main() {
  const silt::Tensor3 stress{300, 0,   100, 0,  200,
                             0,   100, 0,   300};  // [Pa], of stress(sim, box).total()
  const std::vector<silt::Vec3d> surface{{0, 0, 0}, {1, 0, 0.5}, {0, 1, 0}, {1, 1, 0.5}};  // [m]
  // Values ascend; directions are the columns of a matrix.
  const silt::PrincipalAxes axes = silt::principal_axes(stress);
  const double deviator = axes.values[2] - axes.values[0];  // [Pa]
  const auto p = silt::columns_of(surface);                 // a view, no copy
  const Eigen::Vector3d highest = p.rowwise().maxCoeff();
  const silt::PlaneFit plane = silt::fit_plane(surface);
  const double slope = std::hypot(plane.normal.x, plane.normal.y) / std::abs(plane.normal.z);
  std::printf("deviator %.3f Pa, highest point %.3f m, slope %.3f\n", deviator, highest.z(), slope);
  const bool holds =
      std::abs(deviator - 200) < 1e-9 && highest.z() == 0.5 && std::abs(slope - 0.5) < 1e-12;
  std::printf(holds ? "as it should be\n" : "NOT as it should be\n");
  return holds ? 0 : 1;
}
