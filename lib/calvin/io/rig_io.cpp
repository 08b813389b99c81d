// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Recognises the format of a rig's file by its content; the tables of readers and writers.

#include "calvin/io/rig_io.hpp"

#include <algorithm>
#include <array>
#include <span>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "calvin/camera/camera.hpp"
#include "calvin/core/file.hpp"
#include "calvin/core/text.hpp"
#include "calvin/core/utf8.hpp"
#include "calvin/io/calibration_formats.hpp"
#include "calvin/io/file_text.hpp"
#include "calvin/io/printable.hpp"
#include "calvin/io/rig_formats.hpp"
#include "calvin/io/text_document.hpp"

namespace calvin {

namespace {

using io::Node;

// A rig has several of these files.
Result<Rig> read_one_of_mrcal(const Node& root) {
  auto camera = io::read_mrcal(root);
  if (!camera) return tl::unexpected(camera.error());
  return make_error(ErrorCode::kUnsupported,
                    "it is one camera of mrcal's: give the folder that has the models of all");
}

struct Reader {
  bool (*claims)(const Node&);
  Result<Rig> (*read)(const Node&);
};
// In this order: the first that claims a document reads it, the first one what nobody claims.
constexpr std::array<Reader, 7> kReaders = {
    {{io::is_native_rig, io::read_native_rig},
     {io::is_kalibr, io::read_kalibr},
     {io::is_caliscope, io::read_caliscope},
     {io::is_mrcal, read_one_of_mrcal},
     {io::is_bouguet_stereo, io::read_bouguet_stereo},
     {io::is_opencv_stereo, io::read_opencv_stereo},
     {io::is_half_of_opencv_stereo, io::read_half_of_opencv_stereo}}};

// Of one file, or of a folder of them.
struct Writer {
  std::string_view format;
  Result<std::string> (*print)(const Rig&);
  Status (*write_folder)(const std::filesystem::path&, const Rig&);
};
constexpr std::array<Writer, 5> kWriters = {{{"calvin", io::print_native_rig, nullptr},
                                             {"kalibr", io::print_kalibr, nullptr},
                                             {"caliscope", io::print_caliscope, nullptr},
                                             {"mrcal", nullptr, io::write_mrcal_folder},
                                             {"colmap", nullptr, io::write_colmap_folder}}};

const Reader* reader_of(const Node& root) {
  const auto reader =
      std::ranges::find_if(kReaders, [&](const Reader& r) { return r.claims(root); });
  return reader == kReaders.end() ? nullptr : &*reader;
}

Result<Rig> rig_of(std::string_view content) {
  if (content.size() > kMaxRigBytes) {
    return make_error(
        ErrorCode::kMalformed,
        fmt::format("it is larger than the {} MiB that a rig may have", kMaxRigBytes >> 20));
  }
  if (io::is_colmap_cameras(content)) {
    return make_error(ErrorCode::kUnsupported,
                      "it is a part of a model of COLMAP's: give the folder that has cameras.txt "
                      "and images.txt");
  }
  const auto root = io::parse_text_document(content);
  if (!root) return tl::unexpected(root.error());
  if (root->kind != Node::Kind::kMap) {
    return make_error(ErrorCode::kMalformed, "it has none of the fields of a rig");
  }
  const Reader* reader = reader_of(*root);
  return reader != nullptr ? reader->read(*root) : io::read_native_rig(*root);
}

constexpr io::FileKind kRigFile = {
    "The text of a rig", "a rig",
    "Give a file that calvin-rig or calibrig has written, Kalibr's camchain, caliscope's "
    "camera_array.toml, OpenCV's stereo parameters in one file or two, Calib_Results_stereo of "
    "Bouguet's "
    "toolbox as text, or a folder of mrcal's or "
    "COLMAP's."};

Result<const Writer*> find_writer(std::string_view format) {
  const auto writer =
      std::ranges::find_if(kWriters, [&](const Writer& w) { return w.format == format; });
  if (writer != kWriters.end()) return &*writer;
  return make_error(ErrorCode::kInvalidArgument,
                    fmt::format("There is no rig format '{}'. Known formats: {}.",
                                shortened(format, 64), join(rig_formats(), ", ")));
}

// Whether the content is a document that `claims` takes. Only one with any of the words is parsed
// for this, which most files are not.
bool is_document(std::string_view content, std::span<const std::string_view> words,
                 bool (*claims)(const Node&)) noexcept {
  const bool may_be =
      content.size() <= kMaxRigBytes && std::ranges::any_of(words, [&](std::string_view word) {
        return content.find(word) != std::string_view::npos;
      });
  if (!may_be) return false;
  try {
    const auto root = io::parse_text_document(content);
    return root && claims(*root);
  } catch (const std::exception&) {
    return false;
  }
}

Status check(const Rig& rig) {
  for (const RigCamera& camera : rig.cameras) {
    if (const auto good = Camera::make(camera.calibration); !good) {
      return tl::unexpected(good.error());
    }
  }
  return io::check_printable(rig);
}

}  // namespace

Result<Rig> parse_rig(std::string_view content, std::string_view name) {
  return io::parse_as<Rig>(kRigFile, name, rig_of, content);
}

bool is_rig(std::string_view content) noexcept {
  constexpr std::array<std::string_view, 3> kWords = {"calvin-rig", "T_cn_cnm1", "distortions"};
  return is_document(content, kWords, [](const Node& root) {
    return io::is_native_rig(root) || io::is_kalibr(root) || io::is_caliscope_rig(root);
  });
}

bool is_stereo_file(std::string_view content) noexcept {
  constexpr std::array<std::string_view, 2> kWords = {"M2", "fc_right"};
  return is_document(content, kWords, [](const Node& root) {
    return io::is_bouguet_stereo(root) || io::is_opencv_stereo(root) ||
           io::is_half_of_opencv_stereo(root);
  });
}

Result<Rig> read_rig(const std::filesystem::path& path) {
  std::error_code none;
  if (std::filesystem::is_directory(path, none)) {
    auto rig = io::read_rig_folder(path);
    const bool is_of_system =
        !rig && (rig.error().code == ErrorCode::kNotFound || rig.error().code == ErrorCode::kIo);
    if (!rig && !is_of_system) {
      rig.error() = io::explained(kRigFile, path.string(), std::move(rig.error()));
    }
    return rig;
  }
  const auto files = files_of_rig(path);
  const auto content = read_file(files.front().string(), kMaxRigBytes);
  if (!content) return tl::unexpected(content.error());
  if (files.size() == 1) return parse_rig(*content, path.string());
  const auto other = read_file(files.back().string(), kMaxRigBytes);
  if (!other) return tl::unexpected(other.error());
  if (!io::is_half_of_opencv_stereo(*content)) return parse_rig(*content, path.string());
  auto rig = io::join_opencv_stereo(*content, *other);
  if (!rig) rig.error() = io::explained(kRigFile, path.string(), std::move(rig.error()));
  return rig;
}

Result<std::string> print_rig(const Rig& rig, std::string_view format) {
  const auto writer = find_writer(format);
  if (!writer) return tl::unexpected(writer.error());
  if ((*writer)->print == nullptr) {
    return make_error(ErrorCode::kInvalidArgument,
                      fmt::format("A rig of the format {} is a folder of files, and no text.",
                                  (*writer)->format));
  }
  if (const Status good = check(rig); !good) return tl::unexpected(good.error());
  try {
    return (*writer)->print(rig);
  } catch (const std::exception& exception) {
    return make_error(ErrorCode::kInvalidArgument,
                      fmt::format("The rig cannot be written: {}.", exception.what()));
  }
}

std::vector<std::string_view> rig_formats() {
  std::vector<std::string_view> formats;
  for (const Writer& writer : kWriters) formats.push_back(writer.format);
  return formats;
}

Status write_rig(const std::filesystem::path& path, const Rig& rig, std::string_view format) {
  const auto writer = find_writer(format);
  if (writer && (*writer)->write_folder != nullptr) {
    if (Status good = check(rig); !good) return good;
    return (*writer)->write_folder(path, rig);
  }
  const auto printed = print_rig(rig, format);
  if (!printed) return tl::unexpected(printed.error());
  return write_file(path.string(), *printed);
}

}  // namespace calvin
