// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The words of a session for its user.

#include "calvin/session/session_words.hpp"

#include <algorithm>
#include <string_view>

#include <fmt/format.h>

#include "calvin/core/text.hpp"

namespace calvin {

namespace {

std::string_view words_of(Reason refused) {
  switch (refused) {
    case Reason::kMoving:
      return "it moved: hold it still for a moment";
    case Reason::kBlurred:
      return "it was blurred: focus, and more light or a shorter exposure";
    case Reason::kTooFewPoints:
      return "too few of its corners were in the picture";
    case Reason::kTooSmall:
      return "it was too small: come closer";
    case Reason::kTooSimilar:
      return "there was nothing new about it, or no view was asked for";
    case Reason::kWrongBoard:
      return "it was not the board that the property names";
    case Reason::kOffSize:
      return "the frames had another size than the views before";
    default:
      return to_string(refused);
  }
}

std::string views(std::size_t count) {
  return count == 1 ? "1 view" : fmt::format("{} views", count);
}

// What kept the boards that were seen from being taken; nothing where none was.
std::string told(const Refusals& refused) {
  if (refused.empty()) return {};
  const auto most =
      std::max_element(refused.begin(), refused.end(),
                       [](const auto& a, const auto& b) { return a.second < b.second; });
  std::size_t all = 0;
  for (const auto& [reason, times] : refused) all += times;
  return fmt::format(" A board was seen {} and not taken, {}{}.",
                     all == 1 ? "once" : fmt::format("{} times", all),
                     refused.size() > 1 ? "mostly since " : "since ", words_of(most->first));
}

}  // namespace

Error too_few_views(std::size_t views, int least, const Refusals& refused,
                    const std::string& obstacle) {
  return {
      ErrorCode::kDegenerate,
      fmt::format("No calibration: {} taken, at least {} are needed. Show the whole board, flat "
                  "and sharp, in different places and tilts, and check that the property "
                  "`board` is the text of this board (calvin-board identify PICTURE tells it).{}{}",
                  views == 0   ? "no view of the board was"
                  : views == 1 ? "only one view of the board was"
                               : fmt::format("only {} views of the board were", views),
                  least, obstacle.empty() ? "" : " " + obstacle + ".", told(refused))};
}

Error no_frames() {
  return {ErrorCode::kDegenerate,
          "No calibration: the stream ended before its first frame. Look at what is upstream, as "
          "the name of a file or a camera that sends nothing."};
}

Error nothing_detected() {
  return {ErrorCode::kDegenerate,
          "No calibration: no view of the board was taken, since no detector has said anything of "
          "any frame. calibsolve comes after calibdetect, as in calibdetect ! calibsolve, and "
          "elements between them, as videoflip, may lose what was found. Where frames could not be "
          "read, calibdetect has warned of it."};
}

Error too_few_points(const std::string& hint) {
  return {ErrorCode::kDegenerate,
          fmt::format("No calibration: the manual points are not enough. {}", hint)};
}

Error solve_failed(const std::string& why, bool before) {
  return {
      ErrorCode::kDegenerate,
      (before ? "The final solve failed and the one before it stays: " : "No calibration: ") + why};
}

Error refused_setting(Error why) {
  why.message += " What was set before goes on.";
  return why;
}

Notice late_files(const std::vector<CalibrationFile>& files, std::chrono::seconds waited) {
  std::vector<std::string> paths;
  for (const CalibrationFile& file : files) paths.push_back(file.path);
  return {Notice::Kind::kWarning,
          {ErrorCode::kIo,
           fmt::format("The write of '{}' has not ended after {} s: its disk, or the server or "
                       "reader behind it, does not answer. Results go on to the bus, and the "
                       "newest one is written once it answers; EOS waits for that.",
                       join(paths, "', '"), waited.count())}};
}

std::optional<Notice> other_frames(ImageSize size, std::size_t taken_up,
                                   const Session::Views& set_aside) {
  if (taken_up == 0 && set_aside.empty()) return std::nullopt;
  std::string words = taken_up > 0
                          ? fmt::format("{} that {} taken before of frames of {}x{} px {} on.",
                                        views(taken_up), taken_up == 1 ? "was" : "were", size.width,
                                        size.height, taken_up == 1 ? "goes" : "go")
                          : fmt::format("The frames are {}x{} px now, and a new session begins.",
                                        size.width, size.height);
  if (!set_aside.empty()) {
    words += fmt::format(" {} of frames of another size {} until such frames come again.",
                         views(set_aside.size()), set_aside.size() == 1 ? "waits" : "wait");
  }
  return Notice{Notice::Kind::kInfo, {ErrorCode::kInvalidArgument, std::move(words)}};
}

Notice frames_stopped(std::uint64_t seconds, std::size_t kept) {
  const std::string waiting =
      kept == 0 ? "" : fmt::format(" {} {} for that.", views(kept), kept == 1 ? "waits" : "wait");
  return {Notice::Kind::kWarning,
          {ErrorCode::kIo,
           fmt::format("No frame has come for {} s: the camera, or what is between it and this "
                       "element, has stopped. See that it is plugged in and that no other program "
                       "has it; dmesg tells what a USB camera suffers from. The session goes on "
                       "when frames come again.{}",
                       seconds, waiting)}};
}

Notice frames_again(std::size_t kept) {
  return {Notice::Kind::kInfo,
          {ErrorCode::kInvalidArgument, fmt::format("Frames come again, and the session goes on{}.",
                                                    kept == 0 ? "" : " with " + views(kept))}};
}

Notice kept_file(const std::string& path) {
  return {
      Notice::Kind::kInfo,
      {ErrorCode::kInvalidArgument,
       fmt::format("'{}' holds the calibration of another session, which stays until this "
                   "one's is as good. Where the camera is another one since, the final result "
                   "takes its place: end with EOS (gst-launch-1.0 -e) or emit the signal solve. "
                   "overwrite=true replaces it at once.",
                   path)}};
}

}  // namespace calvin
