// silt - BSD-3-Clause, see LICENSE
// A user's program for many processes: how many are there?
#include <silt/mpi.hpp>

int main(int argc, char** argv) {
  silt::Mpi mpi(argc, argv);
  std::int64_t one[] = {1};
  mpi.comm().sum_of(one);
  return one[0] == mpi.size() ? 0 : 1;
}
