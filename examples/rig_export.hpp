// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// calvin-rig and calvin-light: further files of a rig, and how its places are printed.
#pragma once

#include <cmath>
#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "calvin/core/file.hpp"
#include "calvin/core/text.hpp"
#include "calvin/draw/scene/scene_gltf.hpp"
#include "calvin/session/rig/rig_exports.hpp"

#include "output_files.hpp"

namespace rig_export {

// The scene of calibview is an export here, too.
constexpr std::string_view kScene = "gltf:";

using Exports = std::vector<calvin::RigExport>;

// What is said where one was not understood.
inline constexpr const char* kUsage =
    "--export takes FORMAT:PATH, with calvin, kalibr, caliscope, mrcal, colmap, gltf, opencv or "
    "ros.";

// Whether all were understood.
inline bool parse(std::string_view text, Exports& exports) {
  for (const std::string_view part : calvin::split(text, ',')) {
    if (part.starts_with(kScene) && part.size() > kScene.size()) {
      exports.push_back({"gltf", std::string(part.substr(kScene.size()))});
      continue;
    }
    const auto one = calvin::parse_rig_exports(part);
    if (!one || one->size() != 1) return false;
    exports.push_back(one->front());
  }
  return true;
}

inline calvin::Status write(const calvin::Rig& rig, const calvin::RigExport& to) {
  if (to.format != "gltf") return calvin::write_rig_export(to, rig);
  return calvin::write_file(to.path, calvin::print_glb(calvin::make_scene(rig)));
}

// All that can be; whether that is all. What cannot is named.
inline bool write_all(const calvin::Rig& rig, const Exports& exports) {
  bool all = true;
  for (const calvin::RigExport& to : exports) {
    const calvin::Status written = write(rig, to);
    if (written) continue;
    fmt::print(stderr, "{}:{} is not written: {}\n", to.format, to.path, written.error().message);
    all = false;
  }
  return all;
}

// The file of the rig and all further ones.
inline std::vector<output_files::Output> outputs(const std::string& rig, const Exports& exports) {
  std::vector<output_files::Output> all = {{rig, {output_files::kRig}}};
  for (const calvin::RigExport& to : exports) {
    all.push_back({to.path, {}});
    if (to.format == "calvin") all.back().kinds.push_back(output_files::kRig);
  }
  return all;
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
