// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cmath>

#include <silt/core/target.hpp>

namespace silt::inline SILT_TARGET {

/// Factor of mean 1 for strengths, Weibull distributed: (-ln(1 - share))^(1/m) over Gamma(1 + 1/m).
/// `share` [-] in (0, 1), uniform; `modulus` m [-], 0: no scatter.
inline double weibull_factor(double share, double modulus) {
  if (!(modulus > 0)) return 1;
  return std::pow(-std::log1p(-share), 1 / modulus) / std::tgamma(1 + 1 / modulus);
}

}  // namespace silt
