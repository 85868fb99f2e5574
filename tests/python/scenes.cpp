// silt - BSD-3-Clause, see LICENSE
// Writes one of each kind of file that silt has into a folder, for the tests of the Python package.
// What the tests compare with comes by another way: tables of the same step, closed forms.
//
// The last three, which take a minute to compile, with SILT_LONG_SCENES alone.
//
//   grains/   spheres with bonds and temperatures in a box; one is taken out half way
//   again/    the same run again; other/: with another gravity
//   flow/     cells with fields of closed form
//   shapes/   a mix by its surfaces; parts/: bodies of several spheres
//   pieces/   spheres on three ranks; whole/: the same on one
//   failed/   what a run leaves that fails

#include "scenes.hpp"

#include <cstdio>
#include <exception>
#include <vector>

#include <silt/core/box.hpp>
#include <silt/files/csv_table.hpp>
#include <silt/files/vtk.hpp>

namespace {

/// 4 x 3 x 5 cells of 1 x 2 x 1 mm with pressure = x + 10 y + 100 z and velocity = (z, x, y) t.
void write_cells(const std::string& folder) {
  const silt::Box box{{0.001, 0, 0}, {0.005, 0.006, 0.005}};
  silt::VtkSeries series(folder, "flow");
  for (int frame = 0; frame < 3; ++frame) {
    const double t = 0.25 * frame;  // [s]
    std::vector<double> pressure;
    std::vector<silt::Vec3d> velocity;
    std::vector<std::int32_t> open;
    for (int k = 0; k < 5; ++k)
      for (int j = 0; j < 3; ++j)
        for (int i = 0; i < 4; ++i) {
          const silt::Vec3d x{1e-3 * (i + 1.5), 1e-3 * (2 * j + 1), 1e-3 * (k + 0.5)};
          pressure.push_back(x.x + 10 * x.y + 100 * x.z);
          velocity.push_back({t * x.z, t * x.x, t * x.y});
          open.push_back(i == 3 && k == 4 ? 0 : 1);
        }
    const std::string name = "flow_" + std::to_string(frame) + ".vti";
    silt::VtkFields fields;
    fields.add("pressure", pressure).add("velocity", velocity).add("open", open);
    silt::write_vti(folder + '/' + name, box, {4, 3, 5}, fields);
    series.add(t, name);
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "python_scenes FOLDER\n");
    return 2;
  }
  try {
    const std::string folder = argv[1];
    silt::make_folder(folder);
    write_grains(folder), write_cells(folder + "/flow");
#ifdef SILT_LONG_SCENES
    write_shapes(folder), write_pieces(folder);
#endif
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
  return 0;
}
