// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Builds undistorters on the spot, or beside the streaming thread.
#pragma once

#include <array>
#include <chrono>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "calvin/remap/undistorter.hpp"
#include "calvin/remap/view_range.hpp"
#include "common/worker.hpp"
#include "undistort/calibration_input.hpp"

namespace calvin::gst {

class UndistorterBuilder {
 public:
  // What an undistorter is made for: frames and a camera (counted by whoever makes the request; 0:
  // a plain one, to scale with), one view.
  struct Key {
    int frames = 0;
    int camera = 0;
    int lens = 0;  // that the camera has, wherever it stands: counted too
    ViewOptions view;
    bool distort = false;  // the frames that come in show the view
    friend bool operator==(const Key&, const Key&) = default;
  };
  struct Request {
    Key key;
    Camera camera;
    std::shared_ptr<const Rectification>
        rectification;  // nullptr: the camera has a view of its own
    std::vector<PlaneLayout> planes;
    int turn = 0;  // for whoever asks: comes back with what was built
  };
  struct Built {
    Key key;
    Result<std::shared_ptr<const Undistorter>> undistorter;  // kCancelled after cancel()
    int turn = 0;
  };
  // Of a processor: what other programs take meanwhile does not count.
  using Time = std::chrono::nanoseconds;

  [[nodiscard]] Status start();
  // Makes what is being built end soon, wherever it runs. Any thread.
  void cancel();
  // cancel(), then joins the worker.
  void stop();

  // On the calling thread.
  [[nodiscard]] Built build(const Request& request);
  // On the worker; a request that still waits is replaced.
  void offer(Request request);
  // What the worker has finished since the last call.
  [[nodiscard]] std::optional<Built> take();
  // What it will take to build this, going by the last one like it; absent: there was none.
  [[nodiscard]] std::optional<Time> estimate(const Key& key);

 private:
  // What is known of the undistorters, or of the scalers, for frames of one kind.
  struct Past {
    int frames = 0;
    // The views of one camera.
    int camera = 0;
    bool distort = false;
    std::shared_ptr<const ViewRange> range;
    // What the last ones took.
    std::optional<Time> search;
    std::optional<Time> map;

    [[nodiscard]] bool knows(const Key& key) const {
      return range && frames == key.frames && camera == key.camera && distort == key.distort &&
             range->serves(key.view);
    }
  };
  [[nodiscard]] Past& past(const Key& key) { return past_[key.camera == 0 ? 0 : 1]; }
  Built make(const Request& request, const std::stop_token& stop);
  Result<std::shared_ptr<const ViewRange>> range_of(const Request& request);

  std::mutex lock_;
  std::stop_source stop_;
  std::optional<Built> finished_;
  std::array<Past, 2> past_;
  Worker worker_;
};

}  // namespace calvin::gst
