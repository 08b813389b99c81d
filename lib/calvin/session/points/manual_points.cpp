// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Which points are taken, which view they make, and what their user is told.

#include "calvin/session/points/manual_points.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <Eigen/Eigenvalues>

#include "calvin/geometry/pixels.hpp"
#include "calvin/solve/residuals/points.hpp"
#include "calvin/target/point_board.hpp"

namespace calvin {

namespace {

constexpr std::size_t kFewestPoints = 4;   // of a view
constexpr double kSamePlace = 1e-6;        // m
constexpr double kSamePixel = 0.5;         // px
constexpr double kMillimetre = 1e-3;       // m
constexpr std::size_t kMostPoints = 2000;  // without a board

std::string millimetres(const Eigen::Vector3d& p) {
  return fmt::format("{:.5g} {:.5g} {:.5g} mm", p.x() / kMillimetre, p.y() / kMillimetre,
                     p.z() / kMillimetre);
}

std::string some_points(std::size_t count) {
  return count == 1 ? "1 point" : fmt::format("{} points", count);
}

// Whether all of the points but that one lie on one line, to a thousandth of its length.
bool lie_on_a_line(const std::vector<Eigen::Vector3d>& points, std::size_t without) {
  constexpr double kThin = 1e-3;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (i != without) mean += points[i] / static_cast<double>(points.size() - 1);
  }
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d d = points[i] - mean;
    if (i != without) spread += d * d.transpose();
  }
  const Eigen::Vector3d axes =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread, Eigen::EigenvaluesOnly).eigenvalues();
  return !(axes[1] > kThin * kThin * axes[2]);
}

// Then the pose of a plane is open: four of them must lie in general position. Of many points that
// is not looked at.
bool lie_on_a_line_but_one(const std::vector<Eigen::Vector3d>& points) {
  constexpr std::size_t kMany = 60;
  for (std::size_t i = 0; points.size() <= kMany && i < points.size(); ++i) {
    if (lie_on_a_line(points, i)) return true;
  }
  return false;
}

}  // namespace

double snap_reach(ImageSize size) {
  constexpr double kLeast = 5;      // px
  constexpr double kShare = 0.005;  // of the diagonal
  return std::max(kLeast, kShare * std::hypot(size.width, size.height));
}

std::string_view to_string(PointVerdict verdict) noexcept {
  switch (verdict) {
    case PointVerdict::kAccepted:
      return "accepted";
    case PointVerdict::kOutside:
      return "outside";
    case PointVerdict::kTwice:
      return "twice";
    case PointVerdict::kNotOnBoard:
      return "not-on-board";
    case PointVerdict::kNoneLeft:
      return "none-left";
    case PointVerdict::kNoPlace:
      return "no-place";
    case PointVerdict::kNotThere:
      return "not-there";
  }
  return "";
}

void ManualPoints::begin(ImageSize size, std::optional<Board> board) {
  size_ = size;
  board_ = std::move(board);
  ids_ = board_ ? board_->ids() : std::vector<int>();
  places_ = board_ ? board_->points() : std::vector<Eigen::Vector3d>();
  points_.clear();
  next_id_ = 0;
}

ManualPoints::Point* ManualPoints::find(int id) {
  const auto found = std::ranges::find(points_, id, &Point::id);
  return found == points_.end() ? nullptr : &*found;
}

std::optional<std::size_t> ManualPoints::next() const {
  for (std::size_t i = 0; i < ids_.size(); ++i) {
    if (std::ranges::find(points_, ids_[i], &Point::id) == points_.end()) return i;
  }
  return std::nullopt;
}

std::optional<ManualPoints::Point> ManualPoints::place_of(const PointChoice& choice,
                                                          PointVerdict& verdict) const {
  if (!choice.world) {
    const auto i = next();
    verdict = board_ ? PointVerdict::kNoneLeft : PointVerdict::kNoPlace;
    return i ? std::optional(Point{ids_[*i], places_[*i], {}, 0}) : std::nullopt;
  }
  verdict = PointVerdict::kNoPlace;
  if (!choice.world->allFinite()) return std::nullopt;
  const auto is_there = [&](const Eigen::Vector3d& p) {
    return (p - *choice.world).norm() < kSamePlace;
  };
  if (board_) {
    verdict = PointVerdict::kNotOnBoard;
    const auto on_board = std::ranges::find_if(places_, is_there);
    if (on_board == places_.end()) return std::nullopt;
    return Point{ids_[static_cast<std::size_t>(on_board - places_.begin())], *on_board, {}, 0};
  }
  const auto known = std::ranges::find_if(points_, is_there, &Point::world);
  verdict = PointVerdict::kNoneLeft;
  if (known == points_.end() && points_.size() >= kMostPoints) return std::nullopt;
  return Point{known == points_.end() ? next_id_ : known->id, *choice.world, {}, 0};
}

PointAnswer ManualPoints::take(const PointChoice& choice, const std::optional<FoundPoint>& found) {
  const bool is_inside = choice.at.u >= -0.5 && choice.at.v >= -0.5 &&
                         choice.at.u <= size_.width - 0.5 && choice.at.v <= size_.height - 0.5;
  if (!is_inside) return refuse(choice, PointVerdict::kOutside);
  PointVerdict verdict = PointVerdict::kAccepted;
  std::optional<Point> point = place_of(choice, verdict);
  if (!point) return refuse(choice, verdict);
  const bool measured = choice.sigma && is_known_sigma(*choice.sigma);
  const bool snapped = found && !measured;
  point->at = snapped ? found->at : choice.at;
  point->sigma = snapped ? found->sigma : measured ? *choice.sigma : kClickSigma;
  const auto is_other = [&](const Point& other) {
    return other.id != point->id && distance(other.at, point->at) < kSamePixel;
  };
  if (std::ranges::any_of(points_, is_other)) return refuse(choice, PointVerdict::kTwice);
  if (Point* known = find(point->id)) {
    *known = *point;
  } else {
    points_.push_back(*point);
    next_id_ = std::max(next_id_, point->id + 1);
  }
  const auto kind = snapped ? std::optional(found->kind) : std::nullopt;
  return {PointVerdict::kAccepted, kind, point->at, point->sigma, point->id, point->world,
          points_.size(),          ""};
}

PointAnswer ManualPoints::add(const PointChoice& choice, const std::optional<FoundPoint>& found) {
  PointAnswer answer = take(choice, found);
  answer.hint = then_next(words_of(answer));
  return answer;
}

PointAnswer ManualPoints::add_all(const std::vector<PointChoice>& choices) {
  PointAnswer all;
  std::string refused;
  std::size_t taken = 0;
  for (const PointChoice& choice : choices) {
    const PointAnswer answer = take(choice, std::nullopt);
    if (answer.accepted()) {
      ++taken;
    } else if (all.accepted()) {
      all = answer;
      refused = fmt::format(" {}", words_of(answer));
    }
  }
  all.count = points_.size();
  all.hint =
      then_next(fmt::format("{} of {} with a pixel {} taken.{}", taken, some_points(choices.size()),
                            taken == 1 ? "is" : "are", refused));
  return all;
}

PointAnswer ManualPoints::add_found(const std::vector<std::pair<PointChoice, FoundPoint>>& points) {
  std::size_t taken = 0;
  PointAnswer answer;
  for (const auto& [choice, found] : points) {
    if (take(choice, found).accepted()) ++taken;
    answer.snapped = found.kind;
  }
  answer.count = points_.size();
  answer.hint =
      then_next(fmt::format("{} more {} found where the camera has {}.", some_points(taken),
                            taken == 1 ? "is" : "are", taken == 1 ? "it" : "them"));
  return answer;
}

PointAnswer ManualPoints::remove(std::optional<std::size_t> index) {
  const std::size_t at = index.value_or(points_.size() - 1);
  if (at >= points_.size()) {
    PointAnswer none = refuse({}, PointVerdict::kNotThere);
    none.hint = then_next(words_of(none));
    return none;
  }
  const Point gone = points_[at];
  points_.erase(points_.begin() + static_cast<std::ptrdiff_t>(at));
  return {PointVerdict::kAccepted,
          std::nullopt,
          gone.at,
          gone.sigma,
          gone.id,
          gone.world,
          points_.size(),
          then_next(fmt::format("The point {} is taken out.", gone.id))};
}

PointAnswer ManualPoints::refuse(const PointChoice& choice, PointVerdict verdict) const {
  PointAnswer answer;
  answer.verdict = verdict;
  answer.at = choice.at;
  answer.world = choice.world;
  answer.count = points_.size();
  return answer;
}

std::vector<PlacedPoint> ManualPoints::placed(std::size_t most) const {
  std::vector<PlacedPoint> placed;
  for (std::size_t i = points_.size() - std::min(most, points_.size()); i < points_.size(); ++i) {
    const Point& p = points_[i];
    placed.push_back({p.id, {(p.at.u + 0.5) / size_.width, (p.at.v + 0.5) / size_.height}});
  }
  return placed;
}

std::optional<View> ManualPoints::view() const {
  if (points_.size() < kFewestPoints) return std::nullopt;
  View view;
  std::vector<Point> sorted = points_;
  std::ranges::sort(sorted, {}, &Point::id);
  std::vector<PointBoard::Dot> dots;
  std::vector<Eigen::Vector3d> places;
  for (const Point& p : sorted) {
    places.push_back(p.world);
    view.observation.ids.push_back(p.id);
    view.observation.uv.push_back(p.at);
    view.observation.sigma.push_back(p.sigma);
    dots.push_back({p.id, p.world.x(), p.world.y(), 0, p.world.z()});
  }
  // A board of these points alone also tells whether all of many lie on one line.
  auto own = PointBoard::make("manual", std::move(dots));
  if (!own || lie_on_a_line_but_one(places)) return std::nullopt;
  view.board = board_ ? *board_ : Board(*std::move(own));
  view.observation.board = view.board.text();
  view.observation.image_size = size_;
  return view;
}

std::size_t ManualPoints::needed() const {
  constexpr int kPose = 6;
  constexpr int kSpare = 2;           // equations more than unknowns, that errors show at all
  constexpr std::size_t kMatrix = 6;  // of the projection matrix from which a camera starts
  if (unknowns_ == 0) return kFewestPoints;
  return std::max(kMatrix, static_cast<std::size_t>(kPose + unknowns_ + kSpare + 1) / 2);
}

bool ManualPoints::suffice() const {
  const auto seen = view();
  if (!seen || points_.size() < needed()) return false;
  return unknowns_ == 0 ||
         spans_space(to_points(seen->board, seen->board.points(), seen->observation));
}

// ---- Words --------------------------------------------------------------------------------------

std::string ManualPoints::words_of(const PointAnswer& answer) const {
  if (!answer.accepted()) return words_of_refused(answer);
  std::string words = fmt::format("The point {} ({}) is at {:.2f}, {:.2f}", *answer.id,
                                  millimetres(*answer.world), answer.at.u, answer.at.v);
  if (answer.snapped) {
    const bool is_disc = *answer.snapped == FoundPoint::Kind::kDisc;
    return words + fmt::format(", the {} there, to {:.2g} px.",
                               is_disc ? "centre of the disc" : "corner", *answer.sigma);
  }
  if (*answer.sigma != kClickSigma) return words + fmt::format(", to {:.2g} px.", *answer.sigma);
  return words +
         fmt::format(
             ", to {:.2g} px: no corner of four squares and no disc was found within {:.0f} px.",
             *answer.sigma, snap_reach(size_));
}

std::string ManualPoints::words_of_refused(const PointAnswer& answer) const {
  switch (answer.verdict) {
    case PointVerdict::kAccepted:
      return "";
    case PointVerdict::kOutside:
      if (!std::isfinite(answer.at.u + answer.at.v)) {
        return "Not taken: it has no pixel. Give u and v as two numbers.";
      }
      return fmt::format(
          "Not taken: {:.1f}, {:.1f} is outside the picture of {}x{} px. Choose a "
          "pixel inside it.",
          answer.at.u, answer.at.v, size_.width, size_.height);
    case PointVerdict::kTwice:
      return fmt::format(
          "Not taken: another point is at {:.1f}, {:.1f} already. Choose another "
          "place, or take that point out first (remove-point).",
          answer.at.u, answer.at.v);
    case PointVerdict::kNotOnBoard:
      return fmt::format(
          "Not taken: {} has no point at that place. Give one of its points, or "
          "leave `points` unset for places of your own.",
          board_ ? board_->text() : "the board");
    case PointVerdict::kNoneLeft:
      return "Not taken: every point has its pixel. Take one out (remove-point) to choose it "
             "again.";
    case PointVerdict::kNoPlace:
      return "Not taken: nobody knows which place in the world it is. Give its X Y Z with the "
             "pixel, or set `points` to a file of points.";
    case PointVerdict::kNotThere:
      return "There is no such point to take out.";
  }
  return "";
}

std::string ManualPoints::then_next(std::string words) const {
  const std::string next = hint();
  return next.empty() ? words : fmt::format("{} {}", words, next);
}

std::string ManualPoints::lack() const {
  if (points_.size() >= kFewestPoints && !view()) {
    return "All points, or all but one, lie on one line: choose others beside it.";
  }
  if (points_.size() < needed()) {
    const std::size_t left = needed() - points_.size();
    return fmt::format("{} more {} needed.", some_points(left), left == 1 ? "is" : "are");
  }
  if (suffice()) return "";
  return "All points lie in one plane, which alone tells no camera: choose some beside it, hold "
         "the "
         "camera (fix=all with initial), or show a board in other views, too.";
}

std::string ManualPoints::hint() const {
  if (points_.empty() && !board_) return "";
  const auto i = next();
  const std::string lacking = lack();
  if (!i && lacking.empty()) return done_words_;
  if (!i) return lacking;
  const std::string further = fmt::format("Next: the point {} of {}, at {}.", ids_[*i],
                                          board_->text(), millimetres(places_[*i]));
  return fmt::format("{} {}", further, lacking.empty() ? done_words_ : lacking);
}

}  // namespace calvin
