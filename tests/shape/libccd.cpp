// silt - BSD-3-Clause, see LICENSE
//
// Every pair of kinds of bodies against libccd: SILT_TEST_PAIRS=100000 for so many pairs of each.

#include "solids.hpp"

#if defined(SILT_TEST_CCD)
#include <ccd/ccd.h>

#include <variant>

#include "pair_count.hpp"

namespace libccd_test {

using namespace solids;
using silt::touch_solids;

namespace {

using Solid = std::variant<PlacedBall, Super, PolySuper, PlacedPolyhedron>;

/// A convex part in the frame of its body, and unit normals in the middle of its faces, edges and
/// corners.
struct Part {
  std::variant<double, silt::SuperForm<double>, silt::PolyForm<double>, Polyhedron> form;
  Vec3d centre{0, 0, 0};

  Solid at(const Vec3d& x, const Quaternion& q) const {
    const Vec3d c = x + rotate(q, centre);
    return std::visit(
        [&](const auto& f) -> Solid {
          using F = std::decay_t<decltype(f)>;
          if constexpr (std::is_same_v<F, double>)
            return PlacedBall{f, c};
          else if constexpr (std::is_same_v<F, Polyhedron>)
            return PlacedPolyhedron{&f, {c, q}};
          else
            return silt::PlacedSuper<F>{f, body_axes(q), c};
        },
        form);
  }
};
struct Body {
  std::vector<Part> parts;
  std::array<std::vector<Vec3d>, 3> features;
};
struct Placed {
  std::vector<Solid> parts;
};
Placed place(const Body& body, const Vec3d& x, const Quaternion& q) {
  Placed out;
  for (const auto& p : body.parts) out.parts.push_back(p.at(x, q));
  return out;
}

Vec3d farthest_of(const Solid& body, const Vec3d& n) {
  return std::visit([&](const auto& b) { return farthest(b, n); }, body);
}
Vec3d farthest_of(const Placed& body, const Vec3d& n) {
  Vec3d best = farthest_of(body.parts[0], n);
  for (const auto& p : body.parts)
    if (const Vec3d x = farthest_of(p, n); dot(n, x) > dot(n, best)) best = x;
  return best;
}
double depth_of(const Solid& i, const Solid& j, const Vec3d& m) {
  return dot(m, farthest_of(i, m) - farthest_of(j, -m));
}

// ---- kinds --------------------------------------------------------------------------------------

/// Of a body with its faces on the axes: faces, edges and corners of a box.
std::array<std::vector<Vec3d>, 3> of_a_box() {
  std::array<std::vector<Vec3d>, 3> out;
  for (int x = -1; x <= 1; ++x)
    for (int y = -1; y <= 1; ++y)
      for (int z = -1; z <= 1; ++z)
        if (const int n = x * x + y * y + z * z; n > 0)
          out[static_cast<std::size_t>(n - 1)].push_back(
              normalised(Vec3d{1.0 * x, 1.0 * y, 1.0 * z}));
  return out;
}

Body ball(Random& random) { return {{{random.uniform(0.3, 0.5)}}, of_a_box()}; }
/// Two to five balls, each of which reaches into the first.
Body balls(Random& random) {
  Body out{{{random.uniform(0.2, 0.3)}}, of_a_box()};
  for (double more = random.uniform(1, 5); more > 1; --more)
    out.parts.push_back({random.uniform(0.05, 0.3), 0.25 * random.direction()});
  return out;
}
/// Exponents s and s, 2 and s or s and 2; aspect ratios up to 3.
template <int s>
Body super(Random& random) {
  const auto axis = [&] { return std::pow(3, random.uniform(0, 1)); };
  silt::SuperEllipsoid shape{axis(), axis(), axis(), s, s};
  if (const double which = random.uniform(0, 1); which > 0.5)
    (which > 0.75 ? shape.s1 : shape.s2) = 2;
  const double scale = 0.4 / shape.equal_volume_radius();
  shape.a *= scale, shape.b *= scale, shape.c *= scale;
  return {{{form_of(shape)}}, of_a_box()};
}
Body poly_super(Random& random) {
  const auto side = [&] { return random.uniform(0.2, 0.5); };
  const auto exponent = [&] { return std::pow(2, random.uniform(1, 3)); };
  const Vec3d plus{side(), side(), side()}, minus{side(), side(), side()};
  const silt::PolySuperEllipsoid shape{plus, minus, exponent(), exponent()};
  return {{{form_of(shape)}}, of_a_box()};
}
/// Hulls of 4 to 150 points, and boxes.
Body polyhedron_of(const Polyhedron& shape) {
  Body out{{{shape}}, {}};
  for (const auto& f : shape.faces()) out.features[0].push_back(f.normal);
  for (const auto& e : shape.edges())
    out.features[1].push_back(
        normalised(shape.faces()[e.left].normal + shape.faces()[e.right].normal));
  std::vector<Vec3d> sum(shape.vertices().size(), Vec3d{0, 0, 0});
  for (const auto& f : shape.faces())
    for (const auto v : shape.loop(f)) sum[v] += f.normal;
  for (const auto& s : sum) out.features[2].push_back(normalised(s));
  return out;
}
Polyhedron any_hull(Random& random) {
  const double which = random.uniform(0, 1);
  const auto side = [&] { return random.uniform(0.3, 0.9); };
  if (which < 0.3) return shape_test::box({side(), side(), side()});
  return random.hull(which > 0.95 ? 150 : static_cast<int>(random.uniform(4, 30)));
}
Body polyhedron(Random& random) { return polyhedron_of(any_hull(random)); }
Body dilated(Random& random) {
  const auto core = any_hull(random);
  return polyhedron_of(Polyhedron::from_points(core.vertices(), random.uniform(0.01, 0.1)));
}

struct Kind {
  std::string name;
  Body (*make)(Random&);
};
const Kind kinds[] = {{"ball", ball},
                      {"balls", balls},
                      {"super s = 2", super<2>},
                      {"super 4", super<4>},
                      {"super 8", super<8>},
                      {"poly-super", poly_super},
                      {"polyhedron", polyhedron},
                      {"dilated", dilated}};

// ---- pairs --------------------------------------------------------------------------------------

/// Turns unit a to unit b.
Quaternion from_to(const Vec3d& a, const Vec3d& b) {
  const Vec3d axis = cross(a, b);
  const double sine = norm(axis);
  if (sine > 1e-12) return silt::rotation_about(axis * (1 / sine), std::atan2(sine, dot(a, b)));
  if (dot(a, b) > 0) return {};
  Vec3d s, t;
  silt::tangents(a, s, t);
  return silt::rotation_about(s, shape_test::pi);
}

/// Anywhere; a little apart or overlapping along a random direction; deep; and a face, an edge or a
/// corner of one towards one of the other, up to a tilt, shifted sideways or not.
std::pair<Placed, Placed> arrange(int way, const Body& a, const Body& b, Random& random) {
  const auto turn = random.turn();
  const auto i = place(a, {0, 0, 0}, turn);
  if (way == 0) return {i, place(b, random.in_cube(0.8), random.turn())};
  if (way == 1) return {i, place(b, 0.1 * random.direction(), random.turn())};
  const auto log_uniform = [&](double low, double high) {
    return low * std::pow(high / low, random.uniform(0, 1));
  };
  Vec3d towards = random.direction(), shift{0, 0, 0};
  Quaternion turn_j = random.turn();
  if (way > 2) {
    const auto pick = [&](const std::vector<Vec3d>& from) {
      return from[static_cast<std::size_t>(random.uniform(0, 0.999999) *
                                           static_cast<double>(from.size()))];
    };
    const auto one_of = [&] { return static_cast<std::size_t>(random.uniform(0, 2.999999)); };
    // Both of one sort every other time.
    const std::size_t sort = static_cast<std::size_t>(way - 3);
    const Vec3d of_a = pick(a.features[sort]);
    const Vec3d of_b = pick(b.features[random.uniform() < 0.5 ? sort : one_of()]);
    towards = rotate(turn, of_a);
    turn_j = from_to(rotate(turn, of_b), -towards) * turn;
    if (random.uniform() < 0.5)
      turn_j = silt::rotation_about(towards, random.uniform(0, 2 * shape_test::pi)) * turn_j;
    if (random.uniform() < 0.5)
      turn_j = silt::rotation_about(random.direction(), log_uniform(1e-7, 1e-2)) * turn_j;
    if (random.uniform() < 0.5)
      shift = random.uniform(0, 0.3) * normalised(cross(towards, random.direction()));
  }
  const double depth = log_uniform(1e-5, 0.05) * (random.uniform() < 0.3 ? -1 : 1);
  const auto j = place(b, {0, 0, 0}, turn_j);
  return {i, place(b, farthest_of(i, towards) - farthest_of(j, -towards) - depth * towards + shift,
                   turn_j)};
}

// ---- libccd -------------------------------------------------------------------------------------

/// Its expanding polytope may go on forever: after so many supports it gets a point inside, which
/// ends it.
constexpr int most_supports = 5000;
int supports = 0;

void ccd_support(const void* object, const ccd_vec3_t* dir, ccd_vec3_t* out) {
  if (++supports > most_supports) return ccdVec3Set(out, 0, 0, 0);
  const Vec3d n = normalised(Vec3d{dir->v[0], dir->v[1], dir->v[2]});
  const Vec3d p = farthest_of(*static_cast<const Solid*>(object), n);
  ccdVec3Set(out, p.x, p.y, p.z);
}
/// The polytope is good to the root of the tolerance, 3e-5 m; a finer one ends less often.
ccd_t settings() {
  ccd_t out;
  CCD_INIT(&out);
  out.support1 = out.support2 = ccd_support;
  out.max_iterations = 500, out.epa_tolerance = 1e-9;
  return out;
}

/// The least of F over the normals of faces of two polyhedra and of planes through an edge of each:
/// how deep, if they are sharp. [m]
double depth_by_axes(const PlacedPolyhedron& i, const PlacedPolyhedron& j) {
  double least = 9;
  const auto look = [&](const Vec3d& m) { least = std::min(least, depth_along(i, j, m)); };
  for (const auto& f : i.shape->faces()) look(i.pose.turn * f.normal);
  for (const auto& f : j.shape->faces()) look(-(j.pose.turn * f.normal));
  const auto along = [](const PlacedPolyhedron& body, const Polyhedron::Edge& e) {
    return body.pose.turn * (body.shape->vertices()[e.to] - body.shape->vertices()[e.from]);
  };
  for (const auto& e : i.shape->edges())
    for (const auto& f : j.shape->edges()) {
      const Vec3d m = cross(along(i, e), along(j, f));
      if (norm(m) < 1e-12) continue;
      look(normalised(m)), look(-normalised(m));
    }
  return least;
}

/// The least of F near the directions given, or over all: an upper bound of how deep. [m]
double settled_depth(const Solid& i, const Solid& j, std::vector<Vec3d> starts) {
  double least = std::visit([](const auto& a, const auto& b) { return least_depth(a, b); }, i, j);
  const auto *a = std::get_if<PlacedPolyhedron>(&i), *b = std::get_if<PlacedPolyhedron>(&j);
  if (a && b) least = std::min(least, depth_by_axes(*a, *b));
  for (Vec3d best : starts) {
    double found = depth_of(i, j, best);
    for (double step = 0.01; step > 1e-9;) {
      Vec3d s, t, to = best;
      silt::tangents(best, s, t);
      for (int k = 0; k < 16; ++k) {
        const double phi = 0.39269908169872414 * k;
        const Vec3d m = normalised(best + s * (step * std::cos(phi)) + t * (step * std::sin(phi)));
        if (const double d = depth_of(i, j, m); d < found) found = d, to = m;
      }
      if (to == best)
        step *= 0.5;
      else
        best = to;
    }
    least = std::min(least, found);
  }
  return least;
}

struct Found {
  int pairs = 0, touching = 0, differ = 0, wrong = 0;  // on touching; wrong: silt
  int depths = 0, gave_up = 0, missed = 0;             // libccd's
  int off = 0, above = 0, deep = 0, deep_above = 0;    // silt's
  int arched = 0, arch_off = 0;                        // by faces, and beyond their bounds
  double worst = 0, shallowest = 9;                    // [m] above; of deep ones above

  void add(const Found& o) {
    pairs += o.pairs, touching += o.touching, differ += o.differ, wrong += o.wrong;
    depths += o.depths, gave_up += o.gave_up, missed += o.missed;
    arched += o.arched, arch_off += o.arch_off;
    off += o.off, above += o.above, deep += o.deep, deep_above += o.deep_above;
    worst = std::max(worst, o.worst), shallowest = std::min(shallowest, o.shallowest);
  }
};

constexpr double tolerance = 1e-9;  // [m] of a depth, of bodies of size 1
constexpr double shallow = 0.1;     // [m]: a quarter of their radius, deeper than contacts are

/// One convex part on another. Bodies that only one of the two says touch are judged by support
/// functions alone: apart if any direction parts them.
void compare(const Solid& i, const Solid& j, const ccd_t& ccd, Found& found) {
  NormalMemory<double> memory;
  auto [overlap, normal] = std::visit(
      [&](const auto& a, const auto& b) {
        const auto c = touch_solids(a, b, memory);
        return std::pair{c.overlap, c.normal};
      },
      i, j);
  supports = 0;
  const bool touch = overlap > 0, said = ccdGJKIntersect(&i, &j, &ccd) != 0;
  ++found.pairs, found.touching += touch;
  if (touch != said) {
    ++found.differ;
    std::vector<Vec3d> starts;
    if (touch) starts.push_back(-normal);
    if (memory.follows != 0)
      starts.push_back(
          std::visit([&](const auto& a,
                         const auto& b) { return silt::detail::last_direction_of(a, b, memory); },
                     i, j));
    const double depth = settled_depth(i, j, starts);
    found.wrong += std::abs(depth) > tolerance && touch != (depth > 0);
  }
  if (!touch) return;
  // Of sharp polyhedra the overlap is a thickness, of nearly parallel faces of dilated ones an
  // arched depth, which is the depth to 1.25 times it (face_patch.hpp (1), r <= rho); what is
  // compared is the way out.
  const auto *a = std::get_if<PlacedPolyhedron>(&i), *b = std::get_if<PlacedPolyhedron>(&j);
  if (a && b && a->shape->radius() == 0 && b->shape->radius() == 0) {
    const auto gjk = silt::gjk_distance(*a, *b, Vec3d{0, 0, 0});
    if (!gjk.overlapping) return;
    const auto deep = penetration(*a, *b, gjk);
    overlap = deep.depth, normal = deep.normal;
  } else if (a && b) {
    NormalMemory<double> none;
    const auto c = silt::detail::touch_dilated(*a, *b, normal, none);
    found.arched += overlap > c.overlap + tolerance;
    found.arch_off +=
        !(overlap >= c.overlap - tolerance && overlap <= 1.25 * c.overlap + tolerance);
    overlap = c.overlap, normal = c.normal;
  }
  // So the overlap is no less than the least depth, but for what the normal is uncertain by, 3e-7
  // (turn_tolerance), times levers of up to 0.5 m on an edge or face ...
  found.off += std::abs(depth_of(i, j, -normal) - overlap) > 1.5e-7;
  supports = 0;
  ccd_real_t depth;
  ccd_vec3_t direction, position;
  if (ccdGJKPenetration(&i, &j, &ccd, &depth, &direction, &position) != 0 ||
      supports > most_supports) {
    ++found.gave_up;
    return;
  }
  // ... and here no more than along the way out that libccd found.
  const Vec3d m = normalised(Vec3d{direction.v[0], direction.v[1], direction.v[2]});
  if (!silt::is_finite(m)) return;
  ++found.depths;
  const double way = std::min(depth_of(i, j, m), depth_of(i, j, -m)), more = overlap - way;
  if (overlap > shallow) {
    ++found.deep;
    if (more > 1e-6) ++found.deep_above, found.shallowest = std::min(found.shallowest, overlap);
    return;
  }
  found.above += more > tolerance;
  found.worst = std::max(found.worst, more);
  found.missed += std::abs(depth - overlap) > 1e-4;
}

}  // namespace

TEST_CASE("libccd: every pair of kinds: what touches, and how deep") {
  constexpr std::size_t of_each = 100;
  const int count = pairs::count(120);
  const auto ccd = settings();
  Random random(1);
  std::vector<std::vector<Body>> bodies;
  for (const auto& kind : kinds) {
    bodies.emplace_back();
    for (std::size_t k = 0; k < of_each; ++k) bodies.back().push_back(kind.make(random));
  }
  const auto any = [&](std::size_t kind) -> const Body& {
    return bodies[kind][static_cast<std::size_t>(random.uniform(0, 0.999999 * of_each))];
  };
  Found all;
  for (std::size_t one = 0; one < std::size(kinds); ++one)
    for (std::size_t other = one; other < std::size(kinds); ++other) {
      Found found;
      for (int k = 0; k < count; ++k) {
        const bool swapped = k / 6 % 2 == 1;
        const auto [i, j] =
            arrange(k % 6, any(swapped ? other : one), any(swapped ? one : other), random);
        for (const auto& part_i : i.parts)
          for (const auto& part_j : j.parts) compare(part_i, part_j, ccd, found);
      }
      INFO(kinds[one].name, " and ", kinds[other].name);
      const bool smooth = one < 6 && other < 6;
      if (count > 120)
        MESSAGE(kinds[one].name, " and ", kinds[other].name, ": ", found.pairs, " pairs, ",
                found.touching, " touch, ", found.differ, " differ, ", found.wrong, " wrong here; ",
                found.depths, " depths, ", found.gave_up, " given up, ", found.missed,
                " missed there; ", found.off, " off, ", found.above, " above (", found.worst,
                " m), ", found.deep_above, " of ", found.deep,
                " deep ones above, the least of them ", found.shallowest, " m");
      CHECK(found.touching > found.pairs / 10);
      CHECK(found.wrong == 0);
      CHECK(found.arch_off == 0);
      CHECK(found.off == 0);
      CHECK(found.above == 0);
      CHECK(found.missed <= 2 + found.depths / 100);
      // Smooth bodies deep in each other: a minimum from the line of centres, not the least of all.
      if (!smooth) CHECK(found.deep_above <= found.deep / 100);
      all.add(found);
    }
  CHECK(all.arched >= 5);  // so that the bounds are tried
  MESSAGE("libccd: ", all.differ, " of ", all.pairs, " pairs differ on touching, ", all.wrong,
          " of them wrong here; of ", all.depths, " depths ", all.missed, " missed there, ",
          all.above, " above here, at most ", all.worst, " m; of ", all.deep, " deep ones ",
          all.deep_above, " above, the least of them ", all.shallowest, " m");
}

}  // namespace libccd_test
#endif
