// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The text of an element's property `calibration`: a file, or a calibration in itself.
#pragma once

#include <string_view>
#include <variant>

#include "calvin/camera/zoom_table.hpp"
#include "calvin/core/calibration.hpp"
#include "calvin/core/result.hpp"
#include "calvin/core/rig.hpp"

namespace calvin {

// In this order: text that starts with `{` is JSON, with `<` or `%YAML` OpenCV's XML or YAML (the
// settings of the GStreamer element cameraundistort are), an existing file is read, text with `=`
// is a key list (io/key_list.hpp). Anything else is a path that does not exist yet: kNotFound, and
// the caller may wait for it. Other errors as of parse_calibration() and read_calibration().
[[nodiscard]] Result<Calibration> parse_calibration_setting(std::string_view text);

// A file of a stereo pair that programs of one camera read as well: OpenCV's M1 D1 M2 D2 and the
// Calib_Results_stereo of Bouguet's toolbox.
struct StereoFile {
  Calibration first;  // for whoever has one camera
  Result<Rig> pair;   // an Error where it does not say, or not well, how the cameras stand
};

// The same, for an element that knows what to do with the cameras of a rig and with the settings of
// a zoom table: their JSON or their file. Other errors as of parse_rig() and parse_zoom_table().
using CameraSetting = std::variant<Calibration, Rig, ZoomTable, StereoFile>;
[[nodiscard]] Result<CameraSetting> parse_camera_setting(std::string_view text);

// What the setting has for whoever has one camera, and for whoever has a pair; else nullptr.
[[nodiscard]] Calibration* one_camera_of(CameraSetting& setting) noexcept;
[[nodiscard]] Rig* rig_of(CameraSetting& setting) noexcept;

// Whether the text is (or will be) the path of a file, rather than a calibration in itself: then it
// may be worth looking again for a newer one.
[[nodiscard]] bool is_calibration_path(std::string_view text);

// False only where the text tells its calibration by itself. Does not look into any folder but the
// current one: for whoever must not wait for a disk or a network.
[[nodiscard]] bool may_be_calibration_path(std::string_view text);

}  // namespace calvin
