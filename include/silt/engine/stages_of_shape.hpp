// silt - BSD-3-Clause, see LICENSE
#pragma once

// Which pipelines compute the contacts of a shape, and what these store.

#include <silt/engine/contact/shape_inertia.hpp>
#include <silt/engine/contact/shared_contacts.hpp>
#include <silt/engine/convex/convex_pairs.hpp>
#include <silt/engine/convex/convex_walls.hpp>
#include <silt/engine/spheres/wall_pipeline.hpp>
#include <silt/engine/state/composition.hpp>

namespace silt::inline SILT_TARGET::detail {

template <class ShapeType, class Contacts>
struct ContactsOf {
  using type = Contacts;
};
template <Shape ShapeType, class Contacts>
requires(!std::is_same_v<ShapeType, Sphere>) struct ContactsOf<ShapeType, Contacts> {
  using type = OfShape<Contacts, ShapeType>;
};
template <BodyShape ShapeType, class Contacts>
struct ContactsOf<ShapeType, Contacts> {
  using type = WithShares<Contacts>;
};
template <SolidShape ShapeType, class Contacts>
struct ContactsOf<ShapeType, Contacts> {
  using type = WithNormals<Contacts, points_of_contacts<typename ShapeType::Kinds>>;
};

/// Selected by whether bodies have convex parts. `Repeats`: walls repeat with a periodic box.
template <bool Convex>
struct WallStageOf {
  template <class, class ContactsType, class Arch, class Scalar, class Fluxes, bool Repeats>
  using type = WallPipeline<ContactsType, Arch, Scalar, Fluxes, Repeats>;
};
template <>
struct WallStageOf<true> {
  template <class ShapeType, class ContactsType, class Arch, class, class Fluxes, bool Repeats>
  using type =
      ConvexWalls<typename ConvexRowsOf<ShapeType>::type, ContactsType, Arch, Fluxes, Repeats>;
};

}  // namespace silt::detail
