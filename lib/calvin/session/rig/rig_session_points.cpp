// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Manual points of the cameras of a rig: those of all cameras lie in one world.

#include <algorithm>
#include <utility>

#include "calvin/camera/camera.hpp"
#include "calvin/session/points/point_fit.hpp"
#include "calvin/session/rig/rig_session.hpp"
#include "calvin/target/point_board.hpp"

namespace calvin {

namespace {

constexpr double kSameDot = 1e-6;  // m

// The places of all cameras' points, each once.
class World {
 public:
  // The number of a place.
  int id_of(const Eigen::Vector3d& place) {
    const auto known =
        std::ranges::find_if(dots_, [&](const PointBoard::Dot& dot) { return is_at(dot, place); });
    if (known != dots_.end()) return known->id;
    const int id = static_cast<int>(dots_.size());
    dots_.push_back({id, place.x(), place.y(), 0, place.z()});
    return id;
  }
  [[nodiscard]] std::optional<Board> board() const {
    auto made = PointBoard::make("manual", dots_);
    return made ? std::optional<Board>(*std::move(made)) : std::nullopt;
  }

 private:
  static bool is_at(const PointBoard::Dot& dot, const Eigen::Vector3d& place) {
    return (Eigen::Vector3d(dot.x, dot.y, dot.z) - place).norm() < kSameDot;
  }

  std::vector<PointBoard::Dot> dots_;
};

// A view whose points have other ids on another board.
View renamed(View view, const std::vector<int>& ids, const Board& board) {
  struct Point {
    int id;
    Pixel at;
    double sigma;
  };
  std::vector<Point> points;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    points.push_back({ids[i], view.observation.uv[i], view.observation.sigma[i]});
  }
  std::ranges::sort(points, {}, &Point::id);
  for (std::size_t i = 0; i < ids.size(); ++i) {
    view.observation.ids[i] = points[i].id;
    view.observation.uv[i] = points[i].at;
    view.observation.sigma[i] = points[i].sigma;
  }
  view.board = board;
  view.observation.board = board.text();
  return view;
}

}  // namespace

void RigSession::set_size(std::size_t camera, ImageSize size) {
  Camera& own = at(camera);
  if (own.size == size) return;
  // Pictures of another size are those of another camera, whose views begin anew.
  forget_views(own);
  recent_instants_.forget(camera);
  own.size = size;
  fit_intrinsics(own);
  begin_points(own);
}

void RigSession::set_points(std::size_t camera, KnownPoints points) {
  at(camera).known = std::move(points);
  begin_points(at(camera));
}

bool RigSession::clicks_choose(std::size_t camera) { return at(camera).known.has_value(); }

void RigSession::begin_points(Camera& camera) {
  camera.report.reset();
  camera.points.begin(camera.size.value_or(ImageSize{}),
                      camera.known ? std::optional(camera.known->board) : std::nullopt);
  camera.points.set_done_words(
      "That is enough for this camera: choose points in the others, or more here.");
  if (camera.size && camera.known && !camera.known->seen.empty()) {
    camera.report = camera.points.add_all(camera.known->seen);
  }
  renew_chosen();
}

// All of them anew: the board has the places of all cameras.
void RigSession::renew_chosen() {
  std::vector<std::optional<View>> views;
  std::optional<Board> common;  // of all cameras, where it is one
  bool is_common = true;
  for (const Camera& camera : cameras_) {
    const auto& view = views.emplace_back(camera.points.view());
    if (!view) continue;
    is_common = is_common && (!common || *common == view->board) && camera.known;
    common = view->board;
  }
  World world;
  std::vector<std::vector<int>> ids;
  for (const auto& view : views) {
    ids.emplace_back();
    if (!view || is_common) continue;
    for (const int id : view->observation.ids) {
      ids.back().push_back(world.id_of(view->board.points()[view->board.index_of(id).value()]));
    }
  }
  const std::optional<Board> board = is_common ? common : world.board();
  bool any = false;
  for (std::size_t c = 0; c < cameras_.size(); ++c) {
    any = any || cameras_[c].chosen;
    cameras_[c].chosen.reset();
    if (!views[c] || !board) continue;
    View view = is_common ? *std::move(views[c]) : renamed(*std::move(views[c]), ids[c], *board);
    view.observation.camera = cameras_[c].name;
    view.observation.timestamp = chosen_at_;
    cameras_[c].chosen = std::make_shared<const View>(std::move(view));
    any = true;
  }
  if (any) ++revision_;
  is_due_ = is_due_ || any;
}

PointAnswer RigSession::told(Camera& camera, PointAnswer answer) const {
  if (!camera.chosen || !camera.fitted) return answer;
  const auto known = calvin::Camera::make(*camera.fitted);
  const auto fit = known ? fit_points(*known, *camera.chosen) : std::nullopt;
  if (fit) answer.hint.append(" ").append(to_text(*fit));
  return answer;
}

PointAnswer RigSession::add_point(std::size_t camera, const PointChoice& choice,
                                  const std::optional<FoundPoint>& found, std::uint64_t timestamp) {
  Camera& own = at(camera);
  PointAnswer answer = own.points.add(choice, found);
  if (!answer.accepted()) return answer;
  if (timestamp != kNoTimestamp) chosen_at_ = timestamp;
  renew_chosen();
  return told(own, std::move(answer));
}

PointAnswer RigSession::remove_point(std::size_t camera, std::optional<std::size_t> index) {
  Camera& own = at(camera);
  PointAnswer answer = own.points.remove(index);
  if (!answer.accepted()) return answer;
  renew_chosen();
  return told(own, std::move(answer));
}

std::optional<PointAnswer> RigSession::take_points_report(std::size_t camera) {
  auto report = std::exchange(at(camera).report, std::nullopt);
  return report ? std::optional(told(at(camera), *std::move(report))) : std::nullopt;
}

std::optional<std::size_t> RigSession::find(const std::string& name) const {
  const auto found = std::ranges::find(cameras_, name, &Camera::name);
  if (name.empty() || found == cameras_.end()) return std::nullopt;
  return static_cast<std::size_t>(found - cameras_.begin());
}

}  // namespace calvin
