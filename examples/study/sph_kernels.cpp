// silt - BSD-3-Clause, see LICENSE
// SPH study: kernels and smoothing lengths.

#include "study/sph.hpp"
#include "study/sph_scenes.hpp"

namespace studies::sph {

namespace {

template <class Kernel>
silt::Study::Variant with_stiffness(const Choice& choice, const Kernel& kernel) {
  return [choice, all = all_of(choice, kernel)](silt::StudyRun& run) {
    all(run);
    run.note("lattice G/P", 100 * lattice_stiffness<Kernel>(choice.smoothing), "%");
  };
}

}  // namespace

Variants kernels(double fine, bool quick) {
  Variants all;
  for (const double smoothing : {0.8, 0.9, 1.0, 1.1, 1.2, 1.4, 1.7}) {
    if (quick && smoothing != 0.9 && smoothing != 1.2) continue;
    const Choice choice{.fine = fine, .smoothing = smoothing};
    all.push_back(
        {silt::text("Wendland, ", smoothing), with_stiffness(choice, silt::WendlandC2{})});
    all.push_back(
        {silt::text("cubic spline, ", smoothing), with_stiffness(choice, silt::CubicSpline{})});
  }
  return all;
}

}  // namespace studies::sph
