// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Waits for a board that comes nearer to the view that is asked for, and takes what there is of one
// that does not.

#include "calvin/session/guidance/guided_capture.hpp"

#include <algorithm>

#include "calvin/session/progress.hpp"

namespace calvin {

namespace {

constexpr double kPassing = 0.5;     // of what the view asked for tells: of who passes by
constexpr double kPatience = 8e9;    // ns, after which anything new is welcome
constexpr double kReaction = 1.5e9;  // ns, in which who follows has come nearer
constexpr double kTooLong = 4e9;     // ns, after which nobody is asked to hold it still
constexpr double kPause = 0.5e9;     // ns between views of one movement
constexpr double kMuchNearer = 0.7;  // of the first distance
constexpr double kNearer = 0.95;     // of what was nearer before
constexpr double kTurnedAway = 1.1;  // of the least distance

}  // namespace

void GuidedCapture::restart(std::uint64_t now) {
  since_ = now;
  change_target(now);
}

void GuidedCapture::change_target(std::uint64_t now) {
  nearer_ = now;
  first_.reset();
}

void GuidedCapture::follow(double distance, std::uint64_t now) {
  if (!first_) first_ = nearest_ = near_ = distance;
  if (distance < kNearer * near_) {
    near_ = distance;
    nearer_ = now;
  }
  nearest_ = std::min(nearest_, distance);
  if (static_cast<double>(now - nearer_) > kReaction) {
    follows_ = false;
  } else if (nearest_ < kMuchNearer * *first_) {
    follows_ = true;
  }
}

ViewWorth GuidedCapture::worth(const std::optional<NearView>& view, std::uint64_t now) {
  if (now == kNoTimestamp) return {};
  if (since_ == kNoTimestamp || now < since_) restart(now);
  const auto waited = static_cast<double>(now - since_);
  const bool paused = waited > kPause;
  // The first views may be of anything.
  if (!view) return {true, false, paused};
  follow(view->distance, now);
  const bool turned_away = view->distance > kTurnedAway * nearest_;
  const double patience = 1 - std::min(1.0, waited / kPatience);
  const bool is_enough = view->share >= Progress::kEnoughShare * patience;
  const bool is_enough_moving = view->share >= kPassing || waited > kPatience;
  return {is_enough, is_enough_moving && (turned_away || waited > kTooLong), !follows_ && paused};
}

}  // namespace calvin
