// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The property `recheck`: each board found is held against an existing calibration.

#include "detect/calibration_check.hpp"

#include <string>
#include <utility>

#include <fmt/format.h>

#include "calvin/camera/frame_fit.hpp"
#include "common/values.hpp"

namespace calvin::gst {

void CalibrationCheck::fit(ImageSize size, std::vector<Error>& warnings) {
  if (std::exchange(size_, size) == size) return;
  watch_.reset();
  const auto fitted = fit_to_frame(calibration_, size);
  if (!fitted) {
    warnings.push_back(fitted.error());
    return;
  }
  if (fitted->scaled) {
    warnings.push_back(
        {ErrorCode::kInvalidArgument,
         fmt::format("The calibration to check against is for {}x{} px and is scaled to "
                     "the frames of {}x{}.",
                     calibration_.image_size.width, calibration_.image_size.height, size.width,
                     size.height)});
  }
  watch_.emplace(fitted->camera, calibration_);
}

GstStructure* CalibrationCheck::check(const View& view, int place, const FrameTimes& times,
                                      std::vector<Error>& warnings) {
  fit(view.observation.image_size, warnings);
  if (!watch_) return nullptr;
  const auto report = watch_->add(view, place);
  if (!report) return nullptr;
  GstStructure* s = new_message("calib-check", times, view.observation.camera);
  gst_structure_set(s, "board", G_TYPE_STRING, view.observation.board.c_str(), "points", G_TYPE_INT,
                    report->points, "rms", G_TYPE_DOUBLE, report->rms, "moved", G_TYPE_DOUBLE,
                    report->displacement, "moved-sigma", G_TYPE_DOUBLE, report->displacement_sigma,
                    nullptr);
  const std::string hint = advice(*report);
  if (!hint.empty()) gst_structure_set(s, "hint", G_TYPE_STRING, hint.c_str(), nullptr);
  for (const auto& [name, error] :
       {std::pair{"expected-error", calibration_.expected_error},
        std::pair{"expected-error-anywhere", calibration_.expected_error_anywhere}}) {
    if (error) gst_structure_set(s, name, G_TYPE_DOUBLE, *error, nullptr);
  }
  // Where the board looks the same after a turn nobody knows its pose.
  if (view.observation.ambiguous.empty()) {
    set_doubles(s, "rotation", report->camera_from_board.rotation);
    set_doubles(s, "translation", report->camera_from_board.translation);
  }
  return s;
}

}  // namespace calvin::gst
