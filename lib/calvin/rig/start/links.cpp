// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Proposes places of two cameras from single instants, and asks all instants how well each fits.

#include "calvin/rig/start/links.hpp"

#include <algorithm>
#include <map>
#include <span>
#include <utility>

#include "calvin/rig/start/mirrored.hpp"
#include "calvin/rig/start/vote.hpp"

namespace calvin::rig {

namespace {

// All ways to name the points of `second` by the labels of `first`.
std::vector<SE3> first_from_second(const BoardView& first, const BoardView& second) {
  if (first.labellings.size() == 1 && second.labellings.size() == 1) {
    return {first.labellings.front().inverse() * second.labellings.front()};
  }
  std::vector<SE3> all;
  for (const SE3& of_first : first.labellings) {
    for (const SE3& of_second : second.labellings) {
      const SE3 motion = of_first.inverse() * of_second;
      const bool known = std::ranges::any_of(
          all, [&](const SE3& other) { return is_same_labelling(other, motion); });
      if (!known) all.push_back(motion);
    }
  }
  return all;
}

Agreement best_agreement(const BoardView& first, std::span<const SE3> poses,
                         const BoardView& second, const CameraPoints& second_camera,
                         const SE3& second_from_first) {
  Agreement best;
  bool none = true;
  for (const SE3& motion : first_from_second(first, second)) {
    for (const SE3& pose : poses) {
      const double now = misfit(second, second_camera, second_from_first * pose, motion);
      if (none || now < best.misfit) best = {pose, motion, now};
      none = false;
    }
  }
  return best;
}

// By every tilt and labelling of some instants.
std::vector<SE3> proposals(const std::vector<BoardView>& views, const Link& link) {
  std::vector<SE3> all;
  for (const auto& [a, b] : some_of(link.common, kMostProposers)) {
    const auto motions = first_from_second(views[a], views[b]);
    for (const SE3& pose_a : views[a].poses) {
      for (const SE3& pose_b : views[b].poses) {
        for (const SE3& motion : motions) {
          all.push_back(pose_b * motion.inverse() * pose_a.inverse());
        }
      }
    }
  }
  return all;
}

void decide(const std::vector<BoardView>& views, const std::vector<CameraPoints>& cameras,
            Link& link) {
  double away = 0;
  for (const CommonView& c : link.common) {
    away = std::max(away, views[c.a].poses.front().translation.norm());
  }
  Voters voters;
  voters.count = link.common.size();
  // The worse of what each camera's pose of the board makes the other one expect.
  voters.misfit = [&](std::size_t i, const SE3& b_from_a) {
    const BoardView& a = views[link.common[i].a];
    const BoardView& b = views[link.common[i].b];
    return std::max(agreement(a, b, cameras[link.b], b_from_a).misfit,
                    agreement(b, a, cameras[link.a], b_from_a.inverse()).misfit);
  };
  voters.is_elsewhere = [&](const SE3& one, const SE3& other) {
    return is_elsewhere(one.inverse(), other.inverse(), away);
  };
  const Vote vote = vote_on(proposals(views, link), voters);
  link.b_from_a = vote.place;
  link.votes = vote.votes;
  link.is_decided = vote.is_decided;
  if (link.is_decided && 2 * link.votes > link.common.size()) return;
  link.is_mirrored = is_mirrored(views, cameras, link);
  link.is_decided = link.is_decided && !link.is_mirrored;
}

}  // namespace

Agreement agreement(const BoardView& first, const BoardView& second,
                    const CameraPoints& second_camera, const SE3& second_from_first) {
  return best_agreement(first, first.poses, second, second_camera, second_from_first);
}

Agreement agreement(const BoardView& first, const SE3& pose, const BoardView& second,
                    const CameraPoints& second_camera, const SE3& second_from_first) {
  return best_agreement(first, {&pose, 1}, second, second_camera, second_from_first);
}

std::vector<Link> find_links(const std::vector<BoardView>& views,
                             const std::vector<std::vector<std::size_t>>& groups,
                             const std::vector<Camera>& cameras) {
  std::map<std::pair<std::size_t, std::size_t>, Link> links;
  for (const auto& group : groups) {
    for (std::size_t i = 0; i < group.size(); ++i) {
      for (std::size_t j = i + 1; j < group.size(); ++j) {
        const BoardView& a = views[group[i]];
        const BoardView& b = views[group[j]];
        if (a.of.camera == b.of.camera || a.board != b.board) continue;
        Link& link = links[{a.of.camera, b.of.camera}];
        link.a = a.of.camera;
        link.b = b.of.camera;
        link.common.push_back({group[i], group[j]});
      }
    }
  }
  const std::vector<CameraPoints> points = points_before(cameras);
  std::vector<Link> all;
  for (auto& [pair, link] : links) {
    decide(views, points, link);
    all.push_back(std::move(link));
  }
  return all;
}

}  // namespace calvin::rig
