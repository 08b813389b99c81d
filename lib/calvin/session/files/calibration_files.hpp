// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The files that a session keeps up to date: the properties `location` and `export` of calibsolve.
#pragma once

#include <string>
#include <vector>

#include "calvin/core/result.hpp"

namespace calvin {

struct CalibrationFile {
  std::string format;  // a name of calibration_formats()
  std::string path;
};

// `location` is native JSON; `exports` is "FORMAT:PATH,FORMAT:PATH". Both may be empty. Looks at no
// disk.
[[nodiscard]] Result<std::vector<CalibrationFile>> parse_calibration_files(
    const std::string& location, const std::string& exports);

// Where what another session left in a file is kept when it is replaced.
[[nodiscard]] std::string copy_of(const std::string& path);
// Copies a file there.
[[nodiscard]] Status keep_copy(const std::string& path);

// Whether each is a file of its own, and none the copy_of() another: two texts for one would
// overwrite each other at every solve.
[[nodiscard]] Status are_different_files(const std::vector<CalibrationFile>& files);

// The first file whose format has no camera model of that name. A model of `auto` may be any.
[[nodiscard]] Status can_hold_all(const std::vector<CalibrationFile>& files,
                                  const std::string& model);

// The first file that could not be written now.
[[nodiscard]] Status can_write_all(const std::vector<CalibrationFile>& files);

}  // namespace calvin
