// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cmath>

#include <silt/core/error.hpp>
#include <silt/core/target.hpp>

namespace silt::inline SILT_TARGET {

/// Factor of mean 1 for strengths, Weibull distributed: (-ln(1 - share))^(1/m) over Gamma(1 + 1/m).
/// `share` [-] in (0, 1), uniform; `modulus` m [-], 0: no scatter.
inline double weibull_factor(double share, double modulus) {
  if (!(modulus > 0)) return 1;
  return std::pow(-std::log1p(-share), 1 / modulus) / std::tgamma(1 + 1 / modulus);
}
/// InputError unless it is 0 or at least 0.5: below that nearly all strengths are 0.
inline void check_weibull_modulus(const char* of, double modulus) {
  require(modulus == 0 || (modulus >= 0.5 && std::isfinite(modulus)), of,
          ".weibull_modulus = ", modulus,
          " [-] must be 0, for no scatter, or at least 0.5; brittle solids have 2 to 20");
}

}  // namespace silt
