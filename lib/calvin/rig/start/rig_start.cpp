// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Prim's tree over cameras, then each board where most of its views agree.

#include "calvin/rig/start/rig_start.hpp"

#include <algorithm>
#include <map>
#include <numeric>
#include <optional>
#include <string>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "calvin/core/text.hpp"

namespace calvin::rig {

namespace {

std::string quoted(const std::vector<std::string>& names) {
  std::vector<std::string> all;
  for (const std::string& name : names) all.push_back(fmt::format("'{}'", name));
  return join(all, ", ");
}

std::string not_joined(const std::vector<std::string>& joined,
                       const std::vector<std::string>& others) {
  return fmt::format(
      "The {} {} seen no board at the same time as {}: show one to both, where their pictures "
      "overlap, or to a third camera with each of them.",
      others.size() == 1 ? "camera" : "cameras",
      quoted(others) + (others.size() == 1 ? " has" : " have"), quoted(joined));
}

std::string not_decided(const std::string& a, const std::string& b) {
  return fmt::format(
      "What the cameras '{}' and '{}' have seen leaves open where they stand to each other: the "
      "board looks the same when it is turned, or it is seen from far away and flat. Show it in "
      "more places and tilted, or take a board that names its corners, as puzzle:14x9:20mm.",
      a, b);
}

// The cameras that a link is of, or the one of them that agrees with no other camera.
std::string mirrored(const Link& link, const std::vector<Link>& links,
                     const std::vector<std::string>& names) {
  const auto count = [&links](std::size_t camera) {
    return std::ranges::count_if(links, [camera](const Link& other) {
      return other.is_decided && (other.a == camera || other.b == camera);
    });
  };
  const auto of_a = count(link.a);
  const auto of_b = count(link.b);
  const std::string which = of_a == of_b
                                ? fmt::format("'{}' or those of '{}'", names[link.a], names[link.b])
                                : fmt::format("'{}'", names[of_a < of_b ? link.a : link.b]);
  return fmt::format(
      "The pictures of {} are mirrored, as videoflip does it, or a program that shows people "
      "themselves: each camera fits what it has seen by itself, and no place of the two fits both. "
      "Take the mirror out, and calibrate that camera again without it.",
      which);
}

std::string why_open(const Link& link, const std::vector<Link>& links,
                     const std::vector<std::string>& names) {
  return link.is_mirrored ? mirrored(link, links, names)
                          : not_decided(names[link.a], names[link.b]);
}

// For each camera the first one of its set, which decided links join.
std::vector<std::size_t> sets_of(const std::vector<Link>& links, std::size_t cameras) {
  std::vector<std::size_t> first(cameras);
  std::iota(first.begin(), first.end(), std::size_t{0});
  for (std::size_t round = 0; round < cameras; ++round) {
    for (const Link& link : links) {
      if (!link.is_decided) continue;
      const std::size_t least = std::min(first[link.a], first[link.b]);
      first[link.a] = first[link.b] = least;
    }
  }
  return first;
}

// The link to a further camera that most views agree on; nullptr where there is none.
const Link* best_link(const std::vector<Link>& links,
                      const std::vector<std::optional<SE3>>& placed) {
  const Link* best = nullptr;
  for (const Link& link : links) {
    if (placed[link.a].has_value() == placed[link.b].has_value()) continue;
    // Of those that are not decided one that tells why.
    const auto rank = [](const Link& l) {
      return std::tuple(l.is_decided, l.is_mirrored, l.votes);
    };
    if (best == nullptr || rank(link) > rank(*best)) best = &link;
  }
  return best;
}

Result<std::vector<SE3>> place_cameras(const std::vector<Link>& links,
                                       const std::vector<std::string>& names) {
  std::vector<std::optional<SE3>> placed(names.size());
  placed.front() = SE3();
  while (const Link* link = best_link(links, placed)) {
    if (!link->is_decided) {
      return make_error(ErrorCode::kDegenerate, why_open(*link, links, names));
    }
    if (placed[link->a]) {
      placed[link->b] = link->b_from_a * *placed[link->a];
    } else {
      placed[link->a] = link->b_from_a.inverse() * *placed[link->b];
    }
  }
  std::vector<std::string> joined;
  std::vector<std::string> others;
  std::vector<SE3> all;
  for (std::size_t c = 0; c < names.size(); ++c) {
    (placed[c] ? joined : others).push_back(names[c]);
    all.push_back(placed[c].value_or(SE3()));
  }
  if (!others.empty()) return make_error(ErrorCode::kDegenerate, not_joined(joined, others));
  return all;
}

// The pose of one board at one instant, with the labels of one of its views.
struct BoardPlace {
  SE3 rig_from_board;
  std::vector<SE3> board_from_own;  // of the views, in their order
  double misfit = 0;                // px, the sum over the views
};

// As the view `first` of a group has it.
BoardPlace place_by(std::size_t first, const std::vector<std::size_t>& group,
                    const std::vector<BoardView>& views, const std::vector<CameraPoints>& cameras,
                    const std::vector<SE3>& camera_from_rig) {
  const BoardView& own = views[group[first]];
  const SE3 rig_from_own = camera_from_rig[own.of.camera].inverse();
  BoardPlace best;
  bool none = true;
  for (const SE3& pose : own.poses) {
    BoardPlace place{rig_from_own * pose, {}, 0};
    for (std::size_t i = 0; i < group.size(); ++i) {
      const BoardView& other = views[group[i]];
      if (i == first) {
        place.board_from_own.emplace_back();
        continue;
      }
      const Agreement agreed = agreement(own, pose, other, cameras[other.of.camera],
                                         camera_from_rig[other.of.camera] * rig_from_own);
      place.board_from_own.push_back(agreed.labelling);
      place.misfit += agreed.misfit;
    }
    if (none || place.misfit < best.misfit) best = std::move(place);
    none = false;
  }
  return best;
}

}  // namespace

JoinedCameras joined_cameras(const std::vector<Link>& links,
                             const std::vector<std::string>& names) {
  const std::vector<std::size_t> sets = sets_of(links, names.size());
  std::size_t largest = 0;
  for (const std::size_t set : sets) {
    if (std::ranges::count(sets, set) > std::ranges::count(sets, largest)) largest = set;
  }
  JoinedCameras joined;
  std::vector<std::string> others;
  for (std::size_t c = 0; c < names.size(); ++c) {
    joined.is_joined.push_back(sets[c] == largest);
    if (joined.is_joined[c]) others.push_back(names[c]);
  }
  for (std::size_t c = 0; c < names.size(); ++c) {
    const auto is_between = [&](const Link& link) {
      return (link.a == c && joined.is_joined[link.b]) || (link.b == c && joined.is_joined[link.a]);
    };
    auto undecided = std::ranges::find_if(
        links, [&](const Link& link) { return is_between(link) && link.is_mirrored; });
    if (undecided == links.end()) undecided = std::ranges::find_if(links, is_between);
    std::string& why = joined.why_not.emplace_back();
    if (joined.is_joined[c]) continue;
    why = undecided == links.end() ? not_joined(others, {names[c]})
                                   : why_open(*undecided, links, names);
  }
  return joined;
}

Result<RigPlaces> place_all(const std::vector<BoardView>& views,
                            const std::vector<std::vector<std::size_t>>& groups,
                            const std::vector<Camera>& cameras, const std::vector<Link>& links,
                            const std::vector<std::string>& names, std::size_t fewest) {
  auto camera_from_rig = place_cameras(links, names);
  if (!camera_from_rig) return tl::unexpected<Error>(camera_from_rig.error());
  const std::vector<CameraPoints> points = points_before(cameras);
  RigPlaces places;
  places.camera_from_rig = *std::move(camera_from_rig);
  for (const auto& group : groups) {
    std::map<std::size_t, std::vector<std::size_t>> by_board;
    for (const std::size_t v : group) by_board[views[v].board].push_back(v);
    for (const auto& [board, of_board] : by_board) {
      if (of_board.size() < fewest) continue;
      BoardPlace best;
      for (std::size_t first = 0; first < of_board.size(); ++first) {
        BoardPlace place = place_by(first, of_board, views, points, places.camera_from_rig);
        if (first == 0 || place.misfit < best.misfit) best = std::move(place);
      }
      for (std::size_t i = 0; i < of_board.size(); ++i) {
        places.views.push_back({of_board[i], places.rig_from_board.size(), best.board_from_own[i]});
      }
      places.rig_from_board.push_back(best.rig_from_board);
    }
  }
  return places;
}

}  // namespace calvin::rig
