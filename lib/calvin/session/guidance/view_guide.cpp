// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Tries places, sizes and tilts of the board and takes the one whose view tells most.

#include "calvin/session/guidance/view_guide.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <utility>

#include "calvin/camera/image_transform.hpp"
#include "calvin/camera/usable_area.hpp"
#include "calvin/geometry/convex_hull.hpp"
#include "calvin/session/guidance/board_placement.hpp"
#include "calvin/solve/pose.hpp"

namespace calvin {

namespace {

constexpr std::array kPlaces = {0.12, 0.3, 0.5, 0.7, 0.88};  // of the picture, across and down
constexpr std::array kSizes = {0.25, 0.35, 0.5, 0.65, 0.8};  // BoardPlacement::pose_at
constexpr std::array kTilts = {0.4, 0.8};                    // rad
constexpr int kDirections = 8;                               // to which it is tilted
constexpr double kUncovered = 0.2;  // of the picture that may stay uncovered, as of who is done
constexpr double kRoll = 0.15;      // rad, to either side
constexpr double kUnlike = 0.06;    // of the diagonal: RMS of the corners' moves
constexpr double kTooNear = 0.125;  // of its distance, that a hand holds a board too near
constexpr double kAside = 0.08;     // of the picture's longer side, that it is beside its place
constexpr double kReach = 0.7;      // of its distance, to where it is moved at once
constexpr double kBeyond = 0.05;    // of the diagonal: how far outside of the corners seen so far
constexpr std::size_t kTargets = 3;
constexpr double kAgain = 0.5;  // of what the best one tells: an older one is asked for as well

// How easily a hand gets to a target and has the board seen there; each includes those before it.
enum class Ease {
  kAny,
  kRoomy,  // however a hand errs, the board stays in the picture
  kKnown,  // corners were seen there: the camera shows it where it is expected
  kNear,   // to where the board was asked for first
};

// What of a board has to be in the picture for its corners to be found: half of its outer squares.
BoardArea wanted_area(const Board& board) {
  const BoardArea corners = board.extent();
  const BoardArea all = board.outline();
  return {(corners.left + all.left) / 2, (corners.top + all.top) / 2,
          (corners.right + all.right) / 2, (corners.bottom + all.bottom) / 2};
}

// Turns to try, the frontal one first.
std::vector<Eigen::Vector3d> turns() {
  std::vector<Eigen::Vector3d> turns = {{0, 0, kRoll}};
  for (const double tilt : kTilts) {
    for (int i = 0; i < kDirections; ++i) {
      const double side = 2 * std::numbers::pi * i / kDirections;
      turns.emplace_back(tilt * std::cos(side), tilt * std::sin(side), i % 2 == 0 ? kRoll : -kRoll);
    }
  }
  return turns;
}

// The pose at that place or, where the picture ends, as near to it as the board fits.
std::optional<SE3> pose_inside(const BoardPlacement& placement, Pixel at, double size,
                               const Eigen::Vector3d& turn) {
  const ImageSize picture = placement.camera().image_size();
  const double margin = placement.margin();
  for (int i = 0; i < 4; ++i) {
    const auto pose = placement.pose_at(at, size, turn);
    const auto box = pose ? placement.box(*pose) : std::nullopt;
    if (!box) return std::nullopt;
    if (placement.is_inside(*pose)) return pose;
    at.u += std::max(0.0, margin - box->left) -
            std::max(0.0, box->right - (picture.width - 1 - margin));
    at.v += std::max(0.0, margin - box->top) -
            std::max(0.0, box->bottom - (picture.height - 1 - margin));
  }
  return std::nullopt;
}

// Of the board, in the camera's frame, m.
Eigen::Vector3d middle_of(const Board& board, const SE3& pose) {
  const BoardArea area = board.outline();
  return pose * Eigen::Vector3d((area.left + area.right) / 2, (area.top + area.bottom) / 2, 0);
}

// Whether the board stays in the picture in a hand that errs by as much.
bool has_room(const BoardPlacement& placement, const Board& board, SE3 pose) {
  pose.translation -= kTooNear * middle_of(board, pose);
  const auto box = placement.box(pose);
  const ImageSize picture = placement.camera().image_size();
  const double room = kAside * std::max(picture.width, picture.height);
  return box && box->left >= room && box->top >= room && box->right <= picture.width - 1 - room &&
         box->bottom <= picture.height - 1 - room;
}

// How far a hand moves from one to the other, of the first one's distance.
double way_between(const Board& board, const SE3& pose, const SE3& other) {
  const Eigen::Vector3d place = middle_of(board, pose);
  return (middle_of(board, other) - place).norm() / place.norm();
}

// camera_from_board of all that is tried.
std::vector<SE3> poses_inside(const BoardPlacement& placement) {
  std::vector<SE3> poses;
  const ImageSize picture = placement.camera().image_size();
  const auto all_turns = turns();
  for (const double across : kPlaces) {
    for (const double down : kPlaces) {
      const Pixel at = {coordinate_at(across, picture.width), coordinate_at(down, picture.height)};
      for (const double size : kSizes) {
        for (const Eigen::Vector3d& turn : all_turns) {
          if (const auto pose = pose_inside(placement, at, size, turn)) poses.push_back(*pose);
        }
      }
    }
  }
  return poses;
}

// RMS distance of the corners that a view of a whole board shares with another view, px; infinite
// where these are none.
double corner_distance(const View& whole, const View& other) {
  if (whole.observation.board != other.observation.board) return HUGE_VAL;
  double square = 0;
  int shared = 0;
  for (std::size_t i = 0; i < other.observation.ids.size(); ++i) {
    const auto index = whole.board.index_of(other.observation.ids[i]);
    if (!index || *index >= whole.observation.uv.size()) continue;
    const Pixel a = whole.observation.uv[*index];
    const Pixel b = other.observation.uv[i];
    square += (a.u - b.u) * (a.u - b.u) + (a.v - b.v) * (a.v - b.v);
    ++shared;
  }
  return shared > 0 ? std::sqrt(square / shared) : HUGE_VAL;
}

// Whether the corners are about where those of the other view are.
bool is_like(const View& view, const View& other) {
  const ImageSize size = view.observation.image_size;
  return corner_distance(view, other) < kUnlike * std::hypot(size.width, size.height);
}

// The median of the corners' sigmas; 0 where there are none.
double middle_sigma(const std::vector<std::shared_ptr<const View>>& views) {
  std::vector<double> sigmas;
  for (const auto& view : views) {
    const auto& of = view->observation.sigma;
    sigmas.insert(sigmas.end(), of.begin(), of.end());
  }
  if (sigmas.empty()) return 0;
  const auto middle = sigmas.begin() + static_cast<std::ptrdiff_t>(sigmas.size() / 2);
  std::nth_element(sigmas.begin(), middle, sigmas.end());
  return *middle;
}

}  // namespace

ViewGuide::ViewGuide(const Camera& camera, ViewScorer scorer)
    : camera_(camera),
      visible_area_(visible_area(camera)),
      scorer_(std::move(scorer)),
      known_(scorer_.prior()) {}

std::optional<ViewGuide> ViewGuide::make(const Camera& camera, const SolveOptions& options,
                                         const Views& kept, const Board& board,
                                         const Views& missed) {
  auto scorer = ViewScorer::make(camera, options);
  if (!scorer) return std::nullopt;
  ViewGuide guide(camera, *std::move(scorer));
  std::vector<Eigen::MatrixXd> all;
  for (const auto& view : kept) {
    const auto pose = solve_pose(camera, view->board, view->observation);
    const auto information = pose ? guide.scorer_.information(*view, *pose) : std::nullopt;
    all.push_back(information.value_or(Eigen::MatrixXd()));
    if (!information) continue;
    guide.known_ += *information;
    const auto& corners = view->observation.uv;
    guide.covered_.insert(guide.covered_.end(), corners.begin(), corners.end());
    guide.covered_ = convex_hull(std::move(guide.covered_));
  }
  guide.variance_ = guide.scorer_.variance(guide.known_);
  guide.find_weakest(kept, all);
  const double sigma = middle_sigma(kept);
  Views unlike = kept;
  unlike.insert(unlike.end(), missed.begin(), missed.end());
  guide.find_targets(std::move(unlike), board, sigma > 0 ? sigma : 1);
  guide.has_exchange_ = guide.asked() && guide.exchange_for(*guide.asked()->view) != nullptr;
  return guide;
}

void ViewGuide::find_weakest(const Views& kept, const std::vector<Eigen::MatrixXd>& information) {
  double least = HUGE_VAL;
  for (std::size_t i = 0; i < kept.size(); ++i) {
    // A view that has no pose tells nothing.
    const bool tells = information[i].size() > 0;
    const Eigen::MatrixXd without = tells ? Eigen::MatrixXd(known_ - information[i]) : known_;
    const double variance = scorer_.variance(without);
    if (!(variance < least)) continue;
    least = variance;
    weakest_ = kept[i];
    without_weakest_ = without;
  }
}

void ViewGuide::Target::take(View seen) {
  if (const auto found = footprint_of(seen)) footprint = *found;
  view = std::make_shared<const View>(std::move(seen));
}

std::vector<ViewGuide::Target> ViewGuide::candidates(const BoardPlacement& placement,
                                                     double sigma) const {
  std::vector<Target> candidates;
  for (const SE3& pose : poses_inside(placement)) {
    const auto view = placement.view(pose, sigma);
    const auto information = view ? scorer_.information(*view, pose) : std::nullopt;
    const double gained = information ? gain(*view, *information) : 0;
    if (gained > 0) candidates.push_back({pose, gained, nullptr, {}, std::nullopt});
  }
  std::ranges::stable_sort(candidates, std::greater<>(), &Target::gain);
  return candidates;
}

void ViewGuide::find_targets(Views unlike, const Board& board, double sigma) {
  // The board may stick out of the picture a little, so that corners are seen near its border.
  const BoardPlacement placement(board, camera_, wanted_area(board));
  std::vector<Target> tried = candidates(placement, sigma);
  const BoardPlacement corners(board, camera_, board.extent());
  const auto way_to = [&](const Target& candidate) {
    return way_between(board, targets_.front().pose, candidate.pose);
  };
  const auto is_as_easy = [&](const Target& candidate, Ease wanted) {
    if (wanted >= Ease::kRoomy && !has_room(placement, board, candidate.pose)) return false;
    if (wanted >= Ease::kKnown && !is_known(candidate.outline)) return false;
    return wanted < Ease::kNear || way_to(candidate) <= kReach;
  };
  const auto take = [&](Ease wanted, std::size_t most) {
    for (Target& candidate : tried) {
      if (targets_.size() == most) return;
      if (candidate.view) continue;
      if (candidate.outline.empty()) candidate.outline = corners.outline(candidate.pose);
      // What cannot be shown cannot be followed: a wide lens may end within the board.
      if (candidate.outline.empty() || !is_as_easy(candidate, wanted)) continue;
      View view = placement.view(candidate.pose, sigma).value();
      view.observation.board = board.text();
      const auto like = [&](const auto& other) { return is_like(view, *other); };
      if (std::ranges::any_of(unlike, like)) continue;
      candidate.take(std::move(view));
      unlike.push_back(candidate.view);
      targets_.push_back(candidate);
    }
  };
  take(Ease::kAny, 1);
  if (targets_.empty()) return;
  take(Ease::kNear, kTargets);
  // What is farther away takes a hand the longer: the nearest will do.
  std::ranges::stable_sort(tried, std::less<>(), way_to);
  for (const Ease ease : {Ease::kKnown, Ease::kRoomy}) take(ease, kTargets);
}

bool ViewGuide::is_known(const std::vector<Pixel>& outline) const {
  const ImageSize size = camera_.image_size();
  const Pixel middle = {coordinate_at(0.5, size.width), coordinate_at(0.5, size.height)};
  const double beyond = kBeyond * std::hypot(size.width, size.height);
  return std::ranges::all_of(outline, [&](const Pixel& at) {
    const double away = std::hypot(at.u - middle.u, at.v - middle.v);
    const double left = std::max(0.0, away - beyond) / std::max(away, 1.0);
    return contains(covered_, {std::lerp(middle.u, at.u, left), std::lerp(middle.v, at.v, left)});
  });
}

const ViewGuide::Target* ViewGuide::asked() const noexcept {
  return asked_ < targets_.size() ? &targets_[asked_] : nullptr;
}

std::optional<SE3> ViewGuide::target() const {
  return asked() ? std::optional(asked()->pose) : std::nullopt;
}

std::shared_ptr<const View> ViewGuide::target_view() const {
  return asked() ? asked()->view : nullptr;
}

std::vector<Pixel> ViewGuide::outline() const {
  return asked() ? asked()->outline : std::vector<Pixel>();
}

std::optional<BoardFootprint> ViewGuide::footprint() const {
  return asked() ? asked()->footprint : std::nullopt;
}

void ViewGuide::ask_for_another() noexcept {
  if (has_another()) ++asked_;
}

bool ViewGuide::keep_asking(const ViewGuide& before, const Views& kept) {
  const Target* old = before.asked();
  if (!old || !asked()) return false;
  const auto like = [&](const auto& view) { return is_like(*old->view, *view); };
  if (std::ranges::any_of(kept, like)) return false;
  const Board& board = old->view->board;
  const BoardPlacement placement(board, camera_, wanted_area(board));
  if (!placement.is_inside(old->pose)) return false;
  auto view = placement.view(old->pose, old->view->observation.sigma.front());
  const auto information = view ? scorer_.information(*view, old->pose) : std::nullopt;
  Target again = {old->pose, information ? gain(*view, *information) : 0, nullptr, {}, {}};
  again.outline = BoardPlacement(board, camera_, board.extent()).outline(old->pose);
  if (again.gain < kAgain * asked()->gain || again.outline.empty()) return false;
  view->observation.board = old->view->observation.board;
  again.take(*std::move(view));
  targets_.insert(targets_.begin() + static_cast<std::ptrdiff_t>(asked_), std::move(again));
  return true;
}

double ViewGuide::uncovered(const std::vector<Pixel>& hull) const {
  return std::max(kUncovered, 1 - polygon_area(hull) / visible_area_);
}

double ViewGuide::gain(const View& view, const Eigen::MatrixXd& information) const {
  std::vector<Pixel> corners = covered_;
  corners.insert(corners.end(), view.observation.uv.begin(), view.observation.uv.end());
  return std::log(variance_ / scorer_.variance(known_ + information)) +
         std::log(uncovered(covered_) / uncovered(convex_hull(std::move(corners))));
}

double ViewGuide::share(const View& view) const {
  if (!asked()) return 1;
  const auto pose = solve_pose(camera_, view.board, view.observation);
  const auto information = pose ? scorer_.information(view, *pose) : std::nullopt;
  return information ? std::max(0.0, gain(view, *information) / asked()->gain) : 0;
}

const View* ViewGuide::exchange_for(const View& view) const {
  constexpr double kWorth = 0.97;  // of the variance: less is not worth a solve
  if (!weakest_) return nullptr;
  const auto pose = solve_pose(camera_, view.board, view.observation);
  const auto information = pose ? scorer_.information(view, *pose) : std::nullopt;
  if (!information) return nullptr;
  const double variance = scorer_.variance(without_weakest_ + *information);
  return variance < kWorth * variance_ ? weakest_.get() : nullptr;
}

double ViewGuide::distance(const View& view) const {
  return asked() ? corner_distance(*asked()->view, view) : HUGE_VAL;
}

}  // namespace calvin
