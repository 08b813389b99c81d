// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What a session of several cameras decides: which views to keep, and when to solve where the
// cameras stand. Knows no thread, no clock and no GStreamer.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "calvin/core/calibration.hpp"
#include "calvin/core/observation.hpp"
#include "calvin/core/result.hpp"
#include "calvin/rig/solve_rig.hpp"

namespace calvin {

struct RigSessionSettings {
  RigOptions options;
  std::string board;  // only this one counts; empty: every board
};

// What is to be solved.
struct RigJob {
  std::vector<RigCameraViews> cameras;
  RigOptions options;
  bool final = false;
  std::uint64_t generation = 0;  // a result of another one is of views that were forgotten
};

// How far a session is.
struct RigProgress {
  struct Link {
    std::string a;
    std::string b;
    int views = 0;  // that both cameras have seen at one time
  };
  std::vector<std::string> cameras;  // that have seen a board
  std::vector<Link> links;
  std::string weakest;  // "cam0 cam1": the pair that the rig hangs on and that has fewest views
};

// Not thread-safe. A camera is a number that the caller gives it.
class RigSession {
 public:
  // Forgets all views and cameras.
  void start(RigSessionSettings settings);
  // A camera is there from its name on, until it is removed with all that it has seen.
  void set_name(std::size_t camera, std::string name);
  void remove(std::size_t camera);
  // Of pictures of any size with the aspect of the calibration.
  void set_intrinsics(std::size_t camera, const Calibration& calibration);

  // A board that a camera has seen, with a timestamp of the clock that all cameras share. Kept
  // where the board was not seen there before, or where another camera's view of the same time is
  // kept. Whether it was. kInvalidArgument for what is no view of its board.
  [[nodiscard]] Result<bool> offer(std::size_t camera, Observation observation);

  // Where enough has come since the last job; where `final`, where there is anything new at all.
  [[nodiscard]] std::optional<RigJob> take_solve(bool final);
  [[nodiscard]] bool is_current(const RigJob& job) const { return job.generation == generation_; }
  void solved(const RigJob& job, bool well);
  // Whether the last job that ended well was final and of all views.
  [[nodiscard]] bool is_solved() const { return solved_revision_ == revision_; }

  [[nodiscard]] RigProgress progress() const;
  // Why there is nothing to solve: which camera lacks what.
  [[nodiscard]] Error lack() const;

 private:
  struct Camera {
    std::string name;  // empty: there is no such camera
    std::optional<Calibration> intrinsics;
    std::deque<View> recent;  // of the last moment, not kept
    std::vector<View> kept;
    std::optional<Observation> last;  // to see how fast the board moves
    std::vector<Pixel> behind;        // px/s: from the one before the last one to that
  };

  Camera& at(std::size_t camera);
  [[nodiscard]] Result<View> to_view(const Observation& observation);
  void set_velocity(Camera& camera, View& view) const;
  [[nodiscard]] bool is_new(const Camera& camera, const View& view) const;
  void keep(Camera& camera, View view);
  void keep_recent_at(std::uint64_t timestamp);
  void thin_out();
  [[nodiscard]] std::vector<RigCameraViews> views() const;
  // That have seen a board at one time.
  [[nodiscard]] std::vector<CameraPair> pairs() const;
  [[nodiscard]] std::optional<Calibration> fitted(const Camera& camera) const;

  RigSessionSettings settings_;
  std::vector<Camera> cameras_;
  std::vector<Board> boards_;          // that were parsed
  std::vector<std::uint64_t> wanted_;  // ns: views of these times are kept
  std::uint64_t generation_ = 0;
  std::uint64_t revision_ = 0;         // counts views that were kept
  std::uint64_t asked_revision_ = 0;   // at the last job
  std::uint64_t solved_revision_ = 0;  // of the last one that ended well
};

}  // namespace calvin
