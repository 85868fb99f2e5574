// silt - BSD-3-Clause, see LICENSE

#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include <doctest/doctest.h>

#include <silt/fluid/flow_vtk.hpp>

#include "near.hpp"

namespace flow_vtk_test {

namespace {

namespace fs = std::filesystem;

// Prints what VTK's own reader finds: sizes, then every array with the values of cell (1, 2, 3).
constexpr const char* vti_dump = R"(
import sys
from vtkmodules.vtkIOXML import vtkXMLImageDataReader
reader = vtkXMLImageDataReader()
errors = []
reader.AddObserver('ErrorEvent', lambda *_: errors.append(1))
reader.SetFileName(sys.argv[1])
reader.Update()
data = reader.GetOutput()
print(len(errors), *data.GetDimensions(), *data.GetOrigin(), *data.GetSpacing())
cells = data.GetCellData()
at = (3 * 5 + 2) * 4 + 1
for k in range(cells.GetNumberOfArrays()):
    a = cells.GetArray(k)
    print(cells.GetArrayName(k), a.GetNumberOfTuples(), *(repr(float(x)) for x in a.GetTuple(at)))
)";

}  // namespace

TEST_CASE("VTK's own reader finds a flow where it is") {
  std::string folder = (fs::temp_directory_path() / "silt_flow_XXXXXX").string();
  REQUIRE(::mkdtemp(folder.data()) != nullptr);
  const silt::Grid g({{1, 2, 3}, {1.4, 3, 4.5}}, {4, 5, 6});
  silt::FlowSolver flow(g, {1.2, 1.8e-5});
  flow.set_boundary({.distance = [](const silt::Vec3d& x) { return x.x - 1.05; }});
  flow.set_turbulence(silt::KEpsilon{.width = 1});
  flow.velocity(2).fill(1), flow.step(1e-4);
  const double eddies = flow.eddy_viscosity()(1, 2, 3);
  CHECK(eddies > 0);
  for (int k = 0; k < 6; ++k)
    for (int j = 0; j < 5; ++j)
      for (int i = 0; i < 4; ++i) {
        flow.turbulent_energy()(i, j, k) = i + 10 * j + 100 * k, flow.dissipation()(i, j, k) = 7 * k;
        flow.pressure()(i, j, k) = 100 * i + 10 * j + k;
        flow.voidage()(i, j, k) = 0.5 + 0.01 * i;
        flow.velocity(0)(i, j, k) = i, flow.velocity(1)(i, j, k) = 2 * j;
        flow.velocity(2)(i, j, k) = 3 * k;
      }
  silt::write_flow(folder + "/flow.vti", flow);
  if (std::system("/usr/bin/python3 -c 'import vtkmodules.vtkIOXML' 2>/dev/null") != 0) {
    MESSAGE("skipped: /usr/bin/python3 has no VTK (Debian: apt-get install python3-vtk9)");
  } else {
    std::ofstream(folder + "/dump.py") << vti_dump;
    const std::string out = folder + "/dump.txt";
    REQUIRE(std::system(("/usr/bin/python3 " + folder + "/dump.py " + folder + "/flow.vti > " + out)
                            .c_str()) == 0);
    std::ifstream in(out);
    int errors, nx, ny, nz;
    double ox, oy, oz, hx, hy, hz;
    in >> errors >> nx >> ny >> nz >> ox >> oy >> oz >> hx >> hy >> hz;
    CHECK(errors == 0);
    CHECK(std::array{nx, ny, nz} == std::array{5, 6, 7});  // points
    CHECK(std::array{ox, oy, oz} == std::array{1.0, 2.0, 3.0});
    CHECK(hx == near(0.1));
    CHECK(hy == near(0.2));
    CHECK(hz == near(0.25));
    const auto expect = [&](const std::string& name, std::initializer_list<double> values) {
      std::string word;
      int tuples;
      in >> word >> tuples;
      CHECK(word == name);
      CHECK(tuples == 120);
      for (const double v : values) {
        double read;
        in >> read;
        CHECK(read == v);
      }
    };
    expect("velocity", {1.5, 5, 10.5});
    expect("pressure", {123});
    expect("voidage", {0.51});
    expect("open", {1});
    expect("eddy_viscosity", {eddies});
    expect("turbulent_energy", {321});
    expect("dissipation", {21});
  }
  fs::remove_all(folder);
  CHECK_THROWS_AS(silt::write_flow("/nowhere/at/all/flow.vti", flow), silt::FileError);
}

}  // namespace flow_vtk_test
