// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// For every sample of an output plane: where in the source plane it comes from.
#pragma once

#include <cstdint>
#include <span>
#include <stop_token>
#include <vector>

#include "calvin/camera/camera.hpp"
#include "calvin/remap/sampling.hpp"

namespace calvin {

// A place in the source plane in 1/1024 of a sample, within the plane; x < 0: there is none.
struct MapEntry {
  std::int32_t x = -1;
  std::int32_t y = -1;

  [[nodiscard]] bool valid() const noexcept { return x >= 0; }
};

class RemapMap {
 public:
  static constexpr int kFractionBits = 10;
  static constexpr int kOne = 1 << kFractionBits;

  // The map from the plane of frames of `output` to the like plane of frames of `source`. An entry
  // is valid where the ray of the output sample meets the source within the centres of its border
  // pixels (to 1/2048 px). kCancelled soon after a stop was requested; kInvalidArgument where the
  // memory does not suffice.
  static Result<RemapMap> build(const Camera& source, const Camera& output,
                                const PlaneSites& sites = {}, const std::stop_token& stop = {});

  // Of the output plane, in samples.
  [[nodiscard]] ImageSize size() const noexcept { return size_; }
  [[nodiscard]] std::span<const MapEntry> row(int y) const noexcept {
    const auto width = static_cast<std::size_t>(size_.width);
    return std::span(entries_).subspan(static_cast<std::size_t>(y) * width, width);
  }

 private:
  ImageSize size_;
  std::vector<MapEntry> entries_;
};

// Whether pixel (x, y) of the output has a valid entry in the map of a full-size plane.
[[nodiscard]] bool is_inside(const Camera& source, const Camera& output, double x,
                             double y) noexcept;

}  // namespace calvin
