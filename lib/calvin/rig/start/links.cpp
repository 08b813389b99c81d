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
std::vector<SE3> first_from_second(const BoardView& first, const BoardView& second,
                                   Pictures pictures) {
  const bool is_plain = pictures == Pictures::kAsTheyAre;
  if (is_plain && first.labellings.size() == 1 && second.labellings.size() == 1) {
    return {first.labellings.front().inverse() * second.labellings.front()};
  }
  std::vector<SE3> all;
  for (const SE3& mirror : mirrors_of_board(second.middle, pictures)) {
    for (const SE3& of_first : first.labellings) {
      for (const SE3& of_second : second.labellings) {
        const SE3 motion = of_first.inverse() * mirror * of_second;
        const bool known = std::ranges::any_of(
            all, [&](const SE3& other) { return is_same_labelling(other, motion); });
        if (!known) all.push_back(motion);
      }
    }
  }
  return all;
}

// `second_from_first` has the mirror before the camera of the one that is mirrored in it.
Agreement best_agreement(const BoardView& first, std::span<const SE3> poses,
                         const BoardView& second, const CameraPoints& second_camera,
                         const SE3& second_from_first, Pictures pictures = Pictures::kAsTheyAre) {
  Agreement best;
  bool none = true;
  for (const SE3& motion : first_from_second(first, second, pictures)) {
    for (const SE3& pose : poses) {
      const double now = misfit(second, second_camera, second_from_first * pose, motion);
      if (none || now < best.misfit) best = {pose, motion, now};
      none = false;
    }
  }
  return best;
}

// By every tilt and labelling of some instants.
std::vector<SE3> proposals(const std::vector<BoardView>& views, const Link& link,
                           Pictures pictures) {
  const SE3 mirror = mirror_before_camera(pictures);
  std::vector<SE3> all;
  for (const auto& [a, b] : some_of(link.common, kMostProposers)) {
    const auto motions = first_from_second(views[a], views[b], pictures);
    for (const SE3& pose_a : views[a].poses) {
      for (const SE3& pose_b : views[b].poses) {
        for (const SE3& motion : motions) {
          all.push_back(mirror * pose_b * motion.inverse() * pose_a.inverse());
        }
      }
    }
  }
  return all;
}

// On where b is to a, with the pictures of one of them as they are or mirrored.
Vote vote_on_link(const std::vector<BoardView>& views, const std::vector<CameraPoints>& cameras,
                  const Link& link, Pictures pictures) {
  double away = 0;
  for (const CommonView& c : link.common) {
    away = std::max(away, views[c.a].poses.front().translation.norm());
  }
  const SE3 mirror = mirror_before_camera(pictures);
  Voters voters;
  voters.count = link.common.size();
  // The worse of what each camera's pose of the board makes the other one expect.
  voters.misfit = [&](std::size_t i, const SE3& b_from_a) {
    const BoardView& a = views[link.common[i].a];
    const BoardView& b = views[link.common[i].b];
    const SE3 seen = mirror * b_from_a;
    return std::max(
        best_agreement(a, a.poses, b, cameras[link.b], seen, pictures).misfit,
        best_agreement(b, b.poses, a, cameras[link.a], seen.inverse(), pictures).misfit);
  };
  voters.is_elsewhere = [&](const SE3& one, const SE3& other) {
    return is_elsewhere(one.inverse(), other.inverse(), away);
  };
  return vote_on(proposals(views, link, pictures), voters);
}

// Whether most of the views agree as soon as the pictures of one of the cameras are taken for
// mirrored. Which one it is they do not tell.
bool agree_mirrored(const std::vector<BoardView>& views, const std::vector<CameraPoints>& cameras,
                    const Link& link) {
  constexpr std::size_t kFewest = 4;  // views: a few agree by chance
  if (link.common.size() < kFewest) return false;
  const std::size_t votes = vote_on_link(views, cameras, link, Pictures::kMirrored).votes;
  return votes >= kFewest && 2 * votes > link.common.size() && votes > 2 * link.votes;
}

void decide(const std::vector<BoardView>& views, const std::vector<CameraPoints>& cameras,
            Link& link) {
  const Vote vote = vote_on_link(views, cameras, link, Pictures::kAsTheyAre);
  link.b_from_a = vote.place;
  link.votes = vote.votes;
  link.is_decided = vote.is_decided;
  if (link.is_decided && 2 * link.votes > link.common.size()) return;
  link.is_mirrored = agree_mirrored(views, cameras, link);
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
