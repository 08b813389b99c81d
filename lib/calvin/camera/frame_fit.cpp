// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The camera of frames that are scaled, cropped or turned, from a calibration of the whole picture.

#include "calvin/camera/frame_fit.hpp"

#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "calvin/camera/image_transform.hpp"

namespace calvin {

namespace {

// The part of the calibrated image that frames show.
Result<Rectangle> shown_part(const Calibration& calibration, ImageSize size) {
  const Rectangle part = calibration.sensor_crop.value_or(
      Rectangle{0, 0, static_cast<double>(size.width), static_cast<double>(size.height)});
  if (!(part.width > 0) || !(part.height > 0) || !std::isfinite(part.width + part.height) ||
      !std::isfinite(part.x + part.y)) {
    return make_error(ErrorCode::kMalformed, "The sensor_crop of the calibration has no area.");
  }
  return part;
}

bool same_aspect(const Rectangle& part, ImageSize frame) {
  return std::abs(frame.width / part.width * part.height - frame.height) <= 1 ||
         std::abs(frame.height / part.height * part.width - frame.width) <= 1;
}

Error other_aspect(const Calibration& calibration, const Rectangle& part, ImageSize frame) {
  if (calibration.sensor_crop) {
    const ImageSize whole = calibration.image_size;
    return {
        ErrorCode::kInvalidArgument,
        fmt::format("The sensor_crop of the calibration is a part of {}x{} px of its picture of "
                    "{}x{}, the frames are {}x{}: another aspect. Make sensor_crop the part of "
                    "that picture that the frames show, or take it out where they show all.",
                    part.width, part.height, whole.width, whole.height, frame.width, frame.height)};
  }
  return {ErrorCode::kInvalidArgument,
          fmt::format("The calibration is for a picture of {}x{} px, the frames are {}x{}: "
                      "another aspect. Calibrate at that size, or say with sensor_crop which "
                      "part of the calibrated image the frames show.",
                      part.width, part.height, frame.width, frame.height)};
}

}  // namespace

Result<FittedCamera> fit_to_frame(const Calibration& calibration, ImageSize frame,
                                  Orientation upright) {
  Calibration known = calibration;
  if (known.image_size == ImageSize{}) known.image_size = frame;
  const auto camera = Camera::make(known);
  if (!camera) return tl::unexpected(camera.error());
  const auto part = shown_part(known, camera->image_size());
  if (!part) return tl::unexpected(part.error());
  const bool turned = !same_aspect(*part, frame) && same_aspect(*part, upright.size_of(frame));
  if (!turned && !same_aspect(*part, frame)) {
    return tl::unexpected(other_aspect(known, *part, frame));
  }
  const ImageSize calibrated = turned ? upright.size_of(frame) : frame;
  auto fitted = ImageTransform::filled(*part, calibrated)(*camera);
  if (fitted && turned) fitted = fitted->turned(upright.inverse());
  if (!fitted) return tl::unexpected(fitted.error());
  const bool scaled = part->width != calibrated.width || part->height != calibrated.height;
  return FittedCamera{*std::move(fitted), scaled, turned};
}

Result<FittedCamera> fit_to_part(const Calibration& calibration, const FramePart& part,
                                 Orientation upright) {
  const bool of_the_frames = calibration.sensor_crop || calibration.image_size == ImageSize{} ||
                             calibration.image_size == part.size;
  if (!of_the_frames) {
    if (auto fitted = fit_to_frame(calibration, part.whole, upright)) {
      auto cropped = ImageTransform::cropped(part.x, part.y, part.size)(fitted->camera);
      if (!cropped) return tl::unexpected(cropped.error());
      fitted->camera = *std::move(cropped);
      return fitted;
    }
  }
  return fit_to_frame(calibration, part.size, upright);
}

}  // namespace calvin
