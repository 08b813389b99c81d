// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Votes over pairs of boards in one picture, and Prim's tree over boards.

#include "calvin/rig/fixed/fixed_boards.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <map>
#include <tuple>
#include <utility>

#include "calvin/rig/start/vote.hpp"

namespace calvin::rig {

namespace {

// Two boards in one picture: numbers of views.
struct SeenTogether {
  std::size_t a = 0;
  std::size_t b = 0;
};

struct BoardLink {
  std::size_t a = 0;  // boards, a < b
  std::size_t b = 0;
  std::vector<SeenTogether> pictures;
  Vote a_from_b;
};

// camera_from_board by every tilt and labelling.
std::vector<SE3> poses_of(const BoardView& view) {
  std::vector<SE3> all;
  for (const SE3& pose : view.poses) {
    for (const SE3& labelling : view.labellings) all.push_back(pose * labelling.inverse());
  }
  return all;
}

// px, weighted: of the corners of `second` from where `first` expects them.
double misfit_of(const BoardView& first, const BoardView& second, const CameraPoints& camera,
                 const SE3& first_from_second) {
  double least = std::numeric_limits<double>::infinity();
  for (const SE3& pose : poses_of(first)) {
    for (const SE3& labelling : second.labellings) {
      least = std::min(least, misfit(second, camera, pose * first_from_second, labelling));
    }
  }
  return least;
}

std::vector<SE3> proposals(const std::vector<BoardView>& views, const BoardLink& link) {
  std::vector<SE3> all;
  for (const SeenTogether& picture : some_of(link.pictures, kMostProposers)) {
    for (const SE3& a : poses_of(views[picture.a])) {
      for (const SE3& b : poses_of(views[picture.b])) all.push_back(a.inverse() * b);
    }
  }
  return all;
}

// The labellings that all views of each board have: its symmetries. By any of them the board lies
// as well.
std::vector<std::vector<SE3>> symmetries_of(const std::vector<BoardView>& views) {
  std::vector<std::vector<SE3>> all;
  for (const BoardView& view : views) {
    if (view.board >= all.size()) all.resize(view.board + 1);
    std::vector<SE3>& common = all[view.board];
    if (common.empty()) common = view.labellings;
    std::erase_if(common, [&](const SE3& one) {
      return std::ranges::none_of(view.labellings,
                                  [&](const SE3& other) { return is_same_labelling(one, other); });
    });
  }
  return all;
}

void decide(const std::vector<BoardView>& views, const std::vector<CameraPoints>& cameras,
            const std::vector<std::vector<SE3>>& symmetries, BoardLink& link) {
  double away = 0;  // m, of the board
  for (const SeenTogether& picture : link.pictures) {
    away = std::max(away, views[picture.a].poses.front().translation.norm());
  }
  Voters voters;
  voters.count = link.pictures.size();
  voters.misfit = [&](std::size_t i, const SE3& a_from_b) {
    const BoardView& a = views[link.pictures[i].a];
    const BoardView& b = views[link.pictures[i].b];
    const CameraPoints& camera = cameras[a.of.camera];
    return std::max(misfit_of(a, b, camera, a_from_b), misfit_of(b, a, camera, a_from_b.inverse()));
  };
  voters.is_elsewhere = [&](const SE3& one, const SE3& other) {
    for (const SE3& a : symmetries[link.a]) {
      for (const SE3& b : symmetries[link.b]) {
        if (!is_elsewhere(a * one * b, other, away)) return false;
      }
    }
    return true;
  };
  link.a_from_b = vote_on(proposals(views, link), voters);
}

std::vector<BoardLink> links_of(const std::vector<BoardView>& views,
                                const std::vector<RigCameraViews>& seen,
                                const std::vector<Camera>& cameras,
                                const std::vector<std::vector<SE3>>& symmetries) {
  std::map<std::pair<std::size_t, std::uint64_t>, std::vector<std::size_t>> pictures;
  for (std::size_t v = 0; v < views.size(); ++v) {
    const RigView& of = views[v].of;
    const auto time = seen[of.camera].views[of.view].observation.timestamp;
    if (time != kNoTimestamp) pictures[{of.camera, time}].push_back(v);
  }
  std::map<std::pair<std::size_t, std::size_t>, BoardLink> links;
  for (const auto& [picture, shown] : pictures) {
    for (const std::size_t a : shown) {
      for (const std::size_t b : shown) {
        if (views[a].board >= views[b].board) continue;
        BoardLink& link = links[{views[a].board, views[b].board}];
        std::tie(link.a, link.b) = std::pair(views[a].board, views[b].board);
        link.pictures.push_back({a, b});
      }
    }
  }
  const std::vector<CameraPoints> points = points_before(cameras);
  std::vector<BoardLink> all;
  for (auto& [pair, link] : links) {
    decide(views, points, symmetries, link);
    all.push_back(std::move(link));
  }
  return all;
}

// Puts what hangs on the board `first` onto its body, along the links that most pictures agree on.
// A board that lies as well when it is turned tells nothing of what hangs on it.
void grow(std::size_t first, const std::vector<BoardLink>& links,
          const std::vector<std::vector<SE3>>& symmetries, std::vector<bool>& is_placed,
          std::vector<BoardOnBody>& boards) {
  boards[first] = {first, SE3()};
  is_placed[first] = true;
  const auto is_good = [&](std::size_t from, std::size_t to) {
    return is_placed[from] && !is_placed[to] && symmetries[from].size() == 1;
  };
  for (;;) {
    const BoardLink* best = nullptr;
    for (const BoardLink& link : links) {
      const bool is_open = is_good(link.a, link.b) || is_good(link.b, link.a);
      if (!is_open || !link.a_from_b.is_decided) continue;
      if (best == nullptr || link.a_from_b.votes > best->a_from_b.votes) best = &link;
    }
    if (best == nullptr) return;
    const bool is_forward = is_placed[best->a];
    const auto [from, to] = is_forward ? std::pair(best->a, best->b) : std::pair(best->b, best->a);
    const SE3 between = is_forward ? best->a_from_b.place : best->a_from_b.place.inverse();
    boards[to] = {first, boards[from].body_from_board * between};
    is_placed[to] = true;
  }
}

}  // namespace

std::vector<BoardOnBody> boards_on_bodies(const std::vector<BoardView>& views,
                                          const std::vector<RigCameraViews>& seen,
                                          const std::vector<Camera>& cameras) {
  const std::vector<std::vector<SE3>> symmetries = symmetries_of(views);
  const std::vector<BoardLink> links = links_of(views, seen, cameras, symmetries);
  const std::size_t count = symmetries.size();
  std::vector<BoardOnBody> boards(count);
  std::vector<bool> is_placed(count, false);
  for (const bool is_symmetric : {false, true}) {
    for (std::size_t b = 0; b < count; ++b) {
      if (is_placed[b] || (symmetries[b].size() > 1) != is_symmetric) continue;
      grow(b, links, symmetries, is_placed, boards);
    }
  }
  for (const BoardLink& link : links) {
    BoardOnBody& a = boards[link.a];
    BoardOnBody& b = boards[link.b];
    a.is_seen_with_others = b.is_seen_with_others = true;
    if (a.body != b.body) boards[std::max(a.body, b.body)].is_decided = false;
  }
  return boards;
}

std::vector<BoardView> views_of_bodies(const std::vector<BoardOnBody>& boards,
                                       const std::vector<BoardView>& views) {
  std::vector<BoardView> all = views;
  for (BoardView& view : all) {
    const BoardOnBody& on = boards[view.board];
    for (SE3& labelling : view.labellings) labelling = on.body_from_board * labelling;
    view.board = on.body;
  }
  return all;
}

}  // namespace calvin::rig
