// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The settings of an element, which the application's threads change while others read them.
#pragma once

#include <mutex>

namespace calvin::gst {

// The base of the class behind an element. It may guard more of its own by the same lock.
template <typename S>
class SharedSettings {
 public:
  using Settings = S;

  [[nodiscard]] Settings settings() {
    const std::lock_guard guard(lock_);
    return settings_;
  }
  // Calls f(Settings&) with the lock held.
  template <typename F>
  void change_settings(F f) {
    const std::lock_guard guard(lock_);
    f(settings_);
  }

 protected:
  std::mutex lock_;
  Settings settings_;  // lock_
};

}  // namespace calvin::gst
