// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// calvin-rig: what all cameras have seen, from videos, files of observations and pictures. Which
// frames of videos count is decided as calibrig decides it, by the same session.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <future>
#include <iterator>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gst/gst.h>

#include "calvin/camera/frame_fit.hpp"
#include "calvin/io/board_names.hpp"
#include "calvin/rig/solve_rig.hpp"
#include "calvin/session/rig/rig_session.hpp"

#include "camera_names.hpp"
#include "rig_recording.hpp"
#include "rig_views.hpp"

namespace rig_sources {

struct Options {
  std::string board;                     // that of --board, or empty
  std::map<std::string, double> starts;  // s: when cameras began, by their names
  calvin::RigOptions rig;
};

// What a camera has seen in the order of time: of a video, or of a file of observations.
struct Recording {
  std::size_t camera = 0;
  std::unique_ptr<rig_recording::Video> video;    // or nullptr
  std::vector<calvin::Observation> observations;  // where there is none
  std::uint64_t later = 0;                        // ns, than the clock of all
  std::string name;                               // of the camera, as a file of observations has it

  [[nodiscard]] bool is_over() const { return video ? video->is_over() : observations.empty(); }
  // By the clock of all.
  std::vector<calvin::Observation> until(std::uint64_t end) {
    const std::uint64_t own_end = end - std::min(end, later);
    std::vector<calvin::Observation> seen;
    if (video) {
      seen = video->until(own_end);
    } else {
      const auto last = std::ranges::find_if(
          observations, [&](const auto& one) { return one.timestamp >= own_end; });
      std::move(observations.begin(), last, std::back_inserter(seen));
      observations.erase(observations.begin(), last);
    }
    for (calvin::Observation& one : seen) one.timestamp += later;
    return seen;
  }
};

inline calvin::Status check_elements() {
  gst_init(nullptr, nullptr);
  for (const char* name : {"filesrc", "decodebin", "videoconvert", "appsink"}) {
    g_autoptr(GstElementFactory) factory = gst_element_factory_find(name);
    if (factory != nullptr) continue;
    return calvin::make_error(
        calvin::ErrorCode::kUnsupported,
        fmt::format("GStreamer's element {} is missing, without which no video can be decoded: "
                    "install gstreamer1.0-plugins-base.",
                    name));
  }
  return {};
}

// `board`: that of --board, or empty.
inline calvin::Result<Recording> open(std::size_t camera, const std::string& source,
                                      const std::string& board) {
  Recording one{camera, {}, {}, 0, {}};
  if (rig_recording::is_video(source)) {
    const auto boards = calvin::parse_boards(given_board::or_usual(board));
    if (!boards) return tl::unexpected(boards.error());
    auto video = rig_recording::Video::open(source, *boards);
    if (!video) return tl::unexpected(video.error());
    one.video = *std::move(video);
    return one;
  }
  auto views = rig_views::read(source, board);
  if (!views) return tl::unexpected(views.error());
  one.name = camera_names::name_in(*views);
  for (calvin::View& view : *views) {
    if (view.observation.timestamp == calvin::kNoTimestamp) continue;
    one.observations.push_back(std::move(view.observation));
  }
  std::ranges::stable_sort(one.observations, {}, &calvin::Observation::timestamp);
  return one;
}

// ns, from the earliest start to that of each camera.
inline std::vector<std::uint64_t> later_than_first(const std::vector<calvin::RigCameraViews>& all,
                                                   const std::map<std::string, double>& starts) {
  constexpr double kSecond = 1e9;  // ns
  std::vector<double> seconds;
  for (const calvin::RigCameraViews& camera : all) {
    const auto start = starts.find(camera.calibration.camera);
    seconds.push_back(start == starts.end() ? 0 : start->second);
  }
  const double first = std::ranges::min(seconds);
  std::vector<std::uint64_t> later;
  for (const double start : seconds) {
    later.push_back(static_cast<std::uint64_t>(std::llround(kSecond * (start - first))));
  }
  return later;
}

// What all have seen before a time, in the order of it: each file is worked on by a thread.
inline std::vector<std::pair<std::size_t, calvin::Observation>> seen_until(
    std::vector<Recording>& recordings, std::uint64_t end) {
  std::vector<std::future<std::vector<calvin::Observation>>> parts;
  for (Recording& one : recordings) {
    parts.push_back(std::async(std::launch::async, [&one, end] { return one.until(end); }));
  }
  std::vector<std::pair<std::size_t, calvin::Observation>> all;
  for (std::size_t r = 0; r < parts.size(); ++r) {
    for (calvin::Observation& seen : parts[r].get()) {
      all.emplace_back(recordings[r].camera, std::move(seen));
    }
  }
  std::ranges::stable_sort(all, {}, [](const auto& one) { return one.second.timestamp; });
  return all;
}

// Into `cameras` the views that the session keeps of what was recorded.
inline calvin::Status select(std::vector<Recording>& recordings, const Options& options,
                             std::vector<calvin::RigCameraViews>& cameras) {
  constexpr std::uint64_t kStep = 2'000'000'000;  // ns that are looked at at a time
  calvin::RigSession session;
  session.start({.options = options.rig, .method = calvin::RigMethod::kBoards});
  for (const Recording& one : recordings) {
    session.set_name(one.camera, cameras[one.camera].calibration.camera);
  }
  const auto is_over = [](const Recording& one) { return one.is_over(); };
  for (std::uint64_t end = kStep; !std::ranges::all_of(recordings, is_over); end += kStep) {
    for (auto& [camera, seen] : seen_until(recordings, end)) {
      const auto kept = session.offer(camera, std::move(seen));
      if (!kept) return tl::unexpected(kept.error());
    }
  }
  for (const Recording& one : recordings) {
    for (const auto& view : session.kept_views(one.camera)) {
      cameras[one.camera].views.push_back(*view);
    }
  }
  return {};
}

// Videos and pictures have no common clock.
inline calvin::Status check_clocks(const std::vector<std::string>& sources,
                                   const calvin::RigOptions& options) {
  if (options.mode == calvin::RigMode::kFloor) return {};
  const auto video = std::ranges::find_if(sources, rig_recording::is_video);
  const auto pictures = std::ranges::find_if(sources, rig_views::are_pictures);
  if (video == sources.end() || pictures == sources.end()) return {};
  return calvin::make_error(
      calvin::ErrorCode::kInvalidArgument,
      fmt::format(
          "'{}' is taken for a video, and '{}' are pictures, of which nobody knows when they "
          "were taken: give videos of all cameras, or a folder of pictures of each; with "
          "--floor any will do.",
          *video, *pictures));
}

// A lens that is known at another size of the same aspect.
inline calvin::Status fit_calibration(calvin::RigCameraViews& camera, const std::string& source) {
  if (camera.views.empty()) return {};
  const calvin::ImageSize size = camera.views.front().observation.image_size;
  calvin::Calibration& known = camera.calibration;
  if (size == calvin::ImageSize{}) return {};
  if (known.image_size == calvin::ImageSize{}) known.image_size = size;
  if (size == known.image_size) return {};
  const auto fit = calvin::fit_to_frame(known, size);
  if (!fit) {
    return calvin::make_error(
        fit.error().code, fmt::format("The calibration of '{}' is of {}x{} and '{}' of {}x{}: {}",
                                      known.camera, known.image_size.width, known.image_size.height,
                                      source, size.width, size.height, fit.error().message));
  }
  fmt::print("The calibration of '{}' is taken from {}x{} to the {}x{} of '{}'.\n", known.camera,
             known.image_size.width, known.image_size.height, size.width, size.height, source);
  std::string name = std::move(known.camera);
  known = fit->camera.to_calibration();
  known.camera = std::move(name);
  return {};
}

inline void print(const std::string& source, const Recording* recording, std::size_t views) {
  if (recording != nullptr && recording->video) {
    fmt::print(
        "{}: {}; {} views count, of places of the board that are new, and what the others "
        "saw at those times\n",
        source, recording->video->summary(), views);
  } else {
    fmt::print("{}: {} views\n", source, views);
  }
}

// Files of one pipeline keep when their cameras began, against each other.
inline void print_first_times(const std::vector<Recording>& recordings, const Options& options,
                              const std::vector<calvin::RigCameraViews>& cameras) {
  constexpr std::uint64_t kAlike = 1'000'000;  // ns
  std::uint64_t first = calvin::kNoTimestamp;
  for (const Recording& one : recordings) {
    if (one.video) first = std::min(first, one.video->first_time());
  }
  std::string starts;
  for (const Recording& one : recordings) {
    if (!one.video || one.video->first_time() <= first + kAlike) continue;
    starts += fmt::format("{}{}:{:.3f}", starts.empty() ? "" : ",",
                          cameras[one.camera].calibration.camera,
                          1e-9 * static_cast<double>(one.video->first_time() - first));
  }
  if (starts.empty() || !options.starts.empty()) return;
  fmt::print(
      "If one pipeline has recorded all videos, they did not begin at one time: give "
      "--start {}\n",
      starts);
}

inline calvin::Status check_starts(const std::map<std::string, double>& starts,
                                   const std::vector<std::string>& sources,
                                   const std::vector<calvin::RigCameraViews>& cameras) {
  for (const auto& [name, seconds] : starts) {
    const auto is_called = [&name](const auto& one) { return one.calibration.camera == name; };
    const auto camera = std::ranges::find_if(cameras, is_called);
    if (camera == cameras.end()) {
      return calvin::make_error(
          calvin::ErrorCode::kNotFound,
          fmt::format("No camera is called '{}', of which --start says when it began.", name));
    }
    const std::string& source = sources[static_cast<std::size_t>(camera - cameras.begin())];
    if (!rig_views::are_pictures(source)) continue;
    return calvin::make_error(
        calvin::ErrorCode::kInvalidArgument,
        fmt::format("--start says when '{}' began, and '{}' are pictures, which belong together by "
                    "the numbers in their names: it is for videos and files of observations.",
                    name, source));
  }
  return {};
}

// Views of pictures or of a file of observations, which are not looked at in the order of time.
// `later`: ns, than the clock of all.
inline calvin::Status read_views(const std::string& source, const std::string& board,
                                 std::uint64_t later, calvin::RigCameraViews& camera) {
  auto views = rig_views::read(source, board);
  if (!views) return tl::unexpected(views.error());
  for (calvin::View& view : *views) {
    std::uint64_t& time = view.observation.timestamp;
    if (time != calvin::kNoTimestamp) time += later;
  }
  camera.views = *std::move(views);
  return {};
}

// Opens what is looked at in the order of time, which is all but pictures where a video is there;
// the views of all others go into `cameras`.
inline calvin::Result<std::vector<Recording>> open_all(
    const std::vector<std::string>& sources, const Options& options,
    std::vector<calvin::RigCameraViews>& cameras) {
  const bool any_video = std::ranges::any_of(sources, rig_recording::is_video);
  if (any_video) {
    if (const auto good = check_elements(); !good) return tl::unexpected(good.error());
  }
  const auto later = later_than_first(cameras, options.starts);
  std::vector<Recording> recordings;
  std::vector<camera_names::Use> names;
  for (std::size_t c = 0; c < cameras.size(); ++c) {
    std::string name;
    if (any_video && !rig_views::are_pictures(sources[c])) {
      auto one = open(c, sources[c], options.board);
      if (!one) return tl::unexpected(one.error());
      one->later = later[c];
      name = one->name;
      recordings.push_back(*std::move(one));
    } else {
      const auto views = read_views(sources[c], options.board, later[c], cameras[c]);
      if (!views) return tl::unexpected(views.error());
      name = camera_names::name_in(cameras[c].views);
    }
    names.push_back({sources[c], std::move(name), cameras[c].calibration.camera});
  }
  const auto theirs = camera_names::check(std::move(names), "with the calibration of");
  if (!theirs) return tl::unexpected(theirs.error());
  return recordings;
}

inline calvin::Status check_found(const std::vector<Recording>& recordings,
                                  const std::vector<std::string>& sources,
                                  const std::string& board) {
  for (const Recording& one : recordings) {
    if (!one.video || one.video->has_seen_boards()) continue;
    return calvin::make_error(
        calvin::ErrorCode::kNotFound,
        fmt::format("In '{}' ({}) there is no board '{}': see --board, or is it too small or "
                    "blurred?",
                    sources[one.camera], one.video->summary(), given_board::or_usual(board)));
  }
  return {};
}

// `sources`: what each camera has seen; their calibrations are there, with their names.
inline calvin::Status read(const std::vector<std::string>& sources, const Options& options,
                           std::vector<calvin::RigCameraViews>& cameras) {
  if (const auto good = check_clocks(sources, options.rig); !good) return good;
  if (const auto good = check_starts(options.starts, sources, cameras); !good) return good;
  auto recordings = open_all(sources, options, cameras);
  if (!recordings) return tl::unexpected(recordings.error());
  print_first_times(*recordings, options, cameras);
  if (const auto good = select(*recordings, options, cameras); !good) return good;
  if (const auto good = check_found(*recordings, sources, options.board); !good) return good;
  for (std::size_t c = 0; c < cameras.size(); ++c) {
    const auto of = std::ranges::find(*recordings, c, &Recording::camera);
    print(sources[c], of == recordings->end() ? nullptr : &*of, cameras[c].views.size());
    if (const auto good = fit_calibration(cameras[c], sources[c]); !good) return good;
  }
  return {};
}

}  // namespace rig_sources
