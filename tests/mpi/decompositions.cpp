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

#endif

}  // namespace

int main(int argc, char** argv) {
  silt::Mpi mpi(argc, argv);
  without_zoltan(mpi.comm());
#if __has_include(<zoltan.h>)
  rcb(mpi.comm());
#else
  if (mpi.rank() == 0) std::puts("without Zoltan");
#endif
  if (mpi.rank() == 0) std::puts("fine");
}
