// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include <silt/core/dyn_array.hpp>
#include <silt/files/atomic_file.hpp>
#include <silt/files/vtk.hpp>
#include <silt/io/observers.hpp>

namespace silt::inline SILT_TARGET {
namespace detail {

/// File name of a step: "name_000001200.vtp".
inline std::string file_of_step(const char* name, std::int64_t step, const char* kind) {
  const auto number = std::to_string(step);
  return text(name, '_', std::string(9 - std::min<std::size_t>(9, number.size()), '0'), number,
              kind);
}

/// Passes the contacts to a writer, with or without the declaration of an observer.
template <class Sim>
auto asked_contacts(const Sim& sim) {
  return [&sim](const auto& f) { sim.for_each_contact(f); };
}
template <class Sim>
auto recorded_contacts(const Sim& sim, const char* who) {
  return [&sim, who](const auto& f) { sim.visit_contacts(f, who); };
}

/// Contacts as lines for a file. Its arrays are kept and reused.
class ContactLines {
 public:
  /// Takes the contacts that `each` visits; `sim` gives the positions of particles.
  template <class Sim, class Each>
  void take(const Sim& sim, const Each& each) {
    count_ = 0;
    each([&](const ContactSeen& c) __attribute__((always_inline)) {
      if (count_ == normal_.size()) make_room();
      const std::size_t k = count_++;
      const Vec3d to = sim.position(c.place_a);
      points_[2 * k] = single(to - c.branch), points_[2 * k + 1] = single(to);
      force_[k] = single(c.force), normal_[k] = static_cast<float>(c.normal_force);
      tangential_[k] = static_cast<float>(norm(c.tangential_force));
      overlap_[k] = static_cast<float>(c.overlap);
      a_[k] = c.a, b_[k] = c.b;
      wall_[k] = c.wall == no_wall ? -1 : static_cast<std::int32_t>(c.wall);
    });
  }
  template <class Sim>
  void write(const Sim& sim, const std::string& file) {
    VtkFields fields;
    fields.add("normal_force", taken(normal_)).add("tangential_force", taken(tangential_));
    fields.add("force", taken(force_)).add("overlap", taken(overlap_));
    fields.add("a", taken(a_)).add("b", taken(b_)).add("wall", taken(wall_));
    write_in_pieces(sim, file, fields, {"PCellData", "Float32"}, [&](const auto& path) {
      write_vtp_lines(path, std::span<const Point>(points_.data(), 2 * count_), fields, cells_);
    });
  }

 private:
  using Point = std::array<float, 3>;
  static Point single(const Vec3d& v) {
    return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
  }
  [[gnu::cold, gnu::noinline]] void make_room() {
    const std::size_t room = std::max<std::size_t>(1024, 2 * count_);
    points_.resize(2 * room), force_.resize(room), normal_.resize(room), tangential_.resize(room);
    overlap_.resize(room), a_.resize(room), b_.resize(room), wall_.resize(room);
  }
  template <class T>
  std::span<const T> taken(const DynArray<T>& all) const {
    return {all.data(), count_};
  }

  std::size_t count_ = 0;
  DynArray<Point> points_, force_;
  DynArray<float> normal_, tangential_, overlap_;
  DynArray<std::uint64_t> a_, b_;
  DynArray<std::int32_t> wall_;
  VtkLines cells_;
};

template <class Sim, class Each>
void write_contact_table(const Sim& sim, const std::string& file, const Each& each) {
  const std::string_view header =
      "a,b,wall,surface,facet,x [m],y [m],z [m],normal x [-],normal y [-],normal z [-],overlap "
      "[m],normal force [N],force x [N],force y [N],force z [N]\n";
  DynArray<SortedLine> lines;
  std::string all;
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
    lines.push_back({c.a, c.b, std::exchange(all, {})});
  });
  if constexpr (Sim::has_ranks) lines = gather_lines(sim, std::move(lines));
  on_all_ranks(sim, "a table of contacts", [&] {
    if (sim.rank() != 0) return;
    AtomicFile out(file, Flush::Never);
    out.write(header);
    for (const auto& line : lines) out.write(line.words);
    out.commit();
  });
}

/// `Table`: writes CSV files instead of lines.
template <bool Table>
class ContactSeries {
 public:
  static constexpr bool only_reads = true, reads_contacts = true, reads_forces_alone = true;
  ContactSeries(std::string folder, Schedule schedule)
      : folder_(std::move(folder)), schedule_(schedule) {}

  template <class Sim>
  void begin(const Sim& sim, double) {
    schedule_.begin(sim, only_reads);
    if (begun_) return;
    begun_ = true;
    if (sim.rank() != 0) return;
    make_folder(folder_);
    if constexpr (!Table)
      series_ = sim.continues(folder_ + "/contacts.pvd")
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
      write_contact_table(sim, text(folder_, '/', file), each);
    } else {
      lines_.take(sim, each);
      lines_.write(sim, text(folder_, '/', file));
      if (series_) series_->add(sim.time(), listed_file(sim, file));
    }
    schedule_.mark(sim);
  }

 private:
  std::string folder_;
  Schedule schedule_;
  bool begun_ = false;
  std::optional<VtkSeries> series_;
  ContactLines lines_;
};

}  // namespace detail

/// Writes the contacts of the present step as lines between the centres of two particles, or from
/// the point at a wall to the centre. Fields: normal force, tangential force (magnitude), force on
/// a [N], overlap [m], ids a and b (the largest integer for a wall), wall (-1: none). A contact
/// across the side of a periodic box is drawn whole, beside a. `file` should end in .vtp.
template <class Sim>
void write_contacts(const std::string& file, const Sim& sim) {
  detail::ContactLines lines;
  lines.take(sim, detail::asked_contacts(sim));
  lines.write(sim, file);
}
/// The same as a table: ids, wall, surface and facet (-1: none), point, normal, overlap, forces.
template <class Sim>
void write_contact_csv(const std::string& file, const Sim& sim) {
  detail::write_contact_table(sim, file, detail::asked_contacts(sim));
}

/// Writes `folder/contacts.pvd`, a time series of lines as in write_contacts(). It shows force
/// chains, in ParaView with the filter Tube, or by `silt draw` (docs/python.md).
///   sim.run(1.0, silt::contact_series("out", silt::every(0.01)));
inline detail::ContactSeries<false> contact_series(std::string folder, Schedule schedule) {
  return {std::move(folder), schedule};
}
/// Writes `folder/contacts_<step>.csv` at the times of the schedule.
inline detail::ContactSeries<true> contact_csv(std::string folder, Schedule schedule) {
  return {std::move(folder), schedule};
}

}  // namespace silt
