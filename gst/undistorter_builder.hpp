// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Builds undistorters on the spot, or beside the streaming thread.
#pragma once

#include <chrono>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "calvin/remap/undistorter.hpp"
#include "worker.hpp"

namespace calvin::gst {

class UndistorterBuilder {
 public:
  // What an undistorter is made for: frames and a camera (counted by whoever makes the request; 0:
  // a plain one, to scale with), one view.
  struct Key {
    int frames = 0;
    int camera = 0;
    ViewOptions view;      // but for its size
    bool distort = false;  // the frames that come in show the view
    friend bool operator==(const Key&, const Key&) = default;
  };
  struct Request {
    Key key;
    Camera camera;
    ImageSize input;   // px
    ImageSize output;  // px
    std::vector<PlaneLayout> planes;
  };
  struct Built {
    Key key;
    Result<std::shared_ptr<const Undistorter>> undistorter;  // kCancelled after cancel()
    std::chrono::nanoseconds took{};
  };

  void start();
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

 private:
  static Built make(const Request& request, const std::stop_token& stop);

  std::mutex lock_;
  std::stop_source stop_;
  std::optional<Built> finished_;
  Worker worker_;
};

}  // namespace calvin::gst
