// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What calibrig does: tells its session what the cameras see, solves on a worker, posts and writes.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <gst/gst.h>

#include "calvin/session/rig/rig_file.hpp"
#include "calvin/session/rig/rig_session.hpp"
#include "common/messages.hpp"
#include "common/properties.hpp"
#include "common/shared_settings.hpp"
#include "common/worker.hpp"
#include "rig/rig_settings.hpp"

namespace calvin::gst {

// What a pad is told of its camera.
struct RigCameraSettings {
  std::string name;
  std::string intrinsics;  // as `calibration` of calibundistort; empty: the event tells them
  std::string points;      // whose pixels clicks choose; or empty
};

class RigSolver : public SharedSettings<RigSettings> {
 public:
  explicit RigSolver(GstElement* element) : element_(element) {}

  // An error for settings that cannot work, or not with these cameras.
  [[nodiscard]] Status start(const RigNames& names);
  // Any thread: whoever waits for a solve goes on without it.
  void cancel() {
    worker_.cancel();
    watcher_.cancel();
    reader_.cancel();
  }
  void resume() {
    worker_.resume();
    watcher_.resume();
    reader_.resume();
  }
  void stop() {
    worker_.stop();
    watcher_.stop();
    reader_.stop();
  }

  // Cameras are live: their streams come before the solution. Until the next start().
  void give_way();

  // Before there are frames. An error for intrinsics that cannot be read.
  [[nodiscard]] Status add_camera(std::size_t camera, const RigCameraSettings& settings);
  // The same error for a camera that may come later, of which the session is to know nothing yet.
  [[nodiscard]] static Status check_camera(const RigCameraSettings& settings);
  // While the others run: the file is read beside the stream, and a WARNING says where it cannot
  // be. One with which no rig would come of the others is left out, and a WARNING says why.
  void add_camera_later(std::size_t camera, const RigCameraSettings& settings);
  void remove_camera(std::size_t camera);
  // Streaming threads, each for its own camera.
  void set_intrinsics(std::size_t camera, const std::string& json);
  // `times` are of the frame that the board was seen on; `shared_clock` is its time by the clock
  // of all cameras.
  void offer(std::size_t camera, Observation observation, const FrameTimes& times,
             GstClockTime shared_clock);
  // The last camera has come to its end: waits for the last solve, and says what came of it.
  void finish();
  // The same for who does not wait: on the reader, and `then` after it. Neither where all is
  // cancelled before.
  void finish_later(std::function<void()> then);

  // Any thread: a camera that has moved stands where it does now. A WARNING, and false, where there
  // is no camera of that name.
  bool reinsert(const std::string& camera);
  bool reinsert(std::size_t camera);

  // Manual points: rig_solver_points.cpp. Any thread: one waits for a frame of its camera.
  void add_point(std::size_t camera, const PointChoice& choice);
  // Of that name: false, and a WARNING, where there is no such camera.
  bool add_point(const std::string& camera, const PointChoice& choice);
  // Absent: the newest one. Whether there was one.
  bool remove_point(std::size_t camera, std::optional<unsigned> index);
  bool remove_point(const std::string& camera, std::optional<unsigned> index);
  [[nodiscard]] bool has_points(std::size_t camera);
  // Whether a click in the picture of a camera chooses a point.
  [[nodiscard]] bool clicks_choose(std::size_t camera);
  // On the streaming thread of the camera. `timestamp`: of the clock of all cameras.
  void set_size(std::size_t camera, ImageSize size);
  [[nodiscard]] bool has_waiting_points(std::size_t camera);
  // `point_at`: what is in the frame with these times within so many px of a pixel.
  using PointAt = std::function<std::optional<FoundPoint>(Pixel at, double reach)>;
  void take_waiting_points(std::size_t camera, const FrameTimes& times, GstClockTime timestamp,
                           const PointAt& point_at);

  // The rig as JSON where it is another one than that with the number `known`, which becomes its
  // own.
  [[nodiscard]] std::optional<std::string> take_rig(guint64& known);

 private:
  [[nodiscard]] RigSettings in_use() {
    const std::lock_guard guard(lock_);
    return in_use_;
  }
  // A session of which nothing is known yet.
  void begin(const RigSettings& now, RigSessionSettings session);
  void read_intrinsics(const std::stop_token& stop);
  void post_point(std::size_t camera, const FrameTimes& times, const PointAnswer& answer);
  void post_points_report(std::size_t camera);
  [[nodiscard]] std::optional<std::size_t> find(const std::string& camera);
  void solve_if_due(bool final);
  void watch_if_due();
  // On the worker.
  void run(const RigJob& job, const std::stop_token& stop);
  [[nodiscard]] Result<RigSolution> solve(const RigJob& job,
                                          const std::vector<RigCameraViews>& views,
                                          const std::stop_token& stop);
  void publish(const RigJob& job, std::shared_ptr<const RigSolution> solution,
               const std::stop_token& stop);
  // On the watcher.
  void watch(const WatchJob& job, const std::stop_token& stop);
  // At the end, after what was read: false where all was cancelled.
  [[nodiscard]] bool solve_last();
  void tell_end();
  // Where the last solve failed and one before did not.
  void keep_last(const Error& error);

  GstElement* element_;

  // Under lock_.
  RigSettings in_use_;  // since the start: what is set later is for the next one
  RigSession session_;
  FrameTimes times_;
  std::string json_;
  guint64 json_number_ = 0;
  std::shared_ptr<const RigSolution> solution_;  // the last one
  bool is_final_ = false;                        // and it was posted as the final one
  std::optional<Error> solve_error_;             // of the last solve
  std::optional<Error> write_error_;             // of the last write
  bool complained_ = false;                      // of a broken observation
  bool write_failed_ = false;                    // and that was said

  std::vector<std::pair<std::size_t, PointChoice>> waiting_points_;  // for a frame of their camera

  std::vector<std::pair<std::size_t, RigCameraSettings>> unread_;  // cameras that came later

  // Of the worker alone.
  [[nodiscard]] Status write_files(const Rig& rig);
  RigFile file_;
  // Of the watcher alone.
  RigWatch watch_;
  std::uint64_t watched_generation_ = 0;

  Worker worker_;
  Worker watcher_;
  Worker reader_;
};

extern const Property<RigSolver> kRigProperties[16];

}  // namespace calvin::gst
