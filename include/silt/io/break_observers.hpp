// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include <silt/breakage/breakage.hpp>
#include <silt/breakage/size_table.hpp>
#include <silt/core/dyn_array.hpp>
#include <silt/core/names.hpp>
#include <silt/files/csv_table.hpp>
#include <silt/fill/size_distribution.hpp>
#include <silt/io/observers.hpp>

namespace silt::inline SILT_TARGET {
namespace detail {

template <class Action>
class BreakObserver {
 public:
  explicit BreakObserver(Action action) : action_(std::move(action)) {}

  template <class Sim>
  void begin(const Sim&, double) const {
    static_assert(Sim::has_breakage,
                  "on_break needs a simulation whose particles break: give it the policy "
                  "silt::Breakage{...} in addition to particles and contacts");
  }
  template <class Sim>
  bool is_due(const Sim&) const {
    return false;
  }
  template <class Sim>
  void operator()(const Sim&) const {}
  void tell(const DynArray<BreakEvent>& broken) const {
    for (const BreakEvent& one : broken) action_(one);
  }

 private:
  mutable Action action_;
};

}  // namespace detail

/// Calls `action(const BreakEvent&)` for each particle that breaks, in the step in which its
/// fragments replace it; within a step in the order of ids.
///
///   sim.run(1.0, silt::on_break([&](const silt::BreakEvent& b) { dust += b.dust; }));
template <class Action>
detail::BreakObserver<Action> on_break(Action action) {
  return detail::BreakObserver<Action>(std::move(action));
}

namespace detail {

/// Columns of breakage_table().
template <class Sim>
DynArray<std::string> columns_of_breakage(const Sim& sim) {
  DynArray<std::string> all{"time [s]",
                            "particles [-]",
                            "broken at walls [-]",
                            "broken in pairs [-]",
                            "broken as asked [-]",
                            "present [kg]",
                            "left [kg]",
                            "dust [kg]"};
  if constexpr (Sim::ContactsType::several_materials)
    for (std::size_t k = 0; k < sim.contacts().materials(); ++k) {
      const std::string_view name = sim.contacts().given_name(k);
      const std::string of = name.empty() ? text("material ", k) : std::string(name);
      for (const auto& [what, unit] : {std::pair{"broken of ", " [-]"},
                                       {"present of ", " [kg]"},
                                       {"left of ", " [kg]"},
                                       {"dust of ", " [kg]"}})
        all.push_back(what + of + unit);
    }
  return all;
}
template <class Sim>
DynArray<double> row_of_breakage(const Sim& sim) {
  const auto number = [](auto count) { return static_cast<double>(count); };
  const MassBalance m = sim.mass_balance();
  DynArray<double> row{sim.time(),
                       number(sim.size()),
                       number(sim.broken(BreakCause::Wall)),
                       number(sim.broken(BreakCause::Pair)),
                       number(sim.broken(BreakCause::Asked)),
                       m.present,
                       m.left,
                       m.dust};
  if constexpr (Sim::ContactsType::several_materials) {
    DynArray<CompensatedSum> present(sim.contacts().materials());
    for (std::size_t k = 0; k < sim.rows(); ++k)
      if (sim.is_present(k) && std::isfinite(sim.mass(k)))
        present[sim.material(k)].add(sim.mass(k));
    if constexpr (Sim::has_ranks)
      for (auto& one : present) one = {sim.sum_over_ranks(one.value()), 0};
    for (std::size_t k = 0; k < present.size(); ++k)
      row.insert(row.end(), {number(sim.broken(k)), present[k].value(), sim.left(k).mass(),
                             sim.dust(k).mass()});
  }
  return row;
}

}  // namespace detail

/// Appends a row to a CSV table at the times of the schedule: time, particles, breakages so far (at
/// walls, in pairs and on request), and the mass that is present, has left, and is dust. With
/// several materials (those of walls included) the breakages and masses of each follow.
inline auto breakage_table(const std::string& path, Schedule schedule) {
  return at<ActionKind::Reads>(
      schedule, [path, open = std::shared_ptr<CsvTable>()](const auto& sim) mutable {
        const DynArray<double> row = detail::row_of_breakage(sim);
        if (sim.rank() != 0) return;
        if (!open) open = detail::open_table(path, detail::columns_of_breakage(sim), sim, row[0]);
        open->add_row(std::span<const double>(row));
      });
}

/// Particles present, by diameter (polyhedra: of the sphere of equal volume), as a size table that
/// can be merged with dust() and left(). For one material, by number or name, or for all. On many
/// ranks: the particles of all (collective).
template <class Sim>
SizeTable sizes_present(const Sim& sim, std::optional<WhichMaterial> of = {}) {
  SizeTable all;
  const std::size_t wanted = of ? sim.contacts().material_number(*of) : 0;
  for (std::size_t k = 0; k < sim.rows(); ++k)
    if (sim.is_present(k) && std::isfinite(sim.mass(k)) && (!of || sim.material(k) == wanted))
      all.add(detail::equal_volume_diameter(sim.engine().volume_of(k)), sim.mass(k), 1, sim.time());
  return detail::merged_over_ranks(sim, all);
}

namespace detail {

/// First class of a table that is not empty.
inline std::size_t first_class(const SizeTable& sizes) {
  std::size_t first = 0;
  while (first < sizes.classes() && sizes.number(first) == 0) ++first;
  return first;
}

}  // namespace detail

/// Writes a size table as CSV. For each class: lower and upper limit (the last class ends at the
/// largest size), mass, number, and the cumulative share of mass finer than the upper limit.
inline void write_sizes(const std::string& path, const SizeTable& sizes) {
  CsvTable out(path, {"from [m]", "to [m]", "mass [kg]", "number [-]", "finer [-]"});
  for (std::size_t k = detail::first_class(sizes); k < sizes.classes(); ++k)
    out.add_row({SizeTable::edge(k), sizes.end_of(k), sizes.mass(k), sizes.number(k),
                 sizes.finer(sizes.end_of(k))});
}

/// Writes the arrival times of the mass in a size table as CSV: one row for each time interval and
/// class that received mass.
inline void write_size_times(const std::string& path, const SizeTable& sizes) {
  CsvTable out(path, {"time from [s]", "time to [s]", "from [m]", "to [m]", "mass [kg]"});
  for (std::size_t bin = 0; bin < sizes.bins(); ++bin)
    for (std::size_t k = detail::first_class(sizes); k < sizes.classes(); ++k)
      if (const double mass = sizes.mass(k, bin); mass > 0)
        out.add_row({static_cast<double>(bin) * sizes.bin_width(),
                     static_cast<double>(bin + 1) * sizes.bin_width(), SizeTable::edge(k),
                     sizes.end_of(k), mass});
}

}  // namespace silt
