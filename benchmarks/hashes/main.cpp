// silt - BSD-3-Clause, see LICENSE
// Prints the hashes of all scenes; compare.sh sets those of two versions side by side.

#include "scene_hash.hpp"

int main() {
  hashes::spheres();
  hashes::laws();
  hashes::bodies();
  hashes::fluids();
}
