// silt - BSD-3-Clause, see LICENSE
#pragma once

// Part of Sph that only checkpoints ask for.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include <silt/sph/sph.hpp>

namespace silt::inline SILT_TARGET {

template <class... Policies>
template <class Visit>
void Sph<Policies...>::for_each_state(const Visit& visit) {
  clock.for_each_state(visit);
  constexpr std::size_t row = 8;
  const auto is_lane = [](std::uint32_t label) { return label == Lists::none; };
  std::vector<double> rows, labels, built, radii;
  for (std::size_t k = 0; k < columns_.size(); ++k) {
    const auto put = [&](const Row& r) {
      rows.insert(rows.end(), {r.x, r.y, r.z, r.vx, r.vy, r.vz, r.density, r.pressure});
    };
    put(columns_.rows[k]), put(columns_.start[k]);
    labels.push_back(is_lane(columns_.label[k]) ? -1 : static_cast<double>(columns_.label[k]));
    labels.push_back(static_cast<double>(columns_.kind[k]));
    const Vec3d at = stale_ ? columns_.rows[k].position() : lists_.built(k);
    built.insert(built.end(), {at.x, at.y, at.z});
  }
  for (const auto& body : bodies_.bodies) radii.push_back(body.radius);
  std::array<double, 9> numbers{static_cast<double>(next_),
                                static_cast<double>(left_),
                                static_cast<double>(displaced_),
                                static_cast<double>(steps_),
                                time_,
                                last_,
                                moved_,
                                stale_ ? 1.0 : 0.0,
                                made_ ? 1.0 : 0.0};
  visit("fluid.rows", rows), visit("fluid.labels", labels), visit("fluid.built", built);
  visit("fluid.radii", radii), visit("fluid.numbers", std::span<double>(numbers));

  const std::size_t n = labels.size() / 2;
  require(labels.size() == 2 * n && rows.size() == 2 * row * n && built.size() == 3 * n,
          "Sph: a state of ", n, " particles has ", rows.size(), " numbers of rows and ",
          built.size(), " of places");
  columns_ = {};
  std::vector<Row> then(n);
  for (std::size_t k = 0; k < n; ++k) {
    const auto get = [&](std::size_t of) {
      const double* const r = rows.data() + row * (2 * k + of);
      return Row{r[0], r[1], r[2], r[3], r[4], r[5], r[6], r[7]};
    };
    const double label = labels[2 * k], kind = labels[2 * k + 1];
    require(label == std::floor(label) && label >= -1 && label < Lists::most &&
                (kind == 0 || kind == 1 || kind == 2 || kind == 3),
            "Sph: particle ", k, " of a state has number ", label, " and kind ", kind);
    columns_.add(get(0), static_cast<int>(kind),
                 label < 0 ? Lists::none : static_cast<std::uint32_t>(label));
    columns_.start.back() = get(1);
    then[k].place({built[3 * k], built[3 * k + 1], built[3 * k + 2]});
  }
  next_ = static_cast<std::uint32_t>(numbers[0]);
  left_ = static_cast<std::size_t>(numbers[1]), displaced_ = static_cast<std::size_t>(numbers[2]);
  steps_ = static_cast<std::int64_t>(numbers[3]), time_ = now_ = numbers[4], last_ = numbers[5];
  moved_ = numbers[6], stale_ = numbers[7] != 0, made_ = numbers[8] != 0, known_ = false;
  bodies_.restore(radii, setup_);
  if (made_ && walls_.fresh()) walls_.make(setup_);
  if (!stale_) make_lists(then, {});
}

}  // namespace silt
