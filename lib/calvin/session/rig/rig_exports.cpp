// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Which format is written by whom.

#include "calvin/session/rig/rig_exports.hpp"

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "calvin/core/file.hpp"
#include "calvin/core/text.hpp"
#include "calvin/core/utf8.hpp"
#include "calvin/io/rig_io.hpp"
#include "calvin/io/stereo_io.hpp"
#include "calvin/remap/rectification.hpp"

namespace calvin {

namespace {

Status write_text(const std::filesystem::path& path, const Result<std::string>& text) {
  if (!text) return tl::unexpected<Error>(text.error());
  return write_file(path.string(), *text);
}

Status write_two(const std::filesystem::path& folder, const std::string& first_name,
                 const Result<std::string>& first, const std::string& second_name,
                 const Result<std::string>& second) {
  std::error_code none;
  std::filesystem::create_directories(folder, none);
  Status written = write_text(folder / first_name, first);
  return written ? write_text(folder / second_name, second) : written;
}

Status write_opencv(const std::string& path, const Rig& rig, const RectifiedPair& pair) {
  std::error_code none;
  if (!path.ends_with('/') && !std::filesystem::is_directory(path, none)) {
    return write_text(path, print_opencv_stereo(rig, pair));
  }
  auto files = print_opencv_stereo_files(rig, pair);
  if (!files) return tl::unexpected<Error>(files.error());
  return write_two(path, "intrinsics.yml", std::move(files->intrinsics), "extrinsics.yml",
                   std::move(files->extrinsics));
}

tl::unexpected<Error> wrong(std::string_view part, std::string_view why) {
  return make_error(ErrorCode::kInvalidArgument,
                    fmt::format("The export '{}' is wrong: {}. Give FORMAT:PATH, as "
                                "kalibr:camchain.yaml, separated by commas, with one of {}.",
                                shortened(part, 80), why, join(rig_export_formats(), ", ")));
}

}  // namespace

std::vector<std::string_view> rig_export_formats() {
  std::vector<std::string_view> formats = rig_formats();
  formats.insert(formats.end(), {"opencv", "ros"});
  return formats;
}

Result<std::vector<RigExport>> parse_rig_exports(std::string_view text) {
  std::vector<RigExport> all;
  if (trim(text).empty()) return all;
  for (const std::string_view part : split(text, ',')) {
    const auto colon = part.find(':');
    const std::string_view format = trim(part.substr(0, colon));
    const std::string_view path =
        colon == std::string_view::npos ? "" : trim(part.substr(colon + 1));
    if (path.empty()) return wrong(part, "it has no path");
    if (std::ranges::count(rig_export_formats(), format) == 0) {
      return wrong(part, "there is no such format");
    }
    if (std::ranges::find(all, path, &RigExport::path) != all.end()) {
      return wrong(part, "another one has its path");
    }
    all.push_back({std::string(format), std::string(path)});
  }
  return all;
}

Status write_rig_export(const RigExport& to, const Rig& rig) {
  const bool is_stereo = to.format == "opencv" || to.format == "ros";
  if (!is_stereo) return write_rig(to.path, rig, to.format);
  const auto pair = rectified_pair(rig);
  if (!pair) return tl::unexpected<Error>(pair.error());
  if (to.format == "opencv") return write_opencv(to.path, rig, *pair);
  return write_two(to.path, "left.yaml", print_ros_stereo(rig, *pair, true), "right.yaml",
                   print_ros_stereo(rig, *pair, false));
}

}  // namespace calvin
