// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cmath>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include <silt/core/random.hpp>
#include <silt/parallel/decomposition/concept.hpp>

#include "comm_checks.hpp"

/// Clouds of points, and what every decomposition must do with them, as functions that all ranks
/// call.
namespace silt_test {

struct Cloud {
  std::vector<silt::Vec3d> points;
  std::vector<double> weights;
};

/// Numbers in [0, 1) that depend on k alone.
inline double number(std::uint64_t k) {
  k += 0x9e3779b97f4a7c15u;
  k = (k ^ (k >> 30)) * 0xbf58476d1ce4e5b9u;
  k = (k ^ (k >> 27)) * 0x94d049bb133111ebu;
  return static_cast<double>((k ^ (k >> 31)) >> 11) * 0x1p-53;
}

/// A flat bed of 0.1 x 0.02 x 0.05 m, denser below.
inline Cloud bed(std::size_t n, bool weighted) {
  Cloud c;
  for (std::uint64_t k = 0; k < n; ++k) {
    const double z = number(3 * k + 2);
    c.points.push_back({0.1 * number(3 * k) - 0.03, 0.02 * number(3 * k + 1), 0.05 * z * z});
    c.weights.push_back(weighted ? 1 + 9 * number(1000003 + k) : 1);
  }
  return c;
}

/// A lattice: thousands of points in one plane.
inline Cloud lattice(int side) {
  Cloud c;
  for (int i = 0; i < side; ++i)
    for (int j = 0; j < side; ++j)
      for (int k = 0; k < side; ++k) {
        c.points.push_back({1e-3 * i, 1e-3 * j, 1e-3 * k});
        c.weights.push_back(1);
      }
  return c;
}

/// The points that this rank has at first: every size()-th, or all on one rank.
template <silt::Communicator C>
Cloud own_part(const C& comm, const Cloud& all, int only = -1) {
  Cloud own;
  const auto n = static_cast<std::size_t>(comm.size()), r = static_cast<std::size_t>(comm.rank());
  for (std::size_t k = 0; k < all.points.size(); ++k)
    if (only < 0 ? k % n == r : comm.rank() == only)
      own.points.push_back(all.points[k]), own.weights.push_back(all.weights[k]);
  return own;
}

/// Work of each rank when all points are with their owners.
template <silt::Communicator C>
std::vector<double> work_of(const C& comm, const Cloud& own, const std::vector<int>& owner) {
  std::vector<double> mine(static_cast<std::size_t>(comm.size()), 0);
  for (std::size_t k = 0; k < owner.size(); ++k)
    mine[static_cast<std::size_t>(owner[k])] += own.weights[k];
  const auto each = silt::gather(comm, std::span<const double>(mine));
  std::vector<double> all(mine.size(), 0);
  for (int r = 0; r < comm.size(); ++r)
    for (std::size_t part = 0; part < all.size(); ++part) all[part] += each[r][part];
  return all;
}

/// Partitions, and checks what holds always: a rank for each point, one that rank_of knows as well,
/// and the same again, also where other ranks have the points. Returns the work of each rank.
template <silt::Communicator C, class D>
std::vector<double> parted(const C& comm, D& parts, const Cloud& all) {
  [[maybe_unused]] const auto before = [&] {
    if constexpr (std::copy_constructible<D>)
      return parts;
    else
      return 0;
  }();
  const auto own = own_part(comm, all);
  const auto owner = parts.partition(comm, own.points, own.weights);
  expect(owner.size() == own.points.size(), "a rank for each point");
  for (const int r : owner) expect(r >= 0 && r < comm.size(), "a rank that is there");
  if constexpr (D::by_place)
    for (std::size_t k = 0; k < owner.size(); ++k)
      expect(parts.rank_of(own.points[k]) == owner[k], "rank_of says what partition says");
  if constexpr (std::copy_constructible<D>) {
    auto again = before;
    expect(again.partition(comm, own.points, own.weights) == owner, "the same again");
    auto elsewhere = before;
    const auto gathered = own_part(comm, all, comm.size() - 1);
    (void)elsewhere.partition(comm, gathered.points, gathered.weights);
    for (std::size_t k = 0; k < owner.size(); ++k)
      expect(elsewhere.rank_of(own.points[k]) == owner[k], "wherever the points were before");
  } else {
    D first{}, second{};
    expect(first.partition(comm, own.points, own.weights) ==
               second.partition(comm, own.points, own.weights),
           "the same twice");
  }
  // All ranks know the same parts.
  for (std::size_t k = 0; k < 50; ++k) {
    const silt::Vec3d p{0.1 * number(k) - 0.03, 0.02 * number(k + 77), 0.05 * number(k + 99)};
    if constexpr (D::by_place)
      for (const int r : silt::gather_each(comm, parts.rank_of(p)))
        expect(r == parts.rank_of(p), "all ranks know who has a place");
  }
  const auto work = work_of(comm, own, owner);
  return work;
}

inline double largest(const std::vector<double>& work) {
  return *std::max_element(work.begin(), work.end());
}
inline double mean(const std::vector<double>& work) {
  double sum = 0;
  for (const double w : work) sum += w;
  return sum / static_cast<double>(work.size());
}
inline double furthest_from_mean(const std::vector<double>& work) {
  double most = 0;
  for (const double w : work) most = std::max(most, std::abs(w - mean(work)));
  return most;
}

/// Of a policy that divides any cloud: work within `points` of one point's largest weight of the
/// mean.
template <silt::Communicator C, class Make>
void divides_every_cloud(const C& comm, const Make& make, double points, std::size_t n = 3000) {
  const auto check = [&](const Cloud& cloud, double weight, const char* what) {
    auto parts = make();
    const auto work = parted(comm, parts, cloud);
    const double off = furthest_from_mean(work);
    expect(off <= points * weight * (1 + 1e-9),
           silt::text(what, " on ", comm.size(), " ranks: work ", off / weight,
                      " points from the mean, allowed ", points));
  };
  check(bed(n, false), 1, "a bed");
  check(bed(n, true), 10, "a bed with weights");
  check(lattice(12), 1, "a lattice");
  Cloud line = bed(n, false);
  for (auto& p : line.points) p.y = p.z = -0.0;
  check(line, 1, "points on a line");
  Cloud far = bed(n, true);
  for (std::size_t k = 0; k < far.points.size(); k += 2) far.points[k] = far.points[k] * 1e9;
  check(far, 10, "points at distances of many orders");
  Cloud light = bed(n, false);
  for (auto& w : light.weights) w = 1e-300;
  check(light, 1e-300, "weights near nought");
  Cloud none = bed(n, false);
  for (auto& w : none.weights) w = 0;
  {
    auto parts = make();
    const auto own = own_part(comm, none);
    const auto owner = parts.partition(comm, own.points, own.weights);
    Cloud counted = own;
    for (auto& w : counted.weights) w = 1;
    expect(furthest_from_mean(work_of(comm, counted, owner)) <= points + 1e-9,
           "points without weight are counted");
  }
}

/// Clouds that cannot be divided well: it ends all the same, and no point is lost.
template <silt::Communicator C, class Make>
void ends_on_every_cloud(const C& comm, const Make& make) {
  const auto check = [&](const Cloud& cloud, const char* what) {
    auto parts = make();
    const auto work = parted(comm, parts, cloud);
    double wanted = 0, sum = 0;
    for (const double w : cloud.weights) wanted += w;
    for (const double w : work) sum += w;
    expect(std::abs(sum - wanted) <= 1e-9 * wanted, silt::text(what, ": work was lost"));
    return work;
  };
  check({}, "no points");
  check({{{1, 2, 3}}, {5}}, "one point");
  check(bed(static_cast<std::size_t>(comm.size()) / 2, false), "fewer points than ranks");
  Cloud same;
  for (int k = 0; k < 100; ++k) same.points.push_back({0.1, -0.2, 0.3}), same.weights.push_back(1);
  expect(largest(check(same, "100 points at one place")) == 100, "one rank has them all");
  Cloud two = same;
  for (std::size_t k = 0; k < 60; ++k) two.points[k].y = 0.7;
  const double most = largest(check(two, "points at two places"));
  // Zoltan divides even points at one place, but a place tells one rank: there all may go to one.
  if constexpr (std::copy_constructible<decltype(make())>)
    expect(most == (comm.size() == 1 ? 100 : 60), "two places");
  Cloud heavy = bed(200, false);
  heavy.weights[17] = 1e12;
  check(heavy, "one point with nearly all weight");
  Cloud some = bed(500, false);
  for (std::size_t k = 0; k < some.weights.size(); k += 3) some.weights[k] = 0;
  check(some, "weights of nought");
}

template <silt::Communicator C, class Make>
void refuses_wrong_input(const C& comm, const Make& make) {
  const bool last = comm.rank() == comm.size() - 1;
  const std::string who = comm.size() > 1
                              ? silt::text("rank ", comm.size() - 1, " of ", comm.size(), ": ")
                              : std::string();
  const auto refused = [&](std::vector<double> weights) {
    auto parts = make();
    const std::vector<silt::Vec3d> points(3, silt::Vec3d{1, 2, 3});
    return said([&] { (void)parts.partition(comm, points, weights); });
  };
  // One rank's input is refused on all, in one sentence.
  expect_words(refused(last ? std::vector<double>{1, -2, 1} : std::vector<double>{1, 1, 1}),
               who + "partition: weight 1 = -2 [-] must be finite and not negative");
  expect_words(refused(last ? std::vector<double>{1, 1, INFINITY} : std::vector<double>{1, 1, 1}),
               who + "partition: weight 2 = inf [-] must be finite");
  expect_words(refused(last ? std::vector<double>{1} : std::vector<double>{1, 1, 1}),
               who + "partition: 3 points and 1 weights; each point has one");
  // A point that is nowhere stays with its rank.
  auto parts = make();
  const std::vector<silt::Vec3d> points{{0, 0, 0}, {NAN, 0, 0}, {1, 1, 1}};
  const auto owner = parts.partition(comm, points, std::vector<double>{1, 5, 1});
  expect(owner[1] == comm.rank(), "a point that is not finite stays");
}

}  // namespace silt_test
