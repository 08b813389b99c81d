// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Undistorter: all that undistorting the frames of one stream takes.
#pragma once

#include <optional>
#include <vector>

#include "calvin/remap/kernel.hpp"
#include "calvin/remap/view.hpp"

namespace calvin {

// Immutable; safe to share between threads. Planes with the same places share a map.
class Undistorter {
 public:
  // `planes` of a frame, in the order in which apply() names them. Fails as output_camera() and
  // RemapMap::build() do.
  static Result<Undistorter> make(const Camera& source, const ViewOptions& options,
                                  const std::vector<PlaneLayout>& planes,
                                  const std::stop_token& stop = {});

  [[nodiscard]] const Camera& source() const noexcept { return source_; }
  [[nodiscard]] const Camera& output() const noexcept { return output_; }
  [[nodiscard]] std::size_t planes() const noexcept { return planes_.size(); }

  // Undistorts one plane; see remap_plane().
  void apply(std::size_t plane, PlaneMemory<const std::uint8_t> source,
             PlaneMemory<std::uint8_t> output) const noexcept;

  // px of the source frame -> px of the output, and its inverse. Absent where the result lies
  // outside the picture or the model.
  [[nodiscard]] std::optional<Pixel> to_output(Pixel source) const noexcept;
  [[nodiscard]] std::optional<Pixel> to_source(Pixel output) const noexcept;

  // An observation as a detector would have made it in the output: points that the view does not
  // show are left out, the uncertainty grows and shrinks with the picture.
  [[nodiscard]] Observation to_output(const Observation& observation) const;

  // The box around what a box of the source has become, cut to the picture; a picture of w columns
  // goes from x = 0 to w. Absent where the output shows nothing of it.
  [[nodiscard]] std::optional<Rectangle> to_output(const Rectangle& box) const;

  // to_source(), or where that is absent the last place of the source on the way to the pixel from
  // the middle of the output.
  [[nodiscard]] Pixel nearest_source(Pixel output) const noexcept;

 private:
  struct Plane {
    PlaneLayout layout;
    std::size_t map;
  };

  Undistorter(const Camera& source, const Camera& output) : source_(source), output_(output) {}

  Camera source_;
  Camera output_;
  std::vector<RemapMap> maps_;
  std::vector<Plane> planes_;
};

}  // namespace calvin
