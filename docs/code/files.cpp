// silt - BSD-3-Clause, see LICENSE
//
// Files of other programs (docs/particle_files.md, docs/walls.md): a dump, a mesh in PLY and STL.

#include <cstdio>

#include <silt/boundary/mesh_file.hpp>
#include <silt/boundary/wall.hpp>
#include <silt/fill/particles.hpp>

namespace {

void write(const char* path, const char* content) {
  std::FILE* file = std::fopen(path, "w");
  std::fputs(content, file);
  std::fclose(file);
}

}  // namespace

int main() {
  write("dump.granular",
        "ITEM: TIMESTEP\n1000\nITEM: NUMBER OF ATOMS\n2\nITEM: BOX BOUNDS ff ff ff\n"
        "0 0.1\n0 0.1\n0 0.1\nITEM: ATOMS id type x y z radius\n"
        "1 1 0.02 0.05 0.05 0.002\n2 1 0.08 0.05 0.05 0.003\n");
  silt::Particles<silt::Sphere> grains;
  grains.read("dump.granular", {.density = 2500,     // [kg/m3] where the file has none
                                .timestep = 1000});  // the last frame, if left out
  std::printf("%zu grains, the second at x = %g m\n", grains.size(), grains[1].position.x);

  write("stone.ply",
        "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
        "property float z\nelement face 4\nproperty list uchar int vertex_indices\nend_header\n"
        "0 0 0\n6 0 0\n0 6 0\n0 0 6\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n");
  const silt::Surfaces wall = silt::mesh_wall("stone.ply", 1e-3);  // a unit of the file is 1 mm
  const silt::TriangleMesh mesh(silt::read_mesh("stone.ply", 1e-3));
  silt::write_stl("stone.stl", mesh);  // binary; text with silt::StlFormat::Ascii
  const double volume = 1e9 * silt::TriangleMesh(silt::read_mesh("stone.stl")).volume();  // [mm3]
  std::printf("%zu wall, a stone of %.3f mm3\n", wall.parts.size(), volume);
  const bool holds = grains.size() == 2 && grains[1].position.x == 0.08 && wall.parts.size() == 1 &&
                     volume > 35.999 && volume < 36.001;  // 6^3/6
  std::printf(holds ? "as it should be\n" : "NOT as it should be\n");
  return holds ? 0 : 1;
}
