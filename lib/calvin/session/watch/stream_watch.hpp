// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Whether a camera has stopped sending.
#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>

namespace calvin {

// It counts seconds in which no frame came, and not the time since the last one: a program that was
// stopped for a while, or a machine that slept, says nothing of its camera.
class StreamWatch {
 public:
  enum class Change { kNone, kSilent, kBack };

  // ns from one frame to the next; 0: not known.
  void set_frame_duration(std::uint64_t duration) noexcept {
    constexpr std::uint64_t kFrames = 3;
    constexpr std::uint64_t kSecond = 1'000'000'000;
    patience_ = std::max<std::uint64_t>(kPatience, kFrames * duration / kSecond);
  }
  void frame_came() noexcept { came_ = true; }

  // To be called once a second. `expected`: a frame could have come, for the stream plays, has not
  // ended, and nobody holds the frame before.
  [[nodiscard]] Change second_passed(bool expected) noexcept {
    if (std::exchange(came_, false)) {
      silent_ = 0;
      return std::exchange(told_, false) ? Change::kBack : Change::kNone;
    }
    silent_ = expected ? silent_ + 1 : 0;
    if (told_ || silent_ < patience_) return Change::kNone;
    told_ = true;
    return Change::kSilent;
  }
  // Seconds of silence before it is told.
  [[nodiscard]] std::uint64_t patience() const noexcept { return patience_; }

 private:
  // s. A camera that changes its exposure or its mode, and a bus that is reset, take up to three.
  static constexpr std::uint64_t kPatience = 5;

  std::uint64_t patience_ = kPatience;
  std::uint64_t silent_ = 0;  // s
  bool came_ = false;         // since the second before
  bool told_ = false;
};

}  // namespace calvin
