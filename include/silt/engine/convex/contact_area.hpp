// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include <silt/engine/contact/contact_stage.hpp>
#include <silt/shape/narrow/contact_spread.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Friction and damping of a contact that has an area: the law acts at three points of it.
///
/// The overlap of two bodies is one number, and its gradient gives one normal force. Alone they do
/// not resist a block spinning on its face or rocking on it. So the contact force is distributed
/// over three points p_k of the area, each with a third of the normal force, its own sliding
/// velocity, overlap rate and history:
///
///   p_k = p + a sqrt(2) C^(1/2) u_k,  u_k = cos(2 pi k/3) t + sin(2 pi k/3) n x t             (1)
///   force = 1/3 sum_k F(overlap, rate at p_k, slip at p_k, history k), each acting at p_k      (2)
///
/// C is the covariance of the contact region perpendicular to the normal n (SolidContact::spread),
/// t a direction that rotates with the contact. As sum u_k = 0 and sum 2 u_k u_k^T / 3 = 1, the
/// points have the mean p and the covariance a^2 C; the elastic force equals that of one point at
/// p, so a law without losses still conserves energy. Contacts of edges have their points on a
/// line; for corners and round bodies all three are at p.
///
/// Friction: Coulomb's torque against spinning is mu F times the mean distance of the p_k from p.
/// With a = 0.9372 it equals that of a uniform pressure on a square, 0.3826 of its edge. On a
/// disc it is 0.6 % low; on a rectangle, averaged over the rotations of t, at most 2.6 % low; the
/// worst error is 10 %, for one orientation of t on a very long rectangle.
///
/// Where bodies stick: as a face tilts by a fraction of its depth, p moves across the face, and the
/// factor g between displacements and overlaps, with which velocities and forces of the law are
/// multiplied (SolidContact), changes by a third. A tangential spring that followed them would be
/// loaded in one state and unloaded in another. A static friction force that shifts with the normal
/// force is no potential's either: a block that rolls sideways was turned by it. Blocks on steep
/// slopes rocked and walked down without sliding, and gained energy on the way. So the tangential
/// forces act at p' and take g', which stand still in the contact's frame as long as friction does
/// not slide, and follow p and g where it does. Otherwise they follow slowly, and where the bodies
/// roll on each other, by |w x r| dt in a step, as soon as that is a hundredth of the region's
/// size d. (In proportion to |w x r| cubes that rock on rough ground would not come to rest.)
///
///   dp'/dt = (p - p') (1/(100 s) + (100 |w x r|/d)^2 dt),  s = sqrt(m overlap/F);  g' the same (3)
///
/// p' is kept relative to the middle between both centres (at a wall, to the centre); |r|^2 is the
/// mean of both. Laws whose coefficients have neither `friction` nor `mu`
/// do not tell whether they slide: p' = p, g' = g.
///
/// Damping: with c = the law's dashpot, rocking with angular velocity w is resisted by the torque
/// a^2 c C w; its ratio to critical damping is nearly that of the normal motion.
///
/// Source: silt's own. Tests: tests/engine/contact_area.cpp.
inline constexpr std::size_t area_points = 3;
inline constexpr double area_factor = 0.93717;  // a

/// Positions of the points of a contact: the direction t, and a sqrt(2) C^(1/2) in the frame of t
/// and n x t. Stored with the contact from step to step.
template <class Real>
struct AreaFrame {
  Vec3<Real> way;            // [-] t; 0 in a new contact
  Real along, both, across;  // [m] components of the square root

  /// Rotates with the contact by `turn` [rad] and stays perpendicular to n.
  SILT_INLINE void turn_with(const Vec3<Real>& n, const Vec3<Real>& turn) {
    way = way + cross(turn, way);
    way = way - dot(way, n) * n;
    way = way * (Real(1) / sqrt(max(dot(way, way), smallest<Real>())));
  }
  SILT_INLINE auto is_new() const { return !(dot(way, way) > Real(0.5)); }
  /// The frame of a new contact: along the longer side of its region, in the direction in which
  /// `toward` leans, else in that of `velocity`. (Three points are not the same turned by half a
  /// turn. By a convention of space the losses of a scene would depend on how it lies in space.)
  SILT_INLINE void begin(const Spread<Real>& spread, const Vec3<Real>& n, const Vec3<Real>& toward,
                         const Vec3<Real>& velocity) {
    const Real zero(0), half(0.5), tiny = smallest<Real>();
    Vec3<Real> s, t;
    tangents(n, s, t);
    const Vec3<Real> of_s = spread.times(s);
    const Real ss = dot(s, of_s), st = dot(t, of_s), tt = dot(t, spread.times(t));
    const Real less = half * (ss - tt), size = sqrt(less * less + st * st);
    const auto longer_s = !(less < zero);  // of the two forms, the one without cancellation
    const Real along_s = select(longer_s, size + less, st),
               along_t = select(longer_s, st, size - less);
    const Real square = along_s * along_s + along_t * along_t;
    const auto is_round = !(square > Real(1e-20) * (ss + tt) * (ss + tt) + tiny);
    const Vec3<Real> longest = (along_s * s + along_t * t) * (Real(1) / sqrt(max(square, tiny)));
    const Vec3<Real> leans = toward - dot(toward, n) * n, slips = velocity - dot(velocity, n) * n;
    const Real least = Real(1e-12) * dot(toward, toward), lean = dot(longest, leans);
    const Real sense = select(lean * lean > least, lean, dot(longest, slips));
    const Vec3<Real> any =
        select(dot(leans, leans) > least, leans, select(dot(slips, slips) > tiny, slips, s));
    const Vec3<Real> found =
        select(is_round, any * (Real(1) / sqrt(max(dot(any, any), tiny))),
               select(sense < zero, Vec3<Real>{-longest.x, -longest.y, -longest.z}, longest));
    way = select(is_new(), found, way);
  }
  /// The root of [a b; b c] is (it + sqrt(det) 1)/sqrt(trace + 2 sqrt(det)). A region as small as
  /// rounding may have any numbers: b is bounded such that the root exists.
  template <class Mask>
  SILT_INLINE void set_root(const Spread<Real>& spread, const Vec3<Real>& n, const Mask& where) {
    const Real zero(0), tiny = smallest<Real>();
    const Vec3<Real> beside = cross(n, way), of_way = spread.times(way);
    const Real a = max(dot(way, of_way), zero), c = max(dot(beside, spread.times(beside)), zero);
    const Real most = sqrt(a * c), b = min(max(dot(beside, of_way), -most), most);
    const Real root = sqrt(max(a * c - b * b, zero));
    const Real scale = Real(std::sqrt(2.0) * area_factor) / sqrt(max(a + c + Real(2) * root, tiny));
    along = select(where, scale * (a + root), along), both = select(where, scale * b, both);
    across = select(where, scale * (c + root), across);
  }
  /// [m] relative to the contact point.
  SILT_INLINE std::array<Vec3<Real>, area_points> arms(const Vec3<Real>& n) const {
    const Vec3<Real> beside = cross(n, way), first = along * way + both * beside;
    const Vec3<Real> second = Real(std::sqrt(0.75)) * (both * way + across * beside);
    return {first, second - Real(0.5) * first, -Real(0.5) * first - second};
  }
};

/// What the tangential forces of a contact keep from step to step: (3).
template <class Real>
struct SlipFrame {
  Real gradient;       // [-] g'; 0 in a new contact
  Real along, beside;  // [m] p' from the centre of i, in the frame of AreaFrame

  static SILT_INLINE SlipFrame at(double* const* from) {
    return {load<Real>(from[0]), load<Real>(from[1]), load<Real>(from[2])};
  }
  SILT_INLINE void keep(double* const* to) const {
    store(to[0], gradient), store(to[1], along), store(to[2], beside);
  }
  SILT_INLINE void follow(const SlipFrame& now, const Real& share) {
    gradient += share * (now.gradient - gradient);
    along += share * (now.along - along), beside += share * (now.beside - beside);
  }
};

/// Where the tangential forces of a contact act in a step.
template <class Real>
struct SlipPoint {
  SlipFrame<Real> now, held;  // of the contact point; of p'
  Vec3<Real> off;             // [m] p' - p
  Real scale;                 // [-] g'/g
  Vec3<Real> middle;          // [-] the normal at the time of the velocities

  /// Velocity times g [m/s] for the law: `v` at p, its part across the normal at p' times g'/g.
  SILT_INLINE Vec3<Real> velocity(const Vec3<Real>& v, const Vec3<Real>& spin) const {
    const Vec3<Real> slip = scale * (v + cross(spin, off));
    return dot(v, middle) * middle + slip - dot(slip, middle) * middle;
  }
};

/// Input of the points of N contacts, and their resulting loads.
template <std::size_t N>
struct AreaBlock {
  alignas(64) double spread[6][N];  // [m2] of SolidContact
  alignas(64) double spin[3][N];    // [rad/s] of i relative to the partner, times the gradient
  alignas(64) double moment[3][N];  // [N m] of the points' forces about the contact point

  template <class Real>
  SILT_INLINE void put_spread(std::size_t k, const Spread<Real>& s) {
    const Real values[6] = {s.xx, s.yy, s.zz, s.xy, s.yz, s.zx};
    for (std::size_t c = 0; c < 6; ++c) store(spread[c] + k, values[c]);
  }
  void put_spread(std::size_t k, const Symmetric3& s) {
    put_spread(k, Spread<double>{s.xx, s.yy, s.zz, s.xy, s.yz, s.zx});
  }
  template <class Real>
  SILT_INLINE Spread<Real> get_spread(std::size_t k) const {
    return {load<Real>(spread[0] + k), load<Real>(spread[1] + k), load<Real>(spread[2] + k),
            load<Real>(spread[3] + k), load<Real>(spread[4] + k), load<Real>(spread[5] + k)};
  }
  template <class Real>
  SILT_INLINE void put_spin(std::size_t k, const Vec3<Real>& w) {
    store(spin[0] + k, w.x), store(spin[1] + k, w.y), store(spin[2] + k, w.z);
  }
  template <class Real>
  SILT_INLINE Vec3<Real> get_moment(std::size_t k) const {
    return load3<Real>(moment[0] + k, moment[1] + k, moment[2] + k);
  }
};

/// Evaluates contacts that have an area: the law at its points (ContactStage). The loads of the
/// block are sums over the points.
template <std::size_t N>
struct AtAreaPoints {
  AreaBlock<N>& area;
  bool renew;  // recompute all points from the spread; else only those of new contacts
  std::array<const double*, 3> levers;     // [m] of the points from the centres of i
  const double* gradients = nullptr;       // of SolidContact, or null if all are 1
  std::array<const double*, 3> between{};  // [m] from the centres of i to those of j; at walls null

  template <class ContactsType, class Arch, class Block, std::size_t H, class Losses>
  SILT_INLINE void loads(Block& block, std::size_t count, const StepTimes& times,
                         const CoefficientTable<ContactsType>& table, const std::uint16_t* kinds,
                         const std::array<double*, H>& history,
                         RunningTally<ContactsType, typename Lanes<Arch, double>::Real>& tally,
                         [[maybe_unused]] Losses& losses) const {
    using Real = typename Lanes<Arch, double>::Real;
    using Kernel = ContactKernel<ContactsType, Real>;
    constexpr std::size_t W = Lanes<Arch, double>::width, of_one = ContactsType::point_history;
    const Real step(times.step), lag(times.lag), part(1.0 / double{area_points});
    const Vec3<Real> none{Real(0), Real(0), Real(0)};
    ContactCoefficients<ContactsType, Real> coefficients(table);
    for (std::size_t k = 0; k < count; k += W) {
      if (kinds != nullptr) coefficients.choose(kinds + k);
      const Kinematics<Real> kin = block.template get<Real>(k);
      const auto radii = block.template get_radii<Real>(k);
      const auto touches = kin.overlap > Real(0);
      const Vec3<Real> spin = load3<Real>(area.spin[0] + k, area.spin[1] + k, area.spin[2] + k);
      double* frame[ContactsType::area_numbers];
      for (std::size_t h = 0; h < ContactsType::area_numbers; ++h)
        frame[h] = history[ContactsType::frame_from + h] + k;
      start_points<ContactsType, Real>(history, frame, k);
      const auto arms = arms_of(kin, touches, step, k, frame);

      SlipPoint<Real> slip = slip_point(kin, spin, touches, step, lag, k, frame);

      Vec3<Real> force = none, moment = none, across = none;
      const auto add = [&]<std::size_t P>() {
        const Vec3<Real> arm = select(touches, arms[P], none);
        Kinematics<Real> here = kin;
        here.velocity = slip.velocity(kin.velocity + cross(spin, arm), spin);
        std::array<double*, of_one + 1> own{};
        for (std::size_t h = 0; h < of_one; ++h)
          own[h] = history[ContactsType::history_of(P) + h] + k;
        const Vec3<Real> f = Kernel::load(here, {}, radii, step, lag, times.ask, coefficients.law(),
                                          coefficients.rolling(), own.data(), tally, part)
                                 .force;
        const Vec3<Real> pressing = dot(f, kin.normal) * kin.normal,
                         holding = slip.scale * (f - pressing);
        force += pressing + holding, across += holding;
        moment += cross(arm, pressing) + cross(arm + slip.off, holding);
      };
      losses.begin(tally.lanes);
      add.template operator()<0>();
      const auto safeguards = tally.sum.safeguards;  // counts contacts, not points
      add.template operator()<1>(), add.template operator()<2>();
      tally.sum.safeguards = safeguards;
      losses.end(k, times, tally.lanes);
      slip.held.follow(slip.now, slides(kin, coefficients.law(), slip.scale, dot(force, kin.normal),
                                        across, step));
      slip.held.gradient = select(touches, slip.held.gradient, Real(0));
      slip.held.keep(frame + 6);
      if constexpr (keeps_events<ContactsType>)
        watch<ContactsType>(kin, touches, force, moment, spin, history, times, k, tally.sum.notes);
      block.template put_load<Real>(k, {force, none, none});
      store(area.moment[0] + k, moment.x), store(area.moment[1] + k, moment.y);
      store(area.moment[2] + k, moment.z);
    }
  }
  /// See tell_parts(): the sum over the points.
  template <class ContactsType, std::size_t H>
  void tell(const Contact<double>& c, const typename ContactsType::LawCoefficients& p,
            const std::array<double*, H>& history, std::size_t k, RecordedContact& to) const {
    const Vec3d before = to.spring;
    for (std::size_t point = 0; point < area_points; ++point) {
      std::array<double*, ContactsType::point_history + 1> own{};
      for (std::size_t h = 0; h < ContactsType::point_history; ++h)
        own[h] = history[ContactsType::history_of(point) + h] + k;
      tell_parts<ContactsType>(c, p, own.data(), 1.0 / double{area_points}, to);
    }
    const double held = history[ContactsType::frame_from + 6][k];
    if (gradients != nullptr && held > 0)
      to.spring = before + (held / gradients[k]) * (to.spring - before);
  }

 private:
  template <class Real, class Touches>
  SILT_INLINE SlipPoint<Real> slip_point(const Kinematics<Real>& kin, const Vec3<Real>& spin,
                                         const Touches& touches, const Real& step, const Real& lag,
                                         std::size_t k, double* const* frame) const {
    const Real g = gradients != nullptr ? silt::load<Real>(gradients + k) : Real(1);
    const Vec3<Real> way = load3<Real>(frame[0], frame[1], frame[2]),
                     beside = cross(kin.normal, way);
    // From the middle between both centres, so that i may be either.
    Vec3<Real> lever = load3<Real>(levers[0] + k, levers[1] + k, levers[2] + k);
    Real lever2 = dot(lever, lever);
    if (between[0] != nullptr) {
      const Vec3<Real> d = load3<Real>(between[0] + k, between[1] + k, between[2] + k),
                       of_j = lever - d;
      lever2 = Real(0.5) * (lever2 + dot(of_j, of_j)), lever = lever - Real(0.5) * d;
    }
    const SlipFrame<Real> now{g, dot(lever, way), dot(lever, beside)};
    SlipFrame<Real> held = SlipFrame<Real>::at(frame + 6);
    held.follow(now, select(held.gradient > Real(0), rolls(spin, lever2, kin.normal, frame, step),
                            Real(1)));
    const Vec3<Real> off = (held.along - now.along) * way + (held.beside - now.beside) * beside;
    return {now, held, select(touches, off, {Real(0), Real(0), Real(0)}), held.gradient / g,
            kin.normal - lag * kin.change};
  }
  /// [-] share by which the points of friction follow in this step, (3): where bodies roll, and
  /// otherwise; 1 where they slide.
  template <class Real>
  static SILT_INLINE Real rolls(const Vec3<Real>& spin, const Real& lever2, const Vec3<Real>& n,
                                double* const* area, const Real& step) {
    const Vec3<Real> tilts = spin - dot(spin, n) * n;
    const Real a = load<Real>(area[3]), b = load<Real>(area[4]), c = load<Real>(area[5]);
    const Real way =
        dot(tilts, tilts) * lever2 / max(a * a + Real(2) * b * b + c * c, smallest<Real>());
    return min(Real(1e4) * step * step * way, Real(1));
  }
  template <class Real, class Coefficients>
  static SILT_INLINE Real slides(const Kinematics<Real>& kin, const Coefficients& of,
                                 const Real& scale, const Real& force, const Vec3<Real>& across,
                                 const Real& step) {
    if constexpr (requires { of.body.friction; }) {
      return slides(kin, of.body, scale, force, across, step);
    } else if constexpr (
        requires { of.friction; } || requires { of.mu; }) {
      const Real friction = [&of] {
        if constexpr (requires { of.friction; })
          return of.friction;
        else
          return of.mu;
      }();
      const Real pressing = max(force, Real(0)), limit = Real(0.98) * friction * scale * pressing;
      const Real rate = sqrt(pressing * kin.inverse_m_eff / max(kin.overlap, smallest<Real>()));
      return select(dot(across, across) < limit * limit, min(Real(0.01) * step * rate, Real(1)),
                    Real(1));
    } else {
      return Real(1);
    }
  }
  /// A contact that had one point, among ellipsoids alone, continues with its history at each.
  template <class ContactsType, class Real, std::size_t H>
  static SILT_INLINE void start_points(const std::array<double*, H>& history, double* const* at,
                                       std::size_t k) {
    const Vec3<Real> way = load3<Real>(at[0], at[1], at[2]);
    const auto is_new = !(dot(way, way) > Real(0.5));
    if (!any(is_new)) return;
    for (std::size_t h = 0; h < ContactsType::point_history; ++h)
      for (std::size_t point = 1; point < area_points; ++point) {
        double* const own = history[ContactsType::history_of(point) + h] + k;
        store(own, select(is_new, load<Real>(history[h] + k), load<Real>(own)));
      }
  }
  /// The arms of a pack's points; stores their frames, one pointer per component.
  template <class Real, class Touches>
  SILT_INLINE auto arms_of(const Kinematics<Real>& kin, const Touches& touches, const Real& step,
                           std::size_t k, double* const* at) const {
    AreaFrame<Real> frame{load3<Real>(at[0], at[1], at[2]), load<Real>(at[3]), load<Real>(at[4]),
                          load<Real>(at[5])};
    const auto is_new = frame.is_new();
    frame.turn_with(kin.normal, cross(kin.normal, kin.change) + (step * kin.twist) * kin.normal);
    if (renew || any(is_new && touches)) {
      const Spread<Real> spread = area.template get_spread<Real>(k);
      if (any(is_new)) {
        Vec3<Real> toward = load3<Real>(levers[0] + k, levers[1] + k, levers[2] + k);
        if (between[0] != nullptr)  // the sum of both levers, so that i may be either
          toward += toward - load3<Real>(between[0] + k, between[1] + k, between[2] + k);
        frame.begin(spread, kin.normal, toward, kin.velocity);
      }
      frame.set_root(spread, kin.normal, is_new || Mask<Real>(renew));
    }
    const Vec3<Real> way = select(touches, frame.way, {Real(0), Real(0), Real(0)});
    store(at[0], way.x), store(at[1], way.y), store(at[2], way.z);
    store(at[3], select(touches, frame.along, Real(0)));
    store(at[4], select(touches, frame.both, Real(0)));
    store(at[5], select(touches, frame.across, Real(0)));
    return frame.arms(kin.normal);
  }

  template <class ContactsType, class Real, class Touches, std::size_t H>
  SILT_INLINE void watch(const Kinematics<Real>& kin, const Touches& touches,
                         const Vec3<Real>& force, const Vec3<Real>& moment, const Vec3<Real>& spin,
                         const std::array<double*, H>& history, const StepTimes& times,
                         std::size_t k, ContactNotes& notes) const {
    using Watch = ContactWatch<ContactsType, Real>;
    std::array<double*, ContactsType::event_numbers> kept;
    for (std::size_t h = 0; h < kept.size(); ++h)
      kept[h] = history[ContactsType::events_from + h] + k;
    if (!Watch::is_due(kin, touches, kept[WatchedNumbers::begin], times)) return;
    const Vec3<Real> none{Real(0), Real(0), Real(0)};
    const PairLoad<Real> load{force, none, none};
    if (gradients != nullptr)
      Watch::template step<true>(kin, touches, load, moment, spin, kept.data(), times, k, notes,
                                 silt::load<Real>(gradients + k));
    else
      Watch::template step<false>(kin, touches, load, moment, spin, kept.data(), times, k, notes);
  }
};
template <std::size_t N>
AtAreaPoints(AreaBlock<N>&, bool, std::array<const double*, 3>, const double*) -> AtAreaPoints<N>;
template <std::size_t N>
AtAreaPoints(AreaBlock<N>&, bool, std::array<const double*, 3>, const double*,
             std::array<const double*, 3>) -> AtAreaPoints<N>;

}  // namespace silt::detail
