// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// How the lens stood while the views of a session were taken. A calibration holds for one focus and
// one zoom alone.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "calvin/core/result.hpp"
#include "calvin/device/lens.hpp"
#include "calvin/session/guidance/notice.hpp"

namespace calvin {

// One control of a lens.
struct WatchedControl {
  std::optional<int> now;
  std::optional<int> first;  // at the first view
  bool steady = true;        // it was there for all views

  [[nodiscard]] bool has_moved() const { return first && now && *first != *now; }
};

// What it tells is told when it begins to be so, and again only after it was not.
class LensWatch {
 public:
  LensWatch() = default;
  // Of the camera that has this V4L2 node; empty: nothing is read.
  explicit LensWatch(std::string node) : node_(std::move(node)) {}
  [[nodiscard]] const std::string& node() const noexcept { return node_; }

  // The views before are forgotten.
  void begin();
  void view_taken();
  // Views of before, of which nobody knows how the lens stood.
  void views_restored();

  // What was read, and what the user should hear of it.
  [[nodiscard]] std::vector<Notice> see(const Result<LensState>& read);
  // To be called once a second while a read has not ended.
  [[nodiscard]] std::optional<Notice> wait_for_answer();

  // What a calibration of the views is to tell of its camera: of the controls those that stood
  // still for all of them. Absent where nothing was read.
  [[nodiscard]] std::optional<LensState> of_views() const;

 private:
  void see_state(const LensState& lens);
  [[nodiscard]] std::optional<Notice> autofocus_notice();
  [[nodiscard]] std::optional<Notice> moved_notice();

  std::string node_;
  std::optional<CaptureDevice> device_;  // as it was read last
  WatchedControl focus_;
  WatchedControl zoom_;
  bool autofocus_ = false;
  bool has_views_ = false;
  bool view_since_read_ = false;
  int unanswered_ = 0;  // s

  // What was told.
  bool unreadable_ = false;
  bool told_autofocus_ = false;
  bool told_moved_ = false;
};

}  // namespace calvin
