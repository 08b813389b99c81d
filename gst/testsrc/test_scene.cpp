// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Makes camera, board, motion and renderer from the settings, and renders frame after frame.

#include "testsrc/test_scene.hpp"

#include <algorithm>
#include <cmath>
#include <exception>
#include <vector>

#include <fmt/format.h>

#include "calvin/camera/image_transform.hpp"
#include "calvin/core/text.hpp"
#include "calvin/io/board_names.hpp"
#include "calvin/io/calibration_io.hpp"
#include "calvin/io/rig_io.hpp"
#include "calvin/io/settings.hpp"

namespace calvin::gst {

namespace {

constexpr std::uint64_t kHold = 500'000'000;  // ns

Result<Camera> camera_for(const std::optional<Calibration>& calibration, ImageSize size) {
  if (!calibration) return default_camera(size);
  Calibration sized = *calibration;
  if (sized.image_size.width == 0) sized.image_size = size;
  auto camera = Camera::make(sized);
  if (!camera || camera->image_size() == size) return camera;
  const ImageSize from = camera->image_size();
  // The same aspect, to the pixel that rounding may cost.
  if (std::abs(static_cast<double>(size.width) * from.height / from.width - size.height) > 1) {
    return make_error(
        ErrorCode::kInvalidArgument,
        fmt::format("The calibration is for {}x{} px and cannot be scaled to {}x{}: the aspect "
                    "differs. Ask for {}x{} or another size of its aspect in the caps.",
                    from.width, from.height, size.width, size.height, from.width, from.height));
  }
  return ImageTransform::scaled(from, size)(*camera);
}

// The camera of a rig by its name.
Status take_from_rig(const SceneSettings& settings, SceneSource& source) {
  const auto rig = settings.rig.starts_with('{') ? parse_rig(settings.rig) : read_rig(settings.rig);
  if (!rig) return tl::unexpected(rig.error());
  const auto own = std::ranges::find_if(rig->cameras, [&](const RigCamera& camera) {
    return settings.camera.empty() || camera.calibration.camera == settings.camera;
  });
  if (own == rig->cameras.end()) {
    std::vector<std::string> names;
    for (const RigCamera& camera : rig->cameras) names.push_back(camera.calibration.camera);
    return make_error(
        ErrorCode::kInvalidArgument,
        fmt::format("The rig has no camera '{}': it has {}.", settings.camera, join(names, ", ")));
  }
  const auto first = Camera::make(rig->cameras.front().calibration);
  if (!first) return tl::unexpected(first.error());
  source.calibration = own->calibration;
  source.first = SceneSource::First{*first, to_se3(own->rig_from_camera).inverse() *
                                                to_se3(rig->cameras.front().rig_from_camera)};
  return {};
}

}  // namespace

Result<SceneSource> read_scene_settings(const SceneSettings& settings) {
  const auto boards = parse_boards(settings.board);
  if (!boards) return tl::unexpected(boards.error());
  if (boards->size() != 1) {
    return make_error(ErrorCode::kInvalidArgument,
                      fmt::format("calibtestsrc renders one board; board='{}' names {}.",
                                  settings.board, boards->size()));
  }
  SceneSource source = {boards->front(), {}, settings.motion, settings.seed, {}};
  if (!settings.rig.empty()) {
    if (const Status taken = take_from_rig(settings, source); !taken) {
      return tl::unexpected(taken.error());
    }
    return source;
  }
  if (!settings.calibration.empty()) {
    auto calibration = parse_calibration_setting(settings.calibration);
    if (!calibration) return tl::unexpected(calibration.error());
    source.calibration = std::move(*calibration);
  }
  return source;
}

TestScene::TestScene(const SceneSource& source, const Camera& camera)
    : source_(source),
      camera_(camera),
      truth_(camera.to_calibration()),
      motion_(source.motion, source.first ? source.first->camera : camera, source.board,
              source.seed),
      renderer_(camera) {
  const bool named = source.calibration && !source.calibration->camera.empty();
  truth_.camera = named ? source.calibration->camera : "cam0";
  truth_.board = source.board.text();
}

Result<TestScene> TestScene::make(const SceneSource& source, ImageSize size) {
  const auto camera = camera_for(source.calibration, size);
  if (!camera) return tl::unexpected(camera.error());
  try {
    TestScene scene(source, *camera);
    auto json = print_calibration(scene.truth_);
    if (!json) return tl::unexpected(json.error());
    scene.json_ = std::move(*json);
    return scene;
  } catch (const std::bad_alloc&) {
    return make_error(
        ErrorCode::kUnsupported,
        fmt::format("There is not enough memory to render {}x{} px. Ask for a smaller "
                    "size in the caps.",
                    size.width, size.height));
  }
}

bool TestScene::rolls(const TestFrame& frame) const {
  // A random pose is another place, not a motion to there.
  return frame.readout > 0 &&
         (source_.motion == MotionKind::kOrbit || source_.motion == MotionKind::kHand);
}

// As the own camera sees the board. What it sees from behind is the back of a sheet, which shows
// nothing: the board is then where no ray leads to.
SE3 TestScene::placed(double at) const {
  const SE3 pose = motion_.camera_from_board(at);
  if (!source_.first) return pose;
  const SE3 own = source_.first->own_from_first * pose;
  return sees_face(source_.board, own) ? own : SE3{Eigen::Matrix3d::Identity(), {0, 0, -1e3}};
}

SE3 TestScene::pose(const TestFrame& frame, double v) const {
  if (source_.motion == MotionKind::kRandom) {
    const auto holds = frame.time / kHold;
    return placed(frame.hold ? static_cast<double>(holds) : static_cast<double>(frame.number));
  }
  const double rows = std::max(camera_.image_size().height - 1, 1);
  const double later = static_cast<double>(frame.readout) * v / rows;
  return placed((static_cast<double>(frame.time) + later) * 1e-9);
}

GrayImage TestScene::picture(const TestFrame& frame, RenderOptions options) const {
  options.seed = noise_seed(source_.seed, static_cast<std::uint64_t>(frame.number));
  if (!rolls(frame)) return renderer_.render(source_.board, pose(frame), options);
  return renderer_.render(
      source_.board, [&](double v) { return pose(frame, v); }, options);
}

Observation TestScene::observation(const TestFrame& frame) const {
  Observation truth = rolls(frame) ? true_observation(camera_, source_.board,
                                                      [&](double v) { return pose(frame, v); })
                                   : true_observation(camera_, source_.board, pose(frame));
  truth.camera = truth_.camera;
  truth.timestamp = frame.time;
  return truth;
}

}  // namespace calvin::gst
