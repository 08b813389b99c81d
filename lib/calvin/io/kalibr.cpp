// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The camchain of Kalibr, of one camera or of many.

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <Eigen/Core>

#include "calvin/camera/camera.hpp"
#include "calvin/core/text.hpp"
#include "calvin/core/utf8.hpp"
#include "calvin/geometry/se3.hpp"
#include "calvin/io/calibration_formats.hpp"
#include "calvin/io/opencv_camera.hpp"
#include "calvin/io/rig_fields.hpp"
#include "calvin/io/rig_formats.hpp"

namespace calvin::io {

namespace {

// Kalibr's names for a model of ours. `before` parameters of a projection stand before fu fv pu pv;
// coefficients of a distortion are a list of their own.
struct ModelNames {
  std::string_view projection;
  std::string_view distortion;
  std::string_view model;
  std::size_t before;
  std::size_t coefficients;
};
constexpr std::array<ModelNames, 7> kModelNames = {{{"pinhole", "none", "pinhole", 0, 0},
                                                    {"pinhole", "radtan", "brown4", 0, 4},
                                                    {"pinhole", "equidistant", "fisheye", 0, 4},
                                                    {"pinhole", "fov", "fov", 0, 1},
                                                    {"omni", "none", "ucm", 1, 0},
                                                    {"eucm", "none", "eucm", 2, 0},
                                                    {"ds", "none", "doublesphere", 2, 0}}};

// Kalibr's omni is C. Mei's: xi, and focal lengths of the plane at the distance 1 of the centre of
// projection; ours has alpha = xi / (1 + xi) and focal lengths of a plane at 1 + xi.
void from_mei(std::vector<double>& parameters) {
  const double xi = parameters[4];
  parameters[0] /= 1 + xi;
  parameters[1] /= 1 + xi;
  parameters[4] = xi / (1 + xi);
}

void to_mei(std::vector<double>& parameters) {
  const double alpha = parameters[4];
  parameters[0] /= 1 - alpha;
  parameters[1] /= 1 - alpha;
  parameters[4] = alpha / (1 - alpha);
}

std::string name_of(std::size_t number) { return fmt::format("cam{}", number); }

// ---- Reading ------------------------------------------------------------------------------------

std::optional<Camera> read_intrinsics(Fields& fields) {
  const std::string projection = fields.word("camera_model");
  std::string distortion = fields.word("distortion_model");
  if (distortion.empty()) distortion = "none";
  const auto row = std::ranges::find_if(kModelNames, [&](const ModelNames& r) {
    return r.projection == projection && r.distortion == distortion;
  });
  if (row == kModelNames.end()) {
    fields.complain("camera_model",
                    fmt::format("is {} with the distortion {}, which no camera model here has",
                                shortened(projection, 40), shortened(distortion, 40)),
                    ErrorCode::kUnsupported);
    return std::nullopt;
  }
  const std::vector<double> intrinsics = fields.numbers("intrinsics", row->before + 4);
  std::vector<double> coefficients;
  if (row->coefficients > 0) {
    coefficients = fields.numbers("distortion_coeffs", row->coefficients);
  }
  const std::vector<double> size = fields.numbers("resolution", 2);
  if (fields.failed()) return std::nullopt;
  const auto focal = intrinsics.begin() + static_cast<std::ptrdiff_t>(row->before);
  std::vector<double> parameters(focal, intrinsics.end());
  parameters.insert(parameters.end(), intrinsics.begin(), focal);
  parameters.insert(parameters.end(), coefficients.begin(), coefficients.end());
  if (row->model == "ucm") from_mei(parameters);
  const auto to_int = [](double length) {
    return static_cast<int>(std::clamp(length, 0.0, 1e6));  // Camera::make() says what is wrong
  };
  const auto camera = Camera::make(row->model, {to_int(size[0]), to_int(size[1])}, parameters);
  if (camera) return *camera;
  fields.complain("intrinsics", fmt::format("are wrong: {}", camera.error().message),
                  camera.error().code);
  return std::nullopt;
}

// The names by which topics tell cameras apart, as "/left/image_raw" does; where they do not, those
// of the chain.
std::vector<std::string> names_of(const Node& root, std::size_t cameras) {
  constexpr std::string_view kTopic = "/image_raw";
  std::vector<std::string> names;
  std::vector<std::string> numbers;
  for (std::size_t n = 0; n < cameras; ++n) {
    numbers.push_back(name_of(n));
    const Node* topic = root.find(name_of(n))->find("rostopic");
    if (topic == nullptr) continue;
    std::string_view text = topic->text;
    if (!text.starts_with('/') || !text.ends_with(kTopic) || text.size() <= kTopic.size() + 1) {
      continue;
    }
    text.remove_prefix(1);
    text.remove_suffix(kTopic.size());
    if (std::ranges::count(names, text) == 0) names.emplace_back(text);
  }
  return names.size() == cameras ? names : numbers;
}

// A matrix of 4 x 4, whose rotation was printed with few digits perhaps.
std::optional<SE3> read_motion(Fields& fields, std::string_view key) {
  const auto rows = fields.rows(key, 4);
  if (fields.failed()) return std::nullopt;
  Eigen::Matrix3d rotation;
  Eigen::Vector3d translation;
  if (rows.size() == 4) {
    for (int r = 0; r < 3; ++r) {
      const auto& row = rows[static_cast<std::size_t>(r)];
      rotation.row(r) << row[0], row[1], row[2];
      translation(r) = row[3];
    }
    const auto closest = rotation_near(rotation);
    if (closest && is_near(translation)) return SE3{*closest, translation};
  }
  fields.complain(key,
                  "is no rigid motion: a matrix of 4 x 4 with a rotation and a place in metres");
  return std::nullopt;
}

// Of the inertial unit, where the file tells it; chains that OpenVINS reads have its inverse.
std::optional<SE3> camera_from_imu(Fields& fields) {
  if (fields.find("T_cam_imu") != nullptr) return read_motion(fields, "T_cam_imu");
  if (fields.find("T_imu_cam") == nullptr) return std::nullopt;
  const auto imu_from_camera = read_motion(fields, "T_imu_cam");
  if (!imu_from_camera) return std::nullopt;
  return imu_from_camera->inverse();
}

// Of a camera and the one before it: as the chain says, or by way of the inertial unit.
std::optional<SE3> motion_from_last(Fields& fields, Fields last) {
  constexpr std::string_view kChain = "T_cn_cnm1";
  if (fields.find(kChain) == nullptr) {
    const auto own = camera_from_imu(fields);
    const auto before = camera_from_imu(last);
    if (own && before) return *own * before->inverse();
  }
  if (fields.failed()) return std::nullopt;
  return read_motion(fields, kChain);
}

// ---- Writing ------------------------------------------------------------------------------------

// A Brown lens that needs no more than brown4 is one.
Result<Camera> simplified(const Calibration& calibration) {
  if (opencv_lens(calibration.model) == nullptr) return Camera::make(calibration);
  auto numbers = to_opencv(calibration);
  if (!numbers) return tl::unexpected(numbers.error());
  auto& d = numbers->distortion;
  if (d.size() == 5 && d.back() == 0) d.pop_back();
  const auto simple = from_opencv(*numbers, calibration.image_size);
  return Camera::make(simple && calibration.model != "pinhole" ? *simple : calibration);
}

Result<const ModelNames*> row_for(const Camera& camera, std::string_view name) {
  const auto row = std::ranges::find_if(
      kModelNames, [&](const ModelNames& r) { return r.model == camera.model(); });
  // C. Mei's xi has no end where alpha is 1, and near it digits are lost.
  constexpr double kMostAlpha = 0.999;
  const bool is_finite = camera.model() != "ucm" || camera.parameters()[4] < kMostAlpha;
  if (row != kModelNames.end() && camera.skew() == 0 && is_finite) return &*row;
  return make_error(
      ErrorCode::kUnsupported,
      fmt::format("Kalibr has no camera like '{}', a {}{}: calibrate with brown4 or "
                  "fisheye.",
                  shortened(name, 64), camera.model(), camera.skew() == 0 ? "" : " with skew"));
}

std::string motion_text(const SE3& motion) {
  std::string text;
  for (int r = 0; r < 3; ++r) {
    text += fmt::format("  - {}\n", list_text({motion.rotation(r, 0), motion.rotation(r, 1),
                                               motion.rotation(r, 2), motion.translation(r)}));
  }
  return text + "  - [0.0, 0.0, 0.0, 1.0]\n";
}

Result<std::string> camera_text(const RigCamera& of, std::size_t cameras, std::size_t number) {
  const auto camera = simplified(of.calibration);
  if (!camera) return tl::unexpected(camera.error());
  const auto row = row_for(*camera, of.calibration.camera);
  if (!row) return tl::unexpected(row.error());
  std::vector<double> parameters = camera->parameters();
  if ((*row)->model == "ucm") to_mei(parameters);
  const auto focal_end = parameters.begin() + 4;
  const auto before_end = focal_end + static_cast<std::ptrdiff_t>((*row)->before);
  std::vector<double> intrinsics(focal_end, before_end);
  intrinsics.insert(intrinsics.end(), parameters.begin(), focal_end);
  std::vector<std::string> others;
  for (std::size_t other = 0; other < cameras; ++other) {
    if (other != number) others.push_back(fmt::format("{}", other));
  }
  const std::string name = of.calibration.camera.empty() ? name_of(number) : of.calibration.camera;
  return fmt::format(
      "{}:\n  cam_overlaps: [{}]\n  camera_model: {}\n  distortion_coeffs: {}\n"
      "  distortion_model: {}\n  intrinsics: {}\n  resolution: [{}, {}]\n  rostopic: {}\n",
      name_of(number), join(others, ", "), (*row)->projection,
      list_text({before_end, parameters.end()}), (*row)->distortion, list_text(intrinsics),
      camera->image_size().width, camera->image_size().height,
      json_string("/" + name + "/image_raw"));
}

}  // namespace

bool kalibr_holds(std::string_view model) {
  return std::ranges::any_of(kModelNames,
                             [&](const ModelNames& row) { return row.model == model; });
}

bool is_kalibr(const Node& root) {
  const Node* first = root.find("cam0");
  return first != nullptr && first->find("camera_model") != nullptr;
}

Result<Rig> read_kalibr(const Node& root) {
  std::optional<Error> problem;
  Fields chain(root, "", problem);
  Rig rig;
  SE3 rig_from_camera;
  for (std::size_t n = 0; root.find(name_of(n)) != nullptr && !problem; ++n) {
    Fields fields = chain.map(name_of(n));
    const auto camera = read_intrinsics(fields);
    if (n > 0 && camera) {
      const auto from_last = motion_from_last(fields, chain.map(name_of(n - 1)));
      if (from_last) rig_from_camera = rig_from_camera * from_last->inverse();
    }
    if (problem) break;
    RigCamera one;
    one.calibration = camera->to_calibration();
    one.rig_from_camera = to_pose(rig_from_camera);
    rig.cameras.push_back(std::move(one));
  }
  if (problem) return tl::unexpected(*problem);
  const auto names = names_of(root, rig.cameras.size());
  for (std::size_t n = 0; n < names.size(); ++n) rig.cameras[n].calibration.camera = names[n];
  rig.world = names.front();
  return rig;
}

Result<std::string> print_kalibr(const Rig& rig) {
  std::string text;
  for (std::size_t n = 0; n < rig.cameras.size(); ++n) {
    auto camera = camera_text(rig.cameras[n], rig.cameras.size(), n);
    if (!camera) return camera;
    text += *camera;
    if (n == 0) continue;
    const SE3 rig_from_last = to_se3(rig.cameras[n - 1].rig_from_camera);
    const SE3 from_last = to_se3(rig.cameras[n].rig_from_camera).inverse() * rig_from_last;
    text += "  T_cn_cnm1:\n" + motion_text(from_last);
  }
  return text;
}

Result<Calibration> read_kalibr_camera(const Node& root) {
  auto rig = read_kalibr(root);
  if (!rig) return tl::unexpected(rig.error());
  if (rig->cameras.size() == 1) return std::move(rig->cameras.front().calibration);
  return make_error(ErrorCode::kUnsupported,
                    fmt::format("it holds {} cameras. Give one of them alone, or the file where a "
                                "rig is taken.",
                                rig->cameras.size()));
}

Result<std::string> print_kalibr_camera(const Calibration& calibration) {
  Rig rig;
  rig.cameras.push_back({calibration, {}, {}, {}});
  return print_kalibr(rig);
}

}  // namespace calvin::io
