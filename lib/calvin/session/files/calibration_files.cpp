// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The files that a session keeps up to date: their text, and whether they can be.

#include "calvin/session/files/calibration_files.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "calvin/core/file.hpp"
#include "calvin/core/text.hpp"
#include "calvin/io/calibration_io.hpp"
#include "calvin/solve/auto_model.hpp"

namespace calvin {

namespace {

const CalibrationFile* written_twice(const std::vector<CalibrationFile>& files) {
  for (auto file = files.begin(); file != files.end(); ++file) {
    const auto other = std::find_if(files.begin(), file, [&](const CalibrationFile& f) {
      return is_same_file(f.path, file->path);
    });
    if (other != file) return &*file;
  }
  return nullptr;
}

// The file whose copy would be one of the files, if any.
const CalibrationFile* copied_over(const std::vector<CalibrationFile>& files) {
  const auto file = std::ranges::find_if(files, [&files](const CalibrationFile& f) {
    return std::ranges::any_of(files, [copy = copy_of(f.path)](const CalibrationFile& other) {
      return is_same_file(copy, other.path);
    });
  });
  return file == files.end() ? nullptr : &*file;
}

}  // namespace

std::string copy_of(const std::string& path) { return path + "~"; }

Status keep_copy(const std::string& path) {
  const auto bytes = read_file(path);
  if (!bytes) return tl::unexpected<Error>(bytes.error());
  return write_file(copy_of(path), *bytes);
}

Result<std::vector<CalibrationFile>> parse_calibration_files(const std::string& location,
                                                             const std::string& exports) {
  std::vector<CalibrationFile> files;
  if (!location.empty()) files.push_back({"calvin", location});
  if (trim(exports).empty()) return files;
  const auto formats = calibration_formats();
  for (const std::string_view item : split(exports, ',')) {
    if (item.empty()) continue;
    const auto colon = item.find(':');
    const std::string_view format = item.substr(0, colon);
    const bool known = std::find(formats.begin(), formats.end(), format) != formats.end();
    if (!known || colon == std::string_view::npos || colon + 1 == item.size()) {
      return make_error(ErrorCode::kInvalidArgument,
                        fmt::format("The export '{}' is wrong. A right text is "
                                    "'ros:camera.yaml', several separated by commas; the formats "
                                    "are {}.",
                                    item, join(formats, ", ")));
    }
    files.push_back({std::string(format), std::string(item.substr(colon + 1))});
  }
  return files;
}

Status are_different_files(const std::vector<CalibrationFile>& files) {
  if (const CalibrationFile* copied = copied_over(files)) {
    return make_error(ErrorCode::kInvalidArgument,
                      fmt::format("'{0}~' is to hold the calibration, and what '{0}' held of "
                                  "another session is kept there: give it another name.",
                                  copied->path));
  }
  const CalibrationFile* file = written_twice(files);
  if (file == nullptr) return {};
  return make_error(ErrorCode::kInvalidArgument,
                    fmt::format("'{}' is to hold the calibration twice, by location and export "
                                "or by two exports: give each format a file of its own.",
                                file->path));
}

Status can_hold_all(const std::vector<CalibrationFile>& files, const std::string& model) {
  if (model == kAutoModel) return {};
  for (const CalibrationFile& file : files) {
    if (Status status = can_hold(file.format, model); !status) return status;
  }
  return {};
}

Status can_write_all(const std::vector<CalibrationFile>& files) {
  for (const CalibrationFile& file : files) {
    if (Status status = can_write(file.path); !status) return status;
  }
  return {};
}

}  // namespace calvin
