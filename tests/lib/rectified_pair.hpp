// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The two undistorters of a stereo pair, as two elements make them, each for itself.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "calvin/geometry/se3.hpp"
#include "calvin/remap/rectification.hpp"
#include "calvin/remap/undistorter.hpp"
#include "calvin/remap/view_range.hpp"

namespace calvin::scenes {

inline Result<Undistorter> rectifier(const Rig& rig, StereoSide side,
                                     const ViewOptions& options = {},
                                     std::optional<ImageSize> frames = std::nullopt) {
  const auto own = camera_of_side(rig, side);
  if (!own) return tl::unexpected(own.error());
  const ImageSize size = frames.value_or(rig.cameras[*own].calibration.image_size);
  const auto sights = rectified_sights(rig, side, size);
  if (!sights) return tl::unexpected(sights.error());
  const auto range = ViewRange::find(std::span(*sights), options);
  if (!range) return tl::unexpected(range.error());
  const std::size_t number = side == StereoSide::kLeft ? 0 : 1;
  const auto view = range->view(options, number);
  if (!view) return tl::unexpected(view.error());
  return Undistorter::make((*sights)[number].camera, *view, {PlaneLayout()});
}

inline Rig rig_of(const Camera& first, const Camera& second, const SE3& first_from_second) {
  Rig rig;
  rig.world = "first";
  for (const Camera* camera : {&first, &second}) {
    RigCamera one;
    one.calibration = camera->to_calibration();
    one.calibration.camera = rig.cameras.empty() ? "first" : "second";
    one.rig_from_camera = to_pose(rig.cameras.empty() ? SE3() : first_from_second);
    rig.cameras.push_back(one);
  }
  return rig;
}

}  // namespace calvin::scenes
