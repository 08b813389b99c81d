// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Undistorts whole pictures: an Undistorter with one plane.

#include "calvin/remap/picture_undistorter.hpp"

#include <utility>

#include <fmt/format.h>

#include "calvin/remap/undistorter.hpp"

namespace calvin {

namespace {

constexpr int kLongestSide = 65536;  // px, as check_image_size() has it

Status check(const PictureOptions& options) {
  if (options.channels < 1 || options.channels > 4) {
    return make_error(
        ErrorCode::kInvalidArgument,
        fmt::format("Pixels of {} channels are not undistorted: give 1 to 4.", options.channels));
  }
  if (!(options.alpha >= 0 && options.alpha <= 1)) {
    return make_error(
        ErrorCode::kInvalidArgument,
        fmt::format("There is no view for an alpha of {}: give 0 to 1.", options.alpha));
  }
  const auto [width, height] = options.output;
  const bool as_source = width == 0 && height == 0;
  const bool possible =
      width >= 1 && height >= 1 && width <= kLongestSide && height <= kLongestSide;
  if (as_source || possible) return {};
  return make_error(ErrorCode::kInvalidArgument,
                    fmt::format("No picture has {}x{} px: give 1 to {} px each way, or 0x0 for "
                                "the size of the camera's pictures.",
                                width, height, kLongestSide));
}

}  // namespace

struct PictureUndistorter::Maps {
  Undistorter undistorter;
};

Result<PictureUndistorter> PictureUndistorter::make(const Camera& camera,
                                                    const PictureOptions& options) {
  if (const Status good = check(options); !good) return tl::unexpected(good.error());
  ViewOptions view;
  view.alpha = options.alpha;
  view.output = options.output;
  PlaneLayout plane;
  plane.components = options.channels;
  plane.pixel_step = options.channels;
  auto undistorter = Undistorter::make(camera, view, {plane});
  if (!undistorter) return tl::unexpected(undistorter.error());
  return PictureUndistorter(std::make_shared<const Maps>(Maps{std::move(*undistorter)}));
}

const Camera& PictureUndistorter::output() const noexcept { return maps_->undistorter.output(); }

void PictureUndistorter::apply(const std::uint8_t* source, std::ptrdiff_t source_stride,
                               std::uint8_t* target, std::ptrdiff_t target_stride) const noexcept {
  maps_->undistorter.apply(0, {source, source_stride}, {target, target_stride});
}

std::optional<Pixel> PictureUndistorter::to_output(Pixel source) const noexcept {
  return maps_->undistorter.to_output(source);
}

std::optional<Pixel> PictureUndistorter::to_source(Pixel output) const noexcept {
  return maps_->undistorter.to_source(output);
}

}  // namespace calvin
