// silt - BSD-3-Clause, see LICENSE
//
// An ellipsoid, a cylinder and a cube, each as multi-sphere, superellipsoid and polyhedron: table 1
// of the review of CFD-DEM of non-spherical particles by X. Ma et al., with numbers instead of its
// words high, low, fast and medium.

#include "study/shape_study.hpp"

namespace shape_study {

namespace {

void run(const studies::Setting& setting, example::Summary& summary) {
  using namespace studies::shape;
  Cases cases;
  for (const auto& t : targets())
    if (!setting.quick || t.name == "cube") cases.push_back({t, models_for(t, setting.quick)});
  strike(cases, setting, summary);
  settle(cases, setting, summary);
  const Cubes cubes = repose(cases, setting, summary);
  roll(cases, cubes, setting, summary);
}

const studies::Registered here{
    "shape", "spheres, super-ellipsoids, polyhedra for one particle: impact, bed, heap, drum", run};

}  // namespace

}  // namespace shape_study
