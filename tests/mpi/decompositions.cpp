// silt - BSD-3-Clause, see LICENSE
// What ranks.sh runs on several ranks: the checks of tests/parallel/clouds.hpp by MPI, and Zoltan's
// decompositions.

#include <cstdio>

#include <silt/mpi.hpp>

#include "../parallel/clouds.hpp"

namespace {

using silt_test::expect;

void without_zoltan(const silt::MpiComm& comm) {
  silt_test::divides_every_cloud(
      comm, [] { return silt::Bisection{}; }, 1.14, 800);
  silt_test::divides_every_cloud(
      comm, [] { return silt::MovingSlabs{.axis = 0}; }, 1, 800);
  const auto ends = [&](const auto& make) {
    silt_test::ends_on_every_cloud(comm, make);
    silt_test::refuses_wrong_input(comm, make);
  };
  ends([] { return silt::Bisection{}; });
  ends([] { return silt::MovingSlabs{}; });
  ends([] { return silt::StaticSlabs{.axis = 1}; });
}

#if __has_include(<zoltan.h>)

/// Points that rank_of sends from each rank to another; and how far off the mean work is.
void rcb(const silt::MpiComm& comm) {
  const auto make = [] { return silt::Rcb{}; };
  silt_test::ends_on_every_cloud(comm, make);
  silt_test::refuses_wrong_input(comm, make);
  const auto check = [&](const silt_test::Cloud& cloud, double weight, const char* what) {
    silt::Rcb parts;
    silt::Bisection own;
    const auto work = silt_test::parted(comm, parts, cloud);
    const auto ours = silt_test::parted(comm, own, cloud);
    const double mean = silt_test::mean(work);
    if (comm.rank() == 0)
      std::printf("%s: largest over mean work %.5f, Bisection %.5f\n", what,
                  silt_test::largest(work) / mean, silt_test::largest(ours) / mean);
    // Zoltan stops within its tolerance at each of the log2(ranks) levels, or with one point too
    // much.
    const double levels = std::ceil(std::log2(comm.size()));
    expect(silt_test::largest(work) <= mean * std::pow(parts.tolerance, levels) + 2.5 * weight,
           silt::text(what, ": Zoltan's work ", silt_test::largest(work), " of ", mean));
  };
  check(silt_test::bed(3000, false), 1, "a bed");
  check(silt_test::bed(3000, true), 10, "a bed with weights");
  check(silt_test::lattice(14), 1, "a lattice");
  expect(silt::Rcb{}.rank_of({1, 2, 3}) == 0, "before there were points");
  // Points that have hardly moved stay where they are.
  auto cloud = silt_test::bed(3000, false);
  silt::Rcb parts;
  const auto mine = silt_test::own_part(comm, cloud);
  (void)parts.partition(comm, mine.points, mine.weights);
  silt_test::Cloud own;
  for (const auto& p : cloud.points)
    if (parts.rank_of(p) == comm.rank())
      own.points.push_back(p + silt::Vec3d{1e-5, 0, 0}), own.weights.push_back(1);
  std::int64_t moved = 0;
  for (const int r : parts.partition(comm, own.points, own.weights)) moved += r != comm.rank();
  comm.sum_of({&moved, 1});
  if (comm.rank() == 0) std::printf("moved at a second partition: %ld\n", static_cast<long>(moved));
  expect(moved < 60, "few points move");
  silt_test::expect_words(
      silt_test::said([&] { silt::Rcb{.tolerance = 0.5}.partition(comm, {}, {}); }),
      "Rcb.tolerance = 0.5 [-] must be finite and at least 1");
}

/// How many points must be copied to other ranks, if each reaches as far as `reach`.
template <class D>
std::int64_t ghosts(const silt::MpiComm& comm, const D& parts, const silt_test::Cloud& cloud,
                    double reach) {
  std::int64_t copies = 0;
  const auto own = silt_test::own_part(comm, cloud);
  for (const auto& p : own.points) {
    std::vector<int> others;
    for (const double x : {-reach, 0.0, reach})
      for (const double y : {-reach, 0.0, reach})
        for (const double z : {-reach, 0.0, reach})
          others.push_back(parts.rank_of(p + silt::Vec3d{x, y, z}));
    std::sort(others.begin(), others.end());
    others.erase(std::unique(others.begin(), others.end()), others.end());
    copies += static_cast<std::int64_t>(others.size()) - 1;
  }
  comm.sum_of({&copies, 1});
  return copies;
}

void hypergraph(const silt::MpiComm& comm) {
  const auto make = [] { return silt::Hypergraph{}; };
  silt_test::ends_on_every_cloud(comm, make);
  silt_test::refuses_wrong_input(comm, make);
  const auto check = [&](const silt_test::Cloud& cloud, const char* what) {
    silt::Hypergraph parts;
    silt::Bisection own;
    silt::StaticSlabs slabs{.axis = 2};
    const auto work = silt_test::parted(comm, parts, cloud);
    silt_test::parted(comm, own, cloud);
    silt_test::parted(comm, slabs, cloud);
    const double reach = 0.5 * parts.grid.side, mean = silt_test::mean(work);
    const auto copies = ghosts(comm, parts, cloud, reach), boxes = ghosts(comm, own, cloud, reach),
               layers = ghosts(comm, slabs, cloud, reach);
    std::int64_t most = 0, all = 0;
    for (const auto& c : parts.cells) most = std::max(most, c.work), all += c.work;
    const double largest_cell =
        static_cast<double>(most) / static_cast<double>(all) * static_cast<double>(comm.size());
    const double imbalance = silt_test::largest(work) / mean;
    if (comm.rank() == 0)
      std::printf(
          "%s: %zu cells, largest over mean work %.4f (largest cell %.4f); ghosts %ld, Bisection "
          "%ld, slabs %ld\n",
          what, parts.cells.size(), imbalance, largest_cell, static_cast<long>(copies),
          static_cast<long>(boxes), static_cast<long>(layers));
    expect(imbalance <= parts.tolerance + largest_cell, silt::text(what, ": work ", imbalance));
    if (comm.size() > 3) expect(copies < layers, "fewer ghosts than between layers");
  };
  check(silt_test::bed(20000, false), "a bed");
  check(silt_test::bed(20000, true), "a bed with weights");
  check(silt_test::lattice(24), "a lattice");
  // What has hardly moved stays; where one rank's work grows it gives some away, and little else
  // moves.
  auto cloud = silt_test::bed(20000, false);
  silt::Hypergraph parts;
  const auto mine = silt_test::own_part(comm, cloud);
  (void)parts.partition(comm, mine.points, mine.weights);
  const auto moved = [&](double weight) {
    silt_test::Cloud own;
    for (const auto& p : cloud.points)
      if (parts.rank_of(p) == comm.rank()) {
        own.points.push_back(p + silt::Vec3d{1e-5, 0, 0});
        own.weights.push_back(comm.rank() == 0 ? weight : 1);
      }
    const auto owner = parts.partition(comm, own.points, own.weights);
    std::int64_t changed = 0;
    for (const int r : owner) changed += r != comm.rank();
    comm.sum_of({&changed, 1});
    const auto work = silt_test::work_of(comm, own, owner);
    const double imbalance = silt_test::largest(work) / silt_test::mean(work);
    if (comm.rank() == 0)
      std::printf("moved where rank 0 has %.1f times the work: %ld of 20000, imbalance %.4f\n",
                  weight, static_cast<long>(changed), imbalance);
    expect(imbalance < 1.1, "balance after a change");
    return changed;
  };
  expect(moved(1) < 200, "few points move");
  expect(comm.size() == 1 || (moved(1.5) > 200 && moved(1) < 8000), "some points move");
  expect(silt::Hypergraph{}.rank_of({1, 2, 3}) == 0, "before there were points");
  // Places where no point was: outside, and above the bed.
  for (const silt::Vec3d p : {silt::Vec3d{-1, 5, 0}, {1, 1, 1}, {0, 0, -7}, {0.05, 0.01, 0.0499}})
    for (const int r : silt::gather_each(comm, parts.rank_of(p)))
      expect(r == parts.rank_of(p) && r >= 0 && r < comm.size(), "a place without points");
  using silt_test::expect_words;
  using silt_test::said;
  expect_words(said([&] { silt::Hypergraph{.cell = -1}.partition(comm, {}, {}); }),
               "Hypergraph.cell = -1 [m] must be finite and not negative");
  expect_words(said([&] { silt::Hypergraph{.cells_a_rank = 0}.partition(comm, {}, {}); }),
               "Hypergraph.cells_a_rank = 0 [-] must be finite and at least 1");
  expect_words(said([&] { silt::Hypergraph{.tolerance = 0}.partition(comm, {}, {}); }),
               "Hypergraph.tolerance = 0 [-] must be finite and at least 1");
  expect_words(said([&] { silt::Hypergraph{.ghosts_a_move = 0}.partition(comm, {}, {}); }),
               "Hypergraph.ghosts_a_move = 0 [-] must be finite and greater than 0");
}

#endif

}  // namespace

int main(int argc, char** argv) {
  silt::Mpi mpi(argc, argv);
  without_zoltan(mpi.comm());
#if __has_include(<zoltan.h>)
  rcb(mpi.comm());
  hypergraph(mpi.comm());
#else
  if (mpi.rank() == 0) std::puts("without Zoltan");
#endif
  if (mpi.rank() == 0) std::puts("fine");
}
