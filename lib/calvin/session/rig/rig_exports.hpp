// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Further files of a rig, in the formats of other programs.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "calvin/core/result.hpp"
#include "calvin/core/rig.hpp"

namespace calvin {

struct RigExport {
  std::string format;
  std::string path;  // a file, or the folder of a format that has several
};

// Those of rig_formats(), and of two cameras "opencv" (the stereo parameters, YAML; where the path
// ends with / or is a folder, intrinsics.yml and extrinsics.yml in it, as OpenCV's sample has them)
// and "ros" (a folder with left.yaml and right.yaml).
[[nodiscard]] std::vector<std::string_view> rig_export_formats();

// "FORMAT:PATH,FORMAT:PATH"; none in an empty text. kInvalidArgument, with a right one, and for two
// of one path. Looks at no disk.
[[nodiscard]] Result<std::vector<RigExport>> parse_rig_exports(std::string_view text);

// Files are written whole. Errors of write_rig(); kInvalidArgument where a rig of other than two
// cameras is to be a stereo pair.
[[nodiscard]] Status write_rig_export(const RigExport& to, const Rig& rig);

}  // namespace calvin
