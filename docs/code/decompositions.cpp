// silt - BSD-3-Clause, see LICENSE
// A program of docs/ranks.md: mpirun -np 4 docs_decompositions. Its points are divided between the ranks.

#include <cmath>
#include <cstdio>
#include <vector>

#include <silt/mpi.hpp>

int main(int argc, char** argv) {
  silt::Mpi mpi(argc, argv);
  const silt::MpiComm comm = mpi.comm();

  // Whatever a rank has at first: here a quarter million points in a bed, every size()-th of them.
  std::vector<silt::Vec3d> points;
  std::vector<double> work;
  for (int k = comm.rank(); k < 250000; k += comm.size()) {
    points.push_back(
        {0.1 * std::fmod(k * 0.618034, 1), 0.1 * std::fmod(k * 0.754878, 1), 1e-6 * k});
    work.push_back(1 + 0.5 * std::exp(-points.back().z / 0.05));  // more contacts below
  }

  silt::Bisection parts;
  const std::vector<int> owner = parts.partition(comm, points, work);

  // To each rank what is its own now.
  std::vector<std::vector<silt::Vec3d>> leaving(static_cast<std::size_t>(comm.size()));
  for (std::size_t k = 0; k < points.size(); ++k)
    leaving[static_cast<std::size_t>(owner[k])].push_back(points[k]);
  std::vector<silt::Outgoing> out;
  for (int r = 0; r < comm.size(); ++r)
    out.push_back({r, std::as_bytes(std::span(leaving[static_cast<std::size_t>(r)]))});
  std::vector<silt::Vec3d> mine;
  for (const silt::Arrival& message : silt::deliver(comm, out))
    for (const auto& p : silt::values_of<silt::Vec3d>(message.bytes)) mine.push_back(p);

  // A place that no point has yet.
  const int there = parts.rank_of({0.02, 0.03, 0.2});

  // What one rank refuses, all refuse.
  silt::together(comm, "a look at the points", [&] {
    for (const auto& p : mine)
      silt::require(parts.rank_of(p) == comm.rank(), "a point at ", p, " is not mine");
  });

  const double count = static_cast<double>(mine.size());
  const silt::Load load = silt::load_of(comm, count);
  if (comm.rank() == 0)
    std::printf("%.0f points on rank %d, %.0f in the mean; (0.02, 0.03, 0.2) belongs to rank %d\n",
                load.largest, load.rank, load.mean, there);
  return silt::sum(comm, count) == 250000 ? 0 : 1;
}
