// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <dirent.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include <silt/core/dyn_array.hpp>
#include <silt/files/checkpoint_file.hpp>
#include <silt/io/checkpoint_archive.hpp>
#include <silt/io/rank_files.hpp>
#include <silt/simulation.hpp>

/// Checkpoints of many ranks. Each rank writes a block, which is a checkpoint of its rows, ghosts
/// and lists. Then rank 0 writes an index, completely or not at all, and afterwards the blocks of
/// the previous index are removed. Whenever the program is killed, the existing index has all its
/// blocks.
///
///   run.silt               the index
///   run.silt.blocks/1200.0, 1200.1, ...   the blocks of step 1200

namespace silt::inline SILT_TARGET::detail {

/// The index of a checkpoint and its blocks.
struct CheckpointIndex {
  static constexpr const char* mark = "ranks.blocks";
  std::string blocks;                                      // common beginning of their names
  std::int64_t step = 0;                                   // of the run
  std::uint64_t present = 0;                               // particles of all blocks
  DynArray<std::uint64_t> bytes, sums, owned, safeguards;  // of each block

  std::size_t size() const { return bytes.size(); }
  std::uint64_t safeguards_of_all() const {
    std::uint64_t all = 0;
    for (const auto one : safeguards) all += one;
    return all;
  }
  static std::string folder(const std::string& path) { return path + ".blocks"; }
  std::string block(const std::string& path, std::size_t rank) const {
    return text(folder(path), '/', blocks, '.', rank);
  }

  void write(const std::string& path, const std::string& signature) const {
    CheckpointWriter out(signature);
    out.add_text(mark, blocks);
    const DynArray<std::int64_t> at{step};
    const DynArray<std::uint64_t> all{present};
    out.add("ranks.step", at), out.add("ranks.present", all);
    out.add("ranks.bytes", bytes), out.add("ranks.sums", sums);
    out.add("ranks.owned", owned), out.add("ranks.safeguards", safeguards);
    out.commit(path);
  }
  static CheckpointIndex read(const CheckpointReader& in) {
    CheckpointIndex index;
    index.blocks = in.text(mark);
    index.bytes = in.get<std::uint64_t>("ranks.bytes");
    const std::size_t n = index.bytes.size();
    index.sums = in.get<std::uint64_t>("ranks.sums", n);
    index.owned = in.get<std::uint64_t>("ranks.owned", n);
    index.safeguards = in.get<std::uint64_t>("ranks.safeguards", n);
    in.read("ranks.step", &index.step, 1), in.read("ranks.present", &index.present, 1);
    return index;
  }

  /// Opens a block and checks that it was written together with this index.
  CheckpointReader open(const std::string& path, std::size_t rank) const {
    const std::string name = block(path, rank);
    if (!file_exists(name))
      throw FileError(text("checkpoint '", path, "' is of ", size(), " ranks, and its block '",
                           name,
                           "' is missing: a checkpoint is moved and copied together with its "
                           "folder '",
                           folder(path), "'"));
    CheckpointReader in(name);
    std::int64_t of = 0;
    in.read("clock.step", &of, 1);
    if (of != step)
      throw FileError(text("checkpoint '", path, "' is of step ", step, ", but its block '", name,
                           "' is of step ", of, ": use the blocks that were written with it"));
    if (in.stamp() != CheckpointStamp{bytes[rank], sums[rank]})
      throw FileError(text("checkpoint '", path, "' was not written with its block '", name,
                           "', which belongs to another run: use the blocks that were written with "
                           "it"));
    return in;
  }

  /// Beginning of the names of new blocks, which must differ from those of the existing index.
  [[gnu::cold]] static std::string new_blocks(const std::string& path, std::int64_t step) {
    std::string name = std::to_string(step), there;
    if (file_exists(path)) try {
        const CheckpointReader in(path);
        if (in.has(mark)) there = in.text(mark);
      } catch (const FileError&) {  // it is replaced
      }
    return name == there ? name + 'b' : name;
  }
  /// Removes the blocks of previous indices and the remains of killed programs.
  [[gnu::cold]] void remove_others(const std::string& path) const noexcept {
    DIR* const all = ::opendir(folder(path).c_str());
    if (all == nullptr) return;
    while (const dirent* const entry = ::readdir(all))
      if (const std::string_view name(entry->d_name); is_block(name) && !is_own(name))
        ::unlink((folder(path) + '/' + entry->d_name).c_str());
    ::closedir(all);
  }

 private:
  static std::size_t digits(std::string_view name) {
    return std::min(name.find_first_not_of("0123456789"), name.size());
  }
  /// 1200.3, 1200b.3, 1200.3.partial: no other files are removed.
  static bool is_block(std::string_view name) {
    const std::size_t steps = digits(name);
    name.remove_prefix(steps);
    if (name.starts_with('b')) name.remove_prefix(1);
    if (steps == 0 || !name.starts_with('.')) return false;
    name.remove_prefix(1);
    const std::size_t rank = digits(name);
    name.remove_prefix(rank);
    return rank > 0 && (name.empty() || name == ".partial");
  }
  bool is_own(std::string_view name) const {
    for (std::size_t r = 0; r < size(); ++r)
      if (name == text(blocks, '.', r)) return true;
    return false;
  }
};

/// Values that can be copied as bytes, one after the other, in whole words.
struct BytesOut {
  DynArray<std::uint64_t> words;
  template <class T>
  void operator()(const std::vector<T>& values) {
    put(values.data(), values.size() * sizeof(T));
  }
  template <class T>
  requires(std::is_trivially_copyable_v<T>) void operator()(const T& value) {
    put(&value, sizeof(T));
  }

 private:
  void put(const void* from, std::size_t bytes) {
    words.push_back(bytes);
    const std::size_t at = words.size();
    words.resize(at + (bytes + 7) / 8, 0);
    if (bytes > 0) std::memcpy(words.data() + at, from, bytes);
  }
};
struct BytesIn {
  const CheckpointLoader& a;
  DynArray<std::uint64_t> words;
  std::size_t at = 0;
  template <class T>
  void operator()(std::vector<T>& values) {
    const std::size_t bytes = next();
    a.need(bytes % sizeof(T) == 0, "ranks.parts has ", bytes, " bytes, not ", sizeof(T), " each");
    values.resize(bytes / sizeof(T));
    take(values.data(), bytes);
  }
  template <class T>
  requires(std::is_trivially_copyable_v<T>) void operator()(T& value) {
    a.need(next() == sizeof(T), "ranks.parts are of another decomposition");
    take(&value, sizeof(T));
  }

 private:
  std::size_t next() {
    a.need(at < words.size() && (words[at] + 7) / 8 <= words.size() - at - 1,
           "ranks.parts are cut off");
    return words[at++];
  }
  void take(void* to, std::size_t bytes) {
    if (bytes > 0) std::memcpy(to, words.data() + at, bytes);
    at += (bytes + 7) / 8;
  }
};

/// Additional state of a block: its part of the whole.
struct BlockState {
  std::uint64_t rank = 0, of = 1, ghosts = 0, owners = 0;
  double smallest_radius = 0;                  // [m] of all ranks
  bool some_fixed = false;                     // of all ranks
  std::uint64_t present = 0;                   // particles of all ranks
  DynArray<std::uint64_t> counts, neighbours;  // neighbours: rank, first, end, rows sent
  DynArray<std::uint32_t> sent;
  DynArray<Vec3d> impulses;  // of each wall: own, angular; of all, angular
  DynArray<double> balance;  // of Rebalance
  DynArray<double> near;     // NearReach, then near_work; absent in older files
  DynArray<std::uint64_t> parts;

  static bool is_in(const CheckpointLoader& a) { return a.has("ranks.of"); }
  template <class Archive>
  void visit(Archive& a) {
    constexpr std::size_t any = CheckpointLoader::any_count;
    a.number("ranks.rank", rank, count_number), a.number("ranks.of", of, count_number);
    a.number("ranks.ghosts", ghosts, count_number), a.number("ranks.owners", owners, count_number);
    a.number("ranks.smallest_radius", smallest_radius, not_negative_number);
    a.number("ranks.some_fixed", some_fixed, flag_number);
    a.number("ranks.all", present, count_number);
    a.column("ranks.counts", counts, Archive::loads ? any : counts.size());
    a.column("ranks.neighbours", neighbours, Archive::loads ? any : neighbours.size());
    a.column("ranks.sent", sent, Archive::loads ? any : sent.size());
    a.rows("ranks.impulses", impulses, Archive::loads ? any : impulses.size());
    a.column("ranks.balance", balance, Archive::loads ? any : balance.size());
    bool has_near = !near.empty();
    if constexpr (Archive::loads) has_near = a.has("ranks.near");
    if (has_near) a.column("ranks.near", near, Archive::loads ? any : near.size());
    a.column("ranks.parts", parts, Archive::loads ? any : parts.size());
  }

  template <class Engine>
  static BlockState of_engine(const Engine& e) {
    BlockState s;
    const auto state = e.ranks.state(e.walls.size());
    s.rank = static_cast<std::uint64_t>(e.ranks.rank());
    s.of = static_cast<std::uint64_t>(e.ranks.size());
    s.ghosts = e.particles.ghosts, s.owners = e.owners();
    s.smallest_radius = e.particles.smallest_radius, s.some_fixed = e.particles.some_fixed;
    s.present = e.ranks.present();
    const auto& c = e.ranks.counts;
    s.counts = {c.searches, c.partitions, c.migrated,
                c.messages, c.bytes,      static_cast<std::uint64_t>(state.last_step)};
    for (const auto& n : e.ranks.neighbours) {
      s.neighbours.insert(s.neighbours.end(),
                          {static_cast<std::uint64_t>(n.rank), n.first, n.end, n.send.size()});
      s.sent.insert(s.sent.end(), n.send.begin(), n.send.end());
    }
    for (std::size_t w = 0; w < state.loads.own.size(); ++w)
      s.impulses.insert(s.impulses.end(),
                        {state.loads.own[w].impulse, state.loads.own[w].angular,
                         state.loads.shared[w].impulse, state.loads.shared[w].angular});
    s.balance = {state.lost, state.moved};
    s.near = {state.reach.of_surfaces, state.reach.of_centres};
    s.near.insert(s.near.end(), state.near_work.begin(), state.near_work.end());
    using Ranks = std::remove_cvref_t<decltype(e.ranks)>;
    if constexpr (Ranks::template tells_parts<BytesOut>) {
      BytesOut bytes;
      auto told = e.ranks.parts();
      told.for_each_state(bytes);
      s.parts = std::move(bytes.words);
    }
    return s;
  }
  /// State from which RankStage continues.
  template <class Ranks>
  void put(Ranks& ranks) const {
    ranks.counts = {};
    ranks.counts.searches = counts[0], ranks.counts.partitions = counts[1];
    ranks.counts.migrated = counts[2], ranks.counts.messages = counts[3];
    ranks.counts.bytes = counts[4];
    ranks.neighbours.clear();
    auto row = sent.begin();
    for (std::size_t k = 0; k < neighbours.size(); k += 4) {
      const auto to = row + static_cast<std::ptrdiff_t>(neighbours[k + 3]);
      ranks.neighbours.push_back({static_cast<int>(neighbours[k]),
                                  {row, to},
                                  static_cast<std::uint32_t>(neighbours[k + 1]),
                                  static_cast<std::uint32_t>(neighbours[k + 2])});
      row = to;
    }
    typename Ranks::State state;
    state.present = present, state.last_step = static_cast<std::int64_t>(counts[5]);
    state.lost = balance[0], state.moved = balance[1];
    if (near.size() >= 2)
      state.reach = {near[0], near[1]}, state.near_work.assign(near.begin() + 2, near.end());
    for (std::size_t k = 0; k < impulses.size(); k += 4) {
      state.loads.own.push_back({impulses[k], impulses[k + 1]});
      state.loads.shared.push_back({impulses[k + 2], impulses[k + 3]});
    }
    ranks.restore(std::move(state));
  }
  /// Checks that the rows and walls that it refers to exist.
  void check(const CheckpointLoader& a, std::size_t rows, std::size_t walls) const {
    a.need(rank < of, "ranks.rank = ", rank, " must be less than ", of, ", the number of ranks");
    a.need(ghosts <= rows, "ranks.ghosts = ", ghosts, " of ", rows, " rows");
    a.need(counts.size() == 6 && balance.size() == 2 && impulses.size() == 4 * walls &&
               neighbours.size() % 4 == 0,
           "its data on ranks are not those of a rank");
    a.need(near.size() <= 2 || near.size() == 2 + owners, "ranks.near is not of ", owners,
           " particles");
    std::uint64_t all = 0, next = rows - ghosts;
    for (std::size_t k = 0; k < neighbours.size(); k += 4) {
      a.need(neighbours[k] < of && neighbours[k] != rank &&
                 (k == 0 || neighbours[k - 4] < neighbours[k]) && neighbours[k + 1] == next &&
                 neighbours[k + 2] >= next && neighbours[k + 2] <= rows &&
                 neighbours[k + 3] <= sent.size() - all,
             "ranks.neighbours[", k, "] is not another rank with its own rows");
      next = neighbours[k + 2], all += neighbours[k + 3];
    }
    a.need(all == sent.size() && (next == rows || neighbours.empty()),
           "ranks.neighbours have not all ghosts");
    for (const auto row : sent) a.need(row < rows - ghosts, "ranks.sent has row ", row);
  }
};

}  // namespace silt::detail
