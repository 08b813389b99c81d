// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Reads the settings of a session, in groups that work together or not at all.

#include "calvin/session/session_settings.hpp"

#include <utility>

#include <fmt/format.h>

#include "calvin/camera/frame_fit.hpp"
#include "calvin/core/file.hpp"
#include "calvin/core/text.hpp"
#include "calvin/io/board_names.hpp"
#include "calvin/io/settings.hpp"
#include "calvin/solve/methods/methods.hpp"

namespace calvin {

SessionOptions SessionPlan::session_options(bool live) const {
  CaptureMode mode = live ? CaptureMode::kAuto : CaptureMode::kAll;
  if (settings.capture_mode == CaptureChoice::kAll) mode = CaptureMode::kAll;
  if (settings.capture_mode == CaptureChoice::kAuto) mode = CaptureMode::kAuto;
  if (settings.capture_mode == CaptureChoice::kManual) mode = CaptureMode::kManual;
  return {mode, settings.min_views, settings.max_views,
          1e-9 * static_cast<double>(settings.readout_time)};
}

namespace {

// Settings that work together or not at all. The first ones have the calibration to start from.
struct Group {
  bool (*same)(const SessionSettings&, const SessionSettings&);
  Status (*read)(SessionPlan&);  // from plan.settings into what follows from them
  void (*keep)(SessionPlan&, const SessionPlan& before);
  // Makes those that have not changed since they were `seen`, and may have been refused then, what
  // they are `taken` for.
  void (*take_back)(SessionSettings&, const SessionSettings& seen, const SessionSettings& taken);
};

template <auto... kSettings>
void take_back(SessionSettings& now, const SessionSettings& seen, const SessionSettings& taken) {
  ((now.*kSettings = now.*kSettings == seen.*kSettings ? taken.*kSettings : now.*kSettings), ...);
}

Status read_board(SessionPlan& plan) {
  const SessionSettings& settings = plan.settings;
  const BoardShapeChoice shape = settings.warp ? settings.board_shape : BoardShapeChoice::kNone;
  plan.options.warp = shape != BoardShapeChoice::kNone;
  plan.options.offsets = shape == BoardShapeChoice::kPoints;
  if (shape != BoardShapeChoice::kAuto && shape != BoardShapeChoice::kPoints) return {};
  if (!names_a_file(settings.board)) return {};
  auto measured = read_measurement(settings.board);
  if (!measured) return tl::unexpected<Error>(measured.error());
  plan.options.measured = *std::move(measured);
  return {};
}

// A session gathers several views, but where points are chosen, which are one.
Status takes_several_views(const SessionSettings& settings) {
  const std::string& method = settings.method;
  if (!takes_one_view(method)) return {};
  if (!points_text(settings.points, settings.board).empty()) return {};
  return make_error(ErrorCode::kInvalidArgument,
                    fmt::format("method={} takes one view, and several are gathered here: set one "
                                "of {}, or `points` for a view of manual points, or calibrate from "
                                "one view with calvin-solve --method {}.",
                                method, join(methods_of_several_views(), ", "), method));
}

Status read_lens(SessionPlan& plan) {
  const SessionSettings& settings = plan.settings;
  if (const Status several = takes_several_views(settings); !several) return several;
  plan.options.model = settings.model;
  plan.options.method = settings.method;
  plan.options.skew = settings.skew;
  for (const std::string_view name : split(settings.fix, ',')) {
    if (!name.empty()) plan.options.fix.emplace_back(name);
  }
  if (!settings.initial.empty()) {
    auto initial = parse_calibration_setting(settings.initial);
    if (!initial) {
      return make_error(initial.error().code,
                        "The calibration to start from (initial): " + initial.error().message);
    }
    plan.initial = *std::move(initial);
  }
  if (const Status read = read_board(plan); !read) return read;
  SolveOptions complete = plan.options;
  complete.initial = plan.initial;
  return check(complete);
}

// Before the files are the ones of `plan`, where both change.
Status read_lens_and_files(SessionPlan& plan) {
  if (const Status read = read_lens(plan); !read) return read;
  const auto files = parse_calibration_files(plan.settings.location, plan.settings.exports);
  return files ? can_hold_all(*files, plan.settings.model) : Status();
}

void keep_lens(SessionPlan& plan, const SessionPlan& before) {
  plan.options = before.options;
  plan.initial = before.initial;
  plan.settings.model = before.settings.model;
  plan.settings.method = before.settings.method;
  plan.settings.fix = before.settings.fix;
  plan.settings.initial = before.settings.initial;
  plan.settings.board = before.settings.board;
  plan.settings.board_shape = before.settings.board_shape;
  plan.settings.warp = before.settings.warp;
  plan.settings.skew = before.settings.skew;
}

Status read_counts(SessionPlan& plan) {
  const SessionSettings& settings = plan.settings;
  if (settings.max_views > 0 && settings.max_views < settings.min_views) {
    return make_error(ErrorCode::kInvalidArgument,
                      fmt::format("max-views={} is less than min-views={}: raise max-views, or set "
                                  "it to 0 for no limit.",
                                  settings.max_views, settings.min_views));
  }
  return {};
}

void keep_counts(SessionPlan& plan, const SessionPlan& before) {
  plan.settings.min_views = before.settings.min_views;
  plan.settings.max_views = before.settings.max_views;
}

// What is written to a journal in its place would be the end of it.
Status is_no_journal(const CalibrationFile& file, const std::string& journal) {
  if (journal.empty() || !is_same_file(file.path, journal)) return {};
  return make_error(ErrorCode::kInvalidArgument,
                    fmt::format("'{}' is the journal, and is to hold the calibration too: give "
                                "each a file of its own.",
                                file.path));
}

Status read_files(SessionPlan& plan) {
  auto files = parse_calibration_files(plan.settings.location, plan.settings.exports);
  if (!files) return tl::unexpected<Error>(files.error());
  plan.files = *std::move(files);
  for (const CalibrationFile& file : plan.files) {
    if (const Status other = is_no_journal(file, plan.settings.journal); !other) return other;
  }
  if (const Status held = can_hold_all(plan.files, plan.settings.model); !held) return held;
  return are_different_files(plan.files);
}

void keep_files(SessionPlan& plan, const SessionPlan& before) {
  plan.files = before.files;
  plan.settings.location = before.settings.location;
  plan.settings.exports = before.settings.exports;
}

std::string points_of(const SessionSettings& settings) {
  return points_text(settings.points, settings.board);
}

Status read_points(SessionPlan& plan) {
  const std::string text = points_of(plan.settings);
  plan.points.reset();
  if (text.empty()) return {};
  auto points = read_known_points(text);
  if (!points) return tl::unexpected<Error>(points.error());
  plan.points = *std::move(points);
  return {};
}

void keep_points(SessionPlan& plan, const SessionPlan& before) {
  plan.points = before.points;
  plan.settings.points = before.settings.points;
}

bool same_lens(const SessionSettings& a, const SessionSettings& b) {
  return a.model == b.model && a.method == b.method && a.fix == b.fix && a.initial == b.initial &&
         a.board == b.board && a.board_shape == b.board_shape && a.warp == b.warp &&
         a.skew == b.skew;
}

constexpr Group kGroups[] = {
    {[](const SessionSettings& a, const SessionSettings& b) { return same_lens(a, b); },
     read_lens_and_files, keep_lens,
     take_back<&SessionSettings::model, &SessionSettings::method, &SessionSettings::fix,
               &SessionSettings::initial, &SessionSettings::board, &SessionSettings::board_shape,
               &SessionSettings::warp, &SessionSettings::skew>},
    {[](const SessionSettings& a, const SessionSettings& b) {
       return a.min_views == b.min_views && a.max_views == b.max_views;
     },
     read_counts, keep_counts, take_back<&SessionSettings::min_views, &SessionSettings::max_views>},
    {[](const SessionSettings& a, const SessionSettings& b) {
       return points_of(a) == points_of(b);
     },
     read_points, keep_points, take_back<&SessionSettings::points>},
    {[](const SessionSettings& a, const SessionSettings& b) { return !names_other_files(a, b); },
     read_files, keep_files, take_back<&SessionSettings::location, &SessionSettings::exports>},
};

}  // namespace

Result<SessionPlan> make_plan(const SessionSettings& settings) {
  SessionPlan plan;
  plan.settings = settings;
  for (const Group& group : kGroups) {
    if (const Status read = group.read(plan); !read) return tl::unexpected<Error>(read.error());
  }
  return plan;
}

PlanChange change_plan(const SessionPlan& before, const SessionSettings& seen,
                       const SessionSettings& now) {
  PlanChange change;
  change.plan.settings = now;
  for (const Group& group : kGroups) {
    SessionPlan without = change.plan;
    Status read = group.same(seen, now) ? Status() : group.read(change.plan);
    if (!read) {
      // What was refused before does not hinder what is set after it; what belongs together may be
      // set one after the other.
      group.take_back(without.settings, seen, before.settings);
      read = group.read(without);
      if (read) change.plan = std::move(without);
    }
    if (!read) change.refused.push_back(read.error());
    if (!read || group.same(seen, now)) group.keep(change.plan, before);
  }
  return change;
}

SettingsRead read_settings(const SettingsUpdate& update) {
  SettingsRead read;
  read.change = change_plan(update.plan, update.seen, update.now);
  const SessionPlan& plan = read.change.plan;
  if (names_other_files(plan.settings, update.plan.settings)) {
    read.writable = can_write_all(plan.files);
  }
  return read;
}

bool may_wait(const SessionSettings& seen, const SessionSettings& now) {
  const bool other_lens = !kGroups[0].same(seen, now);
  if (other_lens && !now.initial.empty() && may_be_calibration_path(now.initial)) return true;
  if (other_lens && names_a_file(now.board)) return true;
  if (points_of(seen) != points_of(now) && !points_of(now).empty()) return true;
  if (!names_other_files(seen, now)) return false;
  const auto files = parse_calibration_files(now.location, now.exports);
  return files && !files->empty();
}

bool solves_differently(const SessionSettings& a, const SessionSettings& b) {
  return !same_lens(a, b) || a.runs != b.runs || a.readout_time != b.readout_time;
}

bool writes_elsewhere(const SessionSettings& a, const SessionSettings& b) {
  return names_other_files(a, b) || a.camera != b.camera;
}

bool names_other_files(const SessionSettings& a, const SessionSettings& b) {
  return a.location != b.location || a.exports != b.exports;
}

FittedInitial fit_initial(const SessionPlan& plan, ImageSize frames) {
  FittedInitial fitted;
  if (!plan.initial || frames.width == 0) return fitted;
  const auto camera = fit_to_frame(*plan.initial, frames);
  if (!camera) {
    fitted.warning = {camera.error().code, "The calibration to start from (initial) is not used: " +
                                               camera.error().message};
    return fitted;
  }
  // One of just these frames keeps what is known of it: it may be held.
  const bool is_of_frames = plan.initial->image_size == frames && !plan.initial->sensor_crop;
  fitted.calibration = is_of_frames ? *plan.initial : camera->camera.to_calibration();
  if (camera->scaled) {
    fitted.warning = {ErrorCode::kInvalidArgument,
                      fmt::format("The calibration to start from (initial) is for {}x{} px and is "
                                  "scaled to the frames of {}x{}.",
                                  plan.initial->image_size.width, plan.initial->image_size.height,
                                  frames.width, frames.height)};
  }
  return fitted;
}

}  // namespace calvin
