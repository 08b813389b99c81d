// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The vote on where two cameras stand, with one picture in a mirror. With M the mirror before the
// camera and F the one between the labels, M camera_from_board F is a motion for points of a plane:
// what lies off it would be on the other side.

#include "calvin/rig/start/mirrored.hpp"

#include <algorithm>

#include "calvin/rig/start/vote.hpp"

namespace calvin::rig {

namespace {

// No motion: its matrix has the determinant -1.
using Reflection = SE3;

Reflection before_camera() {
  Reflection mirror;
  mirror.rotation(0, 0) = -1;
  return mirror;
}

// Across the middle of a board, upright, level and along both diagonals: those that a grid has, or
// that make it another one, with which nothing agrees.
std::vector<Reflection> of_board(const BoardView& view) {
  std::vector<Reflection> all;
  for (const bool is_diagonal : {false, true}) {
    for (const double side : {-1.0, 1.0}) {
      Eigen::Matrix3d m = Eigen::Matrix3d::Identity();
      m.topLeftCorner<2, 2>() = is_diagonal ? (Eigen::Matrix2d() << 0, side, side, 0).finished()
                                            : (Eigen::Matrix2d() << side, 0, 0, -side).finished();
      all.push_back({m, view.middle - m * view.middle});
    }
  }
  return all;
}

// Of labels: all ways in which those of `first` follow from those of `second` in a mirror.
std::vector<Reflection> first_from_second(const BoardView& first, const BoardView& second) {
  std::vector<Reflection> all;
  for (const SE3& of_first : first.labellings) {
    for (const Reflection& mirror : of_board(second)) all.push_back(of_first.inverse() * mirror);
  }
  return all;
}

// px: how far corners of `second` are from where `first` has them.
double agreement(const BoardView& first, const BoardView& second, const CameraPoints& second_camera,
                 const Reflection& second_from_first, const std::vector<Reflection>& labels) {
  double least = 1e9;
  for (const Reflection& label : labels) {
    for (const SE3& pose : first.poses) {
      least = std::min(least, misfit(second, second_camera, second_from_first * pose, label));
    }
  }
  return least;
}

std::vector<SE3> proposals(const std::vector<BoardView>& views, const Link& link) {
  std::vector<SE3> all;
  for (const auto& [a, b] : some_of(link.common, kMostProposers)) {
    for (const Reflection& label : first_from_second(views[a], views[b])) {
      for (const SE3& pose_a : views[a].poses) {
        for (const SE3& pose_b : views[b].poses) {
          all.push_back(before_camera() * pose_b * label.inverse() * pose_a.inverse());
        }
      }
    }
  }
  return all;
}

}  // namespace

bool is_mirrored(const std::vector<BoardView>& views, const std::vector<CameraPoints>& cameras,
                 const Link& link) {
  constexpr std::size_t kFewest = 4;  // views: a few agree by chance
  if (link.common.size() < kFewest) return false;
  double away = 0;
  for (const CommonView& c : link.common) {
    away = std::max(away, views[c.a].poses.front().translation.norm());
  }
  Voters voters;
  voters.count = link.common.size();
  voters.misfit = [&](std::size_t i, const SE3& b_from_a) {
    const BoardView& a = views[link.common[i].a];
    const BoardView& b = views[link.common[i].b];
    const Reflection to_b = before_camera() * b_from_a;
    std::vector<Reflection> labels = first_from_second(a, b);
    const double in_b = agreement(a, b, cameras[link.b], to_b, labels);
    for (Reflection& label : labels) label = label.inverse();
    return std::max(in_b, agreement(b, a, cameras[link.a], to_b.inverse(), labels));
  };
  voters.is_elsewhere = [&](const SE3& one, const SE3& other) {
    return is_elsewhere(one.inverse(), other.inverse(), away);
  };
  const Vote vote = vote_on(proposals(views, link), voters);
  return vote.votes >= kFewest && 2 * vote.votes > link.common.size() &&
         vote.votes > 2 * link.votes;
}

}  // namespace calvin::rig
