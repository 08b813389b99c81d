// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Keeps views by the places of boards and by the clock.

#include "calvin/session/rig/rig_session.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "calvin/session/rig/corner_velocities.hpp"
#include "calvin/session/views/corner_motion.hpp"
#include "calvin/target/kinds.hpp"
#include "calvin/target/unbounded_grid.hpp"

namespace calvin {

namespace {

constexpr std::uint64_t kMoment = 1'000'000'000;  // ns: views of which the time may yet be wanted
constexpr double kNewPlace = 0.02;                // of the width of the picture
constexpr double kJump = 0.02;                    // likewise, from one picture to the next
// Of a camera; then every other time is forgotten.
constexpr std::size_t kMostBoards = 600;
constexpr std::size_t kMostLights = 2000;  // of one point each
constexpr std::size_t kStillViews = 10;    // views of a board that lies still

std::uint64_t between(std::uint64_t a, std::uint64_t b) { return a > b ? a - b : b - a; }

// The mean distance of the corners that two observations share, px; absent where there are none.
// Ids ascend.
std::optional<double> mean_distance(const Observation& a, const Observation& b) {
  if (a.board != b.board) return std::nullopt;
  double sum = 0;
  int count = 0;
  for (std::size_t i = 0, j = 0; i < a.ids.size() && j < b.ids.size();) {
    if (a.ids[i] == b.ids[j]) {
      sum += std::hypot(a.uv[i].u - b.uv[j].u, a.uv[i].v - b.uv[j].v);
      ++count;
    }
    const bool next_a = a.ids[i] <= b.ids[j];
    const bool next_b = b.ids[j] <= a.ids[i];
    i += next_a ? 1 : 0;
    j += next_b ? 1 : 0;
  }
  return count > 0 ? std::optional(sum / count) : std::nullopt;
}

// Whether two views are of a camera that sees a board without a break.
bool goes_on(const Observation& before, const Observation& now) {
  constexpr std::uint64_t kBreak = 200'000'000;  // ns
  return before.board == now.board && before.timestamp < now.timestamp &&
         now.timestamp - before.timestamp < kBreak;
}

}  // namespace

void RigSession::start(RigSessionSettings settings) {
  settings_ = std::move(settings);
  cameras_.clear();
  wanted_.clear();
  recent_instants_.clear();
  watched_.reset();
  is_light_.reset();
  light_.reset();
  if (settings_.method != RigMethod::kAuto) is_light_ = settings_.method == RigMethod::kSvoboda;
  ++generation_;
  revision_ = told_revision_ = asked_revision_ = solved_revision_ = 0;
  is_due_ = false;
  chosen_at_ = 0;
}

RigSession::Camera& RigSession::at(std::size_t camera) {
  if (camera >= cameras_.size()) cameras_.resize(camera + 1);
  return cameras_[camera];
}

void RigSession::set_name(std::size_t camera, std::string name) {
  at(camera).name = std::move(name);
  fit_intrinsics(at(camera));
}

std::vector<std::string> RigSession::names() const {
  std::vector<std::string> names;
  for (const Camera& camera : cameras_) {
    if (!camera.name.empty()) names.push_back(camera.name);
  }
  return names;
}

void RigSession::remove(std::size_t camera) {
  at(camera) = {};
  recent_instants_.forget(camera);
  renew_chosen();
  ++revision_;
}

void RigSession::set_intrinsics(std::size_t camera, const Calibration& calibration) {
  at(camera).intrinsics = calibration;
  fit_intrinsics(at(camera));
  ++revision_;
}

Result<Board> RigSession::board_of(const Observation& observation) {
  auto known = std::ranges::find_if(
      boards_, [&](const Board& board) { return board.text() == observation.board; });
  if (known != boards_.end()) return *known;
  auto board = parse_board(observation.board);
  if (board) boards_.push_back(*board);
  return board;
}

// Equal boards are the same however their texts are spelled.
bool RigSession::counts(const Board& board) const {
  return settings_.boards.empty() ||
         std::ranges::find(settings_.boards, board) != settings_.boards.end();
}

Result<View> RigSession::to_view(const Observation& observation, const Board& board) {
  if (const Status named = check_names_points(board); !named) {
    return tl::unexpected<Error>(named.error());
  }
  View view{observation, board};
  view.observation.patches.reset();
  if (!std::ranges::is_sorted(observation.ids)) {
    return make_error(ErrorCode::kInvalidArgument,
                      "The ids of an observation do not ascend, as those of calibdetect do.");
  }
  if (const Status good = check(view, observation.image_size); !good) {
    return tl::unexpected<Error>(good.error());
  }
  return view;
}

// The view before is told how fast its board moved, by the views on both sides of it, and is
// forgotten where these tell nothing.
void RigSession::improve_last(std::size_t number, const Observation& now) {
  Camera& camera = cameras_[number];
  const Observation& last = camera.last->observation;
  std::vector<Pixel> ahead = velocities(last, now);
  if (ahead.empty()) return;
  const double passed = seconds_between(last, now);
  const double far = kJump * last.image_size.width;
  const bool jumps =
      !last.velocity.empty() && is_jump(last.velocity, camera.passed, ahead, passed, far);
  const double fastest = std::max(speed_of(last.velocity), speed_of(ahead));
  if (jumps) {
    // It has stood there, or stands there now.
    if (speed_of(last.velocity) < speed_of(ahead)) ahead = last.velocity;
  } else if (!last.velocity.empty()) {
    ahead = interpolated(last.velocity, ahead, camera.passed / (camera.passed + passed));
  }
  auto improved = std::make_shared<View>(*camera.last);
  improved->observation.velocity = std::move(ahead);
  const SharedView better = std::move(improved);
  std::ranges::replace(camera.kept, camera.last, better);
  std::ranges::replace(camera.apart, camera.last, better);
  std::ranges::replace(camera.recent, camera.last, better);
  recent_instants_.replace(number, camera.last, better);
  camera.last = better;
  const bool is_there_still = jumps && passed * speed_of(velocities(last, now)) < far;
  if (is_there_still && !goes_with_another(number, last.timestamp, fastest)) forget_last(number);
}

// The board is there in the next picture, too.
void RigSession::forget_last(std::size_t number) {
  Camera& camera = cameras_[number];
  const std::uint64_t then = camera.last->observation.timestamp;
  const auto kept = std::erase(camera.kept, camera.last) + std::erase(camera.apart, camera.last);
  std::erase(camera.recent, camera.last);
  if (kept > 0) std::erase(wanted_, then);
}

// Whether another camera's picture is of that time, in which a board of that speed, px/s, goes
// nowhere.
bool RigSession::goes_with_another(std::size_t number, std::uint64_t time, double speed) const {
  constexpr double kNowhere = 0.02;  // px
  const auto is_near = [&](const SharedView& other) {
    const std::uint64_t late = between(other->observation.timestamp, time);
    return speed * 1e-9 * static_cast<double>(late) < kNowhere;
  };
  for (std::size_t c = 0; c < cameras_.size(); ++c) {
    if (c == number) continue;
    for (const auto* list : {&cameras_[c].kept, &cameras_[c].apart}) {
      if (std::ranges::any_of(*list, is_near)) return true;
    }
    if (std::ranges::any_of(cameras_[c].recent, is_near)) return true;
  }
  return false;
}

// The first view decides where the settings leave it open.
bool RigSession::takes(const View& view) {
  const bool is_light = view.board.as<PointLight>() != nullptr;
  if (!is_light_) is_light_ = is_light;
  if (*is_light_ != is_light) return false;
  // Of lights and wands the first one alone.
  if (is_light && !light_) light_ = view.board;
  return !is_light || *light_ == view.board;
}

std::size_t RigSession::most_views() const { return sees_light() ? kMostLights : kMostBoards; }

bool RigSession::is_new(const std::vector<SharedView>& kept, const View& view) const {
  const Observation& now = view.observation;
  if (settings_.options.mode == RigMode::kFloor && kept.size() < kStillViews) return true;
  return std::ranges::none_of(kept, [&](const SharedView& other) {
    const auto distance = mean_distance(other->observation, now);
    return distance && *distance < kNewPlace * now.image_size.width;
  });
}

void RigSession::forget_views(Camera& camera) {
  camera.kept.clear();
  camera.recent.clear();
  camera.movement.reset();
  camera.apart.clear();
  camera.last.reset();
}

void RigSession::keep(Camera& camera, const SharedView& view) {
  std::vector<SharedView>& list = camera.list_at(view->observation.timestamp);
  const auto same = [&](const SharedView& kept) {
    return kept->observation.timestamp == view->observation.timestamp &&
           kept->observation.board == view->observation.board &&
           kept->observation.uv.front().u == view->observation.uv.front().u;
  };
  if (std::ranges::any_of(list, same)) return;
  list.push_back(view);
  ++revision_;
}

void RigSession::keep_recent_at(std::uint64_t timestamp) {
  for (Camera& camera : cameras_) {
    for (const SharedView& view : camera.recent) {
      if (between(view->observation.timestamp, timestamp) <= settings_.options.tolerance) {
        keep(camera, view);
      }
    }
  }
}

Result<bool> RigSession::offer(std::size_t camera, Observation observation) {
  if (!observation.found() || observation.timestamp == kNoTimestamp) return false;
  if (at(camera).name.empty()) return false;
  const auto board = board_of(observation);
  if (!board) return tl::unexpected<Error>(board.error());
  if (!counts(*board)) {
    at(camera).seen_other = observation.board;
    return false;
  }
  auto checked = to_view(observation, *board);
  if (!checked) return tl::unexpected<Error>(checked.error());
  if (!takes(*checked)) return false;
  set_size(camera, observation.image_size);
  Camera& own = at(camera);
  own.has_seen = true;
  checked->observation.velocity.clear();
  if (own.last && goes_on(own.last->observation, checked->observation)) {
    improve_last(camera, checked->observation);
    checked->observation.velocity = velocities(checked->observation, own.last->observation);
    own.passed = seconds_between(own.last->observation, checked->observation);
  }
  const auto view = std::make_shared<const View>(*std::move(checked));
  own.last = view;
  const std::uint64_t now = view->observation.timestamp;
  // A camera may be pushed before the first rig is known.
  if (is_watched()) recent_instants_.add(camera, view);
  const bool fresh = is_new(own.list_at(now), *view);
  const bool wanted = std::ranges::any_of(
      wanted_, [&](std::uint64_t at) { return between(at, now) <= settings_.options.tolerance; });
  if (fresh || wanted) {
    keep(own, view);
    if (fresh) wanted_.push_back(now);
    if (fresh) keep_recent_at(now);
    if (own.list_at(now).size() > most_views()) thin_out();
    return true;
  }
  own.recent.push_back(view);
  while (!own.recent.empty() && between(own.recent.front()->observation.timestamp, now) > kMoment) {
    own.recent.pop_front();
  }
  return false;
}

bool RigSession::take_progress() {
  constexpr std::uint64_t kShare = 50;
  const std::uint64_t more = sees_light() ? revision_ / kShare : 0;
  if (revision_ - told_revision_ < std::max<std::uint64_t>(more, 1)) return false;
  told_revision_ = revision_;
  return true;
}

// Forgets what was seen at every other time, so that any stream takes the same memory.
void RigSession::thin_out() {
  std::ranges::sort(wanted_);
  std::vector<std::uint64_t> left;
  for (std::size_t i = 0; i < wanted_.size(); i += 2) left.push_back(wanted_[i]);
  wanted_ = std::move(left);
  for (Camera& camera : cameras_) {
    for (auto* list : {&camera.kept, &camera.apart}) {
      std::erase_if(*list, [&](const SharedView& view) {
        return std::ranges::none_of(wanted_, [&](std::uint64_t at) {
          return between(at, view->observation.timestamp) <= settings_.options.tolerance;
        });
      });
    }
  }
}

}  // namespace calvin
