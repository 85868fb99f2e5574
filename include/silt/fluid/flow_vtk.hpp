// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include <silt/core/dyn_array.hpp>
#include <silt/files/vtk.hpp>
#include <silt/fluid/flow_at.hpp>
#include <silt/fluid/flow_solver.hpp>

namespace silt::inline SILT_TARGET {

namespace detail {

template <class Value>
VtkArray vtk_view(const char* name, const DynArray<Value>& values) {
  return vtk_array(name, std::span<const Value>(values));
}
/// Values of all cells of a grid, i fastest, as a VTK image.
inline void write_cells(const std::string& path, const Grid& g, std::span<const VtkArray> arrays) {
  const VtkSection sections[] = {{"CellData", arrays}};
  const std::string extent = text("\"0 ", g.nx(), " 0 ", g.ny(), " 0 ", g.nz(), '"');
  const Vec3d &o = g.box().min, &h = g.h();
  write_vtk_file(path, "ImageData",
                 text(" WholeExtent=", extent, " Origin=\"", o.x, ' ', o.y, ' ', o.z,
                      "\" Spacing=\"", h.x, ' ', h.y, ' ', h.z, '"'),
                 text("Extent=", extent), sections);
}

/// Calls use(name, its cells) for each field of a turbulent flow.
template <class Flow, class Use>
void for_turbulence(const Flow& flow, const Use& use) {
  if constexpr (requires { flow.turbulence_model(); }) {
    const std::string_view model = flow.turbulence_model();
    if (model == "none") return;
    use("eddy_viscosity", flow.eddy_viscosity());
    if (model != "k-epsilon") return;
    use("turbulent_energy", flow.turbulent_energy()), use("dissipation", flow.dissipation());
  }
}

}  // namespace detail

/// Writes a flow for ParaView, cell by cell: velocity [m/s] (interstitial; mean of the cell's
/// faces), pressure [Pa] (without the fluid's weight), voidage [-], and `open` (1, or 0 inside
/// walls); with `weight` also pressure_with_weight [Pa]; for a flow with heat its temperature [K];
/// for a turbulent flow eddy_viscosity [Pa s] of its last step, with KEpsilon turbulent_energy
/// [m2/s2] and dissipation [m2/s3]. `path` should end in .vti. In a Simulation with a fluid, `vtk_series` writes the same.
/// Errors: FileError if the file cannot be written. Tests: tests/fluid/flow_vtk.cpp.
template <FlowOnGrid Flow>
void write_flow(const std::string& path, const Flow& flow,
                const std::optional<FluidWeight>& weight = {}) {
  const Grid& g = flow.grid();
  const std::size_t n = g.size();
  DynArray<Vec3d> velocity;
  DynArray<double> pressure, voidage, whole, temperature;
  DynArray<std::int32_t> open;
  velocity.reserve(n), pressure.reserve(n), voidage.reserve(n), open.reserve(n);
  for (int k = 0; k < g.nz(); ++k)
    for (int j = 0; j < g.ny(); ++j)
      for (int i = 0; i < g.nx(); ++i) {
        const auto mean = [&](int d) {
          const CellField& u = flow.velocity(d);
          return 0.5 * (u(i, j, k) + u(i + (d == 0), j + (d == 1), k + (d == 2)));
        };
        velocity.push_back({mean(0), mean(1), mean(2)});
        pressure.push_back(flow.pressure()(i, j, k));
        voidage.push_back(flow.voidage()(i, j, k));
        open.push_back(!flow.open_cells() || (*flow.open_cells())(i, j, k) > 0 ? 1 : 0);
        if (const CellField* T = detail::temperature_of(flow)) temperature.push_back((*T)(i, j, k));
        if (weight)
          whole.push_back(pressure.back() +
                          weight->pressure(flow.fluid().density, g.centre(i, j, k)));
      }
  DynArray<detail::VtkArray> arrays{
      detail::vtk_view("velocity", velocity), detail::vtk_view("pressure", pressure),
      detail::vtk_view("voidage", voidage), detail::vtk_view("open", open)};
  if (weight) arrays.push_back(detail::vtk_view("pressure_with_weight", whole));
  if (!temperature.empty()) arrays.push_back(detail::vtk_view("temperature", temperature));
  DynArray<DynArray<double>> turbulence;
  detail::for_turbulence(flow, [&](const char* name, const CellField& field) {
    turbulence.push_back({});
    for (int k = 0; k < g.nz(); ++k)
      for (int j = 0; j < g.ny(); ++j)
        turbulence.back().insert(turbulence.back().end(), field.row(j, k),
                                 field.row(j, k) + g.nx());
    arrays.push_back(detail::vtk_view(name, turbulence.back()));
  });
  detail::write_cells(path, g, arrays);
}

}  // namespace silt
