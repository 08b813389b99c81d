// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A rectified stereo pair in the files of OpenCV and ROS.
#pragma once

#include <string>

#include "calvin/core/result.hpp"
#include "calvin/core/rig.hpp"

namespace calvin {

// What OpenCV's sample stereo_calib tells, in one file of YAML: M1 D1 M2 D2 R T R1 R2 P1 P2 Q, the
// left camera first. `pair` is of that rig. kUnsupported where OpenCV has no such camera model.
[[nodiscard]] Result<std::string> print_opencv_stereo(const Rig& rig, const RectifiedPair& pair);

// The same in two files, as the sample leaves it: M1 D1 M2 D2, with the size of the pictures, and
// R T R1 R2 P1 P2 Q.
struct OpenCvStereoFiles {
  std::string intrinsics;
  std::string extrinsics;
};
[[nodiscard]] Result<OpenCvStereoFiles> print_opencv_stereo_files(const Rig& rig,
                                                                  const RectifiedPair& pair);

// The camera_info of one of the two, with its rectification and projection. kUnsupported as above.
[[nodiscard]] Result<std::string> print_ros_stereo(const Rig& rig, const RectifiedPair& pair,
                                                   bool is_left);

}  // namespace calvin
