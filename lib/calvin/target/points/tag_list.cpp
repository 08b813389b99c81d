// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What a list of tags answers, and its text.

#include "calvin/target/tag_list.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "calvin/target/board_name.hpp"

namespace calvin {

namespace {

constexpr std::size_t kCorners = 4;

Eigen::Vector3d vector_of(const std::array<double, 3>& numbers) {
  return {numbers[0], numbers[1], numbers[2]};
}

// In the plane of the board: turned about its normal alone.
bool lies_in_plane(const TagList::Tag& tag) {
  return tag.middle[2] == 0 && tag.turn[0] == 0 && tag.turn[1] == 0;
}

std::string coordinate(double metres) {
  const double mm = std::round(metres * 1e9) / 1e6;
  return mm == 0 ? "0" : fmt::format("{}mm", mm);
}

std::string angle(double degrees) {
  const double rounded = std::round(degrees * 1e6) / 1e6;
  return rounded == 0 ? "0" : fmt::format("{}", rounded);
}

std::string place_text(const TagList::Tag& tag, double usual_size) {
  std::string text = fmt::format("{}", tag.id);
  if (length_text(tag.size) != length_text(usual_size)) {
    text += fmt::format("/{}", length_text(tag.size));
  }
  text += fmt::format("={},{}", coordinate(tag.middle[0]), coordinate(tag.middle[1]));
  if (!lies_in_plane(tag)) {
    text += fmt::format(",{},{},{},{}", coordinate(tag.middle[2]), angle(tag.turn[0]),
                        angle(tag.turn[1]), angle(tag.turn[2]));
  } else if (tag.turn[2] != 0) {
    text += fmt::format(",{}", angle(tag.turn[2]));
  }
  return text;
}

bool is_number(const TagList::Tag& tag) {
  const auto finite = [](double x) { return std::isfinite(x); };
  return std::isfinite(tag.size) && std::ranges::all_of(tag.middle, finite) &&
         std::ranges::all_of(tag.turn, finite);
}

// m, of a tag with the cells outside of its border.
double whole_size(const TagList& list, const TagList::Tag& tag) {
  return tag.size * (1 + list.grid_of(tag).least_gap_share());
}

// `with_margins`: with what is free around tags.
BoardArea area_of(const TagList& list, bool with_margins) {
  constexpr double kFar = std::numeric_limits<double>::infinity();
  BoardArea area{kFar, kFar, -kFar, -kFar};
  for (const TagList::Tag& tag : list.tags) {
    const SE3 frame = TagList::board_from_grid(tag);
    const double around = list.dictionary == nullptr || !with_margins ? 0 : list.grid_of(tag).gap;
    for (const double x : {-around, tag.size + around}) {
      for (const double y : {-around, tag.size + around}) {
        const Eigen::Vector3d p = frame * Eigen::Vector3d(x, y, 0);
        area = {std::min(area.left, p.x()), std::min(area.top, p.y()), std::max(area.right, p.x()),
                std::max(area.bottom, p.y())};
      }
    }
  }
  return area;
}

}  // namespace

TagGrid TagList::grid_of(const Tag& tag) const {
  TagGrid grid{1, 1, tag.size, 0, dictionary, april, tag.id, border, inverted};
  grid.gap = tag.size / grid.cells() * (dictionary->outside + 1);
  return grid;
}

SE3 TagList::board_from_grid(const Tag& tag) {
  constexpr double kDegree = std::numbers::pi / 180;
  const SE3 board_from_middle = {exp_so3(kDegree * vector_of(tag.turn)), vector_of(tag.middle)};
  return board_from_middle *
         SE3{Eigen::Matrix3d::Identity(), Eigen::Vector3d(-tag.size / 2, -tag.size / 2, 0)};
}

const TagList::Tag* TagList::tag_of(int id) const noexcept {
  if (id < 0) return nullptr;
  const auto tag = std::ranges::lower_bound(tags, id / 4, {}, &Tag::id);
  return tag == tags.end() || tag->id != id / 4 ? nullptr : &*tag;
}

bool TagList::is_flat() const noexcept { return std::ranges::all_of(tags, lies_in_plane); }

std::string TagList::text() const {
  const std::string_view name = dictionary == nullptr ? "" : dictionary->name;
  std::string places;
  for (const Tag& tag : tags) {
    if (!places.empty()) places += '+';
    places += place_text(tag, size);
  }
  std::string all =
      april ? fmt::format("apriltag:{}:{}:{}", family_name(name), length_text(size), places)
            : fmt::format("aruco:{}:{}:{}", length_text(size), places, name);
  if (border != TagGrid::kUsualBorder) all += fmt::format(":border={}", border);
  if (inverted) all += ":inverted";
  return all;
}

Status TagList::check() const {
  const auto refuse = [&](std::string why) {
    return make_error(ErrorCode::kInvalidArgument,
                      fmt::format("The list of tags does not exist: {}.", why));
  };
  if (dictionary == nullptr) return refuse("it has no dictionary of tags");
  if (tags.empty() || tags.size() > kMost) {
    return refuse(fmt::format("it has {} tags, 1 to {} are taken", tags.size(), kMost));
  }
  const bool flat = is_flat();
  for (std::size_t i = 0; i < tags.size(); ++i) {
    const Tag& tag = tags[i];
    if (!is_number(tag)) return refuse(fmt::format("the tag {} has no place", tag.id));
    const auto known = static_cast<int>(dictionary->codes.size());
    if (tag.id < 0 || tag.id >= known) {
      return refuse(
          fmt::format("{} has no tag {}, but 0 to {}", dictionary->name, tag.id, known - 1));
    }
    if (const Status status = grid_of(tag).check(); !status) return status;
    if (i > 0 && tags[i - 1].id >= tag.id) {
      return refuse(fmt::format("the tag {} is given twice, or before one of a lower id", tag.id));
    }
    for (std::size_t k = 0; flat && k < i; ++k) {
      const double apart = (vector_of(tags[k].middle) - vector_of(tag.middle)).norm();
      if (!(apart > (whole_size(*this, tags[k]) + whole_size(*this, tag)) / 2)) {
        return refuse(fmt::format("the tags {} and {} lie over each other", tags[k].id, tag.id));
      }
    }
  }
  return {};
}

std::vector<int> TagList::ids() const {
  std::vector<int> all;
  for (const Tag& tag : tags) {
    for (int corner = 0; corner < 4; ++corner) all.push_back(4 * tag.id + corner);
  }
  return all;
}

std::vector<Eigen::Vector3d> TagList::points() const {
  std::vector<Eigen::Vector3d> all;
  for (const Tag& tag : tags) {
    const SE3 frame = board_from_grid(tag);
    const double s = tag.size;
    for (const auto& [x, y] : {std::pair{0.0, 0.0}, {s, 0.0}, {s, s}, {0.0, s}}) {
      all.push_back(frame * Eigen::Vector3d(x, y, 0));
    }
  }
  return all;
}

std::optional<std::size_t> TagList::index_of(int id) const noexcept {
  const Tag* tag = tag_of(id);
  if (tag == nullptr) return std::nullopt;
  return kCorners * static_cast<std::size_t>(tag - tags.data()) +
         static_cast<std::size_t>(id) % kCorners;
}

std::vector<int> TagList::neighbours(int id) const {
  if (tag_of(id) == nullptr) return {};
  const int first = id / 4 * 4;
  std::vector<int> both = {first + (id + 1) % 4, first + (id + 3) % 4};
  std::ranges::sort(both);
  return both;
}

double TagList::cell_size(int id) const noexcept {
  const Tag* tag = tag_of(id);
  return tag == nullptr ? 0 : tag->size;
}

BoardArea TagList::extent() const { return area_of(*this, false); }
BoardArea TagList::outline() const { return area_of(*this, true); }

bool TagList::looks_like(const TagList& other) const noexcept {
  return dictionary == other.dictionary && april == other.april && border == other.border &&
         inverted == other.inverted && std::ranges::any_of(tags, [&](const Tag& tag) {
           return other.tag_of(4 * tag.id) != nullptr;
         });
}

}  // namespace calvin
