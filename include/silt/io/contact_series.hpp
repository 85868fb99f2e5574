// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <silt/files/atomic_file.hpp>
#include <silt/files/vtk.hpp>
#include <silt/io/observers.hpp>

namespace silt::inline SILT_TARGET {
namespace detail {

/// "name_000001200.vtp" of a step.
inline std::string file_of_step(const char* name, std::int64_t step, const char* kind) {
  const auto number = std::to_string(step);
  return text(name, '_', std::string(9 - std::min<std::size_t>(9, number.size()), '0'), number,
              kind);
}

/// Hands the contacts to a writer: as any caller, or as an observer that has said so.
template <class Sim>
auto asked_contacts(const Sim& sim) {
  return [&sim](const auto& f) { sim.for_each_contact(f); };
}
template <class Sim>
auto recorded_contacts(const Sim& sim, const char* who) {
  return [&sim, who](const auto& f) { sim.visit_contacts(f, who); };
}

/// Writes the lines of contacts that `each` visits; `centre_of` the place of a particle's row.
template <class Sim, class Each>
void write_contact_lines(const std::string& file, const Sim& sim, const Each& each) {
  std::vector<std::array<float, 3>> points, force;
  std::vector<float> normal, tangential, overlap;
  std::vector<std::uint64_t> a, b;
  std::vector<std::int32_t> wall;
  const auto single = [](const Vec3d& v) {
    return std::array<float, 3>{static_cast<float>(v.x), static_cast<float>(v.y),
                                static_cast<float>(v.z)};
  };
  each([&](const ContactSeen& c) {
    const Vec3d to = sim.position(c.place_a);
    points.push_back(single(to - c.branch)), points.push_back(single(to));
    force.push_back(single(c.force)), normal.push_back(static_cast<float>(c.normal_force));
    tangential.push_back(static_cast<float>(norm(c.tangential_force)));
    overlap.push_back(static_cast<float>(c.overlap));
    a.push_back(c.a), b.push_back(c.b);
    wall.push_back(c.wall == no_wall ? -1 : static_cast<std::int32_t>(c.wall));
  });
  VtkFields fields;
  fields.add("normal_force", normal).add("tangential_force", tangential).add("force", force);
  fields.add("overlap", overlap).add("a", a).add("b", b).add("wall", wall);
  write_vtp_lines(file, points, fields);
}

template <class Each>
void write_contact_table(const std::string& file, const Each& each) {
  std::string all =
      "a,b,wall,surface,facet,x [m],y [m],z [m],normal x [-],normal y [-],normal z [-],overlap "
      "[m],normal force [N],force x [N],force y [N],force z [N]\n";
  const auto add = [&](double value) { detail::append(all, value), all += ','; };
  each([&](const ContactSeen& c) {
    all += std::to_string(c.a) + ',';
    all += (c.b == no_particle ? std::string("-1") : std::to_string(c.b)) + ',';
    all += (c.wall == no_wall ? std::string("-1") : std::to_string(c.wall)) + ',';
    all += std::to_string(c.surface) + ',';
    all += (c.facet == no_facet ? std::string("-1") : std::to_string(c.facet)) + ',';
    for (const Vec3d& v : {c.point, c.normal}) add(v.x), add(v.y), add(v.z);
    add(c.overlap), add(c.normal_force), add(c.force.x), add(c.force.y), add(c.force.z);
    all.back() = '\n';
  });
  AtomicFile out(file);
  out.write(all);
  out.commit();
}

/// `Table`: contacts as CSV files instead of lines.
template <bool Table>
class ContactSeries {
 public:
  static constexpr bool only_reads = true, reads_contacts = true;
  ContactSeries(std::string folder, Schedule schedule)
      : folder_(std::move(folder)), schedule_(schedule) {}

  template <class Sim>
  void begin(const Sim& sim, double) {
    schedule_.begin(sim, only_reads);
    if (begun_) return;
    begun_ = true;
    make_folder(folder_);
    if constexpr (!Table)
      series_ = sim.continued()
                    ? VtkSeries::resume(folder_, "contacts", sim.time() + 0.5 * sim.step_length())
                    : VtkSeries(folder_, "contacts");
  }
  template <class Sim>
  bool is_due(const Sim& sim) const {
    return schedule_.is_due(sim) && !sim.awaits_contacts();
  }
  template <class Sim>
  void operator()(const Sim& sim) {
    const auto file = file_of_step("contacts", sim.step(), Table ? ".csv" : ".vtp");
    const auto each = recorded_contacts(sim, Table ? "contact_csv" : "contact_series");
    if constexpr (Table) {
      write_contact_table(text(folder_, '/', file), each);
    } else {
      write_contact_lines(text(folder_, '/', file), sim, each);
      series_->add(sim.time(), file);
    }
    schedule_.mark(sim);
  }

 private:
  std::string folder_;
  Schedule schedule_;
  bool begun_ = false;
  std::optional<VtkSeries> series_;
};

}  // namespace detail

/// Writes the contacts of the present step as lines between the centres of two particles, or from
/// the point at a wall to the centre: normal force, tangential force (its size), force on a [N],
/// overlap [m], ids a and b (of a wall the largest number there is), wall (-1: none). A contact
/// through the side of a periodic box is drawn whole, beside a. `file` should end in .vtp.
template <class Sim>
void write_contacts(const std::string& file, const Sim& sim) {
  detail::write_contact_lines(file, sim, detail::asked_contacts(sim));
}
/// The same as a table: ids, wall, surface and facet (-1: none), point, normal, overlap, forces.
template <class Sim>
void write_contact_csv(const std::string& file, const Sim& sim) {
  detail::write_contact_table(file, detail::asked_contacts(sim));
}

/// Writes `folder/contacts.pvd`, a time series of lines as in write_contacts(): force chains, in
/// ParaView with the filter Tube, or by draw.py.
///   sim.run(1.0, silt::contact_series("out", silt::every(0.01)));
inline detail::ContactSeries<false> contact_series(std::string folder, Schedule schedule) {
  return {std::move(folder), schedule};
}
/// Writes `folder/contacts_<step>.csv` at the times of the schedule.
inline detail::ContactSeries<true> contact_csv(std::string folder, Schedule schedule) {
  return {std::move(folder), schedule};
}

}  // namespace silt
