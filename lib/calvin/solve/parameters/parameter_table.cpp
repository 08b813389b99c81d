// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Lays out the unknowns of cameras, rig and boards, names them, and makes a basis of what is free.

#include "calvin/solve/parameters/parameter_table.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "calvin/camera/camera.hpp"

namespace calvin {

namespace {

constexpr std::string_view kSkew = "skew";
constexpr std::array<std::string_view, 6> kPoseNames = {"rx", "ry", "rz", "tx", "ty", "tz"};
constexpr std::array<std::string_view, 2> kWarpNames = {"kx", "ky"};

}  // namespace

ParameterTable::ParameterTable(std::vector<TableCamera> cameras,
                               std::vector<BoardUnknowns> boards) {
  cameras_.reserve(cameras.size());
  for (TableCamera& camera : cameras) {
    const auto unknowns = CameraUnknowns::of(parameter_names(camera.model).size(), camera.has_skew);
    const int first = take(camera.known.empty() ? unknowns.all().count : 0).first;
    cameras_.push_back({std::move(camera), unknowns, first, {}, {}});
  }
  for (Camera& camera : cameras_) camera.readout = take(camera.of.has_readout ? 1 : 0);
  for (Camera& camera : cameras_) {
    camera.rig_pose = take(camera.of.has_rig_pose ? static_cast<int>(kPoseNames.size()) : 0);
  }
  boards_.reserve(boards.size());
  for (const BoardUnknowns& board : boards)
    boards_.push_back({board, take(board.all().count).first});
  held_.resize(index(count_));
}

ParameterRange ParameterTable::take(int unknowns) {
  const ParameterRange range = {count_, unknowns};
  count_ += unknowns;
  return range;
}

double ParameterTable::skew_at(std::size_t camera, std::span<const double> values) const {
  const ParameterRange range = skew(camera);
  return range.empty() ? cameras_[camera].of.skew : values[index(range.first)];
}

std::string ParameterTable::camera_name(std::size_t i, int unknown) const {
  std::string_view own;
  if (readout(i).has(unknown)) own = "readout";
  if (skew(i).has(unknown)) own = kSkew;
  if (rig_pose(i).has(unknown)) own = kPoseNames[index(unknown - rig_pose(i).first)];
  if (intrinsics(i).has(unknown)) {
    own = parameter_names(model(i))[index(unknown - intrinsics(i).first)];
  }
  if (own.empty() || cameras() == 1) return std::string(own);
  return fmt::format("camera{}.{}", i, own);
}

std::string ParameterTable::board_name(std::size_t j, int unknown) const {
  if (warp(j).has(unknown)) {
    return fmt::format("board{}.{}", j, kWarpNames[index(unknown - warp(j).first)]);
  }
  if (aspect(j).has(unknown)) return fmt::format("board{}.aspect", j);
  if (lights(j).has(unknown)) {
    return fmt::format("board{}.light{}", j, unknown - lights(j).first + 1);
  }
  return {};
}

std::string ParameterTable::name(int unknown) const {
  for (std::size_t i = 0; i < cameras(); ++i) {
    if (std::string found = camera_name(i, unknown); !found.empty()) return found;
  }
  for (std::size_t j = 0; j < boards(); ++j) {
    if (std::string found = board_name(j, unknown); !found.empty()) return found;
  }
  return {};
}

std::optional<int> ParameterTable::find(std::string_view parameter, std::size_t i) const {
  const auto names = parameter_names(model(i));
  const auto at = std::find(names.begin(), names.end(), parameter);
  if (at != names.end() && !is_known(i)) {
    return intrinsics(i)[static_cast<int>(at - names.begin())];
  }
  if (parameter == kSkew && !skew(i).empty()) return skew(i).first;
  return std::nullopt;
}

bool ParameterTable::tied(int unknown) const {
  return std::any_of(ties_.begin(), ties_.end(),
                     [unknown](const Tie& t) { return t.parameter == unknown; });
}

Status ParameterTable::resolve_ties() {
  for (bool changed = true; changed;) {
    changed = false;
    for (Tie& tie : ties_) {
      const auto target = held(tie.with);
      if (held(tie.parameter) && !target) {
        return make_error(ErrorCode::kInvalidArgument,
                          fmt::format("'{}' cannot be both fixed and tied to '{}'.",
                                      name(tie.parameter), name(tie.with)));
      }
      if (target && !held(tie.parameter)) {
        hold(tie.parameter, tie.ratio * *target);
        changed = true;
      }
      for (const Tie& other : ties_) {
        if (other.parameter != tie.with) continue;
        if (other.with == tie.parameter) {
          return make_error(ErrorCode::kInvalidArgument, "What is tied leads in a circle.");
        }
        tie = {tie.parameter, other.with, tie.ratio * other.ratio};
        changed = true;
      }
    }
  }
  return {};
}

Eigen::MatrixXd ParameterTable::basis() const {
  std::vector<Eigen::Index> column(held_.size(), -1);
  Eigen::Index columns = 0;
  for (int i = 0; i < count_; ++i) {
    if (!held(i) && !tied(i)) column[index(i)] = columns++;
  }
  Eigen::MatrixXd basis = Eigen::MatrixXd::Zero(count_, columns);
  for (int i = 0; i < count_; ++i) {
    if (column[index(i)] >= 0) basis(i, column[index(i)]) = 1;
  }
  for (const Tie& tie : ties_) {
    if (!held(tie.parameter)) basis(tie.parameter, column[index(tie.with)]) = tie.ratio;
  }
  return basis;
}

bool ParameterTable::same_focal(const Tie& tie) const {
  for (std::size_t i = 0; i < cameras(); ++i) {
    if (focal(i).has(tie.parameter)) return focal(i).has(tie.with);
  }
  return false;
}

void ParameterTable::apply(std::span<double> values) const {
  for (std::size_t i = 0; i < held_.size(); ++i) {
    if (held_[i]) values[i] = *held_[i];
  }
  for (const Tie& tie : ties_) {
    if (held(tie.parameter)) continue;
    double& with = values[index(tie.with)];
    const double product = with * values[index(tie.parameter)] / tie.ratio;
    if (same_focal(tie) && product > 0) with = std::sqrt(product);
    values[index(tie.parameter)] = tie.ratio * with;
  }
}

}  // namespace calvin
