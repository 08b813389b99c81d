// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The text model of COLMAP: cameras.txt has the lenses, images.txt the pictures and where each was
// taken, which are the cameras of a rig. The corner of its top-left pixel is (0, 0).

#include <algorithm>
#include <array>
#include <charconv>
#include <map>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <Eigen/Core>
#include <Eigen/Geometry>

#include "calvin/camera/camera.hpp"
#include "calvin/core/text.hpp"
#include "calvin/core/utf8.hpp"
#include "calvin/geometry/se3.hpp"
#include "calvin/io/calibration_formats.hpp"
#include "calvin/io/colmap.hpp"
#include "calvin/io/file_text.hpp"
#include "calvin/io/rig_fields.hpp"

namespace calvin::io {

namespace {

// Of a pixel, from its corner.
constexpr double kCentre = 0.5;
// COLMAP's lengths have no unit by themselves.
constexpr std::string_view kInMetres = "# Lengths are in metres.";

// A lens of COLMAP's: the parameters of ours in the order of its own, and one in the place of two
// where fx and fy are one.
struct Lens {
  std::string_view name;
  std::string_view model;
  bool has_one_focal;
  std::size_t coefficients;  // the first ones of ours; those behind them are 0
};
constexpr std::array<Lens, 10> kLenses = {{{"SIMPLE_PINHOLE", "pinhole", true, 0},
                                           {"PINHOLE", "pinhole", false, 0},
                                           {"SIMPLE_RADIAL", "brown4", true, 1},
                                           {"RADIAL", "brown4", true, 2},
                                           {"OPENCV", "brown4", false, 4},
                                           {"FULL_OPENCV", "rational8", false, 8},
                                           {"OPENCV_FISHEYE", "fisheye", false, 4},
                                           {"SIMPLE_RADIAL_FISHEYE", "fisheye", true, 1},
                                           {"RADIAL_FISHEYE", "fisheye", true, 2},
                                           {"FOV", "fov", false, 1}}};

const Lens* lens_called(std::string_view name) {
  const auto lens = std::ranges::find(kLenses, name, &Lens::name);
  return lens == kLenses.end() ? nullptr : &*lens;
}

// ---- Reading ------------------------------------------------------------------------------------

tl::unexpected<Error> broken(std::string_view file, std::size_t line, std::string_view why,
                             ErrorCode code = ErrorCode::kMalformed) {
  return make_error(code, fmt::format("{}, line {}: {}", file, line, why));
}

std::optional<std::uint64_t> to_id(std::string_view text) {
  std::uint64_t id = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), id);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return id;
}

// All words from one on; absent where one is no number.
std::optional<std::vector<double>> to_numbers(const std::vector<std::string_view>& words,
                                              std::size_t from, std::size_t to) {
  std::vector<double> numbers;
  for (std::size_t i = from; i < to; ++i) {
    const auto number = parse_double(words[i]);
    if (!number) return std::nullopt;
    numbers.push_back(*number);
  }
  return numbers;
}

// The parameters of our model.
Result<Camera> to_camera(const Lens& lens, ImageSize size, std::vector<double> numbers) {
  if (lens.has_one_focal) numbers.insert(numbers.begin(), numbers.front());
  numbers[2] -= kCentre;
  numbers[3] -= kCentre;
  const std::size_t count =
      4 + (lens.model == "pinhole" ? 0
           : lens.model == "fov"   ? 1
                                   : std::max<std::size_t>(lens.coefficients, 4));
  numbers.resize(count, 0.0);
  // A lens without k4 to k6 is a smaller one.
  const bool is_brown5 =
      lens.model == "rational8" &&
      std::all_of(numbers.begin() + 9, numbers.end(), [](double number) { return number == 0; });
  if (!is_brown5) return Camera::make(lens.model, size, numbers);
  numbers.resize(9);
  return Camera::make("brown5", size, numbers);
}

Result<std::pair<std::uint64_t, Calibration>> read_camera_line(std::string_view line,
                                                               std::size_t number) {
  constexpr std::string_view kFile = "cameras.txt";
  const auto words = words_of(line);
  const auto id = to_id(words.front());
  if (!id || words.size() < 4) {
    return broken(kFile, number, "it is not 'CAMERA_ID MODEL WIDTH HEIGHT PARAMS...'");
  }
  const Lens* lens = lens_called(words[1]);
  if (lens == nullptr) {
    return broken(kFile, number,
                  fmt::format("no camera model here is like {}: let COLMAP take OPENCV, "
                              "FULL_OPENCV or OPENCV_FISHEYE",
                              shortened(words[1], 40)),
                  ErrorCode::kUnsupported);
  }
  const std::size_t count = lens->coefficients + (lens->has_one_focal ? 3 : 4);
  const auto numbers = to_numbers(words, 4, words.size());
  const auto width = parse_int(words[2]);
  const auto height = parse_int(words[3]);
  if (!numbers || numbers->size() != count || !width || !height) {
    return broken(
        kFile, number,
        fmt::format("{} has a width, a height and {} numbers behind them", lens->name, count));
  }
  const auto camera = to_camera(*lens, {*width, *height}, *numbers);
  if (!camera) return broken(kFile, number, camera.error().message, camera.error().code);
  return std::pair(*id, camera->to_calibration());
}

using Lenses = std::map<std::uint64_t, Calibration>;

Result<Lenses> read_cameras(std::string_view content) {
  Lenses cameras;
  std::size_t number = 0;
  for (const std::string_view line : lines_of(content)) {
    ++number;
    if (line.empty() || line.starts_with('#')) continue;
    auto camera = read_camera_line(line, number);
    if (!camera) return tl::unexpected(camera.error());
    if (!cameras.insert(*std::move(camera)).second) {
      return broken("cameras.txt", number, "an earlier line has that camera, too");
    }
  }
  if (cameras.empty()) return make_error(ErrorCode::kMalformed, "cameras.txt has no camera");
  return cameras;
}

// IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME
Result<RigCamera> read_image_line(std::string_view line, std::size_t number,
                                  const Lenses& cameras) {
  constexpr std::string_view kFile = "images.txt";
  const auto words = words_of(line);
  constexpr std::size_t kName = 9;
  const auto numbers = words.size() > kName ? to_numbers(words, 1, 8) : std::nullopt;
  const auto id = words.size() > kName ? to_id(words[8]) : std::nullopt;
  if (!numbers || !id) {
    return broken(kFile, number, "it is not 'IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME'");
  }
  const auto camera = cameras.find(*id);
  if (camera == cameras.end()) {
    return broken(kFile, number, fmt::format("cameras.txt has no camera {}", *id));
  }
  const auto& n = *numbers;
  const Eigen::Quaterniond turn(n[0], n[1], n[2], n[3]);
  constexpr double kClose = 1e-3;
  if (std::abs(turn.norm() - 1) > kClose) {
    return broken(kFile, number, "QW QX QY QZ is no quaternion of length 1");
  }
  const SE3 camera_from_world = {turn.normalized().toRotationMatrix(), {n[4], n[5], n[6]}};
  if (!is_near(camera_from_world.translation)) {
    return broken(kFile, number, "TX TY TZ is out of range (1e6)");
  }
  RigCamera one;
  one.calibration = camera->second;
  // A name may have blanks: it is the rest of the line.
  const auto begin = static_cast<std::size_t>(words[kName].data() - line.data());
  one.calibration.camera = trim(line.substr(begin));
  one.rig_from_camera = to_pose(camera_from_world.inverse());
  return one;
}

// Two lines for each picture; the second one has its points, or none.
Result<std::vector<RigCamera>> read_images(std::string_view content, const Lenses& cameras) {
  std::vector<RigCamera> images;
  std::size_t number = 0;
  bool is_points = false;
  for (const std::string_view line : lines_of(content)) {
    ++number;
    if (std::exchange(is_points, false) || line.empty() || line.starts_with('#')) continue;
    auto image = read_image_line(line, number, cameras);
    if (!image) return tl::unexpected(image.error());
    if (images.size() == kMostRigCameras) {
      return make_error(ErrorCode::kMalformed,
                        fmt::format("images.txt has over {} pictures, more than any rig has "
                                    "cameras",
                                    kMostRigCameras));
    }
    images.push_back(*std::move(image));
    is_points = true;
  }
  if (images.empty()) return make_error(ErrorCode::kMalformed, "images.txt has no picture");
  if (const std::string* name = repeated_name(images)) {
    return make_error(ErrorCode::kMalformed,
                      fmt::format("images.txt has '{}' twice", shortened(*name, 64)));
  }
  return images;
}

// ---- Writing ------------------------------------------------------------------------------------

tl::unexpected<Error> not_held(const Calibration& calibration, std::string_view with) {
  return make_error(
      ErrorCode::kUnsupported,
      fmt::format("COLMAP has no lens like that of '{}', a {}{}: calibrate with brown5, rational8 "
                  "or fisheye.",
                  shortened(calibration.camera, 64), calibration.model, with));
}

// Its name and numbers.
Result<std::pair<std::string_view, std::vector<double>>> to_colmap(const Calibration& calibration) {
  const auto camera = Camera::make(calibration);
  if (!camera) return tl::unexpected(camera.error());
  if (camera->skew() != 0) return not_held(calibration, " with skew");
  std::vector<double> numbers = camera->parameters();
  std::string_view name = "PINHOLE";
  if (calibration.model == "fov") {
    name = "FOV";
  } else if (calibration.model != "pinhole") {
    const auto opencv = shortest_opencv(calibration);
    if (!opencv) return not_held(calibration, "");
    const std::size_t count = opencv->distortion.size();
    if (count > 8) return not_held(calibration, "");
    name = opencv->fisheye ? "OPENCV_FISHEYE" : count == 4 ? "OPENCV" : "FULL_OPENCV";
    numbers.resize(4);
    numbers.insert(numbers.end(), opencv->distortion.begin(), opencv->distortion.end());
    if (count > 4) numbers.resize(4 + 8, 0.0);
  }
  numbers[2] += kCentre;
  numbers[3] += kCentre;
  return std::pair(name, std::move(numbers));
}

Result<std::string> camera_line(const Calibration& calibration, std::size_t id) {
  const Status sized = check_has_size(calibration, "file of COLMAP");
  if (!sized) return tl::unexpected(sized.error());
  const auto camera = to_colmap(calibration);
  if (!camera) return tl::unexpected(camera.error());
  std::string line = fmt::format("{} {} {} {}", id, camera->first, calibration.image_size.width,
                                 calibration.image_size.height);
  for (const double number : camera->second) line.append(" ").append(format_double(number));
  return line + "\n";
}

// One word, since programs that read these files end a name at a blank.
std::string word_for(const Calibration& calibration, std::size_t number) {
  if (calibration.camera.empty()) return fmt::format("cam{}", number);
  std::string name = calibration.camera;
  std::ranges::replace_if(
      name, [](char c) { return is_control(c) || c == ' '; }, '_');
  return name;
}

std::string image_lines(const RigCamera& camera, std::size_t number) {
  const SE3 camera_from_rig = to_se3(camera.rig_from_camera).inverse();
  Eigen::Quaterniond q(camera_from_rig.rotation);
  q.normalize();
  if (q.w() < 0) q.coeffs() *= -1;
  std::string line = fmt::format("{}", number + 1);
  const Eigen::Vector3d& t = camera_from_rig.translation;
  for (const double x : {q.w(), q.x(), q.y(), q.z(), t.x(), t.y(), t.z()}) {
    line.append(" ").append(format_double(x + 0.0));
  }
  return fmt::format("{} {} {}\n\n", line, number + 1, word_for(camera.calibration, number));
}

constexpr std::string_view kCamerasHead =
    "# Camera list with one line of data per camera:\n"
    "#   CAMERA_ID, MODEL, WIDTH, HEIGHT, PARAMS[]\n";
constexpr std::string_view kImagesHead =
    "# Image list with two lines of data per image:\n"
    "#   IMAGE_ID, QW, QX, QY, QZ, TX, TY, TZ, CAMERA_ID, NAME\n"
    "#   POINTS2D[] as (X, Y, POINT3D_ID)\n";

}  // namespace

bool colmap_holds(std::string_view model) {
  constexpr std::array<std::string_view, 6> kHeld = {"pinhole",   "brown4",  "brown5",
                                                     "rational8", "fisheye", "fov"};
  return std::ranges::find(kHeld, model) != kHeld.end();
}

bool is_colmap_cameras(std::string_view content) {
  const auto is_name = [](std::string_view word) {
    return std::ranges::all_of(word, [](char c) { return (c >= 'A' && c <= 'Z') || c == '_'; });
  };
  for (std::size_t at = 0; at < content.size();) {
    const std::size_t end = std::min(content.find('\n', at), content.size());
    const std::string_view line = trim(content.substr(at, end - at));
    at = end + 1;
    if (line.empty() || line.starts_with('#')) continue;
    const auto words = words_of(line);
    return words.size() > 4 && to_id(words[0]) && is_name(words[1]) && parse_int(words[2]) &&
           parse_int(words[3]);
  }
  return false;
}

Result<Calibration> read_colmap_camera(std::string_view cameras) {
  auto all = read_cameras(cameras);
  if (!all) return tl::unexpected(all.error());
  if (all->size() == 1) return std::move(all->begin()->second);
  return make_error(ErrorCode::kUnsupported,
                    fmt::format("it holds {} cameras. Give one of them alone, or the folder of "
                                "the model where a rig is taken.",
                                all->size()));
}

Result<std::string> print_colmap_camera(const Calibration& calibration) {
  auto line = camera_line(calibration, 1);
  if (!line) return line;
  return std::string(kCamerasHead) + *line;
}

Result<Rig> read_colmap(std::string_view cameras, std::string_view images) {
  const auto lenses = read_cameras(cameras);
  if (!lenses) return tl::unexpected(lenses.error());
  auto all = read_images(images, *lenses);
  if (!all) return tl::unexpected(all.error());
  Rig rig;
  rig.cameras = *std::move(all);
  rig.world = world_of(rig.cameras);
  rig.is_metric = images.find(kInMetres) != std::string_view::npos;
  return rig;
}

Result<ColmapModel> print_colmap(const Rig& rig) {
  ColmapModel model;
  model.cameras = kCamerasHead;
  model.images = kImagesHead;
  if (rig.is_metric) model.images += std::string(kInMetres) + "\n";
  for (std::size_t n = 0; n < rig.cameras.size(); ++n) {
    const auto line = camera_line(rig.cameras[n].calibration, n + 1);
    if (!line) return tl::unexpected(line.error());
    model.cameras += *line;
    model.images += image_lines(rig.cameras[n], n);
  }
  return model;
}

}  // namespace calvin::io
