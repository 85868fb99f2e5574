// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include <silt/core/dyn_array.hpp>
#include <silt/fluid/flow_at.hpp>
#include <silt/fluid/flow_mean.hpp>
#include <silt/io/observers.hpp>

/// Observers of the flow of a CoupledFlow in a run: at points, at pressure taps, along lines, and
/// means over time. `flow_at` and `FlowMean` do the same without a simulation. The flow is ahead of
/// the particles by up to one of its steps; tables contain both times. Pressures exclude the weight
/// of the fluid, as the column names say. `FlowOutput{.weight_from = place}` includes it; both
/// pressures are equal at that place.
/// Errors: InputError at the start of a run for a point without fluid, repeated names, and nothing
///         to measure.
/// Tests:  tests/coupling/flow_observers.cpp.

namespace silt::inline SILT_TARGET {

struct FlowOutput {
  std::optional<Vec3d> weight_from{};  // [m] includes the fluid's weight, which is 0 at this point
  bool temperature = false;            // adds a column to flow_probes, for a flow with heat
};
/// A point where the flow is measured.
struct FlowProbe {
  std::string name;
  Vec3d place;  // [m]
};
/// A place where the pressure is measured: a point, or the mean over the plane normal to a
/// direction (0, 1, 2) through it, as by a ring of taps.
struct PressureTap {
  std::string name;
  Vec3d place;  // [m]
  std::optional<int> across{};
};

namespace detail {

template <class Sim>
const auto& flow_of(const Sim& sim) {
  static_assert(
      requires { sim.fluid().flow().grid(); },
      "observers of a flow (flow_probes, pressure_taps, flow_profile, flow_average) need "
      "a simulation with a CoupledFlow: give it one in addition to particles and contacts");
  return sim.fluid().flow();
}
template <class Sim>
double flow_time(const Sim& sim) {
  return sim.fluid().time();
}
inline std::string pressure_words(const FlowOutput& output) {
  return output.weight_from ? "pressure with weight [Pa]" : "pressure without weight [Pa]";
}
template <class Sim>
std::optional<FluidWeight> weight_of(const Sim& sim, const FlowOutput& output) {
  if (!output.weight_from) return std::nullopt;
  return FluidWeight{sim.gravity, *output.weight_from};
}
template <class Sim>
double weight_at(const Sim& sim, const FlowOutput& output, const Vec3d& x) {
  const auto weight = weight_of(sim, output);
  return weight ? weight->pressure(flow_of(sim).fluid().density, x) : 0;
}

/// Observer that checks the scene before a run.
template <class Observer, class Check>
class Checked {
 public:
  static constexpr bool only_reads = true;

  Checked(Observer observer, Check check)
      : observer_(std::move(observer)), check_(std::move(check)) {}
  template <class Sim>
  void begin(const Sim& sim, double end) {
    check_(sim);
    observer_.begin(sim, end);
  }
  template <class Sim>
  bool is_due(const Sim& sim) const {
    return observer_.is_due(sim);
  }
  template <class Sim>
  void operator()(Sim& sim) {
    observer_(sim);
  }

 private:
  Observer observer_;
  Check check_;
};

template <class Sim>
void check_place(const Sim& sim, const char* what, const std::string& name, const Vec3d& x) {
  require(has_fluid_at(flow_of(sim), x), what, ": at ", in_quotes(name), ", ", x,
          " m, there is no fluid: the flow's box goes from ", flow_of(sim).grid().box().min, " to ",
          flow_of(sim).grid().box().max, " m",
          flow_of(sim).open_cells() ? ", without its walls" : "");
}

}  // namespace detail

/// Writes velocity [m/s] (interstitial), pressure [Pa] and void fraction at points, one row per
/// time, to the table `path`; with FlowOutput{.temperature = true} also temperature [K]. For `silt
/// curves`.
///
///   sim.run(1.0, silt::flow_probes("probes.csv", {{"axis", {0, 0, 0.1}}}, silt::every(0.01)));
inline auto flow_probes(const std::string& path, DynArray<FlowProbe> probes, Schedule schedule,
                        const FlowOutput& output = {}) {
  require(!probes.empty(), "flow_probes '", path, "': there are no points");
  DynArray<std::string> columns{"time [s]", "time of the flow [s]"};
  for (const auto& probe : probes)
    for (const std::string& what :
         {std::string("velocity x [m/s]"), std::string("velocity y [m/s]"),
          std::string("velocity z [m/s]"), detail::pressure_words(output),
          std::string("voidage [-]")})
      columns.push_back(probe.name + ' ' + what);
  for (const auto& probe : probes)
    if (output.temperature) columns.push_back(probe.name + " temperature [K]");
  const auto check = [probes, path, output](const auto& sim) {
    require(!output.temperature || detail::temperature_of(detail::flow_of(sim)) != nullptr,
            "flow_probes '", path,
            "': the flow has no temperature; give it one by FlowSolver::set_heat()");
    for (const auto& p : probes) detail::check_place(sim, "flow_probes", p.name, p.place);
  };
  auto rows = table(path, columns, schedule, [probes, output](const auto& sim) {
    DynArray<double> row{sim.time(), detail::flow_time(sim)};
    for (const auto& p : probes) {
      const FlowValues at = flow_at(detail::flow_of(sim), p.place);
      const double pressure = at.pressure + detail::weight_at(sim, output, p.place);
      row.insert(row.end(), {at.velocity.x, at.velocity.y, at.velocity.z, pressure, at.voidage});
    }
    for (const auto& p : probes)
      if (output.temperature)
        row.push_back(flow_at(detail::flow_of(sim), p.place).temperature.value());
    return row;
  });
  return detail::Checked{std::move(rows), check};
}

/// Writes pressures [Pa] at taps, and the pressure drop from each to the next, one row per time, to
/// the table `path`.
///
///   silt::pressure_taps("taps.csv", {{"below", {0, 0, 0.02}, 2}, {"above", {0, 0, 0.08}, 2}},
///                       silt::every(0.01))
inline auto pressure_taps(const std::string& path, DynArray<PressureTap> taps, Schedule schedule,
                          const FlowOutput& output = {}) {
  require(!taps.empty(), "pressure_taps '", path, "': there are no taps");
  DynArray<std::string> columns{"time [s]", "time of the flow [s]"};
  for (const auto& tap : taps) columns.push_back(tap.name + ' ' + detail::pressure_words(output));
  for (std::size_t k = 1; k < taps.size(); ++k)
    columns.push_back(text("drop from ", taps[k - 1].name, " to ", taps[k].name, " [Pa]"));
  const auto read = [output](const auto& sim, const PressureTap& tap) {
    const auto& flow = detail::flow_of(sim);
    const Vec3d& x = tap.place;
    const double p = !tap.across ? flow_at(flow, x).pressure
                                 : mean_pressure_across(flow, *tap.across,
                                                        *tap.across == 0   ? x.x
                                                        : *tap.across == 1 ? x.y
                                                                           : x.z);
    return p + detail::weight_at(sim, output, x);
  };
  const auto check = [taps, read, path](const auto& sim) {
    for (const auto& tap : taps) {
      if (!tap.across) detail::check_place(sim, "pressure_taps", tap.name, tap.place);
      read(sim, tap);
    }
  };
  auto rows = table(path, columns, schedule, [taps, read](const auto& sim) {
    DynArray<double> row{sim.time(), detail::flow_time(sim)};
    for (const auto& tap : taps) row.push_back(read(sim, tap));
    for (std::size_t k = 1; k < taps.size(); ++k) row.push_back(row[k + 1] - row[k + 2]);
    return row;
  });
  return detail::Checked{std::move(rows), check};
}

/// Writes the flow along a line at `points` equidistant points, both ends included: one table
/// `folder/name_<step>.csv` per time, with distance [m], position [m], velocity [m/s], pressure
/// [Pa] and void fraction; for a flow with heat also temperature [K]. Points without fluid are
/// omitted. For `silt curves --x distance`.
inline auto flow_profile(const std::string& folder, const std::string& name, const Vec3d& from,
                         const Vec3d& to, int points, Schedule schedule,
                         const FlowOutput& output = {}) {
  require(points >= 2, "flow_profile '", name, "': points = ", points, " must be at least 2");
  require(is_finite(from) && is_finite(to) && norm(to - from) > 0, "flow_profile '", name,
          "': the line from ", from, " to ", to, " m must be finite and have a length");
  const auto place = [=](int k) {
    return from + (static_cast<double>(k) / (points - 1)) * (to - from);
  };
  const auto check = [=](const auto& sim) {
    const auto& flow = detail::flow_of(sim);
    bool some = false;
    for (int k = 0; k < points; ++k) some = some || has_fluid_at(flow, place(k));
    require(some, "flow_profile '", name, "': there is no fluid on the line from ", from, " to ",
            to, " m");
  };
  auto write = at<ActionKind::Reads>(schedule, [=](const auto& sim) {
    const auto& flow = detail::flow_of(sim);
    DynArray<DynArray<double>> rows;
    for (int k = 0; k < points; ++k) {
      const Vec3d x = place(k);
      if (!has_fluid_at(flow, x)) continue;
      const FlowValues here = flow_at(flow, x);
      const Vec3d& u = here.velocity;
      rows.push_back({norm(x - from), x.x, x.y, x.z, u.x, u.y, u.z,
                      here.pressure + detail::weight_at(sim, output, x), here.voidage});
      if (here.temperature) rows.back().push_back(*here.temperature);
    }
    DynArray<std::string> columns{"distance [m]",
                                  "x [m]",
                                  "y [m]",
                                  "z [m]",
                                  "velocity x [m/s]",
                                  "velocity y [m/s]",
                                  "velocity z [m/s]",
                                  detail::pressure_words(output),
                                  "voidage [-]"};
    if (detail::temperature_of(flow) != nullptr) columns.push_back("temperature [K]");
    make_folder(folder);
    const auto number = std::to_string(sim.step());
    detail::write_csv(
        text(folder, '/', name, '_', std::string(9 - std::min<std::size_t>(9, number.size()), '0'),
             number, ".csv"),
        columns, rows);
  });
  return detail::Checked{std::move(write), check};
}

/// Options of flow_average().
struct FlowAverageOptions {
  double from = 0;                      // [s] simulation time at which averaging starts
  FlowOutput output{};                  // with or without the fluid's weight
  std::optional<int> plane_across = 1;  // normal direction of the plane written as a table; none:
                                        // no table
  std::optional<double> plane_at{};     // [m] its position; left out: the middle of the box
};

/// Time average of a flow. Each state is weighted with the time since the previous one. At the end
/// of a run it writes `folder/mean_flow.vti` for ParaView, and a plane of it as
/// `folder/mean_flow.csv` for `silt cells`. Given to several runs in turn it continues; after a
/// restart it starts anew.
///
///   auto mean = silt::flow_average("out", silt::every(1e-3), {.from = 0.5});
///   sim.run(2.0, mean);
///   mean.mean().velocity(i, j, k);
class FlowAverage {
 public:
  static constexpr bool only_reads = true;

  FlowAverage(std::string folder, Schedule schedule, const FlowAverageOptions& options)
      : folder_(std::move(folder)), schedule_(schedule), options_(options) {}

  template <class Sim>
  void begin(const Sim& sim, double end) {
    require(!options_.plane_across || (*options_.plane_across >= 0 && *options_.plane_across < 3),
            "FlowAverageOptions.plane_across = ", options_.plane_across.value_or(0),
            " is not 0, 1 or 2");
    detail::flow_of(sim);
    require(mean_.time() > 0 || options_.from < end, "flow_average '", folder_,
            "': FlowAverageOptions.from = ", options_.from, " s is not before the run's end at ",
            end, " s");
    schedule_.begin(sim, true);
  }
  template <class Sim>
  bool is_due(const Sim& sim) const {
    return schedule_.is_due(sim);
  }
  template <class Sim>
  void operator()(const Sim& sim) {
    schedule_.mark(sim);
    const double now = sim.time();
    if (now < options_.from - 0.5 * sim.step_length()) return;
    if (last_) mean_.add(detail::flow_of(sim), now - *last_);
    last_ = now;
  }
  template <class Sim>
  void end(const Sim& sim) {
    if (!(mean_.time() > 0)) return;
    make_folder(folder_);
    mean_.write(folder_ + "/mean_flow.vti", detail::weight_of(sim, options_.output));
    if (!options_.plane_across) return;
    const int d = *options_.plane_across;
    const Vec3d middle = 0.5 * (mean_.grid().box().min + mean_.grid().box().max);
    mean_.write_plane(folder_ + "/mean_flow.csv", d,
                      options_.plane_at.value_or(d == 0   ? middle.x
                                                 : d == 1 ? middle.y
                                                          : middle.z));
  }
  const FlowMean& mean() const { return mean_; }

 private:
  std::string folder_;
  Schedule schedule_;
  FlowAverageOptions options_;
  FlowMean mean_;
  std::optional<double> last_;  // [s]
};

inline FlowAverage flow_average(std::string folder, Schedule schedule,
                                const FlowAverageOptions& options = {}) {
  return {std::move(folder), schedule, options};
}

}  // namespace silt
