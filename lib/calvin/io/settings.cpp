// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Tells text that is a calibration from text that names a file, in the order that
// docs/elements/calibundistort.md gives.

#include "calvin/io/settings.hpp"

#include <algorithm>
#include <filesystem>
#include <string>
#include <system_error>

#include "calvin/core/file.hpp"
#include "calvin/core/text.hpp"
#include "calvin/io/calibration_io.hpp"
#include "calvin/io/key_list.hpp"
#include "calvin/io/rig_io.hpp"
#include "calvin/io/zoom_io.hpp"

namespace calvin {

namespace {

enum class Setting { kText, kFile, kKeyList };

bool is_content(std::string_view text) {
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  const std::string_view start = trim(text);
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
  const Setting kind = kind_of(text);
  if (kind == Setting::kText && is_rig(text)) return parse_rig(text);
  if (kind == Setting::kText && is_zoom_table(text)) return parse_zoom_table(text);
  if (kind == Setting::kFile) {
    const std::filesystem::path path(text);
    if (is_rig_folder(path)) return read_rig(path);
    // Either of OpenCV's two files, or both; the one with the lenses is a calibration by itself.
    if (files_of_rig(path).size() == 2 && !read_calibration(path)) return read_rig(path);
    const auto content = read_file(path.string(), std::max(kMaxRigBytes, kMaxZoomBytes));
    if (content && is_rig(*content)) return parse_rig(*content, path.string());
    if (content && is_zoom_table(*content)) return parse_zoom_table(*content, path.string());
  }
  return parse_calibration_setting(text);
}

}  // namespace calvin
