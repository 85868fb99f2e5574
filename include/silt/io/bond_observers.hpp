// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include <silt/bond/concept.hpp>
#include <silt/core/dyn_array.hpp>
#include <silt/files/vtk.hpp>
#include <silt/io/contact_series.hpp>
#include <silt/io/observers.hpp>
#include <silt/io/rank_files.hpp>

namespace silt::inline SILT_TARGET {
namespace detail {

template <class Action>
class BondObserver {
 public:
  explicit BondObserver(Action action) : action_(std::move(action)) {}

  template <class Sim>
  void begin(const Sim&, double) const {
    static_assert(Sim::has_bonds,
                  "on_bond_break needs a simulation with bonds: give it the policy "
                  "silt::Bonds{silt::ParallelBond{...}} in addition to particles and contacts");
  }
  template <class Sim>
  bool is_due(const Sim&) const {
    return false;
  }
  template <class Sim>
  void operator()(const Sim&) const {}
  void tell(const DynArray<BondBreak>& broken) const {
    for (const BondBreak& one : broken) action_(one);
  }

 private:
  mutable Action action_;
};

class BondSeries {
 public:
  static constexpr bool only_reads = true;
  BondSeries(std::string folder, Schedule schedule)
      : folder_(std::move(folder)), schedule_(schedule) {}

  template <class Sim>
  void begin(const Sim& sim, double) {
    static_assert(Sim::has_bonds,
                  "bond_series needs a simulation with bonds: give it the policy "
                  "silt::Bonds{silt::ParallelBond{...}}");
    schedule_.begin(sim, only_reads);
    if (begun_) return;
    begun_ = true;
    if (sim.rank() != 0) return;
    make_folder(folder_);
    series_ = sim.continues(folder_ + "/bonds.pvd")
                  ? VtkSeries::resume(folder_, "bonds", sim.time() + 0.5 * sim.step_length())
                  : VtkSeries(folder_, "bonds");
  }
  template <class Sim>
  bool is_due(const Sim& sim) const {
    return schedule_.is_due(sim);
  }
  template <class Sim>
  void operator()(const Sim& sim);

 private:
  std::string folder_;
  Schedule schedule_;
  bool begun_ = false;
  std::optional<VtkSeries> series_;
};

}  // namespace detail

/// Calls `action(const BondBreak&)` for each bond that breaks, in the step in which it breaks;
/// within a step in the order in which the bonds were made.
///
///   sim.run(1.0, silt::on_bond_break([&](const silt::BondBreak& b) { lost += b.energy; }));
template <class Action>
detail::BondObserver<Action> on_bond_break(Action action) {
  return detail::BondObserver<Action>(std::move(action));
}

/// Writes the bonds as lines from centre to centre, or from centre to the point on the wall.
/// Fields: `normal_force` [N] (positive: tension), `shear_force` (magnitude), `twisting` and
/// `bending` [N m] (magnitudes), `load` [-] (a bond breaks above 1), `energy` [J], ids `a` and `b`
/// (the largest integer for a wall), `wall` (-1: none), `number`. A bond across the side of a
/// periodic box is drawn whole, beside a. `file` should end in .vtp.
template <class Sim>
void write_bonds(const std::string& file, const Sim& sim) {
  using Point = std::array<float, 3>;
  DynArray<Point> points;
  std::array<DynArray<float>, 6> values;
  DynArray<std::uint64_t> a, b, number;
  DynArray<std::int32_t> wall;
  const auto single = [](const Vec3d& v) {
    return Point{static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
  };
  sim.for_each_bond([&](const BondSeen& bond) {
    points.push_back(single(bond.from)), points.push_back(single(bond.to));
    const double pulls = -dot(bond.force, bond.normal), twists = dot(bond.couple, bond.normal);
    const double all[] = {pulls,
                          norm(bond.force + pulls * bond.normal),
                          std::abs(twists),
                          norm(bond.couple - twists * bond.normal),
                          bond.load,
                          bond.energy};
    for (std::size_t k = 0; k < values.size(); ++k) values[k].push_back(static_cast<float>(all[k]));
    a.push_back(bond.a), b.push_back(bond.b), number.push_back(bond.number);
    wall.push_back(bond.b == no_particle ? static_cast<std::int32_t>(bond.wall) : -1);
  });
  VtkFields fields;
  constexpr std::array names{"normal_force", "shear_force", "twisting",
                             "bending",      "load",        "energy"};
  for (std::size_t k = 0; k < names.size(); ++k)
    fields.add(names[k], std::span<const float>(values[k]));
  fields.add("a", std::span<const std::uint64_t>(a)).add("b", std::span<const std::uint64_t>(b));
  fields.add("wall", std::span<const std::int32_t>(wall));
  fields.add("number", std::span<const std::uint64_t>(number));
  detail::VtkLines cells;
  detail::write_in_pieces(sim, file, fields, {"PCellData", "Float32"}, [&](const auto& path) {
    write_vtp_lines(path, std::span<const Point>(points), fields, cells);
  });
}

/// Writes `folder/bonds.pvd`, a time series of lines as in write_bonds(), for ParaView or `silt
/// draw`.
///   sim.run(1.0, silt::bond_series("out", silt::every(0.01)));
inline detail::BondSeries bond_series(std::string folder, Schedule schedule) {
  return {std::move(folder), schedule};
}

template <class Sim>
void detail::BondSeries::operator()(const Sim& sim) {
  const auto file = file_of_step("bonds", sim.step(), ".vtp");
  write_bonds(text(folder_, '/', file), sim);
  if (series_) series_->add(sim.time(), listed_file(sim, file));
  schedule_.mark(sim);
}

}  // namespace silt
