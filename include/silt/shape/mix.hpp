// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <type_traits>
#include <utility>
#include <variant>

#include <silt/core/dyn_array.hpp>
#include <silt/shape/dilated_moments.hpp>
#include <silt/shape/multi_sphere.hpp>
#include <silt/shape/poly_super_ellipsoid.hpp>
#include <silt/shape/sphere.hpp>

namespace silt::inline SILT_TARGET {

namespace detail {

/// Kinds of parts of a shape, and its parts: the members of SolidShape, for all shapes.
template <class S>
struct SolidsOf {
  using Kinds = typename S::Kinds;
  static constexpr bool one_part = S::one_part;
  static auto solids(const S& form, const MassProperties& mass) { return form.solids(mass); }
};
template <>
struct SolidsOf<MultiSphere> {
  using Kinds = KindList<Ball>;
  static constexpr bool one_part = false;
  static DynArray<SolidPart<Kinds>> solids(const MultiSphere& form, const MassProperties& mass) {
    DynArray<SolidPart<Kinds>> all;
    for (const Ball& b : form.balls)
      all.push_back(
          {Ball{{0, 0, 0}, b.radius}, rotate(conjugate(mass.axes), b.centre - mass.centroid), {}});
    return all;
  }
};
template <>
struct SolidsOf<Sphere> {
  using Kinds = KindList<Ball>;
  static constexpr bool one_part = true;
  static DynArray<SolidPart<Kinds>> solids(const Sphere&, const MassProperties&) {
    return {{Ball{{0, 0, 0}, 1}, {}, {}}};
  }
};

template <class A, class B>
struct Joined;
template <class... A, class... B>
struct Joined<KindList<A...>, KindList<B...>> {
  using type = KindList<A..., B...>;
};
/// The kinds in `Order` that any of Shapes has.
template <class Order, class... Shapes>
struct KindsAmong {
  using type = KindList<>;
};
template <class First, class... Rest, class... Shapes>
struct KindsAmong<KindList<First, Rest...>, Shapes...> {
  using Here = std::conditional_t<(SolidsOf<Shapes>::Kinds::template has<First> || ...),
                                  KindList<First>, KindList<>>;
  using type = typename Joined<Here, typename KindsAmong<KindList<Rest...>, Shapes...>::type>::type;
};

}  // namespace detail

/// Several shapes in one simulation; each particle has a form of one of them.
///
///   silt::Particles<silt::Mix<silt::Sphere, silt::SuperEllipsoid, silt::Polyhedron>> grains;
///   const auto bead = grains.add_form(silt::Sphere{});
///   const auto cube = grains.add_form(silt::Polyhedron::from_points(corners));
///   grains.add({.form = bead, .position = {0, 0, 0.1}, .radius = 2e-3, .density = 2500});
///
/// Every pair of kinds of parts has its own narrow phase, chosen at compile time; pairs are
/// processed kind by kind. The form of a Sphere has a radius of 1 m; its particles give theirs.
/// Parts of MultiSpheres in a mix do not share the stiffness of a contact
/// (engine/contact/shared_contacts.hpp).
/// Tests: tests/engine/mix.cpp
/// Source: none: each pair of shapes has its own narrow phase.
/// Valid:  as its shapes.
/// Units:  SI.
/// Errors: InputError of the shapes' own check().
template <class... Shapes>
struct Mix {
  static constexpr bool is_body = true;
  using Kinds =
      typename detail::KindsAmong<KindList<Ball, SuperEllipsoid, PolySuperEllipsoid, Polyhedron>,
                                  Shapes...>::type;
  static constexpr bool one_part = (detail::SolidsOf<Shapes>::one_part && ...);

  std::variant<Shapes...> shape;

  bool operator==(const Mix&) const = default;

  template <class S>
  requires(std::is_same_v<S, Shapes> || ...) Mix(S form)  // NOLINT: implicit, any of them is one
      : shape(std::move(form)) {}

  void check() const {
    std::visit(
        [](const auto& form) {
          if constexpr (requires { form.check(); }) form.check();
        },
        shape);
  }
  MassProperties mass_properties() const {
    return std::visit(
        [](const auto& form) -> MassProperties {
          if constexpr (requires { form.mass_properties(); }) {
            return form.mass_properties();
          } else {
            const double volume = Sphere::volume(1), moment = Sphere::inertia_factor() * volume;
            return {volume, {0, 0, 0}, {moment, moment, moment}, {}};
          }
        },
        shape);
  }
  DynArray<SolidPart<Kinds>> solids(const MassProperties& mass) const {
    return std::visit(
        [&](const auto& form) {
          DynArray<SolidPart<Kinds>> all;
          for (auto& part :
               detail::SolidsOf<std::remove_cvref_t<decltype(form)>>::solids(form, mass))
            all.push_back({std::visit(
                               [](auto& solid) {
                                 return decltype(SolidPart<Kinds>::solid)(std::move(solid));
                               },
                               part.solid),
                           part.centre, part.axes});
          return all;
        },
        shape);
  }
  std::size_t kind() const { return shape.index(); }  // which of Shapes
  /// Description of the form for comparison (checkpoints): visit(name, number).
  template <class Visit>
  void describe(const Visit& visit) const {
    visit("shape", static_cast<double>(kind()));
    std::visit(
        [&](const auto& form) {
          if constexpr (requires { form.describe(visit); }) form.describe(visit);
        },
        shape);
  }
  /// The form of a Sphere has no size of its own.
  bool has_size() const {
    return std::visit(
        [](const auto& form) { return !std::is_same_v<std::decay_t<decltype(form)>, Sphere>; },
        shape);
  }
};

static_assert(SolidShape<Mix<Sphere, Polyhedron>>);

}  // namespace silt
