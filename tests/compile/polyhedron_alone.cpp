// silt - BSD-3-Clause, see LICENSE
//
// A program that includes a shape and the simulation alone links. Catches functions of the shape
// that are declared there and defined in a header that only others include.

#include <cmath>

#include <silt/contact/hertz_mindlin.hpp>
#include <silt/shape/polyhedron.hpp>
#include <silt/simulation.hpp>

int main() {
  const auto stone = silt::Polyhedron::from_points({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}});
  silt::Particles<silt::Polyhedron> stones;
  stones.add({.form = stones.add_form(stone), .position = {0, 0, 0}, .density = 2500});
  return std::abs(stone.mass_properties().volume - 1.0 / 6) < 1e-12 ? 0 : 1;
}
