// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What a session of several cameras decides: which views to keep, and when to solve where the
// cameras stand; and what becomes of a camera that moves. Knows no thread, no clock and no
// GStreamer.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "calvin/core/calibration.hpp"
#include "calvin/core/observation.hpp"
#include "calvin/core/result.hpp"
#include "calvin/rig/light_camera.hpp"
#include "calvin/rig/rig_watch.hpp"
#include "calvin/rig/solve_rig.hpp"
#include "calvin/session/points/known_points.hpp"
#include "calvin/session/points/manual_points.hpp"
#include "calvin/session/rig/recent_instants.hpp"
#include "calvin/target/board.hpp"

namespace calvin {

enum class RigMethod {
  kAuto,     // by what is seen first
  kBoards,   // solve_rig(): lights do not count
  kSvoboda,  // solve_light(): boards do not count
};

struct RigSessionSettings {
  RigOptions options;
  std::vector<Board> boards = {};  // only these count; empty: every board
  RigMethod method = RigMethod::kAuto;
  LightOptions light = {};  // kSvoboda
};

// What is to be solved. Shares the views of the session, which goes on meanwhile.
struct RigJob {
  struct Camera {
    std::string name;
    std::shared_ptr<const Calibration> calibration;  // nullptr: not known, before a light
    std::vector<SharedView> views;
  };
  std::vector<Camera> cameras;
  std::vector<LeftOutCamera> left_out;  // that have nothing to be solved by
  std::vector<std::string> remarks;     // sentences about cameras that have moved
  RigOptions options;
  std::optional<LightOptions> light;  // absent: the views are of boards
  bool final = false;
  std::uint64_t generation = 0;  // a result of another one is of views that were forgotten
};
// Of boards. Copies the views: not for a thread that others wait for.
[[nodiscard]] std::vector<RigCameraViews> views_of(const RigJob& job);

// What the last rig is to be held against.
struct WatchJob {
  std::shared_ptr<const WatchedRig> rig;
  std::vector<std::string> left_out;  // cameras that are not looked at
  std::vector<RigJob::Camera> cameras;
  std::uint64_t tolerance = 0;  // ns
  std::uint64_t generation = 0;
};
[[nodiscard]] std::vector<RigCameraViews> views_of(const WatchJob& job);

// How far a session is.
struct RigProgress {
  struct Link {
    std::string a;
    std::string b;
    int views = 0;  // that both cameras have seen at one time
  };
  std::vector<std::string> cameras;  // that have seen a board, or a light
  int instants = 0;                  // at which two cameras or more have
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

  [[nodiscard]] const RigOptions& options() const { return settings_.options; }
  // Of the cameras that are there.
  [[nodiscard]] std::vector<std::string> names() const;

  // A board that a camera has seen, with a timestamp of the clock that all cameras share. Kept
  // where the board was not seen there before, or where another camera's view of the same time is
  // kept. Whether it was: nothing is of a camera that is not there. kInvalidArgument for what is no
  // view of its board.
  [[nodiscard]] Result<bool> offer(std::size_t camera, Observation observation);
  // Whether enough has come since the last time to say how far the session is: any view of a board,
  // and a fiftieth more of a light's, which come with every frame.
  [[nodiscard]] bool take_progress();

  // ---- Manual points, each camera's one view, in a world of all: rig_session_points.cpp

  // Of the pictures of a camera, which begins anew where it is another one.
  void set_size(std::size_t camera, ImageSize size);
  // Whose pixels are chosen in the pictures of a camera, in their order; those that are known are.
  void set_points(std::size_t camera, KnownPoints points);
  // Whether there are such points.
  [[nodiscard]] bool clicks_choose(std::size_t camera);
  // How far from a click a corner or a disc is taken for it, px.
  [[nodiscard]] double point_reach(std::size_t camera) {
    return snap_reach(at(camera).size.value_or(ImageSize{}));
  }
  // `found`: what is next to the pixel in the picture of that time, if it was looked for.
  [[nodiscard]] PointAnswer add_point(std::size_t camera, const PointChoice& choice,
                                      const std::optional<FoundPoint>& found,
                                      std::uint64_t timestamp);
  // The newest one, or that of a number.
  [[nodiscard]] PointAnswer remove_point(std::size_t camera, std::optional<std::size_t> index);
  [[nodiscard]] bool has_points(std::size_t camera) { return at(camera).points.count() > 0; }
  // What came of the pixels that are known, once.
  [[nodiscard]] std::optional<PointAnswer> take_points_report(std::size_t camera);
  // The camera of that name.
  [[nodiscard]] std::optional<std::size_t> find(const std::string& name) const;
  [[nodiscard]] const std::string& name(std::size_t camera) { return at(camera).name; }

  // Where enough has come since the last job; where `final`, where there is anything new at all.
  // Of two cameras or more that have something to be solved by (before a light of three, unless all
  // intrinsics are known); the others are named in it.
  [[nodiscard]] std::optional<RigJob> take_solve(bool final);
  [[nodiscard]] bool is_current(const RigJob& job) const { return job.generation == generation_; }
  // A rig came of the job. `watched`: what instants are held against from now on; nullptr: before a
  // light none are.
  void solved(const RigJob& job, std::shared_ptr<const WatchedRig> watched);
  // Whether the last job that ended well was final and of all views.
  [[nodiscard]] bool is_solved() const { return solved_revision_ == revision_; }

  // Instants since the last job of that kind, where there is a rig to hold them against.
  [[nodiscard]] std::optional<WatchJob> take_watch();
  // A camera has moved: what it has seen since then is kept apart, and is no part of any rig.
  // False where that is not so any more.
  bool moved(const WatchJob& job, const MovedCamera& moved);
  // The camera of that name stands where it does now: it is solved anew by what it has seen since
  // it moved, or, where it has not moved, by what it sees from now on. All others stay as they are.
  // False where there is no such camera.
  bool reinsert(const std::string& name);

  // What is kept of a camera, in the order in which it was kept; manual points first.
  [[nodiscard]] std::vector<SharedView> kept_views(std::size_t camera) {
    return at(camera).views();
  }

  [[nodiscard]] RigProgress progress() const;
  // Why there is nothing to solve: which camera lacks what.
  [[nodiscard]] Error lack() const;

 private:
  struct Movement {
    std::uint64_t since = 0;
    std::uint64_t number = 0;  // that of all cameras that were told of together
    std::string text;
  };
  struct Camera {
    std::string name;  // empty: there is no such camera
    std::optional<Calibration> intrinsics;
    std::optional<ImageSize> size;              // of its pictures, once it has seen a board
    std::shared_ptr<const Calibration> fitted;  // to that size; nullptr: they do not fit
    bool has_seen = false;                      // a board
    std::string seen_other;                     // the text of the last board that does not count
    std::deque<SharedView> recent;              // of the last moment, not kept
    std::vector<SharedView> kept;
    std::optional<Movement> movement;
    std::vector<SharedView> apart;     // kept since it moved
    std::optional<KnownPoints> known;  // that a user chooses
    ManualPoints points;
    SharedView chosen;                  // the view of these, on the board of all cameras; or null
    std::optional<PointAnswer> report;  // of those that are known
    SharedView last;                    // to see how fast the board moves
    double passed = 0;                  // s, since the one before

    // What it is solved by: manual points first, whose world is to be that of the rig.
    [[nodiscard]] std::vector<SharedView> views() const {
      std::vector<SharedView> all = kept;
      if (chosen) all.insert(all.begin(), chosen);
      return all;
    }
    // Where views of a time are kept.
    [[nodiscard]] std::vector<SharedView>& list_at(std::uint64_t timestamp) {
      return movement && timestamp >= movement->since ? apart : kept;
    }
  };

  Camera& at(std::size_t camera);
  [[nodiscard]] Result<Board> board_of(const Observation& observation);
  [[nodiscard]] bool counts(const Board& board) const;
  [[nodiscard]] static Result<View> to_view(const Observation& observation, const Board& board);
  void improve_last(std::size_t number, const Observation& now);
  void forget_last(std::size_t number);
  [[nodiscard]] bool goes_with_another(std::size_t number, std::uint64_t time, double speed) const;
  // Whether views of that kind count.
  [[nodiscard]] bool takes(const View& view);
  [[nodiscard]] bool is_new(const std::vector<SharedView>& kept, const View& view) const;
  [[nodiscard]] std::size_t most_views() const;
  void forget_views(Camera& camera);
  void begin_points(Camera& camera);
  void renew_chosen();
  [[nodiscard]] PointAnswer told(Camera& camera, PointAnswer answer) const;
  void keep(Camera& camera, const SharedView& view);
  void keep_recent_at(std::uint64_t timestamp);
  void thin_out();
  // By the times of the views alone: this is asked for on streaming threads.
  [[nodiscard]] std::vector<Instant> instants() const;
  static void fit_intrinsics(Camera& camera);
  [[nodiscard]] bool sees_light() const { return is_light_.value_or(false); }
  // Whether cameras are asked to stay where they are.
  [[nodiscard]] bool is_watched() const {
    return settings_.options.mode == RigMode::kJoint && !sees_light();
  }
  // Why a camera has nothing to be solved by; absent where it has.
  [[nodiscard]] std::optional<Error> lack_of(const Camera& camera) const;
  [[nodiscard]] std::vector<std::string> moved_cameras() const;

  RigSessionSettings settings_;
  std::vector<Camera> cameras_;
  std::vector<Board> boards_;          // that were parsed
  std::optional<bool> is_light_;       // what views are of; absent: that is open
  std::optional<Board> light_;         // which light or wand it is, once one was seen
  std::vector<std::uint64_t> wanted_;  // ns: views of these times are kept
  RecentInstants recent_instants_;
  std::shared_ptr<const WatchedRig> watched_;  // the last rig
  std::uint64_t movements_ = 0;                // how many were told
  std::uint64_t generation_ = 0;
  std::uint64_t revision_ = 0;         // counts views that were kept
  std::uint64_t told_revision_ = 0;    // at the last progress
  std::uint64_t asked_revision_ = 0;   // at the last job
  std::uint64_t solved_revision_ = 0;  // of the last one that ended well
  bool is_due_ = false;                // a camera was asked to be inserted again, or points chosen
  std::uint64_t chosen_at_ = 0;        // ns, of the newest picture in which a point was chosen
};

}  // namespace calvin
