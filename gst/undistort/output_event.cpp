// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What downstream is told of the frames that come out.

#include "undistort/output_event.hpp"

#include <utility>

#include "calvin/io/calibration_io.hpp"
#include "common/calibration_event.hpp"

namespace calvin::gst {

namespace {

EventPtr event_of(const Camera& camera, const std::string& name, bool undistorted) {
  Calibration calibration = camera.to_calibration();
  calibration.camera = name;
  return EventPtr(
      new_calibration_event({name, print_calibration(calibration).value_or(""), undistorted}));
}

}  // namespace

EventPtr OutputEvent::make(const FrameUndistorter& undistorter, const CalibrationInput& input,
                           const Cause& cause) const {
  const auto& camera = input.camera();
  GstEvent* upstream = input.event();
  const bool scales = undistorter.current() && !undistorter.undistorts();
  if (undistorter.undistorts() || (scales && camera && (upstream != nullptr || own_))) {
    if (own_ && cause_ == cause) return nullptr;
    const auto output = undistorter.output_of(camera);
    const bool undistorted =
        undistorter.undistorts() ? !undistorter.distorts() : input.comes_undistorted();
    if (output) return event_of(*output, input.name(), undistorted);
    // The pixels have moved in a way that no calibration tells of.
    if (undistorter.undistorts()) return EventPtr(new_calibration_event({{}, {}, undistorted}));
  }
  if (upstream != nullptr) {
    return EventPtr(upstream == sent_.get() ? nullptr : gst_event_ref(upstream));
  }
  if (!own_ || cause_ == cause) return nullptr;
  return camera && !scales ? event_of(*camera, input.name(), false)
                           : EventPtr(new_calibration_event({}));
}

EventPtr OutputEvent::next(const FrameUndistorter& undistorter, const CalibrationInput& input) {
  Cause cause = {undistorter.current(), undistorter.undistorts() ? 0 : input.serial()};
  EventPtr event = make(undistorter, input, cause);
  if (!event) return nullptr;
  const bool own = event.get() != input.event();
  cause_ = std::move(cause);
  // A camera that turns is the same camera.
  if (own && own_ &&
      gst_structure_is_equal(gst_event_get_structure(event.get()),
                             gst_event_get_structure(sent_.get()))) {
    return nullptr;
  }
  own_ = own;
  sent_.reset(gst_event_ref(event.get()));
  return event;
}

}  // namespace calvin::gst
