// silt - BSD-3-Clause, see LICENSE
// Prints the hashes of all scenes, or with --times the seconds per step of each; compare.sh shows
// those of two versions side by side.

#include <string_view>

#include "scene_hash.hpp"

int main(int argc, char** argv) {
  hashes::timing = argc > 1 && std::string_view(argv[1]) == "--times";
  hashes::spheres();
  hashes::laws();
  hashes::bodies();
  hashes::fluids();
}
