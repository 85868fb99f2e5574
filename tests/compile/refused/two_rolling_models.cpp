// silt - BSD-3-Clause, see LICENSE
// refused: Contacts<Law, Options...> takes one rolling model
#include "scene.hpp"

#if defined(SILT_MENDED)
using Model = silt::Contacts<silt::HertzMindlin, silt::Both<silt::RollingEpsd, silt::Twisting>>;
#else
using Model = silt::Contacts<silt::HertzMindlin, silt::RollingEpsd, silt::Twisting>;
#endif
Model model(silt::HertzMindlin::Material{.youngs_modulus = 1e7, .poisson_ratio = 0.3});
