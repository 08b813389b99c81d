// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Reads intrinsics, asks the session of calibrig what to solve, and publishes what comes of it.

#include "rig/rig_solver.hpp"

#include <utility>

#include <fmt/format.h>

#include "calvin/core/text.hpp"
#include "calvin/io/calibration_io.hpp"
#include "calvin/io/camera_baselines.hpp"
#include "calvin/io/camera_places.hpp"
#include "calvin/io/rig_world.hpp"
#include "calvin/io/settings.hpp"
#include "calvin/rig/solve_light.hpp"
#include "calvin/session/rig/rig_exports.hpp"
#include "rig/rig_messages.hpp"

GST_DEBUG_CATEGORY_EXTERN(calibrig_debug);
#define GST_CAT_DEFAULT calibrig_debug

namespace calvin::gst {

namespace {

constexpr GEnumValue kModes[] = {
    choice(kRigFloor, "floor",
           "One board lies still, and each camera has seen it: its frame is that of the rig"),
    choice(kRigJoint, "joint",
           "A board is carried before two cameras or more at a time: the frame is that of the "
           "first"),
    choice(kRigStereo, "stereo", "As joint, of two cameras"), kNoMoreChoices};

constexpr GEnumValue kMethods[] = {
    choice(RigMethod::kAuto, "auto", "By a light where one is seen first, else by boards"),
    choice(RigMethod::kBoards, "boards", "By boards alone, before cameras whose lenses are known"),
    choice(RigMethod::kSvoboda, "svoboda",
           "By a light alone (board=dot of calibdetect), lenses and places: that of BlueCCal"),
    kNoMoreChoices};

constexpr GEnumValue kIntrinsics[] = {
    choice(RigIntrinsics::kHeld, "no",
           "They stay as they are; how well they are known is a part of the result"),
    choice(RigIntrinsics::kPrior, "prior",
           "What was known of them counts, with its sigmas: for views that it was not found from"),
    choice(RigIntrinsics::kFree, "free", "By the views of the rig alone"), kNoMoreChoices};

// What is to be known of a solve by a light.
Result<LightOptions> light_options(const RigSettings& settings,
                                   const std::vector<CameraBaseline>& baselines) {
  LightOptions options;
  options.model = settings.model;
  options.center_sigma = settings.center_sigma;
  options.wand_sigma = settings.wand_sigma;
  options.fix.clear();
  for (const std::string_view name : split(settings.fix, ',')) {
    if (!trim(name).empty() && trim(name) != "none") options.fix.emplace_back(trim(name));
  }
  if (const Status good = check(options); !good) return tl::unexpected(good.error());
  // Places of two cameras give the unit alone.
  if (settings.places.empty() && baselines.size() == 1 && !baselines.front().a.empty()) {
    set_known_distance(baselines.front(), options);
  }
  if (settings.places.empty()) return options;
  auto places = read_camera_places(settings.places);
  if (!places) return tl::unexpected(places.error());
  options.places = *std::move(places);
  return options;
}

}  // namespace

const Property<RigSolver> kRigProperties[16] = {
    {"board",
     "Board",
     "The board that counts, as the observations have its text; none: every board",
     kept_in<&RigSettings::board>,
     {.flags = kMutableReady}},
    {"mode",
     "Mode",
     "How the places of the cameras are found",
     kept_in<&RigSettings::mode>,
     {.choices = {"GstCalibRigMode", kModes}, .flags = kMutableReady}},
    {"method",
     "Method",
     "What tells where the cameras are",
     kept_in<&RigSettings::method>,
     {.choices = {"GstCalibRigMethod", kMethods}, .flags = kMutableReady}},
    {"location",
     "Location",
     "The file of the rig; written at the first solve, then at every one. What was there before is "
     "kept as FILE~",
     kept_in<&RigSettings::location>,
     {.flags = kMutableReady}},
    {"export",
     "Export",
     "Further files, written with location: FORMAT:PATH,FORMAT:PATH; kalibr, caliscope and calvin "
     "are files, mrcal and colmap folders; of two cameras also opencv (a file or FOLDER/) and ros "
     "(a folder)",
     kept_in<&RigSettings::exports>,
     {.flags = kMutableReady}},
    {"tolerance",
     "Tolerance",
     "How far pictures of one instant may be apart (ns)",
     kept_in<&RigSettings::tolerance>,
     {.range = Range{0, 1e10}, .flags = kMutableReady}},
    {"baseline",
     "Baseline",
     "Known distances between cameras, as left:right:110.03mm:0.05mm (the last is its sigma; none: "
     "exactly), separated by commas, or of two cameras 110.03mm. They tell how large boards are, "
     "and the unit before a light",
     kept_in<&RigSettings::baseline>,
     {.flags = kMutableReady}},
    {"board-sigma",
     "Board Sigma",
     "With a known distance: how well the size of boards is known, 1 sigma, 0..1 of it (0 = "
     "exactly)",
     kept_in<&RigSettings::board_sigma>,
     {.range = Range{0, 1}, .flags = kMutableReady}},
    {"world",
     "World",
     "The frame of the rig: the name of a camera, board (where it was at the first instant), "
     "board:SECONDS or board:last, and quarter turns of the axes, as board:x180 with z up from a "
     "board on the floor; none: the first camera, and with mode=floor the board",
     kept_in<&RigSettings::world>,
     {.flags = kMutableReady}},
    {"fixed-boards",
     "Fixed Boards",
     "Whether the boards are fixed to each other, as on the sides of a box: cameras that see "
     "different ones at one time are joined. How the boards lie is found where one camera sees two",
     kept_in<&RigSettings::fixed_boards>,
     {.flags = kMutableReady}},
    {"estimate-intrinsics",
     "Estimate Intrinsics",
     "Before boards that are carried: whether the lenses are found together with the places",
     kept_in<&RigSettings::intrinsics>,
     {.choices = {"GstCalibRigIntrinsics", kIntrinsics}, .flags = kMutableReady}},
    {"places",
     "Places",
     "Before a light: a file of where some cameras stand, lines 'name x y z' in m. Three or more "
     "give the frame of the rig, two its unit; none: the first camera is the rig, without a unit",
     kept_in<&RigSettings::places>,
     {.flags = kMutableReady}},
    {"model",
     "Model",
     "Before a light: the lens of cameras without intrinsics, one that is a pinhole where its "
     "coefficients are 0",
     kept_in<&RigSettings::model>,
     {.flags = kMutableReady}},
    {"fix",
     "Fix",
     "Before a light: what is held of that lens, separated by commas: aspect, center, cx, cy and "
     "coefficients, or none",
     kept_in<&RigSettings::fix>,
     {.flags = kMutableReady}},
    {"center-sigma",
     "Center Sigma",
     "Before a light: how far the axis of that lens may be from the middle of a picture, 1 sigma, "
     "0..1 of its width (0 = by any distance)",
     kept_in<&RigSettings::center_sigma>,
     {.range = Range{0, 1}, .flags = kMutableReady}},
    {"wand-sigma",
     "Wand Sigma",
     "Before a wand of lights: how well the place of each along it is known, 1 sigma in m (0 = "
     "exactly)",
     kept_in<&RigSettings::wand_sigma>,
     {.range = Range{0, 1}, .flags = kMutableReady}},
};

Status RigSolver::start() {
  const RigSettings now = settings();
  if (Status possible = check_settings(now); !possible) return possible;
  const auto exports = parse_rig_exports(now.exports);
  if (!exports) return tl::unexpected(exports.error());
  auto baselines = parse_camera_baselines(now.baseline);
  if (!baselines) return tl::unexpected(baselines.error());
  auto light = light_options(now, *baselines);
  if (!light) return tl::unexpected(light.error());
  auto world = parse_rig_world(now.world);
  if (!world) return tl::unexpected(world.error());
  if (!now.location.empty()) {
    if (const Status writable = can_write(now.location); !writable) {
      post_warning(element_, writable.error());
    }
  }
  {
    const std::lock_guard guard(lock_);
    RigSessionSettings session;
    session.board = now.board;
    session.options.mode = now.mode == kRigFloor ? RigMode::kFloor : RigMode::kJoint;
    session.options.tolerance = now.tolerance;
    session.options.baselines = *std::move(baselines);
    session.options.board_sigma = now.board_sigma;
    session.options.fixed_boards = now.fixed_boards;
    session.options.intrinsics = now.intrinsics;
    session.options.world = *std::move(world);
    session.method = now.method;
    session.light = *std::move(light);
    session_.start(std::move(session));
    json_.clear();
    solution_.reset();
    is_final_ = false;
    solve_error_.reset();
    write_error_.reset();
    complained_ = write_failed_ = false;
    unread_.clear();
    waiting_points_.clear();
  }
  if (Status started = reader_.start(); !started) return started;
  if (Status started = worker_.start(); !started) return started;
  if (Status started = watcher_.start(); !started) return started;
  file_ = {};  // no job of the run before is left
  return {};
}

Status RigSolver::add_camera(std::size_t camera, const RigCameraSettings& settings) {
  std::optional<Calibration> intrinsics;
  if (!settings.intrinsics.empty()) {
    auto read = parse_calibration_setting(settings.intrinsics);
    if (!read) {
      return make_error(read.error().code, fmt::format("The intrinsics of the camera '{}': {}",
                                                       settings.name, read.error().message));
    }
    intrinsics = *std::move(read);
  }
  std::optional<KnownPoints> points;
  if (!settings.points.empty()) {
    auto read = read_known_points(settings.points);
    if (!read) {
      return make_error(read.error().code, fmt::format("For the camera '{}': {}", settings.name,
                                                       read.error().message));
    }
    points = *std::move(read);
  }
  {
    const std::lock_guard guard(lock_);
    session_.set_name(camera, settings.name);
    if (intrinsics) session_.set_intrinsics(camera, *intrinsics);
    if (points) session_.set_points(camera, *std::move(points));
  }
  post_points_report(camera);
  return {};
}

void RigSolver::add_camera_later(std::size_t camera, const RigCameraSettings& settings) {
  {
    const std::lock_guard guard(lock_);
    session_.set_name(camera, settings.name);
    if (settings.intrinsics.empty() && settings.points.empty()) return;
    unread_.emplace_back(camera, settings);
  }
  reader_.offer([this](const std::stop_token& stop) { read_intrinsics(stop); });
}

// Those of all cameras that wait: a job that comes later takes the place of one that has not begun.
void RigSolver::read_intrinsics(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    std::pair<std::size_t, RigCameraSettings> next;
    {
      const std::lock_guard guard(lock_);
      if (unread_.empty()) return;
      next = std::move(unread_.front());
      unread_.erase(unread_.begin());
    }
    const Status added = add_camera(next.first, next.second);
    if (added) continue;
    const auto report = reader_.begin_report(stop, element_);
    if (report) post_warning(element_, added.error());
  }
}

void RigSolver::remove_camera(std::size_t camera) {
  const std::lock_guard guard(lock_);
  session_.remove(camera);
}

void RigSolver::set_intrinsics(std::size_t camera, const std::string& json) {
  const auto calibration = parse_calibration(json);
  if (!calibration) return;  // an empty one: there is none any more, and the last one stays
  GST_INFO_OBJECT(element_, "the intrinsics of camera %" G_GSIZE_FORMAT " came from upstream",
                  camera);
  const std::lock_guard guard(lock_);
  session_.set_intrinsics(camera, *calibration);
}

// ---- Streaming threads --------------------------------------------------------------------------

void RigSolver::offer(std::size_t camera, Observation observation, const FrameTimes& times,
                      GstClockTime shared_clock) {
  observation.timestamp = shared_clock;
  bool is_kept = false;
  std::optional<Error> complaint;
  std::optional<RigProgress> progress;
  {
    const std::lock_guard guard(lock_);
    times_ = times;
    const auto kept = session_.offer(camera, std::move(observation));
    is_kept = kept.value_or(false);
    if (!kept && !std::exchange(complained_, true)) complaint = kept.error();
    if (is_kept && session_.take_progress()) progress = session_.progress();
  }
  if (complaint) post_warning(element_, *complaint);
  watch_if_due();
  if (!is_kept) return;
  if (progress) post_message(element_, rig_progress_message(times, *progress));
  solve_if_due(false);
}

void RigSolver::solve_if_due(bool final) {
  const std::lock_guard guard(lock_);
  auto due = session_.take_solve(final);
  if (!due) return;
  GST_DEBUG_OBJECT(element_, "%s solve of %" G_GSIZE_FORMAT " cameras asked for",
                   final ? "final" : "intermediate", due->cameras.size());
  const auto job = std::make_shared<const RigJob>(*std::move(due));
  worker_.offer([this, job](const std::stop_token& stop) { run(*job, stop); });
}

void RigSolver::watch_if_due() {
  if (!watcher_.idle()) return;
  std::shared_ptr<const WatchJob> job;
  {
    const std::lock_guard guard(lock_);
    auto due = session_.take_watch();
    if (!due) return;
    job = std::make_shared<const WatchJob>(*std::move(due));
  }
  watcher_.offer([this, job](const std::stop_token& stop) { watch(*job, stop); });
}

bool RigSolver::reinsert(const std::string& camera) {
  bool is_known = false;
  {
    const std::lock_guard guard(lock_);
    is_known = session_.reinsert(camera);
  }
  if (!is_known) {
    post_warning(element_, {ErrorCode::kInvalidArgument,
                            fmt::format("No camera '{}' is linked that could be inserted again: "
                                        "name one as its pad does.",
                                        camera)});
    return false;
  }
  GST_INFO_OBJECT(element_, "the camera '%s' is inserted again", camera.c_str());
  solve_if_due(false);
  return true;
}

void RigSolver::finish() {
  if (!reader_.drain() || !watcher_.drain() || !worker_.drain()) return;
  solve_if_due(true);
  if (!worker_.drain()) return;
  std::optional<Error> error;
  std::optional<Error> write_error;
  bool has_rig = false;
  bool files_wanted = false;
  {
    const std::lock_guard guard(lock_);
    files_wanted = !settings_.location.empty() || !settings_.exports.empty();
    has_rig = solution_ != nullptr;
    error = solve_error_;
    if (!error && !is_final_) error = session_.lack();
    write_error = write_error_;
  }
  if (error && has_rig) {
    keep_last(*error);
    error = write_error;
  } else if (!error) {
    error = write_error;
  }
  if (!error) return;
  if (files_wanted) {
    post_error(element_, *error);
  } else {
    post_warning(element_, *error);
  }
}

void RigSolver::keep_last(const Error& error) {
  std::shared_ptr<const RigSolution> solution;
  FrameTimes times;
  std::string json;
  {
    const std::lock_guard guard(lock_);
    solution = solution_;
    times = times_;
    json = json_;
  }
  post_warning(element_,
               {error.code, fmt::format("The last solve failed, and the rig before it stays: {}",
                                        error.message)});
  post_message(element_, rig_result_message(times, *solution, settings().location, json.c_str()));
}

std::optional<std::string> RigSolver::take_rig(guint64& known) {
  const std::lock_guard guard(lock_);
  if (json_number_ == known || json_.empty()) return std::nullopt;
  known = json_number_;
  return json_;
}

}  // namespace calvin::gst
