// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Compares each reading of a lens with the one at the first view, and has the words for it.

#include "calvin/session/watch/lens_watch.hpp"

#include <string_view>

#include <fmt/format.h>

#include "calvin/core/text.hpp"

namespace calvin {

namespace {

Notice warning(ErrorCode code, std::string words) {
  return {Notice::Kind::kWarning, {code, std::move(words)}};
}

Notice info(std::string words) {
  return {Notice::Kind::kInfo, {ErrorCode::kInvalidArgument, std::move(words)}};
}

// " (HD Pro Webcam C920)", or nothing.
std::string in_brackets(const std::string& name) {
  return name.empty() ? "" : fmt::format(" ({})", name);
}

constexpr std::string_view kAutofocusOff = "focus_automatic_continuous=0";

}  // namespace

void LensWatch::begin() {
  for (WatchedControl* control : {&focus_, &zoom_}) *control = {control->now, std::nullopt, true};
  has_views_ = view_since_read_ = told_moved_ = false;
}

void LensWatch::view_taken() {
  has_views_ = view_since_read_ = true;
  for (WatchedControl* control : {&focus_, &zoom_}) {
    if (!control->first) control->first = control->now;
    if (control->has_moved() || unreadable_) control->steady = false;
  }
  if (autofocus_) focus_.steady = false;
}

void LensWatch::views_restored() {
  view_taken();
  focus_.steady = zoom_.steady = false;
}

void LensWatch::see_state(const LensState& lens) {
  device_ = lens.device;
  autofocus_ = lens.device.autofocus.value_or(false);
  focus_.now = lens.focus;
  zoom_.now = lens.zoom;
  // Between two readings a lens that has moved may have done so before the view.
  const bool between = std::exchange(view_since_read_, false);
  for (WatchedControl* control : {&focus_, &zoom_}) {
    if (has_views_ && !control->first) control->first = control->now;
    if (between && control->has_moved()) control->steady = false;
  }
  // It may be on its way: where it is read to be it need not stay, nor have got to yet.
  if (between && autofocus_) focus_.steady = false;
}

std::vector<Notice> LensWatch::see(const Result<LensState>& read) {
  unanswered_ = 0;
  std::vector<Notice> notices;
  if (!read) {
    if (std::exchange(unreadable_, true)) return notices;
    notices.push_back(
        warning(read.error().code, read.error().message + " The session goes on without it."));
    return notices;
  }
  if (std::exchange(unreadable_, false)) {
    notices.push_back(info(fmt::format("The lens of the camera '{}' is read again.", node_)));
  }
  see_state(*read);
  if (auto notice = autofocus_notice()) notices.push_back(*std::move(notice));
  if (auto notice = moved_notice()) notices.push_back(*std::move(notice));
  return notices;
}

std::optional<Notice> LensWatch::wait_for_answer() {
  constexpr int kLongestSilence = 5;  // s: the drivers of USB cameras themselves give up after that
  if (++unanswered_ < kLongestSilence || std::exchange(unreadable_, true)) return std::nullopt;
  return warning(
      ErrorCode::kIo,
      fmt::format("The camera '{}' has not told its focus for {} s: its driver waits for "
                  "it. Unplug the camera and plug it in again; dmesg may tell more. The "
                  "session goes on without it.",
                  node_, kLongestSilence));
}

std::optional<Notice> LensWatch::autofocus_notice() {
  if (std::exchange(told_autofocus_, autofocus_) == autofocus_) return std::nullopt;
  if (autofocus_) {
    return warning(
        ErrorCode::kInvalidArgument,
        fmt::format("Autofocus is on: the camera '{}'{} moves its lens as it likes, and a "
                    "calibration holds for one focus alone. Switch it off, by v4l2-ctl -d {} -c {} "
                    "or by v4l2src extra-controls=\"c,{}\"{}.",
                    node_, in_brackets(device_->name), node_, kAutofocusOff, kAutofocusOff,
                    has_views_ ? ", and emit the signal reset to begin anew" : ""));
  }
  return info(fmt::format("Autofocus of the camera '{}' is off.{}", node_,
                          has_views_ && !focus_.steady
                              ? " Views were taken while it was on: emit the signal reset to begin "
                                "anew with the lens where it is."
                              : ""));
}

std::optional<Notice> LensWatch::moved_notice() {
  std::vector<std::string> moves;
  std::vector<std::string> commands;
  if (autofocus_) commands.emplace_back(kAutofocusOff);
  const std::pair<const char*, const WatchedControl*> controls[] = {{"focus", &focus_},
                                                                    {"zoom", &zoom_}};
  for (const auto& [name, control] : controls) {
    if (!control->has_moved()) continue;
    moves.push_back(fmt::format("{} from {} to {}", name, *control->first, *control->now));
    commands.push_back(fmt::format("{}_absolute={}", name, *control->first));
  }
  const bool moved = !moves.empty();
  if (std::exchange(told_moved_, moved) == moved) return std::nullopt;
  if (moved) {
    return warning(
        ErrorCode::kInvalidArgument,
        fmt::format("The lens of the camera '{}'{} was moved after the first view: {}. Views of "
                    "both are not of one camera: put it back, by v4l2-ctl -d {} -c {}, or emit the "
                    "signal reset to begin anew with the lens where it is.",
                    node_, in_brackets(device_->name), join(moves, ", "), node_,
                    join(commands, ",")));
  }
  return info(
      fmt::format("The lens of the camera '{}' is where it was at the first view.{}", node_,
                  focus_.steady && zoom_.steady
                      ? ""
                      : " Views were taken meanwhile: emit the signal reset, or remove-view "
                        "for each of them."));
}

std::optional<LensState> LensWatch::of_views() const {
  if (!device_) return std::nullopt;
  LensState lens{*device_, std::nullopt, std::nullopt};
  if (focus_.steady) lens.focus = focus_.first;
  if (zoom_.steady) lens.zoom = zoom_.first;
  return lens;
}

}  // namespace calvin
