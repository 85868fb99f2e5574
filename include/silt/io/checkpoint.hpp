// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <silt/io/checkpoint_file.hpp>
#include <silt/simulation.hpp>

namespace silt::inline SILT_TARGET {

/// Saves and restores the whole state of a simulation: particles, contact history, lists, walls,
/// inlets and outlets, the fluid, clock. A run continued from it gives the same bits as one that
/// never stopped.
///
///   silt::save_checkpoint(sim, "run.silt");
///   silt::load_checkpoint(sim, "run.silt");    // sim: the same scene, built by the same program
///
/// Walls, materials, limits and gravity come from the program; the state replaces all particles.
/// Errors: FileError for a file that is damaged or cannot be read or written; InputError for one of
/// other policies or of a scene with other walls, inlets or outlets. The simulation is then as it
/// was. Tests: tests/io/checkpoint.cpp.
template <class Sim>
class Checkpoint {
  using Engine = typename Sim::Engine;
  using WallPairs = decltype(Engine::Lists::walls);
  static constexpr std::size_t H = Engine::history;
  static constexpr std::size_t part_size = sizeof(PartRow) / sizeof(double);
  static constexpr bool chooses_search = requires(typename Sim::Search s) {
    detail::finder_of(s).choice();
  };

 public:
  static void save(const Sim& sim, const std::string& path) {
    const Engine& e = sim.engine_;
    CheckpointWriter out(signature());
    const std::vector<double> clock{sim.time_,
                                    sim.dt_,
                                    sim.time_origin_,
                                    sim.checked_speed_,
                                    sim.peak_overlap_,
                                    e.particles.largest_radius,
                                    e.particles.mean_diameter,
                                    e.largest_speed,
                                    e.largest_overlap};
    const std::vector<std::int64_t> counters{sim.step_,
                                             sim.step_origin_,
                                             sim.next_id_,
                                             sim.first_kick_,
                                             sim.kicked_,
                                             e.lists.upkeep.pruned_at,
                                             e.lists.upkeep.searched_at,
                                             static_cast<std::int64_t>(e.safeguards),
                                             sim.scene_changed_};
    const auto& plan = e.lists.upkeep.plan;
    const std::vector<double> upkeep{
        e.lists.upkeep.used, e.largest_share, e.lists.upkeep.outer_wall, e.lists.upkeep.inner_wall,
        plan.outer_time,     plan.inner_time, plan.least_outer,          plan.most_outer,
        plan.least_inner,    plan.most_inner};
    out.add("clock", clock), out.add("counters", counters), out.add("upkeep", upkeep);
    out.add("reach.outer", std::span(e.lists.upkeep.outer)),
        out.add("reach.inner", std::span(e.lists.upkeep.inner));

    const std::size_t n = e.particles.size();
    out.add("position", doubles(e.particles.position.data(), n));
    out.add("motion", doubles(e.particles.motion.data(), n));
    if constexpr (Engine::predicts)
      out.add("derivatives", doubles(e.particles.derivatives.data(), n));
    out.add("id", e.particles.id);
    out.add("material", e.particles.material);
    std::vector<std::uint64_t> forms;
    if constexpr (Sim::has_bodies) {
      out.add("bodies", doubles(e.mover.bodies.data(), e.mover.bodies.size()));
      out.add("parts", doubles(e.particles.part.data(), n));
      for (const auto& form : e.mover.forms) forms.push_back(form.parts.size());
      forms.push_back(sim.next_part_);
      out.add("forms", forms);
    }
    out.add("synchronous",
            doubles(e.mover.synchronous.data(), sim.kicked_ ? e.rows_of_particles() : 0));
    out.add("reference", doubles(e.lists.reference.data(), std::min(n, e.lists.reference.size())));

    std::vector<std::uint32_t> outer;
    const auto pairs = e.lists.pairs.state();
    for (const auto [a, b] : pairs.outer) outer.push_back(a), outer.push_back(b);
    out.add("pairs.outer", outer), out.add("pairs.inner", pairs.origin);
    for (std::size_t h = 0; h < H; ++h) out.add(text("pairs.history", h), pairs.history[h]);

    const auto state = e.lists.walls.state();
    const auto candidates_outer = flat(state.outer), candidates_inner = flat(state.inner);
    std::vector<double> normals;
    std::vector<std::uint8_t> touching;
    std::vector<std::uint32_t> features;
    for (const auto& s : state.slots) {
      features.push_back(s.feature);
      normals.insert(normals.end(), {s.normal.x, s.normal.y, s.normal.z});
      touching.push_back(s.touching);
    }
    out.add("walls.outer", candidates_outer), out.add("walls.inner", candidates_inner);
    out.add("walls.outer_facets", state.outer_facets);
    out.add("walls.inner_facets", state.inner_facets);
    out.add("walls.pieces", state.pieces);
    out.add("walls.normal", normals), out.add("walls.touching", touching);
    if constexpr (Sim::Engine::convex) out.add("walls.feature", features);
    for (std::size_t h = 0; h < H; ++h) out.add(text("walls.history", h), state.history[h]);

    std::vector<double> walls, marks;
    std::vector<std::uint64_t> surfaces;
    for (const auto& w : e.walls) {
      surfaces.push_back(w.surfaces.size());
      put(walls, w.pose), put(walls, w.last_pose);
      for (const Vec3d& v : {w.force, w.torque, w.impulse}) put(walls, v);
    }
    for (const auto* mark : {&e.lists.searched_walls, &e.lists.pruned_walls}) {
      put(marks, mark->region().min), put(marks, mark->region().max);
      for (const auto& pose : mark->poses()) put(marks, pose);
    }
    out.add("walls.state", walls), out.add("walls.marks", marks),
        out.add("walls.surfaces", surfaces);

    std::vector<std::uint64_t> counts;
    std::vector<double> flows;
    for (const auto& o : sim.openings_.outlets())
      counts.push_back(o.count), flows.push_back(o.mass);
    for (const auto& i : sim.openings_.inlets()) {
      const auto random = i.random.state();
      counts.insert(counts.end(), {i.placed, i.waiting, i.insertions, random.seed, random.counter});
      flows.push_back(i.start), flows.push_back(i.interval);
    }
    out.add("openings.counts", counts), out.add("openings.flows", flows);
    std::vector<double> books;
    if constexpr (Sim::has_ledger) {
      books = sim.book_.state();
      books.insert(books.end(),
                   {sim.gravity_booked_.x, sim.gravity_booked_.y, sim.gravity_booked_.z});
      out.add("ledger", books);
    }
    std::vector<std::pair<std::string, std::vector<double>>> flow;
    if constexpr (Sim::Fluid::active) {
      e.fluid_loads().for_each([&](const char* name, const auto& column) {
        out.add(name, doubles(column.data(), e.rows_of_particles()));
      });
      visit_fluid(sim, [&](const std::string& name, const auto& values) {
        flow.emplace_back(name, std::vector<double>(values.begin(), values.end()));
      });
      for (const auto& [name, values] : flow) out.add(name, values);
    }
    std::vector<std::uint64_t> search;
    if constexpr (chooses_search) {
      const auto& choice = detail::finder_of(sim.search_).choice();
      search = {choice.finder, choice.spheres};
      out.add("search.choice", search);
    }
    out.commit(path);
  }

  static void load(Sim& sim, const std::string& path) {
    const CheckpointReader in(path);
    in.require_signature(signature());
    Engine& e = sim.engine_;
    const auto surfaces = in.get<std::uint64_t>("walls.surfaces");
    require(surfaces.size() == e.walls.size(), "checkpoint '", path, "' has ", surfaces.size(),
            " walls, but the simulation has ", e.walls.size(), "; build the scene that wrote it");
    for (std::size_t w = 0; w < surfaces.size(); ++w)
      require(surfaces[w] == 0 || surfaces[w] == e.walls[w].surfaces.size(), "checkpoint '", path,
              "': wall ", w, " has ", surfaces[w], " surfaces, but the simulation's has ",
              e.walls[w].surfaces.size(), "; build the scene that wrote it");
    const std::size_t outlets = sim.openings_.outlets().size(),
                      inlets = sim.openings_.inlets().size();
    const auto counts = in.get<std::uint64_t>("openings.counts");
    require(counts.size() == outlets + 5 * inlets, "checkpoint '", path,
            "' has other inlets or outlets than the simulation; build the scene that wrote it");

    // Everything is read and checked for its length before anything is changed.
    const auto clock = in.get<double>("clock", 9), upkeep = in.get<double>("upkeep", 10);
    const auto outer_reach = in.get<double>("reach.outer"),
               inner_reach = in.get<double>("reach.inner", outer_reach.size());
    const auto counters = in.get<std::int64_t>("counters", 9);
    const auto id = in.get<std::uint32_t>("id");
    const std::size_t n = id.size();
    constexpr std::size_t motion_size = sizeof(typename Engine::Motion) / sizeof(double);
    const auto position = in.get<double>("position", 4 * n);
    const auto motion = in.get<double>("motion", motion_size * n);
    std::vector<double> derivatives;
    if constexpr (Engine::predicts)
      derivatives = in.get<double>("derivatives", 4 * Engine::State::derivative_rows * n);
    const auto material =
        in.get<std::uint16_t>("material", Sim::ContactsType::several_materials ? n : 0);
    std::vector<double> bodies, parts;
    std::vector<std::uint64_t> forms;
    std::size_t particles = n;
    if constexpr (Sim::has_bodies) {
      constexpr std::size_t body_size = sizeof(detail::Body) / sizeof(double);
      bodies = in.get<double>("bodies"), parts = in.get<double>("parts", part_size * n);
      particles = bodies.size() / body_size;
      forms = in.get<std::uint64_t>("forms");
      bool same = forms.size() == e.mover.forms.size() + 1;
      for (std::size_t f = 0; same && f + 1 < forms.size(); ++f)
        same = forms[f] == e.mover.forms[f].parts.size();
      require(same && bodies.size() % body_size == 0, "checkpoint '", path,
              "' has particles of other forms than the simulation; build the scene that wrote it");
    }
    const auto synchronous = in.get<double>("synchronous", counters[4] ? 6 * particles : 0);
    const auto reference = in.get<double>("reference");
    const auto outer = in.get<std::uint32_t>("pairs.outer");
    typename decltype(Engine::Lists::pairs)::State pairs;
    pairs.origin = in.get<std::uint32_t>("pairs.inner");
    for (std::size_t h = 0; h < H; ++h)
      pairs.history[h] = in.get<double>(text("pairs.history", h), pairs.origin.size());
    typename WallPairs::State state;
    state.outer = candidates(in.get<std::uint32_t>("walls.outer"));
    state.inner = candidates(in.get<std::uint32_t>("walls.inner"));
    state.outer_facets = in.get<std::uint32_t>("walls.outer_facets");
    state.inner_facets = in.get<std::uint32_t>("walls.inner_facets");
    state.pieces = in.get<std::uint64_t>("walls.pieces");
    const auto touching = in.get<std::uint8_t>("walls.touching");
    const auto normals = in.get<double>("walls.normal", 3 * touching.size());
    for (std::size_t h = 0; h < H; ++h)
      state.history[h] = in.get<double>(text("walls.history", h), touching.size());
    std::vector<std::uint32_t> features(touching.size(), 0);
    if constexpr (Sim::Engine::convex)
      features = in.get<std::uint32_t>("walls.feature", touching.size());
    for (std::size_t k = 0; k < touching.size(); ++k)
      state.slots.push_back({{normals[3 * k], normals[3 * k + 1], normals[3 * k + 2]},
                             touching[k] != 0,
                             features[k]});
    const auto walls = in.get<double>("walls.state", 23 * surfaces.size());
    const auto marks = in.get<double>("walls.marks");
    const auto flows = in.get<double>("openings.flows", outlets + 2 * inlets);
    std::vector<double> books;
    if constexpr (Sim::has_ledger) {
      books = in.get<double>("ledger");
      require(books.size() >= decltype(sim.book_)::least_size + 3, "checkpoint '", path,
              "': its ledger is incomplete");
    }
    std::vector<std::vector<double>> loads, flow;
    if constexpr (Sim::Fluid::active) {
      e.fluid_loads().for_each([&](const char* name, const auto&) {
        loads.push_back(in.get<double>(name, 4 * particles));
      });
      visit_fluid(sim, [&](const std::string& name, auto&& values) {
        if constexpr (sets_its_length<decltype(values)>)
          flow.push_back(in.get<double>(name));
        else
          flow.push_back(in.get<double>(name, values.size()));
      });
    }
    e.set_coefficients(sim.contacts_);  // throws where a pair of materials lacks its values
    if constexpr (chooses_search) {
      const auto choice = in.get<std::uint64_t>("search.choice", 2);
      detail::finder_of(sim.search_).keep({choice[0], choice[1]});  // throws where there is none
    }

    sim.time_ = clock[0], sim.dt_ = clock[1], sim.time_origin_ = clock[2];
    sim.checked_speed_ = clock[3], sim.peak_overlap_ = clock[4];
    sim.step_ = counters[0], sim.step_origin_ = counters[1];
    sim.next_id_ = static_cast<std::uint32_t>(counters[2]);
    sim.continued_ = true;
    sim.scene_changed_ = counters[8] != 0;
    sim.first_kick_ = counters[3] != 0, sim.kicked_ = counters[4] != 0;
    e.safeguards = static_cast<std::uint64_t>(counters[7]);
    e.lists.upkeep.pruned_at = counters[5], e.lists.upkeep.searched_at = counters[6];
    e.lists.upkeep.used = upkeep[0], e.lists.upkeep.outer_wall = upkeep[2],
    e.lists.upkeep.inner_wall = upkeep[3];
    e.lists.upkeep.plan = {upkeep[4], upkeep[5], upkeep[6], upkeep[7], upkeep[8], upkeep[9]};
    e.lists.upkeep.restore(outer_reach, inner_reach);

    e.particles.id = id, e.particles.material = material;
    e.particles.position.resize(n), e.particles.motion.resize(n);
    copy(position, e.particles.position.data()), copy(motion, e.particles.motion.data());
    if constexpr (Engine::predicts) {
      e.particles.derivatives.resize(n);
      copy(derivatives, e.particles.derivatives.data());
    }
    if constexpr (Sim::has_bodies) {
      e.mover.bodies.resize(particles), copy(bodies, e.mover.bodies.data());
      e.particles.part.resize(n), copy(parts, e.particles.part.data());
      sim.next_part_ = static_cast<std::uint32_t>(forms.back());
      e.mover.number_rows(e.particles);
    }
    e.particles.pad();
    if constexpr (Sim::Fluid::active) {
      std::size_t next_load = 0, next_part = 0;
      e.fluid_loads().resize(particles);
      e.fluid_loads().for_each(
          [&](const char*, auto& column) { copy(loads[next_load++], column.data()); });
      visit_fluid(sim, [&](const std::string&, auto&& values) {
        if constexpr (sets_its_length<decltype(values)>) values.resize(flow[next_part].size());
        std::copy(flow[next_part].begin(), flow[next_part].end(), values.begin());
        ++next_part;
      });
    }
    e.mover.synchronous.resize(synchronous.size() / 6),
        copy(synchronous, e.mover.synchronous.data());
    e.lists.reference.resize(reference.size() / 3), copy(reference, e.lists.reference.data());
    for (std::size_t w = 0; w < surfaces.size(); ++w)
      if (surfaces[w] == 0) e.walls[w].surfaces.clear();

    for (std::size_t k = 0; k + 1 < outer.size(); k += 2)
      pairs.outer.push_back({outer[k], outer[k + 1]});
    e.lists.pairs.restore(pairs, n);
    e.lists.walls.restore(std::move(state), e.walls, n);

    const double* next = walls.data();
    for (auto& w : e.walls) {
      take(next, w.pose), take(next, w.last_pose);
      take(next, w.force), take(next, w.torque), take(next, w.impulse);
    }
    next = marks.data();
    const std::size_t poses = (marks.size() - 12) / 14;
    for (auto* mark : {&e.lists.searched_walls, &e.lists.pruned_walls}) {
      Box region;
      take(next, region.min), take(next, region.max);
      std::vector<Pose> was(poses);
      for (auto& pose : was) take(next, pose);
      mark->restore(std::move(was), region);
    }
    std::size_t c = 0, f = 0;
    for (auto& o : sim.openings_.outlets()) o.count = counts[c++], o.mass = flows[f++];
    for (auto& i : sim.openings_.inlets()) {
      i.placed = counts[c], i.waiting = counts[c + 1], i.insertions = counts[c + 2];
      i.random = Random(Random::State{counts[c + 3], counts[c + 4]});
      c += 5;
      i.start = flows[f++], i.interval = flows[f++];
    }
    if constexpr (Sim::has_ledger) {
      const std::size_t last = books.size() - 3;
      sim.gravity_booked_ = {books[last], books[last + 1], books[last + 2]};
      books.resize(last);
      sim.book_.restore(books);
    }
    e.particles.restored(clock[5], clock[6]);
    e.restored(clock[7], clock[8], upkeep[1]);
  }

  /// Which programs can continue from the file: the policies that shape the state.
  static std::string signature() {
    return text("silt state 8; particles ", name_of<typename Sim::ShapeType>(), "; contacts ",
                name_of<typename Sim::ContactsType>(), "; search ", name_of<typename Sim::Search>(),
                "; domain ", name_of<typename Sim::Domain>(), "; precision ",
                name_of<typename Sim::Precision>(), Sim::has_ledger ? "; ledger" : "",
                Sim::Fluid::active ? text("; fluid ", name_of<typename Sim::Fluid>()) : "",
                "; integrator ", name_of<typename Sim::Integrator>(),
                Sim::has_bodies ? text("; rotation ", name_of<typename Sim::Rotation>()) : "");
  }

 private:
  template <class T>
  static std::string name_of() {
#if defined(__GNUC__)
    const std::string_view all = __PRETTY_FUNCTION__;
    const std::size_t from = all.find("T = ") + 4;
    std::string name(all.substr(from, all.find_first_of(";]", from) - from));
    // Written with other compile flags it is still the same scene.
    static constexpr std::string_view target = SILT_TEXT(SILT_TARGET) "::";
    for (auto at = name.find(target); at != name.npos; at = name.find(target, at))
      name.erase(at, target.size());
    return name;
#else
    return typeid(T).name();
#endif
  }

  /// A part of the fluid's state whose length is not known before.
  template <class V>
  static constexpr bool sets_its_length =
      std::is_same_v<std::remove_cvref_t<V>, std::vector<double>>;
  /// The fluid's state, which the visitor may change.
  template <class Visit>
  static void visit_fluid(const Sim& sim, const Visit& visit) {
    const_cast<typename Sim::Fluid&>(sim.fluid_).for_each_state(visit);
  }

  template <class Row>
  static std::span<const double> doubles(const Row* rows, std::size_t count) {
    static_assert(sizeof(Row) % sizeof(double) == 0);
    return {reinterpret_cast<const double*>(rows), count * sizeof(Row) / sizeof(double)};
  }
  template <class Row>
  static void copy(const std::vector<double>& from, Row* to) {
    std::copy(from.begin(), from.end(), reinterpret_cast<double*>(to));
  }
  static void put(std::vector<double>& out, const Vec3d& v) {
    out.insert(out.end(), {v.x, v.y, v.z});
  }
  static void put(std::vector<double>& out, const Pose& p) {
    out.insert(out.end(), {p.rotation.w, p.rotation.x, p.rotation.y, p.rotation.z});
    put(out, p.translation);
  }
  static void take(const double*& from, Vec3d& v) {
    v = {from[0], from[1], from[2]};
    from += 3;
  }
  static void take(const double*& from, Pose& p) {
    p.rotation = {from[0], from[1], from[2], from[3]};
    from += 4;
    take(from, p.translation);
  }
  static std::vector<std::uint32_t> flat(const std::vector<detail::WallCandidate>& candidates) {
    std::vector<std::uint32_t> out;
    for (const auto& c : candidates)
      out.insert(out.end(),
                 {c.particle, c.wall, c.surface, c.slot, c.facets, c.facet_count, c.origin});
    return out;
  }
  static std::vector<detail::WallCandidate> candidates(const std::vector<std::uint32_t>& flat) {
    std::vector<detail::WallCandidate> out;
    for (std::size_t k = 0; k + 6 < flat.size(); k += 7)
      out.push_back({flat[k], static_cast<std::uint16_t>(flat[k + 1]),
                     static_cast<std::uint16_t>(flat[k + 2]), flat[k + 3], flat[k + 4], flat[k + 5],
                     flat[k + 6]});
    return out;
  }
};

template <class Sim>
void save_checkpoint(const Sim& sim, const std::string& path) {
  Checkpoint<Sim>::save(sim, path);
}
template <class Sim>
void load_checkpoint(Sim& sim, const std::string& path) {
  Checkpoint<Sim>::load(sim, path);
}

}  // namespace silt
