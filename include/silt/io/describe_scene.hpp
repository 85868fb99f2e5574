// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <span>
#include <string>
#include <type_traits>

#include <silt/boundary/wall.hpp>
#include <silt/core/dyn_array.hpp>
#include <silt/io/scene_description.hpp>
#include <silt/simulation.hpp>

/// Description of a scene in its checkpoints, besides the policies: domain, materials, walls,
/// inlets and outlets, forms, fluid. Not included is what cannot be read from outside: motions (the
/// pose at the checkpoint's time is compared), and parameters of searches, drag laws and averaging.
/// Tests: tests/io/checkpoint_scene.cpp (items, changed).

namespace silt::inline SILT_TARGET::detail {

/// Adds items; their names begin with `of`.
class Describer {
 public:
  using Aspect = SceneDescription::Aspect;
  Describer(SceneDescription& out, Aspect aspect, std::string of)
      : out_(out), aspect_(aspect), of_(std::move(of)) {}
  void operator()(const std::string& name, const Vec3d& value, std::string_view unit) const {
    out_.add(aspect_, of_ + name, value, unit);
  }
  template <class Value>
  void operator()(const std::string& name, const Value& value) const {
    if constexpr (std::is_arithmetic_v<Value>)
      out_.add(aspect_, of_ + name, static_cast<double>(value));
    else
      out_.add(aspect_, of_ + name, value);
  }
  void number(const std::string& name, double value, double slack) const {
    out_.add(aspect_, of_ + name, value, slack);
  }
  void numbered(const std::string& name, std::size_t k, std::string_view called) const {
    out_.add_numbered(aspect_, of_ + name, k, called);
  }
  void explained(const std::string& name, double value, const std::string& meaning) const {
    out_.add_explained(aspect_, of_ + name, value, meaning);
  }
  Describer of(const std::string& more) const { return {out_, aspect_, of_ + more}; }

 private:
  SceneDescription& out_;
  Aspect aspect_;
  std::string of_;
};

inline void describe(const Describer& is, const Box& box) {
  is("from", box.min), is("to", box.max);
}

inline const char* words_of(Side side) { return side == Side::Inside ? "inside" : "outside"; }
inline void describe(const Describer& is, const Plane& plane) {
  is("is", "a plane"), is("point", plane.point), is("normal", plane.normal, "-");
}
inline void describe(const Describer& is, const Cylinder& c) {
  is("is", "a cylinder"), is("from", c.from), is("to", c.to), is("radius [m]", c.radius);
  is("side", words_of(c.side));
}
inline void describe(const Describer& is, const Cone& c) {
  is("is", "a cone"), is("from", c.from), is("to", c.to), is("radius_from [m]", c.radius_from);
  is("radius_to [m]", c.radius_to), is("side", words_of(c.side));
}
inline void describe(const Describer& is, const TriangleMesh& mesh) {
  is("is", "a mesh"), is("vertices", mesh.vertices().size());
  is("triangles", mesh.triangles().size()),
      is("cosine of the smooth angle", mesh.cos_smooth_angle());
  is("vertices", std::span<const Vec3d>(mesh.vertices()));
  DynArray<Vec3d> corners;
  for (const auto& [i, j, k] : mesh.triangles())
    corners.push_back({static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)});
  is("corners of the triangles", std::span<const Vec3d>(corners));
}

/// Numbers of a plain aggregate of doubles, as used by the kernels of laws; with their meaning if
/// the aggregate has a static array `names`.
template <class Aggregate>
void describe_numbers(const Describer& is, const std::string& whose, const Aggregate& values) {
  if constexpr (!std::is_empty_v<Aggregate>) {
    constexpr std::size_t count = sizeof(Aggregate) / sizeof(double);
    const auto numbers = std::bit_cast<std::array<double, count>>(values);
    for (std::size_t k = 0; k < count; ++k) {
      const std::string name = text(whose, " coefficient ", k + 1, " of ", count);
      if constexpr (requires { Aggregate::names.size(); })
        is.explained(name, numbers[k], Aggregate::names.at(k));
      else
        is(name, numbers[k]);
    }
  }
}

/// The law and the rolling model for every pair, in the order of the engine's table.
template <class Table>
void describe_materials(const Describer& is, const Table& table) {
  is("materials", table.materials);
  const std::size_t n = table.materials;
  for (std::size_t k = 0; k < table.law.size(); ++k) {
    const auto of_pair = is.of(text("materials ", k / n, " and ", k % n, ": "));
    describe_numbers(of_pair, "the law's", table.law[k]);
    describe_numbers(of_pair, "the rolling model's", table.rolling[k]);
  }
}

template <class Form>
void describe_form(const Describer& is, const Form& form) {
  is("parts that touch", form.parts.size());
  if constexpr (requires { form.shape.describe(is); }) form.shape.describe(is);
  const auto& m = form.mass;
  is("radius [m]", form.radius), is("volume [m3]", m.volume);
  const double slack = 1e-9 * norm(m.inertia);
  is.number("inertia x [m5]", m.inertia.x, slack), is.number("inertia y [m5]", m.inertia.y, slack);
  is.number("inertia z [m5]", m.inertia.z, slack);
  const double apart = 1e-9 * (form.radius + norm(m.centroid));
  is.number("centroid x [m]", m.centroid.x, apart),
      is.number("centroid y [m]", m.centroid.y, apart);
  is.number("centroid z [m]", m.centroid.z, apart);
}

/// Name of the form that an inlet inserts.
template <class Sim>
std::string_view name_of_form([[maybe_unused]] const Sim& sim, [[maybe_unused]] std::size_t form) {
  if constexpr (Sim::of_bodies)
    if (form < sim.forms().size()) return sim.forms()[form].name;
  return {};
}

template <class Inlet, class Sim>
void describe_inlet(const Describer& is, const Inlet& inlet, const Sim& sim) {
  const auto& flow = inlet.flow;
  const auto material = [&](const std::string& name, std::size_t k) {
    is.numbered(name, k, sim.contacts().given_name(k));
  };
  const auto form = [&](const std::string& name, std::size_t k) {
    is.numbered(name, k, name_of_form(sim, k));
  };
  is("region", inlet.region), is("density [kg/m3]", flow.density), is("rate [1/s]", flow.rate);
  is("least radius [m]", flow.radius.min()), is("largest radius [m]", flow.radius.max());
  is("mean volume [m3]", flow.radius.mean_volume()), is("velocity", flow.velocity, "m/s");
  is("angular velocity", flow.angular_velocity, "rad/s"),
      is("scatter of velocity", flow.scatter, "m/s");
  is("total", flow.total), material("material", flow.material), form("form", flow.form);
  is("seed", text(flow.seed)), is("trials", flow.trials), is("interval [s]", flow.interval);
  for (std::size_t k = 1; k < flow.kinds(); ++k) {
    const InletShare kind = flow.kind(k);
    is(text("share of kind ", k), kind.share), is(text("density of kind ", k), kind.density);
    is(text("least radius of kind ", k), kind.radius.min());
    is(text("largest radius of kind ", k), kind.radius.max());
    is(text("mean volume of kind ", k), kind.radius.mean_volume());
    material(text("material of kind ", k), kind.material);
    form(text("form of kind ", k), kind.form);
  }
}

/// Motion or drive of a wall. A motion is a function and cannot be described; the pose that it
/// gives is compared instead.
inline void describe_motion(const Describer& is, const Wall& wall) {
  is("moves", wall.moves() ? "yes" : "no");
  const auto is_driven_by = [&](const char* drive) { is("is driven by", drive); };
  const auto number = [&](const char* name, double x) {  // infinite: no limit
    if (std::isfinite(x)) is(name, x);
  };
  std::visit(
      [&](const auto& d) {
        using Drive = std::remove_cvref_t<decltype(d)>;
        if constexpr (requires { d.direction; }) is("direction", d.direction, "-");
        if constexpr (requires { d.axis; }) is("axis", d.axis, "-");
        if constexpr (requires { d.centre; }) is("centre", d.centre);
        if constexpr (requires { d.mass; }) is("mass [kg]", d.mass);
        if constexpr (requires { d.force; }) is("force [N]", d.force);
        if constexpr (requires { d.torque; }) is("torque [N m]", d.torque);
        if constexpr (requires { d.stiffness; })
          is("stiffness of its spring", d.stiffness), is("damping of its dashpot", d.damping);
        if constexpr (requires { d.gain; }) is("gain [-]", d.gain);
        if constexpr (std::is_same_v<Drive, ServoForce>) {
          is_driven_by("a servo of force"), is("largest speed [m/s]", d.max_speed);
          number("largest travel [m]", d.max_travel);
        } else if constexpr (std::is_same_v<Drive, ServoTorque>) {
          is_driven_by("a servo of torque"), is("largest rate [rad/s]", d.max_rate);
          number("largest turn [rad]", d.max_turn);
        } else if constexpr (std::is_same_v<Drive, Slide>) {
          is_driven_by("loads along a slide");
        } else if constexpr (std::is_same_v<Drive, Hinge>) {
          is_driven_by("loads about a hinge"), is("inertia [kg m2]", d.inertia);
          is("centre of mass", d.centre_of_mass);
        } else if constexpr (std::is_same_v<Drive, FreeBody>) {
          is_driven_by("loads as a free body");
          is("inertia on the diagonal", Vec3d{d.inertia.xx, d.inertia.yy, d.inertia.zz}, "kg m2");
          is("products of inertia", Vec3d{d.inertia.xy, d.inertia.yz, d.inertia.zx}, "kg m2");
        }
      },
      wall.drive);
  if (!wall.has_belt()) return;
  is("surface velocity", wall.belt.velocity, "m/s"), is("its rate", wall.belt.rate, "rad/s");
  is("its centre", wall.belt.centre);
}

/// Replaces each `plain` by `named`.
[[gnu::cold]] inline void put_name(std::string& words, const std::string& plain,
                                   const std::string& named) {
  for (auto at = words.find(plain); named != plain && at != words.npos;
       at = words.find(plain, at + named.size()))
    words.replace(at, plain.size(), named);
}

/// Adds names to items such as "wall 2: ", "form 1: " and "materials 0 and 1: ".
template <class Sim>
[[gnu::cold]] std::string with_names(std::string words, const Sim& sim) {
  for (std::size_t w = 0; w < sim.walls(); ++w)
    put_name(words, text("wall ", w, ": "), sim.wall_name(w) + ": ");
  if constexpr (Sim::of_bodies)
    for (std::size_t f = 0; f < sim.forms().size(); ++f)
      put_name(words, text("form ", f, ": "), sim.form_name(f) + ": ");
  const auto& contacts = sim.contacts();
  const auto of = [&](std::size_t k) { return text(k, after_number(contacts.given_name(k))); };
  for (std::size_t a = 0; a < contacts.materials(); ++a)
    for (std::size_t b = 0; b < contacts.materials(); ++b)
      put_name(words, text("materials ", a, " and ", b, ": "),
               text("materials ", of(a), " and ", of(b), ": "));
  return words;
}

/// `removed[w]`: wall w is described as one without surfaces. Walls from `known` on are new.
template <class Sim, class Table, class Openings>
SceneDescription describe_scene(const Sim& sim, const Table& coefficients, const Openings& openings,
                                const DynArray<bool>& removed, std::size_t known) {
  using Aspect = SceneDescription::Aspect;
  SceneDescription out;
  const Describer is(out, Aspect::Scene, "");
  Describer(out, sim.walls() > known ? Aspect::NewWall : Aspect::Scene, "")("walls", sim.walls());
  Describer(out, Aspect::Inlet, "")("inlets", openings.inlets().size());
  const Describer outlet(out, Aspect::Outlet, "");
  outlet("outlets", openings.outlets().size());
  if constexpr (deforms<std::remove_cvref_t<decltype(sim.domain())>>) {
    const Box box = sim.domain().first_box();
    is("deforming box: from", box.min), is("deforming box: to", box.max);
  } else if constexpr (std::remove_cvref_t<decltype(sim.domain())>::periodic) {
    const auto of = is.of("periodic box: ");
    for (int d = 0; d < 3; ++d) {
      of(text("repeats in ", "xyz"[d]), sim.domain().repeats(d) ? "yes" : "no");
      if (sim.domain().repeats(d)) {
        const Vec3d least = sim.domain().box().min;
        of.number(text("begins in ", "xyz"[d], " [m]"),
                  d == 0   ? least.x
                  : d == 1 ? least.y
                           : least.z,
                  1e-9 * sim.domain().length(d));
        of(text("length in ", "xyz"[d], " [m]"), sim.domain().length(d));
      }
    }
  }
  if constexpr (Sim::of_bodies) {
    const std::size_t forms = added_forms(sim.engine().mover);
    is("forms", forms);
    for (std::size_t f = 0; f < forms; ++f)
      describe_form(is.of(text("form ", f, ": ")), sim.forms()[f]);
    is("bodies share the stiffness of contacts", sim.engine().share_contacts ? "yes" : "no");
  }
  describe_materials({out, Aspect::Material, ""}, coefficients);
  for (std::size_t w = 0; w < sim.walls(); ++w) {
    const Wall& wall = sim.wall(w);
    const std::string name = text("wall ", w, ": ");
    const auto as = [&](Aspect aspect) { return w < known ? aspect : Aspect::NewWall; };
    const Describer scene(out, as(Aspect::Scene), "");
    scene(name + "surfaces", removed[w] ? std::size_t{0} : wall.surfaces.size());
    Describer(out, as(Aspect::Material), name)
        .numbered("material", wall.material, sim.contacts().given_name(wall.material));
    describe_motion({out, as(Aspect::Motion), name}, wall);
    for (std::size_t s = 0; s < wall.surfaces.size() && !removed[w]; ++s)
      visit_surface(wall.surfaces[s], [&](const auto& surface) {
        describe(scene.of(wall.surfaces.size() == 1 ? name : text(name, "surface ", s, ": ")),
                 surface);
      });
  }
  for (std::size_t k = 0; k < openings.outlets().size(); ++k)
    describe(outlet.of(text("outlet ", k, ": ")), openings.outlets()[k].region);
  for (std::size_t k = 0; k < openings.inlets().size(); ++k)
    describe_inlet({out, Aspect::Inlet, text("inlet ", k, ": ")}, openings.inlets()[k], sim);
  if constexpr (requires { sim.fluid().describe(is); }) sim.fluid().describe(is.of("fluid: "));
  return out;
}

}  // namespace silt::detail
