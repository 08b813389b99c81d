// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Tells text that is a calibration from text that names a file, in the order that
// docs/elements/calibundistort.md gives.

#include "calvin/io/settings.hpp"

#include <algorithm>
#include <filesystem>
#include <functional>
#include <string>
#include <system_error>
#include <utility>

#include "calvin/core/file.hpp"
#include "calvin/core/text.hpp"
#include "calvin/io/calibration_io.hpp"
#include "calvin/io/file_text.hpp"
#include "calvin/io/key_list.hpp"
#include "calvin/io/rig_io.hpp"
#include "calvin/io/zoom_io.hpp"

namespace calvin {

namespace {

enum class Setting { kText, kFile, kKeyList };

bool is_content(std::string_view text) {
  const std::string_view start = trim(io::without_byte_order_mark(text));
  return start.empty() || start.starts_with('{') || start.starts_with('<') ||
         start.starts_with("%YAML");
}

Setting kind_of(std::string_view text) {
  if (is_content(text)) return Setting::kText;
  if (text.find('=') == std::string_view::npos) return Setting::kFile;
  std::error_code error;
  const bool exists = std::filesystem::exists(std::filesystem::path(text), error);
  return exists ? Setting::kFile : Setting::kKeyList;
}

// `read_pair` reads the cameras of a stereo pair, for which a second file may be needed.
Result<CameraSetting> parse_content(std::string_view content, std::string_view name,
                                    const std::function<Result<Rig>()>& read_pair) {
  if (is_rig(content)) return parse_rig(content, name);
  if (is_zoom_table(content)) return parse_zoom_table(content, name);
  auto calibration = parse_calibration(content, name);
  if (!calibration) return tl::unexpected(calibration.error());
  if (!is_stereo_file(content)) return *std::move(calibration);
  return StereoFile{*std::move(calibration), read_pair()};
}

}  // namespace

bool is_calibration_path(std::string_view text) { return kind_of(text) == Setting::kFile; }

bool may_be_calibration_path(std::string_view text) {
  // No key list has a slash; other folders than the current one may be far away.
  const bool elsewhere = text.find('/') != std::string_view::npos;
  const bool is_near = text.find('=') == std::string_view::npos || !elsewhere;
  return is_near ? is_calibration_path(text) : !is_content(text);
}

Result<Calibration> parse_calibration_setting(std::string_view text) {
  switch (kind_of(text)) {
    case Setting::kText:
      return parse_calibration(text);
    case Setting::kKeyList:
      return parse_key_list(text);
    case Setting::kFile:
      break;
  }
  return read_calibration(std::filesystem::path(text));
}

Result<CameraSetting> parse_camera_setting(std::string_view text) {
  switch (kind_of(text)) {
    case Setting::kText:
      return parse_content(text, "", [&] { return parse_rig(text); });
    case Setting::kKeyList:
      return parse_key_list(text);
    case Setting::kFile:
      break;
  }
  const std::filesystem::path path(text);
  if (is_rig_folder(path)) return read_rig(path);
  // Either of OpenCV's two files, or both; the one with the lenses is a calibration by itself.
  if (files_of_rig(path).size() == 2 && !read_calibration(path)) return read_rig(path);
  const auto content = read_file(path.string(), std::max(kMaxRigBytes, kMaxZoomBytes));
  // Whoever reads a calibration says best why it cannot be read.
  if (!content) return read_calibration(path);
  return parse_content(*content, path.string(), [&] { return read_rig(path); });
}

Calibration* one_camera_of(CameraSetting& setting) noexcept {
  if (auto* stereo = std::get_if<StereoFile>(&setting)) return &stereo->first;
  return std::get_if<Calibration>(&setting);
}

Rig* rig_of(CameraSetting& setting) noexcept {
  auto* stereo = std::get_if<StereoFile>(&setting);
  if (stereo == nullptr) return std::get_if<Rig>(&setting);
  return stereo->pair ? &*stereo->pair : nullptr;
}

}  // namespace calvin
