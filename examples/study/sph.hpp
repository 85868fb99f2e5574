// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <string>
#include <vector>

#include "study/studies.hpp"

/// The parts of the SPH study, in separate files, as each combination of policies is compiled.
namespace studies::sph {

struct Variant {
  std::string name;
  silt::Study::Variant run;
};
using Variants = std::vector<Variant>;

// `fine`: particles per length over the coarsest; quick: fewer variants.
Variants resolutions(bool quick);
Variants kernels(double fine, bool quick);
Variants time_steps(double fine, bool quick);
Variants diffusions(double fine, bool quick);
Variants shifts(double fine, bool quick);
Variants sounds(double fine, bool quick);
/// A floating box after release, by grain steps per liquid step.
silt::Study::Variant box_with_step(double of_liquid, bool quick);

}  // namespace studies::sph
