// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>

#include <silt/core/dyn_array.hpp>
#include <silt/core/error.hpp>
#include <silt/files/csv_table.hpp>
#include <silt/fluid/flow_at.hpp>
#include <silt/fluid/flow_vtk.hpp>

namespace silt::inline SILT_TARGET {

/// Time averages of a flow in its cells, and root mean square deviations.
///
///   silt::FlowMean mean;
///   ... flow.step(dt), mean.add(flow, dt);
///
/// Each state is weighted with the time [s] that it represents. Equidistant states over whole
/// periods of a signal give its mean to rounding; with three or more states per period also the
/// exact deviation of a harmonic.
/// Errors:  InputError for negative weights, flows on other grids, and means without states.
/// Tests:   tests/fluid/flow_mean.cpp.
class FlowMean {
 public:
  template <FlowOnGrid Flow>
  void add(const Flow& flow, double weight) {
    require_not_negative("FlowMean: weight", weight, "s");
    const Grid& g = flow.grid();
    if (!grid_) grid_ = g, cells_.resize(g.size());
    require(*grid_ == g, "FlowMean: a flow on another grid than the first one's is added");
    if (weight == 0) return;
    time_ += weight;
    const double share = weight / time_;
    std::size_t n = 0;
    for (int k = 0; k < g.nz(); ++k)
      for (int j = 0; j < g.ny(); ++j)
        for (int i = 0; i < g.nx(); ++i, ++n) {
          Cell& cell = cells_[n];
          const double eps = flow.voidage()(i, j, k);
          cell.voidage += share * (eps - cell.voidage);
          for (int d = 0; d < 3; ++d) {
            const auto c = static_cast<std::size_t>(d);
            const CellField& f = flow.velocity(d);
            const double u = 0.5 * (f(i, j, k) + f(i + (d == 0), j + (d == 1), k + (d == 2)));
            cell.superficial[c] += share * (eps * u - cell.superficial[c]);
            take(cell.velocity[c], u, share);
          }
          take(cell.pressure, flow.pressure()(i, j, k), share);
          if (const CellField* T = detail::temperature_of(flow))
            take(cell.temperature, (*T)(i, j, k), share), hot_ = true;
          cell.open = !flow.open_cells() || (*flow.open_cells())(i, j, k) > 0;
        }
    density_ = flow.fluid().density;
  }

  double time() const { return time_; }  // [s] the sum of all weights
  const Grid& grid() const { return known(), *grid_; }
  Vec3d velocity(int i, int j, int k) const {  // [m/s] between the particles
    const auto& u = at(i, j, k).velocity;
    return {u[0].mean, u[1].mean, u[2].mean};
  }
  Vec3d velocity_rms(int i, int j, int k) const {  // [m/s] of each component about its mean
    const auto& u = at(i, j, k).velocity;
    return {std::sqrt(u[0].square), std::sqrt(u[1].square), std::sqrt(u[2].square)};
  }
  Vec3d superficial(int i, int j, int k) const {  // [m/s] mean of void fraction times velocity
    const auto& u = at(i, j, k).superficial;
    return {u[0], u[1], u[2]};
  }
  double pressure(int i, int j, int k) const { return at(i, j, k).pressure.mean; }  // [Pa]
  double pressure_rms(int i, int j, int k) const { return std::sqrt(at(i, j, k).pressure.square); }
  double voidage(int i, int j, int k) const { return at(i, j, k).voidage; }  // [-]
  bool has_temperature() const { return hot_; }
  double temperature(int i, int j, int k) const { return hot(i, j, k).mean; }  // [K]
  double temperature_rms(int i, int j, int k) const { return std::sqrt(hot(i, j, k).square); }

  /// Writes for ParaView (.vti): mean_velocity, rms_velocity, mean_superficial_velocity,
  /// mean_pressure (without the fluid's weight), rms_pressure, mean_voidage, open; with `weight`
  /// also mean_pressure_with_weight; for a flow with heat mean_temperature and rms_temperature.
  void write(const std::string& path, const std::optional<FluidWeight>& weight = {}) const {
    using Vector = std::array<double, 3>;
    const auto collect = [&](auto value) {
      DynArray<decltype(value(0, 0, 0))> all;
      for_cells([&](int i, int j, int k) { all.push_back(value(i, j, k)); });
      return all;
    };
    const auto vector = [](const Vec3d& v) { return Vector{v.x, v.y, v.z}; };
    const auto u = collect([&](int i, int j, int k) { return vector(velocity(i, j, k)); });
    const auto rms = collect([&](int i, int j, int k) { return vector(velocity_rms(i, j, k)); });
    const auto flux = collect([&](int i, int j, int k) { return vector(superficial(i, j, k)); });
    const auto p = collect([&](int i, int j, int k) { return pressure(i, j, k); });
    const auto p_rms = collect([&](int i, int j, int k) { return pressure_rms(i, j, k); });
    const auto eps = collect([&](int i, int j, int k) { return voidage(i, j, k); });
    const auto open =
        collect([&](int i, int j, int k) { return static_cast<std::int32_t>(at(i, j, k).open); });
    DynArray<detail::VtkArray> arrays{detail::vtk_view("mean_velocity", u),
                                      detail::vtk_view("rms_velocity", rms),
                                      detail::vtk_view("mean_superficial_velocity", flux),
                                      detail::vtk_view("mean_pressure", p),
                                      detail::vtk_view("rms_pressure", p_rms),
                                      detail::vtk_view("mean_voidage", eps),
                                      detail::vtk_view("open", open)};
    DynArray<double> whole;
    if (weight) {
      whole = collect([&](int i, int j, int k) {
        return pressure(i, j, k) + weight->pressure(density_, grid().centre(i, j, k));
      });
      arrays.push_back(detail::vtk_view("mean_pressure_with_weight", whole));
    }
    DynArray<double> T, T_rms;
    if (hot_) {
      T = collect([&](int i, int j, int k) { return temperature(i, j, k); });
      T_rms = collect([&](int i, int j, int k) { return temperature_rms(i, j, k); });
      arrays.push_back(detail::vtk_view("mean_temperature", T));
      arrays.push_back(detail::vtk_view("rms_temperature", T_rms));
    }
    detail::write_cells(path, grid(), arrays);
  }

  /// Writes the plane of cells normal to direction d (0, 1, 2) nearest to `where` [m] as a table
  /// for `silt cells`: its two coordinates [m], components and magnitude of the mean velocity
  /// [m/s], mean pressure [Pa] and mean void fraction, for a flow with heat the mean temperature.
  void write_plane(const std::string& path, int d, double where) const {
    require(d >= 0 && d < 3, "FlowMean::write_plane: direction ", d, " is not 0, 1 or 2");
    const Vec3d low = grid().box().min, h = grid().h();
    const double from = d == 0   ? low.x
                        : d == 1 ? low.y
                                 : low.z,
                 size = d == 0   ? h.x
                        : d == 1 ? h.y
                                 : h.z;
    const int n = grid().cells()[static_cast<std::size_t>(d)];
    const int plane = static_cast<int>(std::clamp(std::floor((where - from) / size), 0.0, n - 1.0));
    const char *const across = d == 0 ? "y [m]" : "x [m]", *const up = d == 2 ? "y [m]" : "z [m]";
    DynArray<DynArray<double>> rows;
    for_cells([&](int i, int j, int k) {
      if ((d == 0 ? i : d == 1 ? j : k) != plane) return;
      const Vec3d x = grid().centre(i, j, k), u = velocity(i, j, k);
      rows.push_back({d == 0 ? x.y : x.x, d == 2 ? x.y : x.z, u.x, u.y, u.z, norm(u),
                      pressure(i, j, k), voidage(i, j, k)});
      if (hot_) rows.back().push_back(temperature(i, j, k));
    });
    DynArray<std::string> columns{across,
                                  up,
                                  "mean velocity x [m/s]",
                                  "mean velocity y [m/s]",
                                  "mean velocity z [m/s]",
                                  "mean speed [m/s]",
                                  "mean pressure without weight [Pa]",
                                  "mean voidage [-]"};
    if (hot_) columns.push_back("mean temperature [K]");
    detail::write_csv(path, columns, rows);
  }

 private:
  struct Moments {
    double mean = 0, square = 0;  // of differences to the mean
  };
  struct Cell {
    std::array<Moments, 3> velocity;
    std::array<double, 3> superficial{};
    Moments pressure, temperature;
    double voidage = 0;
    bool open = true;
  };
  static void take(Moments& m, double value, double share) {
    const double off = value - m.mean;
    m.mean += share * off;
    m.square += share * ((1 - share) * off * off - m.square);
  }
  const Moments& hot(int i, int j, int k) const {
    require(hot_, "FlowMean: the flow has no temperature; set_heat() it before it is added");
    return at(i, j, k).temperature;
  }
  void known() const { require(time_ > 0, "FlowMean: nothing has been added yet"); }
  const Cell& at(int i, int j, int k) const {
    known();
    const auto n = [](int a) { return static_cast<std::size_t>(a); };
    return cells_[n(i) + n(grid_->nx()) * (n(j) + n(grid_->ny()) * n(k))];
  }
  template <class Visit>
  void for_cells(const Visit& visit) const {
    for (int k = 0; k < grid().nz(); ++k)
      for (int j = 0; j < grid().ny(); ++j)
        for (int i = 0; i < grid().nx(); ++i) visit(i, j, k);
  }

  std::optional<Grid> grid_;
  DynArray<Cell> cells_;
  double time_ = 0, density_ = 0;  // [s], [kg/m3]
  bool hot_ = false;               // flows with heat were added
};

}  // namespace silt
