// silt - BSD-3-Clause, see LICENSE
// SPH study: density diffusion and particle shifting.

#include "study/sph.hpp"
#include "study/sph_scenes.hpp"

namespace studies::sph {

Variants diffusions(double fine, bool quick) {
  Variants all;
  all.push_back({"none", all_of({.fine = fine}, silt::NoDiffusion{})});
  for (const double delta : {0.02, 0.05, 0.1, 0.2}) {
    if (quick && delta != 0.1) continue;
    all.push_back({silt::text("Molteni, ", delta),
                   all_of({.fine = fine}, silt::MolteniColagrossi{.delta = delta})});
    all.push_back({silt::text("Fourtakas, ", delta),
                   all_of({.fine = fine}, silt::Fourtakas{.delta = delta})});
  }
  return all;
}

Variants shifts(double fine, bool quick) {
  Variants all;
  all.push_back({"none", all_of({.fine = fine}, silt::NoShifting{})});
  for (const double strength : {0.5, 1.0, 2.0, 4.0})
    if (!quick || strength == 2)
      all.push_back({silt::text("strength ", strength),
                     all_of({.fine = fine}, silt::Shifting{.strength = strength})});
  return all;
}

}  // namespace studies::sph
