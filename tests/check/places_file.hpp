// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A file of where cameras stand, as a survey of a room would have it.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "calvin/core/calibration.hpp"
#include "calvin/geometry/se3.hpp"
#include "support.hpp"

#include <gst/check/gstcheck.h>

namespace calvin::check {

// The path of a file in the folder.
inline std::string write_places(const TemporaryFolder& folder,
                                const std::vector<Calibration>& cameras,
                                const std::vector<SE3>& world_from_camera) {
  std::string text;
  for (std::size_t c = 0; c < cameras.size(); ++c) {
    const Eigen::Vector3d& at = world_from_camera[c].translation;
    text += fmt::format("{} {} {} {}\n", cameras[c].camera, at.x(), at.y(), at.z());
  }
  const std::string path = folder / "places.txt";
  fail_unless(g_file_set_contents(path.c_str(), text.c_str(), -1, nullptr));
  return path;
}

}  // namespace calvin::check
