// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What a session makes of its camera: of where the lens stands, and of frames that do not come.

#include <utility>

#include "calvin/session/calibration_session.hpp"

namespace calvin {

void CalibrationSession::see_lens(const Result<LensState>& read) {
  for (Notice& notice : lens_.see(read)) say_later(std::move(notice));
}

void CalibrationSession::wait_for_lens() {
  if (auto notice = lens_.wait_for_answer()) say_later(*std::move(notice));
}

void CalibrationSession::second_passed(bool frames_expected) {
  const std::size_t kept = views_.views().size();
  switch (stream_.second_passed(frames_expected)) {
    case StreamWatch::Change::kSilent:
      say_later(frames_stopped(stream_.patience(), kept));
      break;
    case StreamWatch::Change::kBack:
      say_later(frames_again(kept));
      break;
    case StreamWatch::Change::kNone:
      break;
  }
}

}  // namespace calvin
