// silt - BSD-3-Clause, see LICENSE
#pragma once

#include "study/decomposition.hpp"
#include "study/studies.hpp"

namespace decomposition_study {

/// Writes tables and pictures of the counts of a run, and the model's predictions.
void report(const studies::Setting& setting, const Recorded& recorded, example::Summary& summary);

}  // namespace decomposition_study
