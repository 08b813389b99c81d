// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The formats of a rig's file, each in a file named after it: rig_native.cpp, kalibr.cpp,
// opencv_stereo.cpp, caliscope.cpp, bouguet.cpp; and of folders of files, mrcal.cpp and colmap.hpp.
// Readers take a map that they recognised and check every camera.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "calvin/core/rig.hpp"
#include "calvin/io/document.hpp"

namespace calvin::io {

[[nodiscard]] bool is_native_rig(const Node& root);
[[nodiscard]] Result<Rig> read_native_rig(const Node& root);
[[nodiscard]] Result<std::string> print_native_rig(const Rig& rig);

// The camchain of Kalibr (github.com/ethz-asl/kalibr, YAML), of one camera or many: each is placed
// by T_cn_cnm1 before the one with the number below, or, where that is absent, by T_cam_imu of
// both. The frame is that of cam0.
[[nodiscard]] bool is_kalibr(const Node& root);
[[nodiscard]] Result<Rig> read_kalibr(const Node& root);
// kUnsupported for a camera model that Kalibr does not have, and for skew.
[[nodiscard]] Result<std::string> print_kalibr(const Rig& rig);
[[nodiscard]] bool kalibr_holds(std::string_view model);

// The camera_array.toml or config.toml of caliscope and the calibration.toml of aniposelib; printed
// is the first of them. kUnsupported for a camera model that OpenCV does not have.
[[nodiscard]] bool is_caliscope(const Node& root);
// Whether it is one of more than one camera.
[[nodiscard]] bool is_caliscope_rig(const Node& root);
[[nodiscard]] Result<Rig> read_caliscope(const Node& root);
[[nodiscard]] Result<std::string> print_caliscope(const Rig& rig);

// One camera of mrcal's, without a name. `extrinsics` takes points of a frame that all files of a
// rig share to the camera. kUnsupported for a camera model that mrcal does not have, and for skew.
[[nodiscard]] bool is_mrcal(const Node& root);
[[nodiscard]] Result<RigCamera> read_mrcal(const Node& root);
[[nodiscard]] Result<std::string> print_mrcal(const RigCamera& camera);

// M1 D1 M2 D2 R T of OpenCV's sample stereo_calib, in one file; without image_width and
// image_height the lenses are of pictures of any size. Lengths are taken for metres.
[[nodiscard]] bool is_opencv_stereo(const Node& root);
[[nodiscard]] Result<Rig> read_opencv_stereo(const Node& root);
// Either of the two files that the sample writes: the lenses, or where they stand. What is missing
// is said.
[[nodiscard]] bool is_half_of_opencv_stereo(const Node& root);
[[nodiscard]] Result<Rig> read_half_of_opencv_stereo(const Node& root);
// The same of the texts of both files; what both have is taken from the first. Never throw.
[[nodiscard]] bool is_half_of_opencv_stereo(std::string_view content) noexcept;
[[nodiscard]] Result<Rig> join_opencv_stereo(std::string_view one, std::string_view other);

// Calib_Results_stereo of Bouguet's toolbox, as text: om or R, T in mm, and what is known of both
// cameras.
[[nodiscard]] bool is_bouguet_stereo(const Node& root);
[[nodiscard]] Result<Rig> read_bouguet_stereo(const Node& root);

// ---- Folders: rig_folder.cpp

// mrcal's models, each camera called as its file is without `.cameramodel`, or COLMAP's cameras.txt
// and images.txt, or OpenCV's stereo parameters in two files. kMalformed for a folder without any.
[[nodiscard]] Result<Rig> read_rig_folder(const std::filesystem::path& folder);
// The folder is made where there is none; each file is written whole. kInvalidArgument where names
// of cameras are no names of files, or are one, and where the folder has models of other cameras,
// which would be taken for cameras of the rig.
[[nodiscard]] Status write_mrcal_folder(const std::filesystem::path& folder, const Rig& rig);
[[nodiscard]] Status write_colmap_folder(const std::filesystem::path& folder, const Rig& rig);

}  // namespace calvin::io
