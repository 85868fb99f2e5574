// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include <silt/boundary/deforming_box.hpp>
#include <silt/engine/contact/contact_fluxes.hpp>
#include <silt/engine/contact/load_rows.hpp>
#include <silt/engine/contact/offset.hpp>
#include <silt/engine/convex/convex_touch.hpp>
#include <silt/engine/convex/pair_kinds.hpp>
#include <silt/engine/lists/pair_list.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Computes the loads of all pairs of convex parts. The lists contain pairs of bounding spheres;
/// each of these stages passes on only pairs that it cannot prove to be apart, again in whole
/// packs, with pairs of the same two kinds together (an incomplete pack waits for the next pairs):
///   the last gap, less the approach possible since; bounding spheres; separation along the last
///   normal (least_gap()); contact (touch()); law; loads.
/// In a pair of two kinds the first one in KindList is i, else the particle with the lower id.
/// Behind the law's history a pair stores NormalMemory, whose last value is R_eff during contact,
/// and minus a lower bound of the gap otherwise.
template <class Rows, class ContactsType, class Domain, class Arch, class Fluxes = NoFluxes>
class ConvexPairs {
  using Real = typename Lanes<Arch>::Real;
  using List = PairList<ContactsType::history, double, history_in_rows<ContactsType>>;
  using Gather = ConvexGather<Rows, Arch>;
  using Kept = KeptGather<List, ContactsType, Arch>;
  using Kinds = typename Rows::Kinds;
  static constexpr std::size_t W = Lanes<Arch>::width;
  using PairKinds = detail::PairKinds<Kinds::count>;
  static constexpr std::size_t scan = 128, slice = 64;  // pairs of the list, contacts at a time
  static constexpr std::size_t chunks = 2, row = 4 * chunks;
  static constexpr std::size_t H = ContactsType::history, M = ContactsType::memory_from,
                               events = numbers_before_events<ContactsType>,
                               radius = ContactsType::memory_radius,
                               more = radius + 1;  // further history values
  static_assert(load_chunks<ContactsType> == chunks,
                "rolling resistance is of spheres and of bodies made of spheres: the shape of "
                "others resists rolling itself");
  static_assert(!ActsAtDistance<typename ContactsType::Law>,
                "laws that act at a distance are for spheres and bodies made of spheres");
  /// For polyhedra, overlap is not a depth: see SolidContact.
  using Touch = ConvexTouch<Rows, ContactsType, List, slice, Arch>;
  using Slice = typename Touch::Slice;
  using Some = SomePairs<scan + slice + W, W>;
  template <std::size_t A, std::size_t B>
  static constexpr bool has_gradient =
      std::is_same_v<typename Rows::template KindAt<A>, Polyhedron>&& A == B;

 public:
  using Input = ConvexInput<Rows>;

  /// Adds the load of every pair to the sums of its bodies: force, and torque about the centre.
  static Tally<ContactsType> run(const Input& in, List& list,
                                 const CoefficientTable<ContactsType>& table, const Domain& domain,
                                 double* sums, const Team& team, Fluxes* fluxes = nullptr) {
    return sum_over_groups<Tally<ContactsType>>(list, team, [&](std::size_t from, std::size_t to) {
      return run_group({in, list, table, domain, sums, fluxes}, from, to);
    });
  }

 private:
  struct Scene {
    const Input& in;
    List& list;
    const CoefficientTable<ContactsType>& table;
    const Domain& domain;
    double* sums;
    Fluxes* fluxes;  // of modules, if there are any
  };

  using Stage = ContactStage<ContactsType, Arch, double, Fluxes>;
  /// The contacts of a slice.
  struct Ends {
    static constexpr bool at_wall = false;
    const Scene& scene;
    const Some& open;
    const Slice& c;
    std::size_t from;
    bool gradient, area;  // which of them these contacts have
    std::uint32_t first(std::size_t k) const { return open.i[from + k]; }
    std::uint32_t second(std::size_t k) const { return open.j[from + k]; }
    std::uint32_t order(std::size_t k) const { return open.place[from + k]; }
    /// As add_loads().
    void finish(std::size_t k, RecordedContact& one, RecordedTurn& turn) const {
      const auto at = [k](const auto& columns) {
        return Vec3d{columns[0][k], columns[1][k], columns[2][k]};
      };
      turn.arm = at(c.arm_i);
      if (gradient) {
        const double g = c.gradient[k];
        one.force *= g, one.spring *= g, one.cohesion *= g;
        turn.couple_i = (c.couple[k] * dot(one.force, one.normal)) * one.normal;
      }
      if (area) turn.couple_i += (gradient ? c.gradient[k] : 1.0) * at(c.area.moment);
      turn.couple_j = -turn.couple_i;
    }
    void where(std::size_t k, NotedContact& note) const {
      const auto at = [](const auto& columns, std::size_t n) {
        return Vec3d{columns[0][n], columns[1][n], columns[2][n]};
      };
      const Vec3d arm = at(c.arm_i, k);
      note.event.point = scene.in.positions[first(k)].centre() + arm;
      if (!note.ended) return;
      // Bodies that have separated may have neither normal nor point.
      if (c.followed[k] != 0) note.event.normal = -at(c.last, k);
      if (norm(arm) > 0) return;
      const double size_i = scene.in.rows->pose[first(k)].least_radius,
                   size_j = scene.in.rows->pose[second(k)].least_radius;
      note.event.point += (size_i / (size_i + size_j)) * at(open.between, from + k);
    }
  };

  /// By the kinds of i and j.
  struct ByKind {
    Some of[PairKinds::count];
    void add(const Scene& scene, std::size_t k, const double (&x)[3][W], std::size_t lane) {
      const std::uint32_t a = scene.list.first()[k], b = scene.list.second()[k];
      const std::size_t p = scene.in.rows->kind_of(a), q = scene.in.rows->kind_of(b);
      if (p <= q)
        of[PairKinds::at(p, q)].add(static_cast<std::uint32_t>(k), a, b, x, lane);
      else
        of[PairKinds::at(q, p)].add(static_cast<std::uint32_t>(k), b, a, x, lane, -1);
    }
  };

  static Tally<ContactsType> run_group(const Scene& scene, std::size_t from, std::size_t to) {
    RunningTally<ContactsType, Real> tally;
    ByKind near, open;
    for (; from < to; from += scan) {
      sort_out(scene, from, std::min(scan, to - from), near, open, tally.sum);
      const bool last = from + scan >= to;
      PairKinds::for_all([&]<std::size_t A, std::size_t B>() {
        run_kinds<A, B>(scene, near.of[PairKinds::at(A, B)], open.of[PairKinds::at(A, B)], last,
                        tally);
      });
    }
    return tally.end();
  }
  /// Processes full packs or, at the end, all that remain.
  template <std::size_t A, std::size_t B>
  static void run_kinds(const Scene& scene, Some& near, Some& open, bool last,
                        RunningTally<ContactsType, Real>& tally) {
    if (near.count + open.count == 0) return;
    const auto run = [&](auto e) {
      constexpr Exponents E = decltype(e)::value;
      const std::size_t whole = last ? near.count : near.count / W * W;
      if (last) near.pad();
      prove_apart<A, B, E>(scene, near, whole, open, tally.sum);
      near.drop(whole);
      std::size_t k = 0;
      for (; open.count - k >= slice; k += slice)
        run_contacts<A, B, E>(scene, open, k, slice, tally);
      if (last && k < open.count) {
        open.pad();
        run_contacts<A, B, E>(scene, open, k, open.count - k, tally);
        k = open.count;
      }
      open.drop(k);
    };
    if constexpr (Kinds::count == 1 && Touch::template in_lanes<A, B>)
      with_exponents(scene.in.rows->exponents, run);
    else  // not every kernel for every pair of kinds: that would take long to compile
      run(std::integral_constant<Exponents, Exponents::Any>{});
  }

  /// Sorts pairs: those that touched are `open`; of the others, those whose gap may have closed and
  /// whose bounding spheres overlap are `near`.
  static void sort_out(const Scene& scene, std::size_t from, std::size_t count, ByKind& near,
                       ByKind& open, Tally<ContactsType>& tally);

  /// Of the near pairs, those that the last normal does not prove to be apart.
  template <std::size_t A, std::size_t B, Exponents E>
  static void prove_apart(const Scene& scene, const Some& near, std::size_t count, Some& open,
                          Tally<ContactsType>& tally);

  /// Stores the gap [m] of a pair that does not touch; clears its history if it did before.
  static void part(const Scene& scene, std::size_t place, double gap, bool touched,
                   Tally<ContactsType>& tally);

  /// Upper bound of the closing speed [m/s] of each pair.
  static SILT_INLINE Real approach(const Input& in, const std::uint32_t* a,
                                   const std::uint32_t* b) {
    alignas(64) double sum[W];
    const double* const pace = in.rows->pace.data();
    for (std::size_t lane = 0; lane < W; ++lane) sum[lane] = pace[a[lane]] + pace[b[lane]];
    return load<Real>(sum);
  }
  /// The angular velocity is that at the end of a step; earlier in the step that of a free body may
  /// have been slightly larger.
  static constexpr double gap_slack = 1.1;

  template <std::size_t A, std::size_t B, Exponents E>
  static void run_contacts(const Scene& scene, const Some& open, std::size_t from,
                           std::size_t count, RunningTally<ContactsType, Real>& tally) {
    constexpr bool has_area = Touch::template has_area<A, B, E>;
    Slice c;
    const std::size_t padded = pieces(count, W) * W;
    const std::uint32_t* const place = open.place + from;
    Touch::template run<A, B, E>(scene.in, scene.list, open, from, count, c);
    scatter(c.history[radius], place, count, scene.list.history(radius));
    for (std::size_t h = more; h < H; ++h)
      for (std::size_t k = 0; k < count; ++k) c.history[h][k] = scene.list.history(h)[place[k]];
    for (std::size_t h = 0; h < H; ++h)  // no contacts
      std::fill(c.history[h] + count, c.history[h] + padded, 0.0);
    Real share(tally.sum.largest);
    for (std::size_t k = 0; k < padded; k += W)
      complete<has_gradient<A, B>, has_area>(scene, open, from, k, c, share);
    alignas(64) double shares[W];
    store(shares, share);
    tally.sum.largest = *std::max_element(shares, shares + W);
    if constexpr (ContactsType::several_materials)
      for (std::size_t k = 0; k < padded; ++k) c.kind[k] = scene.in.kinds[place[k]];
    std::array<double*, H + 1> history{};
    for (std::size_t h = 0; h < H; ++h) history[h] = c.history[h];
    const std::uint16_t* const kinds = ContactsType::several_materials ? c.kind : nullptr;
    const Stage stage{scene.in.times, scene.table, scene.fluxes};
    const Ends ends{scene, open, c, from, has_gradient<A, B>, has_area};
    if constexpr (has_area)
      stage.run(
          c.kinematics, count, kinds, history, ends, tally,
          AtAreaPoints{c.area,
                       !Touch::template in_lanes<A, B> || scene.in.times.renew_areas,
                       {c.arm_i[0], c.arm_i[1], c.arm_i[2]},
                       has_gradient<A, B> ? c.gradient : nullptr,
                       {open.between[0] + from, open.between[1] + from, open.between[2] + from}});
    else
      stage.run(c.kinematics, count, kinds, history, ends, tally, AtOnePoint<double>{});
    for (std::size_t h = more; h < H; ++h)
      scatter(c.history[h], place, count, scene.list.history(h));
    for (std::size_t k = 0; k < padded; k += W)
      Kept::template keep<has_area>(scene.list, place + k, std::min(W, count - k), c.history, k);
    add_loads<has_gradient<A, B>, has_area>(scene, open, from, count, c, tally.sum);
  }
  /// [m/s] additional velocity of the images of j in a box that deforms.
  static Vec3<Real> carried(const Scene& scene, const Some& open, std::size_t k) {
    alignas(64) double shift[3][W];
    for (std::size_t lane = 0; lane < W; ++lane) {
      const Vec3d whole = scene.in.positions[open.j[k + lane]].centre() -
                          scene.in.positions[open.i[k + lane]].centre();
      shift[0][lane] = open.between[0][k + lane] - whole.x;
      shift[1][lane] = open.between[1][k + lane] - whole.y;
      shift[2][lane] = open.between[2][k + lane] - whole.z;
    }
    return scene.domain.carried(load3<Real>(shift[0], shift[1], shift[2]));
  }

  /// Contacts k and following, whose geometry is in the slice.
  template <bool HasGradient, bool HasArea>
  static SILT_INLINE void complete(const Scene& scene, const Some& open, std::size_t from,
                                   std::size_t k, Slice& c, Real& share) {
    const auto& in = scene.in;
    BodyAtContact<Real> i, j;
    Real thin_i, thin_j;
    Gather::body_pack(in, open.i + from + k, i, thin_i);
    Gather::body_pack(in, open.j + from + k, j, thin_j);
    if constexpr (!Rows::has_levers) {
      i.axes = Gather::axes_pack(in, open.i + from + k);
      j.axes = Gather::axes_pack(in, open.j + from + k);
    }
    const auto at = [&](const double(&v)[3][slice]) {
      return load3<Real>(v[0] + k, v[1] + k, v[2] + k);
    };
    auto& kept = c.kinematics;
    const Real zero(0), step(in.times.step), followed = load<Real>(c.followed + k);
    const auto touches = load<Real>(c.history[radius] + k) > zero;
    const Vec3<Real> n = at(kept.normal), arm_i = at(c.arm_i), last = at(c.last);
    const Vec3<Real> arm_j = arm_i - open.template between_at<Real>(from + k);
    Kinematics<Real> kin;
    kin.normal = n;
    kin.velocity = i.velocity_at(arm_i) - j.velocity_at(arm_j);
    if constexpr (deforms<Domain>) kin.velocity -= carried(scene, open, from + k);
    // The direction of the last step is stored in the axes of one body, which has rotated since.
    const Vec3<Real> turned = step * cross(select(followed > zero, i.spin, j.spin), last);
    kin.change = select(followed != zero, n + last - turned, {zero, zero, zero});
    kin.overlap = select(touches, load<Real>(kept.overlap + k), Real(-1));
    if constexpr (keeps_offset<ContactsType>)
      kin.overlap = without_offset(kin.overlap, c.history[ContactsType::offset_from] + k);
    if constexpr (HasGradient) {
      // The overlap rate and the force both carry the factor `gradient`.
      const Real g = load<Real>(c.gradient + k), couple = load<Real>(c.couple + k);
      kin.velocity += (couple * dot(i.spin - j.spin, n)) * n;
      kin.velocity = g * kin.velocity;
      kin.inverse_m_eff =
          max(g * g * (i.inverse_mass(arm_i, n, couple) + j.inverse_mass(arm_j, n, couple)),
              smallest<Real>());
    } else {
      kin.inverse_m_eff = i.inverse_mass(arm_i, n) + j.inverse_mass(arm_j, n);
    }
    kin.m_eff = Real(1) / kin.inverse_m_eff;
    kin.R_eff = load<Real>(kept.R_eff + k);
    kin.arm = zero, kin.spin = {zero, zero, zero};
    kin.twist = Real(0.5) * dot(i.spin + j.spin, n);
    kept.put(k, kin);
    if constexpr (HasArea) {
      Vec3<Real> spin = i.spin - j.spin;
      if constexpr (HasGradient) spin = load<Real>(c.gradient + k) * spin;
      c.area.put_spin(k, spin);
    }
    kept.put(k, Radii<Real>{Real(2) * kin.R_eff, Real(2) * kin.R_eff});
    share = max(share, select(touches, kin.overlap, zero) / min(thin_i, thin_j));
  }

  /// Adds force and torques of the contacts to the sums of both bodies.
  template <bool HasGradient, bool HasArea>
  static void add_loads(const Scene& scene, const Some& open, std::size_t from, std::size_t count,
                        const Slice& c, [[maybe_unused]] Tally<ContactsType>& tally) {
    alignas(64) double on_i[slice * row], on_j[slice * row];
    for (std::size_t k = 0; k < count; k += W) {
      Vec3<Real> force = c.kinematics.template get_load<Real>(k).force, couple{};
      if constexpr (HasGradient) {
        const Vec3<Real> n = c.kinematics.template get<Real>(k).normal;
        force = load<Real>(c.gradient + k) * force;
        couple = (load<Real>(c.couple + k) * dot(force, n)) * n;
      }
      const Vec3<Real> arm = load3<Real>(c.arm_i[0] + k, c.arm_i[1] + k, c.arm_i[2] + k);
      if constexpr (HasArea) {
        const Vec3<Real> moment = c.area.template get_moment<Real>(k);
        couple += HasGradient ? load<Real>(c.gradient + k) * moment : moment;
      }
      const auto turning = [&](const Vec3<Real>& a) {
        return HasGradient || HasArea ? cross(a, force) + couple : cross(a, force);
      };
      const PairLoad<Real> i{force, turning(arm), {}};
      const PairLoad<Real> j{-force, -turning(arm - open.template between_at<Real>(from + k)), {}};
      write_rows<chunks, Arch, Real>(on_i + k * row, i);
      write_rows<chunks, Arch, Real>(on_j + k * row, j);
    }
    for (std::size_t k = 0; k < count; ++k) {
      add_row<Arch, chunks, false>(scene.sums + open.i[from + k] * row, on_i + k * row);
      add_row<Arch, chunks, false>(scene.sums + open.j[from + k] * row, on_j + k * row);
      if constexpr (sums_virial<ContactsType>) {
        const Vec3d on_first{on_i[k * row], on_i[k * row + 1], on_i[k * row + 2]},
            between{open.between[0][from + k], open.between[1][from + k],
                    open.between[2][from + k]};
        tally.virial = tally.virial - upper_outer(on_first, between);
      }
    }
  }
};

}  // namespace silt::detail

#include <silt/engine/convex/pairs_apart.hpp>
