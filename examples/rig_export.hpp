// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// calvin-rig and calvin-light: further files of a rig, and how its places are printed.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <set>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "calvin/core/file.hpp"
#include "calvin/core/text.hpp"
#include "calvin/draw/scene/scene_gltf.hpp"
#include "calvin/io/rig_io.hpp"
#include "calvin/io/stereo_io.hpp"
#include "calvin/remap/rectification.hpp"

namespace rig_export {

using Exports = std::vector<std::pair<std::string, std::string>>;  // format, path

// What is said where one was not.
inline constexpr const char* kUsage =
    "--export takes FORMAT:PATH, with calvin, kalibr, caliscope, mrcal, colmap, gltf, opencv or "
    "ros.";

// Whether all were understood.
inline bool parse(std::string_view text, Exports& exports) {
  static const std::set<std::string_view> kFormats = {"calvin", "kalibr", "caliscope", "mrcal",
                                                      "colmap", "gltf",   "opencv",    "ros"};
  for (const std::string_view part : calvin::split(text, ',')) {
    const auto colon = part.find(':');
    const std::string_view format = part.substr(0, colon);
    if (colon == std::string_view::npos || colon + 1 == part.size() || !kFormats.contains(format)) {
      return false;
    }
    exports.emplace_back(format, part.substr(colon + 1));
  }
  return true;
}

inline calvin::Status write_text(const std::filesystem::path& path,
                                 const calvin::Result<std::string>& text) {
  if (!text) return tl::unexpected<calvin::Error>(text.error());
  return calvin::write_file(path.string(), *text);
}

inline calvin::Status write(const calvin::Rig& rig, const std::string& format,
                            const std::filesystem::path& path) {
  if (std::ranges::count(calvin::rig_formats(), format) > 0) {
    return calvin::write_rig(path, rig, format);
  }
  if (format == "gltf") {
    return write_text(path, calvin::print_glb(calvin::make_scene(rig)));
  }
  const auto pair = calvin::rectified_pair(rig);
  if (!pair) return tl::unexpected<calvin::Error>(pair.error());
  if (format == "opencv") return write_text(path, calvin::print_opencv_stereo(rig, *pair));
  std::error_code none;
  std::filesystem::create_directories(path, none);
  calvin::Status left = write_text(path / "left.yaml", calvin::print_ros_stereo(rig, *pair, true));
  if (!left) return left;
  return write_text(path / "right.yaml", calvin::print_ros_stereo(rig, *pair, false));
}

// " (+-0.1 0.1 0.4)", of the place of a camera that is not the frame itself.
inline std::string place_sigmas(const calvin::RigCamera& camera) {
  constexpr std::size_t kPose = 6;
  if (camera.covariance.size() != kPose * kPose) return "";
  const auto mm = [&](std::size_t i) {
    return calvin::two_digits(1e3 * std::sqrt(camera.covariance[i * kPose + i]));
  };
  return fmt::format(" (+-{} {} {})", mm(3), mm(4), mm(5));
}

}  // namespace rig_export
