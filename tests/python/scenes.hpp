// silt - BSD-3-Clause, see LICENSE
// Small scenes whose files tests/python/*.py read: see scenes.cpp.
#pragma once

#include <string>

void write_grains(const std::string& folder);
void write_shapes(const std::string& folder);
void write_pieces(const std::string& folder);
