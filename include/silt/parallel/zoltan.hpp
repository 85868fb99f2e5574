// silt - BSD-3-Clause, see LICENSE
#pragma once

#if !__has_include(<zoltan.h>)
#error "this header needs Zoltan (Debian: apt-get install libtrilinos-zoltan-dev); link silt::mpi"
#endif
#include <silt/parallel/mpi_comm.hpp>
//
#include <zoltan.h>

#include <cstddef>
#include <exception>
#include <memory>
#include <string>

namespace silt::inline SILT_TARGET::detail {

/// Throws if a Zoltan call has failed.
inline void check_zoltan(int code, const char* call) {
  require(code == ZOLTAN_OK || code == ZOLTAN_WARN, call, " of Zoltan has failed (",
          code == ZOLTAN_MEMERR ? "there is not enough memory" : "it has told why", ')');
}

struct DestroyZoltan {
  void operator()(Zoltan_Struct* zoltan) const {
    int ended = 0;
    MPI_Finalized(&ended);
    // All ranks must reach this call; a rank that is unwinding an exception may be alone.
    if (ended == 0 && std::uncaught_exceptions() == 0) Zoltan_Destroy(&zoltan);
  }
};

/// A Zoltan data structure, created by all ranks together.
class ZoltanHandle {
 public:
  Zoltan_Struct* get() const { return zoltan_.get(); }
  explicit operator bool() const { return zoltan_ != nullptr; }

  /// Collective.
  void make(const MpiComm& comm) {
    static const int begun = [] {
      float version = 0;
      return Zoltan_Initialize(0, nullptr, &version);
    }();
    check_zoltan(begun, "Zoltan_Initialize");
    zoltan_.reset(Zoltan_Create(comm.mpi()));
    require(zoltan_ != nullptr, "Zoltan_Create has failed");
    set("DEBUG_LEVEL", "0");
    set("NUM_GID_ENTRIES", "2");  // of 32 bits
    set("NUM_LID_ENTRIES", "1");
    set("OBJ_WEIGHT_DIM", "1");
  }
  void set(const char* parameter, const std::string& value) const {
    check_zoltan(Zoltan_Set_Param(get(), parameter, value.c_str()), parameter);
  }
  /// Collective: partitions the objects described by the callbacks; calls moved(own object, part)
  /// for each object that moves to another part, if Zoltan is to list them (RETURN_LISTS).
  template <class Moved>
  void partition(const Moved& moved) const {
    int changes = 0, ids = 0, locals = 0, imports = 0, exports = 0;
    ZOLTAN_ID_PTR import_ids = nullptr, import_locals = nullptr, export_ids = nullptr,
                  export_locals = nullptr;
    int *import_ranks = nullptr, *import_parts = nullptr, *export_ranks = nullptr,
        *export_parts = nullptr;
    check_zoltan(Zoltan_LB_Partition(get(), &changes, &ids, &locals, &imports, &import_ids,
                                     &import_locals, &import_ranks, &import_parts, &exports,
                                     &export_ids, &export_locals, &export_ranks, &export_parts),
                 "Zoltan_LB_Partition");
    for (int k = 0; k < exports; ++k) moved(export_locals[k], export_parts[k]);
    Zoltan_LB_Free_Part(&import_ids, &import_locals, &import_ranks, &import_parts);
    Zoltan_LB_Free_Part(&export_ids, &export_locals, &export_ranks, &export_parts);
  }

 private:
  std::unique_ptr<Zoltan_Struct, DestroyZoltan> zoltan_;
};

}  // namespace silt::inline SILT_TARGET::detail
