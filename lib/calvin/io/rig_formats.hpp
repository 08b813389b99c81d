// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The formats of a rig's file, each in a file named after it: rig_native.cpp, kalibr.cpp,
// opencv_stereo.cpp. Readers take a map that they recognised and check every camera.
#pragma once

#include <string>

#include "calvin/core/rig.hpp"
#include "calvin/io/document.hpp"

namespace calvin::io {

[[nodiscard]] bool is_native_rig(const Node& root);
[[nodiscard]] Result<Rig> read_native_rig(const Node& root);
[[nodiscard]] Result<std::string> print_native_rig(const Rig& rig);

// The camchain of Kalibr (github.com/ethz-asl/kalibr, YAML), of one camera or many: each is placed
// by T_cn_cnm1 before the one with the number below. The frame is that of cam0.
[[nodiscard]] bool is_kalibr(const Node& root);
[[nodiscard]] Result<Rig> read_kalibr(const Node& root);
// kUnsupported for a camera model that Kalibr does not have, and for skew.
[[nodiscard]] Result<std::string> print_kalibr(const Rig& rig);
[[nodiscard]] bool kalibr_holds(std::string_view model);

// M1 D1 M2 D2 R T of OpenCV's sample stereo_calib, in one file, with image_width and image_height;
// lengths are taken for metres.
[[nodiscard]] bool is_opencv_stereo(const Node& root);
[[nodiscard]] Result<Rig> read_opencv_stereo(const Node& root);

}  // namespace calvin::io
