// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Rigs that are several files.

#include <algorithm>
#include <set>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "calvin/core/file.hpp"
#include "calvin/core/text.hpp"
#include "calvin/core/utf8.hpp"
#include "calvin/io/colmap.hpp"
#include "calvin/io/rig_fields.hpp"
#include "calvin/io/rig_formats.hpp"
#include "calvin/io/rig_io.hpp"
#include "calvin/io/text_document.hpp"

namespace calvin::io {

namespace {

namespace fs = std::filesystem;

constexpr std::string_view kModel = ".cameramodel";
constexpr std::size_t kMostBytes = std::size_t{64} << 20;  // of a file: mrcal's hold their data

Result<std::vector<fs::path>> models_in(const fs::path& folder) {
  std::vector<fs::path> models;
  std::error_code error;
  for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
    if (at->path().extension() == kModel) models.push_back(at->path());
  }
  if (error) {
    return make_error(ErrorCode::kIo,
                      fmt::format("The folder '{}' cannot be read: {}.",
                                  shortened(folder.string(), 400), error.message()));
  }
  std::ranges::sort(models);
  return models;
}

Result<RigCamera> read_model(const fs::path& path) {
  const auto content = read_file(path.string(), kMostBytes);
  if (!content) return tl::unexpected(content.error());
  const auto root = parse_text_document(*content);
  Result<RigCamera> camera;
  if (!root) {
    camera = tl::unexpected(root.error());
  } else if (!is_mrcal(*root)) {
    camera = make_error(ErrorCode::kMalformed, "it has no intrinsics and imagersize");
  } else {
    camera = read_mrcal(*root);
  }
  if (!camera) {
    return make_error(camera.error().code,
                      fmt::format("of its file '{}', {}", shortened(path.filename().string(), 80),
                                  camera.error().message));
  }
  camera->calibration.camera = path.stem().string();
  return camera;
}

Result<Rig> read_models(const std::vector<fs::path>& models) {
  if (models.size() > kMostRigCameras) {
    return make_error(ErrorCode::kMalformed,
                      fmt::format("it has {} models; no rig has more than {} cameras",
                                  models.size(), kMostRigCameras));
  }
  Rig rig;
  for (const fs::path& model : models) {
    auto camera = read_model(model);
    if (!camera) return tl::unexpected(camera.error());
    rig.cameras.push_back(*std::move(camera));
  }
  rig.world = world_of(rig.cameras);
  return rig;
}

// The name of the other one of the files that OpenCV's sample stereo_calib writes; empty for any
// other name.
fs::path beside(const fs::path& path) {
  constexpr std::string_view kNames[] = {"intrinsics", "extrinsics"};
  std::string name = path.filename().string();
  for (const std::size_t own : {0, 1}) {
    const auto at = name.rfind(kNames[own]);
    if (at == std::string::npos) continue;
    return path.parent_path() / name.replace(at, kNames[own].size(), kNames[1 - own]);
  }
  return {};
}

bool is_there(const fs::path& path) {
  std::error_code none;
  return !path.empty() && fs::is_regular_file(path, none);
}

// What a path that is no folder names.
std::vector<fs::path> files_of(const fs::path& path) {
  const fs::path other = beside(path);
  if (is_there(path)) return is_there(other) ? std::vector{path, other} : std::vector{path};
  const std::string text = path.string();
  for (auto at = text.find(','); at != std::string::npos; at = text.find(',', at + 1)) {
    const fs::path one = text.substr(0, at);
    const fs::path two = text.substr(at + 1);
    if (is_there(one) && is_there(two)) return {one, two};
  }
  return {path};
}

Status make_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (!error && fs::is_directory(folder, error)) return {};
  return make_error(
      ErrorCode::kIo,
      fmt::format("'{}' cannot be a folder of files: {}. Name another one.",
                  shortened(folder.string(), 400), error ? error.message() : "it is a file"));
}

Result<std::vector<std::string>> file_names(const Rig& rig) {
  std::vector<std::string> names;
  for (const RigCamera& camera : rig.cameras) {
    std::string name = camera.calibration.camera;
    std::ranges::replace_if(
        name, [](char c) { return c == '/' || is_control(c); }, '_');
    const bool is_good = !name.empty() && !name.starts_with('.');
    if (!is_good || std::ranges::count(names, name) > 0) {
      return make_error(ErrorCode::kInvalidArgument,
                        fmt::format("mrcal's files are called after the cameras, and '{}' is no "
                                    "name of one, or is there twice: rename the camera.",
                                    shortened(camera.calibration.camera, 64)));
    }
    names.push_back(std::move(name));
  }
  return names;
}

}  // namespace
}  // namespace calvin::io

namespace calvin {

bool is_rig_folder(const std::filesystem::path& path) noexcept {
  std::error_code none;
  return std::filesystem::is_directory(path, none) && !files_of_rig(path).empty();
}

std::vector<std::filesystem::path> files_of_rig(const std::filesystem::path& path) {
  std::error_code none;
  if (!std::filesystem::is_directory(path, none)) return io::files_of(path);
  if (std::filesystem::exists(path / "images.txt", none)) {
    return {path / "cameras.txt", path / "images.txt"};
  }
  auto models = io::models_in(path).value_or(std::vector<std::filesystem::path>());
  if (!models.empty()) return models;
  for (const char* name :
       {"intrinsics.yml", "intrinsics.yaml", "intrinsics.xml", "intrinsics.json"}) {
    auto files = io::files_of(path / name);
    if (files.size() == 2) return files;
  }
  return {};
}

}  // namespace calvin

namespace calvin::io {

Result<Rig> read_rig_folder(const fs::path& folder) {
  std::error_code none;
  if (fs::exists(folder / "images.txt", none)) {
    const auto cameras = read_file((folder / "cameras.txt").string(), kMostBytes);
    if (!cameras) return tl::unexpected(cameras.error());
    const auto images = read_file((folder / "images.txt").string(), kMostBytes);
    if (!images) return tl::unexpected(images.error());
    return read_colmap(*cameras, *images);
  }
  const auto models = models_in(folder);
  if (!models) return tl::unexpected(models.error());
  if (!models->empty()) return read_models(*models);
  if (const auto stereo = files_of_rig(folder); stereo.size() == 2) {
    const auto one = read_file(stereo[0].string(), kMostBytes);
    if (!one) return tl::unexpected(one.error());
    const auto other = read_file(stereo[1].string(), kMostBytes);
    if (!other) return tl::unexpected(other.error());
    return join_opencv_stereo(*one, *other);
  }
  return make_error(ErrorCode::kMalformed,
                    "the folder has neither models of mrcal's (*.cameramodel) nor cameras.txt and "
                    "images.txt of COLMAP's nor intrinsics.yml and extrinsics.yml of OpenCV's");
}

Status write_mrcal_folder(const fs::path& folder, const Rig& rig) {
  const auto names = file_names(rig);
  if (!names) return tl::unexpected<Error>(names.error());
  std::vector<std::pair<fs::path, std::string>> files;
  std::set<fs::path> own;
  for (std::size_t n = 0; n < rig.cameras.size(); ++n) {
    auto text = print_mrcal(rig.cameras[n]);
    if (!text) return tl::unexpected<Error>(text.error());
    files.emplace_back(folder / ((*names)[n] + std::string(kModel)), *std::move(text));
    own.insert(files.back().first.filename());
  }
  if (Status made = make_folder(folder); !made) return made;
  const auto there = models_in(folder);
  if (!there) return tl::unexpected<Error>(there.error());
  for (const fs::path& model : *there) {
    if (own.contains(model.filename())) continue;
    return make_error(
        ErrorCode::kInvalidArgument,
        fmt::format("The folder '{}' has '{}', the model of a camera that is not in "
                    "the rig, and would be taken for one: name an empty folder.",
                    shortened(folder.string(), 400), shortened(model.filename().string(), 80)));
  }
  for (const auto& [path, text] : files) {
    if (Status written = write_file(path.string(), text); !written) return written;
  }
  return {};
}

Status write_colmap_folder(const fs::path& folder, const Rig& rig) {
  const auto model = print_colmap(rig);
  if (!model) return tl::unexpected<Error>(model.error());
  if (Status made = make_folder(folder); !made) return made;
  // COLMAP reads a model of three files only.
  constexpr std::string_view kPoints =
      "# 3D point list with one line of data per point:\n"
      "#   POINT3D_ID, X, Y, Z, R, G, B, ERROR, TRACK[] as (IMAGE_ID, POINT2D_IDX)\n";
  const std::pair<const char*, std::string_view> files[] = {
      {"cameras.txt", model->cameras}, {"images.txt", model->images}, {"points3D.txt", kPoints}};
  for (const auto& [name, text] : files) {
    if (Status written = write_file((folder / name).string(), text); !written) return written;
  }
  return {};
}

}  // namespace calvin::io
