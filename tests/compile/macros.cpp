// silt - BSD-3-Clause, see LICENSE
// refused: silt: min or max is a macro here; #undef both before the first header of silt
// refused: silt: None is a macro here, as of X11; include silt first, or #undef None before it
#define max(a, b) ((a) < (b) ? (b) : (a))
#define None 0L
#include <silt/core/target.hpp>
