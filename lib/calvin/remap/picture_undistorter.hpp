// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Undistorts whole pictures of one camera. Undistorter does the work, for any format of video too.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>

#include "calvin/camera/camera.hpp"
#include "calvin/core/export.hpp"
#include "calvin/core/image.hpp"
#include "calvin/core/result.hpp"

namespace calvin {

struct PictureOptions {
  // 0: the largest view without a pixel that the camera has not seen. 1: all that the camera sees,
  // with such pixels at the border. Between: the borders of the view move linearly.
  double alpha = 0;
  ImageSize output = {};  // px; 0x0: as the camera's pictures
  int channels = 1;       // bytes of a pixel, 1 to 4: grey, BGR, BGRx
};

// Immutable; safe to share between threads. Copies share the map.
class PictureUndistorter {
 public:
  // kInvalidArgument for another alpha, other channels or an output of more than 65536 px a side,
  // kDegenerate for a camera without a valid region in its picture.
  [[nodiscard]] CALVIN_API static Result<PictureUndistorter> make(
      const Camera& camera, const PictureOptions& options = {});

  // The camera of the undistorted pictures: a pinhole.
  [[nodiscard]] CALVIN_API const Camera& output() const noexcept;

  // Undistorts one picture, bilinearly; pixels that the camera has not seen become 0. `source` has
  // the size of the camera's pictures, `target` that of output(), both 8 bit and `channels` bytes a
  // pixel; strides are the bytes from a row to the next.
  CALVIN_API void apply(const std::uint8_t* source, std::ptrdiff_t source_stride,
                        std::uint8_t* target, std::ptrdiff_t target_stride) const noexcept;

  // px of the camera's picture -> px of the undistorted one, and back; absent where the other
  // picture does not show the place.
  [[nodiscard]] CALVIN_API std::optional<Pixel> to_output(Pixel source) const noexcept;
  [[nodiscard]] CALVIN_API std::optional<Pixel> to_source(Pixel output) const noexcept;

 private:
  struct Maps;
  explicit PictureUndistorter(std::shared_ptr<const Maps> maps) : maps_(std::move(maps)) {}

  std::shared_ptr<const Maps> maps_;
};

}  // namespace calvin
