// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Recognises the format of a calibration file by its content and hands the content to the reader of
// that format; the table of all writers.

#include "calvin/io/calibration_io.hpp"

#include <algorithm>
#include <array>
#include <iterator>

#include <fmt/format.h>

#include "calvin/camera/camera.hpp"
#include "calvin/core/file.hpp"
#include "calvin/core/text.hpp"
#include "calvin/core/utf8.hpp"
#include "calvin/io/calibration_formats.hpp"
#include "calvin/io/file_text.hpp"
#include "calvin/io/printable.hpp"
#include "calvin/io/text_document.hpp"
#include "calvin_config.h"

namespace calvin {

namespace {

using io::Node;

struct Reader {
  bool (*claims)(const Node&);
  Result<Calibration> (*read)(const Node&);
};
// In this order: the first that claims a document reads it.
constexpr std::array<Reader, 7> kReaders = {{{io::is_native, io::read_native},
                                             {io::is_mrcal, io::read_mrcal_camera},
                                             {io::is_ros, io::read_ros},
                                             {io::is_kalibr, io::read_kalibr_camera},
                                             {io::is_caliscope, io::read_caliscope_camera},
                                             {io::is_bouguet, io::read_bouguet_camera},
                                             {io::is_opencv, io::read_opencv}}};

struct Writer {
  std::string_view format;
  Result<std::string> (*print)(const Calibration&);
  bool (*holds)(std::string_view model);
};
constexpr std::array<Writer, 8> kWriters = {
    {{"calvin", io::print_native, [](std::string_view) { return true; }},
     {"opencv-yaml", io::print_opencv_yaml, io::opencv_holds},
     {"opencv-xml", io::print_opencv_xml, io::opencv_holds},
     {"opencv-json", io::print_opencv_json, io::opencv_holds},
     {"ros", io::print_ros, io::ros_holds},
     {"kalibr", io::print_kalibr_camera, io::kalibr_holds},
     {"mrcal", io::print_mrcal_camera, io::mrcal_holds},
     {"colmap", io::print_colmap_camera, io::colmap_holds}}};

constexpr std::string_view kKnown =
    CALVIN_HAVE_FORMATS
        ? "Give a calibration in the native JSON, OpenCV's YAML, XML or JSON, ROS's camera_info, "
          "Kalibr's camchain, mrcal's cameramodel, COLMAP's cameras.txt or the Calib_Results.m of "
          "Bouguet's toolbox, or calibrate again."
        : "Give a calibration in the native JSON, OpenCV's JSON, mrcal's cameramodel, COLMAP's "
          "cameras.txt or the Calib_Results.m of Bouguet's toolbox, or calibrate again.";

Result<const Writer*> find_writer(std::string_view format) {
  const auto writer = std::find_if(kWriters.begin(), kWriters.end(),
                                   [&](const Writer& w) { return w.format == format; });
  if (writer != kWriters.end()) return &*writer;
  return make_error(ErrorCode::kInvalidArgument,
                    fmt::format("There is no calibration format '{}'. Known formats: {}.", format,
                                join(calibration_formats(), ", ")));
}

tl::unexpected<Error> not_held(const Writer& writer, std::string_view model) {
  std::vector<std::string_view> held;
  std::copy_if(model_names().begin(), model_names().end(), std::back_inserter(held), writer.holds);
  return make_error(ErrorCode::kUnsupported,
                    fmt::format("The file format {} has no camera model like {}. Write the format "
                                "calvin, which holds every model, or calibrate with one of {}.",
                                writer.format, model, join(held, ", ")));
}

// Everything but the image size, which an OpenCV file need not have.
Status check(Calibration calibration) {
  if (calibration.image_size == ImageSize{}) calibration.image_size = {1, 1};
  const auto camera = Camera::make(calibration);
  if (!camera) return tl::unexpected(camera.error());
  return {};
}

Result<Calibration> parse_text(std::string_view content) {
  if (content.size() > kMaxCalibrationBytes) {
    return make_error(ErrorCode::kMalformed,
                      fmt::format("it is larger than the {} MiB that a calibration may have",
                                  kMaxCalibrationBytes >> 20));
  }
  if (io::is_colmap_cameras(content)) return io::read_colmap_camera(content);
  const auto root = io::parse_text_document(content);
  if (!root) return tl::unexpected(root.error());
  const auto reader = std::find_if(kReaders.begin(), kReaders.end(),
                                   [&](const Reader& r) { return r.claims(*root); });
  if (reader == kReaders.end()) {
    return make_error(ErrorCode::kMalformed, "it has none of the fields of a calibration");
  }
  auto calibration = reader->read(*root);
  if (!calibration) return calibration;
  if (const auto status = check(*calibration); !status) return tl::unexpected(status.error());
  return calibration;
}

constexpr io::FileKind kKind = {"The calibration text", "a calibration", kKnown};

}  // namespace

Result<Calibration> parse_calibration(std::string_view content, std::string_view name) {
  return io::parse_as<Calibration>(kKind, name, parse_text, content);
}

Result<Calibration> read_calibration(const std::filesystem::path& path) {
  auto content = read_file(path.string(), kMaxCalibrationBytes);
  if (content) return parse_calibration(*content, path.string());
  Error error = std::move(content.error());
  error.message = shortened(error.message, 400) + " " + std::string(kKnown);
  return tl::unexpected(std::move(error));
}

Result<std::string> print_calibration(const Calibration& calibration, std::string_view format) {
  const auto writer = find_writer(format);
  if (!writer) return tl::unexpected(writer.error());
  if (const auto status = check(calibration); !status) return tl::unexpected(status.error());
  if (const auto status = io::check_printable(calibration); !status) {
    return tl::unexpected(status.error());
  }
  try {
    auto text = (*writer)->print(calibration);
    const bool held = text || text.error().code != ErrorCode::kUnsupported;
    if (!held) return not_held(**writer, calibration.model);
    return text;
  } catch (const std::exception& exception) {
    return make_error(
        ErrorCode::kInvalidArgument,
        fmt::format("The calibration cannot be written as {}: {}.", format, exception.what()));
  }
}

Status can_hold(std::string_view format, std::string_view model) {
  const auto writer = find_writer(format);
  if (!writer) return tl::unexpected(writer.error());
  if (!(*writer)->holds(model)) return not_held(**writer, model);
  return {};
}

Status write_calibration(const std::filesystem::path& path, const Calibration& calibration,
                         std::string_view format) {
  const auto text = print_calibration(calibration, format);
  if (!text) return tl::unexpected(text.error());
  return write_file(path.string(), *text);
}

Status can_write(const std::filesystem::path& path) { return check_writable(path.string()); }

std::vector<std::string_view> calibration_formats() {
  std::vector<std::string_view> formats;
  for (const Writer& writer : kWriters) formats.push_back(writer.format);
  return formats;
}

}  // namespace calvin
