// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

#include "calvin/io/settings.hpp"

#include <filesystem>
#include <string>
#include <system_error>

#include "calvin/core/text.hpp"
#include "calvin/io/calibration_io.hpp"
#include "calvin/io/key_list.hpp"

namespace calvin {

namespace {

enum class Setting { kText, kFile, kKeyList };

Setting kind_of(std::string_view text) {
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  const std::string_view start = trim(text);
  if (start.empty() || start.starts_with('{') || start.starts_with('<') ||
      start.starts_with("%YAML")) {
    return Setting::kText;
  }
  std::error_code error;
  if (std::filesystem::exists(std::filesystem::path(text), error)) return Setting::kFile;
  return text.find('=') != std::string_view::npos ? Setting::kKeyList : Setting::kFile;
}

}  // namespace

bool is_calibration_path(std::string_view text) { return kind_of(text) == Setting::kFile; }

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

}  // namespace calvin
