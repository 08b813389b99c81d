// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Files of rigs: the native one (JSON), Kalibr's camchain, caliscope's camera_array.toml, OpenCV's
// stereo parameters in one file or two, known by their content; and folders of mrcal's models and
// of COLMAP's. docs/formats.md.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "calvin/core/export.hpp"
#include "calvin/core/result.hpp"
#include "calvin/core/rig.hpp"

namespace calvin {

// More is no rig.
inline constexpr std::size_t kMaxRigBytes = std::size_t{64} << 20;

// The calibration of every camera makes a Camera, once its image size is known: OpenCV's stereo
// parameters need not say it, and are then of pictures of any size (0x0). kMalformed for broken
// content, kUnsupported for what a newer version has written; the message names `name` and says
// what is wrong.
[[nodiscard]] CALVIN_API Result<Rig> parse_rig(std::string_view content,
                                               std::string_view name = "");

// parse_rig() of a file, or what the files of a folder are together, or OpenCV's intrinsics.yml and
// extrinsics.yml, by the path of either or of both as "ONE,OTHER"; errors as of read_calibration().
[[nodiscard]] CALVIN_API Result<Rig> read_rig(const std::filesystem::path& path);

// The inverse, in one of rig_formats(): numbers read back as the same; only the native format holds
// everything. kInvalidArgument for an unknown format, one that is a folder of files, where a camera
// has no image size, and for a rig that could not be read back: without cameras, with a name twice
// or with numbers that are not finite; kUnsupported where the format has no such camera model.
[[nodiscard]] CALVIN_API Result<std::string> print_rig(const Rig& rig,
                                                       std::string_view format = "calvin");

// print_rig(), then the file is written whole, as write_calibration() does. "mrcal" and "colmap"
// are folders, which are made where there are none; kInvalidArgument where the folder has models of
// other cameras.
[[nodiscard]] CALVIN_API Status write_rig(const std::filesystem::path& path, const Rig& rig,
                                          std::string_view format = "calvin");

// "calvin", "kalibr", "caliscope", "mrcal", "colmap".
[[nodiscard]] CALVIN_API std::vector<std::string_view> rig_formats();

// ---- Internal, and not exported

// Whether the content says that it is a rig and no single camera, sound or not. OpenCV's stereo
// parameters and Bouguet's are the calibration of their first camera too, and do not count.
[[nodiscard]] bool is_rig(std::string_view content) noexcept;

// Whether the content is one of these: the lenses of a stereo pair in the names of OpenCV or of
// Bouguet's toolbox, with or without the places of the cameras.
[[nodiscard]] bool is_stereo_file(std::string_view content) noexcept;

// Whether there is a folder of that name that has models of mrcal's, COLMAP's images.txt or
// OpenCV's intrinsics.yml and extrinsics.yml.
[[nodiscard]] bool is_rig_folder(const std::filesystem::path& path) noexcept;

// The files that read_rig() of a path may read: itself, itself and the other one of OpenCV's
// intrinsics.yml and extrinsics.yml where that lies beside it, both of "ONE,OTHER" where they are
// there, or those of a folder. None where a folder has no rig. What is in them is not looked at.
[[nodiscard]] std::vector<std::filesystem::path> files_of_rig(const std::filesystem::path& path);

}  // namespace calvin
