// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Proposes places of two cameras from single instants, and asks all instants how well each fits.

#include "calvin/rig/joint/links.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <span>
#include <utility>

namespace calvin::rig {

namespace {

constexpr std::size_t kMostProposers = 40;  // instants from which places are proposed
constexpr std::size_t kMostVoters = 80;     // instants that are asked
constexpr std::size_t kRoughVoters = 8;     // that are asked first
constexpr int kAsked =
    3;  // proposals of the best place that are asked for all: it is refined later
constexpr double kAgree = 8;  // px, weighted: of views whose poses are known about
constexpr double kSoft = 2;   // px, from where on a misfit counts less than its square
// How much better than another one a place has to be, in misfits of one view that disagrees.
constexpr double kLead = 1.5;

// All ways to name the points of `second` by the labels of `first`.
std::vector<SE3> first_from_second(const BoardView& first, const BoardView& second) {
  if (first.labellings.size() == 1 && second.labellings.size() == 1) return {SE3()};
  std::vector<SE3> all;
  for (const SE3& of_first : first.labellings) {
    for (const SE3& of_second : second.labellings) {
      const SE3 motion = of_first.inverse() * of_second;
      const bool known = std::ranges::any_of(all, [&](const SE3& other) {
        return (other.rotation - motion.rotation).norm() < 1e-6 &&
               (other.translation - motion.translation).norm() < 1e-6;
      });
      if (!known) all.push_back(motion);
    }
  }
  return all;
}

// Every `step`th of a list, so that at most `most` are left.
template <typename T>
std::vector<T> some_of(const std::vector<T>& all, std::size_t most) {
  std::vector<T> some;
  const std::size_t step = (all.size() + most - 1) / most;
  for (std::size_t i = 0; i < all.size(); i += step) some.push_back(all[i]);
  return some;
}

struct Proposal {
  SE3 b_from_a;
  double cost = 0;
  double rough_cost = 0;  // of a few voters
};

class Vote {
 public:
  Vote(const std::vector<BoardView>& views, const std::vector<CameraPoints>& cameras, Link& link)
      : views_(views), cameras_(cameras), link_(link) {
    for (const CommonView& c : link.common) {
      away_ = std::max(away_, views[c.a].poses.front().translation.norm());
    }
  }

  void run() {
    std::vector<Proposal> all = ranked();
    const Proposal best = ask(all);
    link_.b_from_a = best.b_from_a;
    link_.votes = static_cast<std::size_t>(std::ranges::count_if(
        link_.common, [&](const CommonView& c) { return both_ways(c, best.b_from_a) < kAgree; }));
    link_.is_decided = std::ranges::none_of(all, [&](const Proposal& p) {
      return p.cost < best.cost + kLead && is_elsewhere(p.b_from_a, best.b_from_a);
    });
  }

 private:
  // Those that a few voters like best come first.
  [[nodiscard]] std::vector<Proposal> ranked() const {
    constexpr double kAny = std::numeric_limits<double>::infinity();
    std::vector<Proposal> all = proposals();
    const auto few = some_of(link_.common, kRoughVoters);
    for (Proposal& p : all) p.rough_cost = cost(p.b_from_a, few, kAny);
    std::ranges::stable_sort(all, {}, &Proposal::rough_cost);
    return all;
  }

  // Asks all voters, and gives the best proposal. What costs more than the best so far and kLead is
  // neither the best nor a rival of it, whatever more it costs; nor are more than a few of those
  // that are the same place but for noise of use.
  [[nodiscard]] Proposal ask(std::vector<Proposal>& all) const {
    const auto voters = some_of(link_.common, kMostVoters);
    Proposal best = all.front();
    best.cost = std::numeric_limits<double>::infinity();
    int asked = 0;
    for (Proposal& p : all) {
      const bool is_same = !is_elsewhere(p.b_from_a, best.b_from_a);
      p.cost = std::numeric_limits<double>::infinity();
      if (is_same && asked == kAsked) continue;
      p.cost = cost(p.b_from_a, voters, best.cost + kLead);
      asked = is_same ? asked + 1 : asked;
      if (p.cost >= best.cost) continue;
      best = p;
      if (!is_same) asked = 1;
    }
    return best;
  }

  // By every tilt and labelling of some instants.
  [[nodiscard]] std::vector<Proposal> proposals() const {
    std::vector<Proposal> all;
    for (const auto& [a, b] : some_of(link_.common, kMostProposers)) {
      const auto motions = first_from_second(views_[a], views_[b]);
      for (const SE3& pose_a : views_[a].poses) {
        for (const SE3& pose_b : views_[b].poses) {
          for (const SE3& motion : motions) {
            all.push_back({pose_b * motion.inverse() * pose_a.inverse(), 0});
          }
        }
      }
    }
    return all;
  }

  // The worse of what each camera's pose of the board makes the other one expect.
  [[nodiscard]] double both_ways(const CommonView& common, const SE3& b_from_a) const {
    const BoardView& a = views_[common.a];
    const BoardView& b = views_[common.b];
    return std::max(agreement(a, b, cameras_[link_.b], b_from_a).misfit,
                    agreement(b, a, cameras_[link_.a], b_from_a.inverse()).misfit);
  }

  // A part of it where it comes to `most` and more.
  [[nodiscard]] double cost(const SE3& b_from_a, const std::vector<CommonView>& voters,
                            double most) const {
    double sum = 0;
    for (const CommonView& common : voters) {
      const double misfit = both_ways(common, b_from_a) / kSoft;
      sum += std::log1p(misfit * misfit);
      if (sum >= most) break;
    }
    return sum;
  }

  // Whether a place is another one, and not the same but for noise.
  [[nodiscard]] bool is_elsewhere(const SE3& one, const SE3& other) const {
    constexpr double kTurn = 0.15;      // rad
    constexpr double kDistance = 0.15;  // of the distance of the board
    const SE3 between = one * other.inverse();
    return log_so3(between.rotation).norm() > kTurn ||
           (one.inverse().translation - other.inverse().translation).norm() > kDistance * away_;
  }

  const std::vector<BoardView>& views_;
  const std::vector<CameraPoints>& cameras_;
  Link& link_;
  double away_ = 0;  // m, the farthest board from the first camera
};

}  // namespace

namespace {

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
    Vote(views, points, link).run();
    all.push_back(std::move(link));
  }
  return all;
}

}  // namespace calvin::rig
