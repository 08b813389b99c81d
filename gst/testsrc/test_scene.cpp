// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Makes camera, board, motion and renderer from the settings, and renders frame after frame.

#include "testsrc/test_scene.hpp"

#include <algorithm>
#include <cmath>
#include <exception>

#include <fmt/format.h>

#include "calvin/camera/image_transform.hpp"
#include "calvin/io/board_names.hpp"
#include "calvin/io/calibration_io.hpp"
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

}  // namespace

Result<SceneSource> read_scene_settings(const SceneSettings& settings) {
  const auto boards = parse_boards(settings.board);
  if (!boards) return tl::unexpected(boards.error());
  if (boards->size() != 1) {
    return make_error(ErrorCode::kInvalidArgument,
                      fmt::format("calibtestsrc renders one board; board='{}' names {}.",
                                  settings.board, boards->size()));
  }
  SceneSource source = {boards->front(), {}, settings.motion, settings.seed};
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
      motion_(source.motion, camera, source.board, source.seed),
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

SE3 TestScene::pose(const TestFrame& frame, double v) const {
  if (source_.motion == MotionKind::kRandom) {
    const auto holds = frame.time / kHold;
    return motion_.camera_from_board(frame.hold ? static_cast<double>(holds)
                                                : static_cast<double>(frame.number));
  }
  const double rows = std::max(camera_.image_size().height - 1, 1);
  const double later = static_cast<double>(frame.readout) * v / rows;
  return motion_.camera_from_board((static_cast<double>(frame.time) + later) * 1e-9);
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
