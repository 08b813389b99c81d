// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The text files of BlueCCal (MultiCamSelfCal): where several cameras have seen one light.
// docs/formats.md.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "calvin/core/result.hpp"
#include "calvin/io/observations.hpp"

namespace calvin {

// The contents of the files. `visible` and `names` may be empty.
struct BlueCcalText {
  std::string_view points;   // points.dat: u, v and 1 of each camera, a row each; a column a frame
  std::string_view visible;  // IdMat.dat: a row for each camera, 0 where it has not seen the light
  std::string_view sizes;    // Res.dat: width and height of each camera
  std::string_view names;    // camera_order.txt: a name in each line
};

// A file of observations for each camera, of the board "dot" with the point 0. Frame n has the
// timestamp n s. A point that is no number was not seen; the files tell no sigmas. Cameras without
// names are cam0, cam1 and so on. kMalformed where files are broken or do not fit together; the
// message begins with `name`.
[[nodiscard]] Result<std::vector<ObservationFile>> parse_blueccal(const BlueCcalText& text,
                                                                  std::string_view name = "");

// parse_blueccal() of points.dat, IdMat.dat, Res.dat and camera_order.txt of a folder, of which the
// second and the last may be missing; errors as of read_file(), which say what a folder has to
// hold.
[[nodiscard]] Result<std::vector<ObservationFile>> read_blueccal(
    const std::filesystem::path& folder);

}  // namespace calvin
