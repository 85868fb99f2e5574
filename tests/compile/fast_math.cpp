// silt - BSD-3-Clause, see LICENSE
// refused: silt: -ffast-math and -Ofast compute as if no number were infinite or NaN; take -O3
#include <silt/core/target.hpp>
