// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// calvin-hand-eye: which line of a file of poses belongs to which view.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "calvin/io/robot_poses.hpp"
#include "calvin/solve/view.hpp"

#include "rig_views.hpp"

namespace hand_eye_match {

// The views that have a pose, and their poses.
struct Matched {
  std::vector<calvin::View> views;
  std::vector<calvin::Pose> poses;
  std::vector<std::size_t> lines;  // the numbers of these poses in the file
  const char* by = "order";
};

using Numbers = std::vector<std::optional<std::size_t>>;  // of the pose of each view

// Pictures by the names in the lines, with or without folder and ending, or by their numbers.
inline std::optional<std::size_t> line_of(const rig_views::fs::path& picture,
                                          const std::vector<calvin::RobotPose>& poses) {
  const auto is_same = [&](const calvin::RobotPose& pose) {
    const rig_views::fs::path name = pose.name;
    return name.filename() == picture.filename() || pose.name == picture.stem();
  };
  auto line = std::ranges::find_if(poses, is_same);
  if (line == poses.end()) {
    const auto number = rig_views::number_of(picture);
    line = std::ranges::find_if(poses, [&](const calvin::RobotPose& pose) {
      return number && pose.time == static_cast<double>(*number);
    });
  }
  if (line == poses.end()) return std::nullopt;
  return static_cast<std::size_t>(line - poses.begin());
}

// By the time of each view; lines no farther away than 20 ms.
inline Numbers by_time(const std::vector<calvin::View>& views,
                       const std::vector<calvin::RobotPose>& poses) {
  constexpr double kSecond = 1e9;     // ns
  constexpr double kFarthest = 0.02;  // s
  Numbers numbers;
  for (const calvin::View& view : views) {
    const double at = static_cast<double>(view.observation.timestamp) / kSecond;
    const auto nearest = std::ranges::min_element(poses, {}, [&](const calvin::RobotPose& pose) {
      return std::abs(pose.time.value_or(HUGE_VAL) - at);
    });
    const bool is_near = std::abs(nearest->time.value_or(HUGE_VAL) - at) <= kFarthest;
    numbers.push_back(is_near ? std::optional(static_cast<std::size_t>(nearest - poses.begin()))
                              : std::nullopt);
  }
  return numbers;
}

inline Matched matched(std::vector<calvin::View> views, const std::vector<calvin::RobotPose>& poses,
                       const Numbers& numbers, const char* by) {
  Matched all;
  all.by = by;
  for (std::size_t v = 0; v < views.size(); ++v) {
    if (!numbers[v]) continue;
    all.views.push_back(std::move(views[v]));
    all.poses.push_back(poses[*numbers[v]].base_from_hand);
    all.lines.push_back(*numbers[v]);
  }
  return all;
}

inline tl::unexpected<calvin::Error> no_match(const std::string& what, std::size_t count,
                                              std::size_t lines) {
  return calvin::make_error(
      calvin::ErrorCode::kInvalidArgument,
      fmt::format("There are {} {} and {} poses of the robot, and nothing in the lines tells which "
                  "belong together: give a pose for each, in their order, or begin each line with "
                  "the name of its picture or with its time.",
                  count, what, lines));
}

// Views of pictures: by names or numbers where each line has one and some are those of pictures,
// else the lines are in the order of the pictures, those without a board among them.
inline calvin::Result<Matched> with_pictures(const std::string& source,
                                             std::vector<calvin::View> views,
                                             const std::vector<calvin::RobotPose>& poses) {
  const auto pictures = rig_views::pictures_of(source);
  std::map<std::uint64_t, std::size_t> lines;  // by the timestamp of the view
  if (std::ranges::all_of(poses, [](const auto& pose) { return !pose.name.empty(); })) {
    for (const auto& [number, file] : pictures) {
      if (const auto line = line_of(file, poses)) lines[number * rig_views::kNumber] = *line;
    }
  }
  const char* by = lines.empty() ? "order" : "name";
  if (lines.empty()) {
    if (pictures.size() != poses.size()) {
      return no_match("pictures", pictures.size(), poses.size());
    }
    for (std::size_t i = 0; i < pictures.size(); ++i) {
      lines[pictures[i].first * rig_views::kNumber] = i;
    }
  }
  Numbers numbers;
  for (const calvin::View& view : views) {
    const auto line = lines.find(view.observation.timestamp);
    numbers.push_back(line == lines.end() ? std::nullopt : std::optional(line->second));
  }
  return matched(std::move(views), poses, numbers, by);
}

// Of a file of observations: by time where lines and views have one, else by their order.
inline calvin::Result<Matched> with_observations(std::vector<calvin::View> views,
                                                 const std::vector<calvin::RobotPose>& poses) {
  const auto timed = by_time(views, poses);
  if (std::ranges::any_of(timed, [](const auto& number) { return number.has_value(); })) {
    return matched(std::move(views), poses, timed, "time");
  }
  if (views.size() != poses.size()) return no_match("views", views.size(), poses.size());
  Numbers numbers;
  for (std::size_t v = 0; v < views.size(); ++v) numbers.emplace_back(v);
  return matched(std::move(views), poses, numbers, "order");
}

inline calvin::Result<Matched> match(const std::string& source, std::vector<calvin::View> views,
                                     const std::vector<calvin::RobotPose>& poses) {
  return rig_views::are_pictures(source) ? with_pictures(source, std::move(views), poses)
                                         : with_observations(std::move(views), poses);
}

}  // namespace hand_eye_match
