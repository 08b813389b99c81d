// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Reads `fix`, holds what is known, and lays out the start.

#include "calvin/rig/light/light_unknowns.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "calvin/camera/lens_table.hpp"
#include "calvin/core/text.hpp"

namespace calvin::rig {

namespace {

constexpr int kTranslation = 3;  // the first number of a pose's motion that is its translation

Result<TableCamera> table_camera(const LightCamera& camera, const LightOptions& options,
                                 std::optional<Camera>& given) {
  TableCamera row;
  row.model = options.model;
  if (!camera.calibration) return row;
  auto known = Camera::make(*camera.calibration);
  if (!known) {
    return make_error(known.error().code, fmt::format("The calibration of '{}': {}", camera.name,
                                                      known.error().message));
  }
  if (known->image_size() != camera.image_size) {
    return make_error(
        ErrorCode::kInvalidArgument,
        fmt::format("The calibration of '{}' is for {}x{} px, its pictures are {}x{}: scale it.",
                    camera.name, known->image_size().width, known->image_size().height,
                    camera.image_size.width, camera.image_size.height));
  }
  row.model = known->model();
  row.skew = known->skew();
  given = *std::move(known);
  return row;
}

Status check_model(const std::string& model) {
  const LensTraits* lens = find_lens(model);
  if (lens != nullptr && lens->perspective) return {};
  std::vector<std::string_view> names;
  for (const LensTraits& one : all_lenses()) {
    if (one.perspective) names.push_back(one.model);
  }
  return make_error(ErrorCode::kUnsupported,
                    fmt::format("A light cannot find a lens of the model '{}'. Take one of {}, or "
                                "give the calibrations of cameras with other lenses.",
                                model, join(names, ", ")));
}

}  // namespace

Result<LightUnknowns> LightUnknowns::make(const std::vector<LightCamera>& cameras,
                                          const LightOptions& options) {
  if (const Status known = check_model(options.model); !known) return tl::unexpected(known.error());
  if (!(options.center_sigma >= 0 && options.center_sigma <= 1)) {
    return make_error(
        ErrorCode::kInvalidArgument,
        fmt::format("The axis cannot be {} of the width from the middle of a picture: "
                    "give 0 to 1.",
                    options.center_sigma));
  }
  LightUnknowns all;
  all.center_sigma_ = options.center_sigma;
  std::vector<TableCamera> rows;
  for (const LightCamera& camera : cameras) {
    all.sizes_.push_back(camera.image_size);
    auto row = table_camera(camera, options, all.given_.emplace_back());
    if (!row) return tl::unexpected(row.error());
    row->has_rig_pose = !rows.empty();
    rows.push_back(*std::move(row));
    const auto& given = all.given_.back();
    all.known_.push_back(given.has_value());
    all.scale_.push_back(given ? (given->fx() + given->fy()) / 2
                               : (camera.image_size.width + camera.image_size.height) / 2.0);
  }
  all.wand_ = options.wand;
  all.wand_sigma_ = options.wand_sigma;
  std::vector<BoardUnknowns> boards;
  if (!all.wand_.empty()) boards.push_back({false, false, static_cast<int>(all.lights()) - 1});
  all.table_ = ParameterTable(std::move(rows), boards);
  for (std::size_t c = 0; c < cameras.size(); ++c) {
    if (all.known_[c]) continue;
    for (const std::string& word : options.fix) {
      if (const Status held = all.hold(c, trim(word)); !held) return tl::unexpected(held.error());
    }
  }
  return all;
}

Status LightUnknowns::hold(std::size_t c, std::string_view word) {
  const Pixel center = image_center(sizes_[c]);
  const ParameterRange axis = table_.center(c);
  if (word == "aspect") {
    table_.tie({table_.focal(c)[1], table_.focal(c)[0], 1});
    return {};
  }
  const auto index = word == "center" ? std::optional(axis[0]) : table_.find(word, c);
  if (!index || table_.focal(c).has(*index)) {
    return make_error(ErrorCode::kInvalidArgument,
                      fmt::format("'{}' cannot be fixed. What can: aspect, center, cx, cy and the "
                                  "coefficients of {}.",
                                  word, table_.model(c)));
  }
  if (*index == axis[0]) table_.hold(axis[0], center.u);
  if (*index == axis[1] || word == "center") table_.hold(axis[1], center.v);
  if (!axis.has(*index)) table_.hold(*index, 0);
  return {};
}

ParameterTable LightUnknowns::at(LightStage stage) const {
  ParameterTable table = table_;
  const auto hold_all = [&](ParameterRange range, double value) {
    for (int i = range.first; i < range.end(); ++i) table.hold(i, value);
  };
  if (!wand_.empty() && (stage != LightStage::kWand || !(wand_sigma_ > 0))) {
    hold_all(table.lights(0), 0);
  }
  for (std::size_t c = 0; c < known_.size(); ++c) {
    if (known_[c]) {
      hold_all(table.intrinsics(c), 0);  // the values stay what they are: nothing is applied
      continue;
    }
    if (stage == LightStage::kAll || stage == LightStage::kWand) continue;
    hold_all(table.center(c), 0);
    if (!table.tied(table.focal(c)[1])) table.tie({table.focal(c)[1], table.focal(c)[0], 1});
    if (stage == LightStage::kFocal) hold_all(table.distortion(c), 0);
  }
  return table;
}

std::vector<ParameterTable::Prior> LightUnknowns::priors(const ParameterTable& table,
                                                         double noise) const {
  std::vector<ParameterTable::Prior> priors;
  for (std::size_t c = 0; c < known_.size(); ++c) {
    const Pixel center = image_center(sizes_[c]);
    for (int k = 0; k < 2 && center_sigma_ > 0 && !known_[c]; ++k) {
      const int unknown = table.center(c)[k];
      if (table.held(unknown)) continue;
      priors.push_back(
          {unknown, k == 0 ? center.u : center.v, center_sigma_ * sizes_[c].width / noise});
    }
  }
  const ParameterRange lights = wand_.empty() ? ParameterRange() : table.lights(0);
  for (int i = lights.first; i < lights.end(); ++i) {
    if (!table.held(i)) priors.push_back({i, 0, wand_sigma_ / noise});
  }
  return priors;
}

std::vector<double> LightUnknowns::wand_at(const std::vector<double>& values) const {
  std::vector<double> places = wand_;
  for (std::size_t k = 1; k < places.size(); ++k) {
    places[k] += values_of(values, table_.lights(0))[k - 1];
  }
  return places;
}

std::size_t LightUnknowns::scale_camera(const LightState& state) {
  const auto farthest = std::ranges::max_element(
      state.camera_from_rig, {}, [](const SE3& pose) { return pose.translation.norm(); });
  return static_cast<std::size_t>(farthest - state.camera_from_rig.begin());
}

Eigen::MatrixXd LightUnknowns::basis(LightStage stage, const LightState& state) const {
  const ParameterTable table = at(stage);
  const std::size_t camera = scale_camera(state);
  Eigen::MatrixXd free = table.basis();
  if (stage == LightStage::kWand) return free;
  const int first = table.rig_pose(camera)[kTranslation];
  Eigen::MatrixXd basis(free.rows(), free.cols() - 1);
  const Eigen::Vector3d along = state.camera_from_rig[camera].translation.normalized();
  Eigen::Matrix3d axes = rotation_between(Eigen::Vector3d::UnitX(), along);
  Eigen::Index to = 0;
  for (Eigen::Index from = 0; from < free.cols(); ++from) {
    if (!moves(free, from, {first, 3})) basis.col(to++) = free.col(from);
  }
  basis.rightCols(2).setZero();
  basis.block(first, to, 3, 2) = axes.rightCols<2>();
  return basis;
}

Tracks LightUnknowns::start_tracks(const std::vector<LightCamera>& cameras) const {
  constexpr double kSteepest = 3;  // tangent of the angle to the axis that still weighs well
  Tracks tracks;
  for (std::size_t c = 0; c < cameras.size(); ++c) {
    Track& track = tracks.emplace_back(cameras[c].seen.size());
    const Pixel center = image_center(sizes_[c]);
    for (std::size_t i = 0; i < track.size(); ++i) {
      const auto& seen = cameras[c].seen[i];
      if (!seen) continue;
      if (!given_[c]) {
        track[i] = {{(seen->uv.u - center.u) / scale_[c], (seen->uv.v - center.v) / scale_[c]},
                    scale_[c]};
        continue;
      }
      const auto ray = given_[c]->unproject(seen->uv);
      if (!ray || !(ray->head<2>().norm() < kSteepest * ray->z())) continue;
      track[i] = {ray->hnormalized(), scale_[c]};
    }
  }
  return tracks;
}

std::vector<double> LightUnknowns::start_values(const std::vector<double>& focal) const {
  std::vector<double> values(static_cast<std::size_t>(table_.count()), 0.0);
  const auto set = [&](int unknown, double value) {
    values[static_cast<std::size_t>(unknown)] = value;
  };
  for (std::size_t c = 0; c < known_.size(); ++c) {
    if (given_[c]) {
      std::ranges::copy(given_[c]->parameters(), values.begin() + table_.intrinsics(c).first);
      continue;
    }
    const Pixel center = image_center(sizes_[c]);
    for (int k = 0; k < 2; ++k) set(table_.focal(c)[k], focal[c] * scale_[c]);
    set(table_.center(c)[0], center.u);
    set(table_.center(c)[1], center.v);
  }
  return values;
}

std::optional<std::vector<Camera>> LightUnknowns::cameras(const std::vector<double>& values) const {
  std::vector<Camera> all;
  for (std::size_t c = 0; c < known_.size(); ++c) {
    if (given_[c]) {
      all.push_back(*given_[c]);
      continue;
    }
    const auto own = values_of(values, table_.intrinsics(c));
    auto camera = Camera::make(table_.model(c), sizes_[c], {own.begin(), own.end()});
    if (!camera) return std::nullopt;
    all.push_back(*std::move(camera));
  }
  return all;
}

}  // namespace calvin::rig
