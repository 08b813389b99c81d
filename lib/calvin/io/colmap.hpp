// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The text model of COLMAP (cameras.txt, images.txt), as a rig: every picture is a camera of its
// own, which stands where it was taken. Internal.
#pragma once

#include <string>
#include <string_view>

#include "calvin/core/result.hpp"
#include "calvin/core/rig.hpp"

namespace calvin::io {

// The content of both files.
struct ColmapModel {
  std::string cameras;
  std::string images;
};

// Lengths have no unit, but for a model that was printed here of a rig that has one. kMalformed
// with the file and the line, kUnsupported for a lens that is none of ours.
[[nodiscard]] Result<Rig> read_colmap(std::string_view cameras, std::string_view images);
// kUnsupported for a camera model that COLMAP does not have, and for skew.
[[nodiscard]] Result<ColmapModel> print_colmap(const Rig& rig);

}  // namespace calvin::io
