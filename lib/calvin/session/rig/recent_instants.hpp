// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What several cameras saw in the last moment, until it is known which pictures are of one time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <vector>

#include "calvin/rig/rig_views.hpp"
#include "calvin/solve/view.hpp"

namespace calvin {

// A view of a session of several cameras: shared with whoever works with it, and never changed.
using SharedView = std::shared_ptr<const View>;

// Not thread-safe. Takes the same memory for any stream.
class RecentInstants {
 public:
  void clear();
  void forget(std::size_t camera);
  // Of each camera in the order of time.
  void add(std::size_t camera, SharedView view);
  // Puts another one in the place of a view, if it is there.
  void replace(std::size_t camera, const SharedView& view, const SharedView& by);

  // By camera, the views of instants to which no view can come any more, at which two cameras or
  // more saw a board, and that are at least `interval` ns apart. Each is taken once, and what is
  // older is forgotten.
  [[nodiscard]] std::vector<std::vector<SharedView>> take(std::uint64_t tolerance,
                                                          std::uint64_t interval);

 private:
  // A camera that is silent for longer holds the others up no more.
  static constexpr std::uint64_t kLatest = 2'000'000'000;  // ns
  static constexpr std::size_t kMost = 150;                // views of a camera

  struct Newest {
    std::uint64_t of_any = 0;  // ns
    std::uint64_t of_all = 0;  // up to here every camera has sent what it saw
  };
  [[nodiscard]] Newest newest() const;
  [[nodiscard]] std::vector<ViewTimes> times_of_views() const;
  [[nodiscard]] bool is_apart(std::uint64_t timestamp, std::uint64_t interval) const;

  std::vector<std::deque<SharedView>> cameras_;
  std::uint64_t looked_at_ = 0;   // ns, the newest view then
  std::uint64_t last_taken_ = 0;  // ns, an instant; 0: none
};

}  // namespace calvin
