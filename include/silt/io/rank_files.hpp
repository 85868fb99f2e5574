// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <utility>

#include <silt/core/dyn_array.hpp>
#include <silt/files/vtk.hpp>
#include <silt/simulation.hpp>

/// Files of a run on many ranks: pieces with an index, or lines that rank 0 collects. All functions
/// are collective; without Ranks they do the work of one process.

namespace silt::inline SILT_TARGET::detail {

/// `path` with `words` inserted before its ending: "out/particles_12.vtp", "_r3".
inline std::string before_ending(const std::string& path, const std::string& words) {
  const auto dot = path.rfind('.'), slash = path.rfind('/');
  const bool has_ending = dot != path.npos && (slash == path.npos || dot > slash);
  const std::size_t at = has_ending ? dot : path.size();
  return path.substr(0, at) + words + path.substr(at);
}
inline std::string without_folder(const std::string& path) {
  const auto slash = path.rfind('/');
  return slash == path.npos ? path : path.substr(slash + 1);
}
/// Name that a series lists for a file of all ranks: on one rank the file, on several its index.
template <class Sim>
std::string listed_file(const Sim& sim, const std::string& path) {
  if (sim.ranks() == 1) return path;
  const auto dot = path.rfind('.');
  return path.substr(0, dot) + ".p" + path.substr(dot + 1);
}

/// Writes `path` by write(path). On several ranks each writes its piece, then rank 0 the index,
/// which exists only if all pieces do. `layout` describes the arrays of the pieces.
template <class Sim, class Write>
void write_in_pieces(const Sim& sim, const std::string& path, const VtkFields& fields,
                     const VtkPieces& layout, const Write& write) {
  if (sim.ranks() == 1) return on_all_ranks(sim, "a VTK file", [&] { write(path); });
  on_all_ranks(sim, "pieces of a VTK file",
               [&] { write(before_ending(path, text("_r", sim.rank()))); });
  on_all_ranks(sim, "the index of a VTK file", [&] {
    if (sim.rank() != 0) return;
    DynArray<std::string> names;
    for (int r = 0; r < sim.ranks(); ++r)
      names.push_back(without_folder(before_ending(path, text("_r", r))));
    write_vtp_index(listed_file(sim, path), names, fields, layout);
  });
}

/// Text of all ranks, joined, on all ranks.
template <class Sim>
std::string words_of_ranks(const Sim& sim, const std::string& own, const char* between) {
  const auto& ranks = sim.engine().ranks;
  ranks.meet("words of ranks");
  const auto all = gather(ranks.comm(), std::span<const char>(own));
  std::string words;
  for (int r = 0; r < all.ranks(); ++r)
    if (!all[r].empty())
      words += text(words.empty() ? "" : between, std::string_view(all[r].data(), all[r].size()));
  return words;
}

/// A line of a table, and its sort key.
struct SortedLine {
  std::uint64_t by, then;
  std::string words;
  auto key() const { return std::pair(by, then); }
};
/// Lines of all ranks in order, on rank 0; empty on others.
template <class Sim>
DynArray<SortedLine> gather_lines(const Sim& sim, DynArray<SortedLine> lines) {
  if constexpr (Sim::has_ranks) {
    const auto& ranks = sim.engine().ranks;
    std::string own;
    for (const SortedLine& line : lines) {
      const std::uint64_t head[] = {line.by, line.then, line.words.size()};
      own.append(reinterpret_cast<const char*>(head), sizeof head), own += line.words;
    }
    ranks.meet("lines of a table");
    DynArray<Outgoing> out;
    if (ranks.rank() != 0) {
      lines.clear();
      out.push_back({0, std::as_bytes(std::span(own))});
    }
    for (const Arrival& came : deliver(ranks.comm(), out)) {
      std::string_view rest(reinterpret_cast<const char*>(came.bytes.data()), came.bytes.size());
      while (!rest.empty()) {
        std::uint64_t head[3];
        std::memcpy(head, rest.data(), sizeof head), rest.remove_prefix(sizeof head);
        lines.push_back({head[0], head[1], std::string(rest.substr(0, head[2]))});
        rest.remove_prefix(head[2]);
      }
    }
  }
  std::stable_sort(lines.begin(), lines.end(),
                   [](const SortedLine& a, const SortedLine& b) { return a.key() < b.key(); });
  return lines;
}

}  // namespace silt::detail
