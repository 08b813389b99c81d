// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What a board of dots answers; which dots make a board.

#include "calvin/target/point_board.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "calvin/target/board_name.hpp"

namespace calvin {

namespace {

// Dots within this many cells are neighbours: the four of a square grid, not those along its
// diagonals.
constexpr double kNear = 1.3;

constexpr std::size_t kMostDots = 10'000;

Eigen::Vector3d place(const PointBoard::Dot& dot) { return {dot.x, dot.y, dot.z}; }

double distance(const PointBoard::Dot& a, const PointBoard::Dot& b) {
  return std::hypot(a.x - b.x, a.y - b.y, a.z - b.z);
}

// Whether the dot has another one at most so far away.
bool has_one_within(const std::vector<PointBoard::Dot>& dots, const PointBoard::Dot& dot,
                    double reach) {
  return std::any_of(dots.begin(), dots.end(), [&](const PointBoard::Dot& other) {
    return other.id != dot.id && distance(other, dot) <= reach;
  });
}

// By the distance of each dot from the line through the two that are farthest from each other.
bool lie_on_a_line(const std::vector<PointBoard::Dot>& dots) {
  constexpr double kThin = 1e-3;  // of the length
  const auto farthest_from = [&dots](const PointBoard::Dot& from) {
    return *std::max_element(dots.begin(), dots.end(), [&](const auto& a, const auto& b) {
      return distance(a, from) < distance(b, from);
    });
  };
  const PointBoard::Dot first = farthest_from(dots.front());
  const PointBoard::Dot last = farthest_from(first);
  const double length = distance(first, last);
  return std::none_of(dots.begin(), dots.end(), [&](const PointBoard::Dot& dot) {
    const double area = (place(last) - place(first)).cross(place(dot) - place(first)).norm();
    return area > kThin * length * length;
  });
}

Status refuse(std::string why) {
  return make_error(ErrorCode::kInvalidArgument,
                    "These dots make no board: " + std::move(why) + ".");
}

// `dots` are in the order of their ids.
Status check_dots(const std::vector<PointBoard::Dot>& dots) {
  if (dots.size() < 4) return refuse(fmt::format("{} of them, at least 4 are needed", dots.size()));
  if (dots.size() > kMostDots) {
    return refuse(fmt::format("{} of them, at most {} are taken", dots.size(), kMostDots));
  }
  for (std::size_t i = 0; i < dots.size(); ++i) {
    const PointBoard::Dot& dot = dots[i];
    if (dot.id < 0) return refuse(fmt::format("{} is no id", dot.id));
    if (i > 0 && dots[i - 1].id == dot.id) {
      return refuse(fmt::format("the id {} is given twice", dot.id));
    }
    if (!place(dot).allFinite() || !std::isfinite(dot.diameter) || !(dot.diameter >= 0)) {
      return refuse(fmt::format("the dot {} has no place or no size", dot.id));
    }
    if (!std::ranges::all_of(dot.normal, [](double n) { return std::isfinite(n); })) {
      return refuse(fmt::format("the normal of the dot {} is no direction", dot.id));
    }
    for (std::size_t j = 0; j < i; ++j) {
      if (!(distance(dots[j], dot) > (dots[j].diameter + dot.diameter) / 2)) {
        return refuse(fmt::format("the dots {} and {} touch", dots[j].id, dot.id));
      }
    }
  }
  if (lie_on_a_line(dots)) return refuse("they lie on one line");
  return {};
}

}  // namespace

Result<PointBoard> PointBoard::make(std::string name, std::vector<Dot> dots) {
  if (const Status status = check_board_name(name, kLongestPointsPath); !status) {
    return tl::unexpected<Error>(status.error());
  }
  std::sort(dots.begin(), dots.end(), [](const Dot& a, const Dot& b) { return a.id < b.id; });
  if (const Status status = check_dots(dots); !status) {
    return tl::unexpected<Error>(status.error());
  }
  return PointBoard(std::make_shared<const Shared>(Shared{std::move(name), std::move(dots)}));
}

bool PointBoard::is_flat() const noexcept {
  return std::all_of(dots().begin(), dots().end(), [](const Dot& dot) { return dot.z == 0; });
}

std::string PointBoard::text() const { return "points:" + shared_->name; }

std::vector<int> PointBoard::ids() const {
  std::vector<int> all;
  for (const Dot& dot : dots()) all.push_back(dot.id);
  return all;
}

std::vector<Eigen::Vector3d> PointBoard::points() const {
  std::vector<Eigen::Vector3d> all;
  for (const Dot& dot : dots()) all.push_back(place(dot));
  return all;
}

std::optional<std::size_t> PointBoard::index_of(int id) const noexcept {
  const auto at = std::lower_bound(dots().begin(), dots().end(), id,
                                   [](const Dot& dot, int wanted) { return dot.id < wanted; });
  if (at == dots().end() || at->id != id) return std::nullopt;
  return static_cast<std::size_t>(at - dots().begin());
}

std::vector<int> PointBoard::neighbours(int id) const {
  std::vector<int> all;
  const auto index = index_of(id);
  if (!index) return all;
  const double own = cell_size(id);
  for (const Dot& dot : dots()) {
    if (dot.id == id) continue;
    // By the larger cell of the two: a neighbour has this one for its neighbour.
    const double away = distance(dots()[*index], dot);
    const bool near = away <= kNear * own || !has_one_within(dots(), dot, away / kNear);
    if (near) all.push_back(dot.id);
  }
  return all;
}

double PointBoard::cell_size(int id) const noexcept {
  const auto index = index_of(id);
  if (!index) return 0;
  double nearest = std::numeric_limits<double>::infinity();
  for (const Dot& dot : dots()) {
    if (dot.id != id) nearest = std::min(nearest, distance(dots()[*index], dot));
  }
  return nearest;
}

BoardArea PointBoard::area(double diameters) const noexcept {
  constexpr double kFar = std::numeric_limits<double>::infinity();
  BoardArea area{kFar, kFar, -kFar, -kFar};
  for (const Dot& dot : dots()) {
    const double reach = diameters * dot.diameter;
    area.left = std::min(area.left, dot.x - reach);
    area.top = std::min(area.top, dot.y - reach);
    area.right = std::max(area.right, dot.x + reach);
    area.bottom = std::max(area.bottom, dot.y + reach);
  }
  return area;
}

BoardArea PointBoard::extent() const noexcept { return area(0); }
// Half a diameter of light is left around the outer dots.
BoardArea PointBoard::outline() const noexcept { return area(1); }

}  // namespace calvin
