// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Undistorter: maps and kernels for undistorting the frames of one stream, and the same mapping for
// pixels, boxes and observations.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "calvin/remap/map/plane_layout.hpp"
#include "calvin/remap/map/plane_map.hpp"
#include "calvin/remap/view.hpp"

namespace calvin {

namespace remap {
struct RowScratch;
}

// Immutable; safe to share between threads. Planes with the same sites share a map.
class Undistorter {
 public:
  // What a worker notes while it makes rows: 73 KB, for frames of any undistorter, one apply() at a
  // time. A worker that keeps it needs 73 KB less of its stack, and finds it in its caches.
  class Scratch {
   public:
    Scratch();
    ~Scratch();
    Scratch(Scratch&& other) noexcept;
    Scratch& operator=(Scratch&& other) noexcept;

   private:
    friend class Undistorter;
    std::unique_ptr<remap::RowScratch> rows_;
  };

  // `planes` of a frame, in the order in which apply() names them. Fails as output_view() and
  // RemapMap::build() do.
  static Result<Undistorter> make(const Camera& source, const ViewOptions& options,
                                  const std::vector<PlaneLayout>& planes,
                                  const std::stop_token& stop = {});
  // The way back: frames of `options.output` px, or of the camera's size, become frames of
  // `camera`.
  static Result<Undistorter> make_back(const Camera& camera, const ViewOptions& options,
                                       const std::vector<PlaneLayout>& planes,
                                       const std::stop_token& stop = {});
  // The same for views that are known already, from ViewRange::view().
  static Result<Undistorter> make(const Camera& source, const OutputView& view,
                                  const std::vector<PlaneLayout>& planes,
                                  const std::stop_token& stop = {});
  static Result<Undistorter> make_back(const Camera& camera, const OutputView& view,
                                       const std::vector<PlaneLayout>& planes,
                                       const std::stop_token& stop = {});

  // The camera of the source frames, and the plane (VirtualCamera::plane()) of the output frames.
  [[nodiscard]] const Camera& source() const noexcept { return source_.plane(); }
  [[nodiscard]] const Camera& output() const noexcept { return output_.plane(); }
  // The camera model of the output frames; absent where no model describes the projection.
  [[nodiscard]] std::optional<Camera> output_model() const { return output_.model(); }
  // The view is not as wide as was asked for: its projection cannot show more.
  [[nodiscard]] bool limited() const noexcept { return limited_; }
  // The output has something of the source.
  [[nodiscard]] bool shows_any() const noexcept { return calvin::shows_any(source_, output_); }
  [[nodiscard]] std::size_t planes() const noexcept {
    return planes_.back().first + planes_.back().count;
  }

  // Undistorts one plane; see remap_rows().
  void apply(std::size_t plane, PlaneMemory<const std::uint8_t> source,
             PlaneMemory<std::uint8_t> output, const Sampling& sampling = {}) const noexcept;

  // Undistorts all planes, in the order in which they were named. `part` of `parts` that may be
  // made at the same time: a share of the rows of each plane.
  void apply(std::span<const PlaneMemory<const std::uint8_t>> sources,
             std::span<const PlaneMemory<std::uint8_t>> outputs, const Sampling& sampling = {},
             int part = 0, int parts = 1) const noexcept;
  // As above, in the memory of the worker that makes the part.
  void apply(std::span<const PlaneMemory<const std::uint8_t>> sources,
             std::span<const PlaneMemory<std::uint8_t>> outputs, const Sampling& sampling, int part,
             int parts, Scratch& scratch) const noexcept;

  // Bytes that the maps take.
  [[nodiscard]] std::size_t map_bytes() const noexcept;

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

  // As to_source(); where that is absent, the last pixel of the source on the way from the middle
  // of the output to `output`.
  [[nodiscard]] Pixel nearest_source(Pixel output) const noexcept;

 private:
  // Consecutive planes with one layout: the U and V of I420.
  struct Plane {
    PlaneLayout layout;
    std::size_t map;
    std::size_t first;  // of the planes of a frame
    std::size_t count;
  };

  Undistorter(VirtualCamera source, VirtualCamera output, bool limited)
      : source_(std::move(source)), output_(std::move(output)), limited_(limited) {}
  void apply_part(std::span<const PlaneMemory<const std::uint8_t>> sources,
                  std::span<const PlaneMemory<std::uint8_t>> outputs, const Sampling& sampling,
                  int part, int parts, remap::RowScratch& scratch) const noexcept;
  static Result<Undistorter> between(Undistorter cameras, const std::vector<PlaneLayout>& planes,
                                     const std::stop_token& stop);

  VirtualCamera source_;
  VirtualCamera output_;
  bool limited_;
  std::shared_ptr<const RemapMap> map_;
  std::vector<PlaneMap> maps_;
  std::vector<Plane> planes_;
};

}  // namespace calvin
