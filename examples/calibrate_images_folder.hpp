// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The pictures of a folder: those that can be decoded, are of one size and of one camera.
#pragma once

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gst/gst.h>
#include <gst/tag/tag.h>

#include "calibrate_images_decode.hpp"
#include "calibrate_images_own.hpp"
#include "calvin/core/image.hpp"
#include "calvin/core/result.hpp"

namespace calibrate_images {

struct Picture {
  std::filesystem::path path;
  calvin::ImageSize size;
  [[nodiscard]] std::string name() const { return path.filename().string(); }
};

// The pictures of a folder, by name, with their sizes.
struct Folder {
  std::vector<Picture> pictures;
  std::size_t files = 0;  // those that were left out, too, but for what is no picture at all
};

inline void leave_out(const std::filesystem::path& file, const std::string& why) {
  fmt::print(stderr, "{}: left out, {}\n", file.filename().string(), why);
}

// The size of a picture that GStreamer decodes, or why there is none and what to do.
inline calvin::Result<calvin::ImageSize> size_of(const std::filesystem::path& file) {
  const auto fail = [](std::string why) {
    return calvin::make_error(calvin::ErrorCode::kIo, std::move(why));
  };
  std::error_code ignored;
  const std::filesystem::file_status status = std::filesystem::status(file, ignored);
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status)) {
    return fail("it is a device or a FIFO: take it away.");  // which may never be written
  }
  if (const std::ifstream stream(file); !stream) {
    return fail(fmt::format("it cannot be opened ({}): make it readable, or take it away.",
                            std::generic_category().message(errno)));
  }
  if (is_own(file)) {
    return fail("this program made it from another picture, in an earlier run.");
  }
  const auto sample = decode(file);
  if (!sample) return tl::unexpected<calvin::Error>(sample.error());
  const GstStructure* caps = gst_caps_get_structure(gst_sample_get_caps(sample->get()), 0);
  calvin::ImageSize size;
  gst_structure_get(caps, "width", G_TYPE_INT, &size.width, "height", G_TYPE_INT, &size.height,
                    nullptr);
  return size;
}

// Lets GdkPixbuf decode what no other element does, as TIFF: GStreamer does not try it by itself.
inline void allow_gdk_pixbuf() {
  g_autoptr(GstPluginFeature) decoder =
      gst_registry_lookup_feature(gst_registry_get(), "gdkpixbufdec");
  if (decoder != nullptr) gst_plugin_feature_set_rank(decoder, GST_RANK_MARGINAL);
}

// Names every file that it leaves out; those that match one of `unwanted` ("right*") are.
inline Folder find_pictures(const std::filesystem::path& path,
                            const std::vector<std::string>& unwanted) {
  Folder folder;
  allow_gdk_pixbuf();
  std::vector<std::filesystem::path> files;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(path, error)) {
    std::error_code ignored;  // a link that leads nowhere is no folder
    if (!entry.is_directory(ignored)) files.push_back(std::filesystem::absolute(entry.path()));
  }
  if (error) fmt::print(stderr, "{}: {}\n", path.string(), error.message());
  std::sort(files.begin(), files.end());
  folder.files = files.size();
  const auto is_none = [](const calvin::Error& why) {
    return why.code == calvin::ErrorCode::kUnsupported;
  };
  for (const std::filesystem::path& file : files) {
    const std::string name = file.filename().string();
    if (std::any_of(unwanted.begin(), unwanted.end(), [&](const std::string& pattern) {
          return g_pattern_match_simple(pattern.c_str(), name.c_str()) != FALSE;
        })) {
      leave_out(file, "as you asked for.");
    } else if (const auto size = size_of(file)) {
      folder.pictures.push_back({file, *size});
    } else {
      leave_out(file, size.error().message);
      if (is_none(size.error())) --folder.files;
    }
  }
  return folder;
}

// One camera has one picture size: keeps the most frequent one and names the rest. Fails where no
// size has more than half of the pictures.
inline calvin::Status keep_one_size(std::vector<Picture>& pictures) {
  std::map<std::pair<int, int>, std::size_t> count;
  for (const Picture& p : pictures) ++count[{p.size.width, p.size.height}];
  const auto most = std::max_element(
      count.begin(), count.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  if (2 * most->second <= pictures.size()) {
    std::string sizes;
    for (const auto& [size, pictures_of] : count) {
      sizes += fmt::format("{}{} of {}x{}", sizes.empty() ? "" : ", ", pictures_of, size.first,
                           size.second);
    }
    return calvin::make_error(
        calvin::ErrorCode::kInvalidArgument,
        fmt::format("The pictures are of several sizes ({}), and a camera is calibrated at one: "
                    "put those of one size into a folder, or name the others with --leave-out.",
                    sizes));
  }
  std::erase_if(pictures, [&](const Picture& p) {
    const bool other = std::pair(p.size.width, p.size.height) != most->first;
    if (other) {
      leave_out(p.path,
                fmt::format("it is {}x{} and most are {}x{}: a camera is calibrated at one "
                            "size, put it into a folder of its own.",
                            p.size.width, p.size.height, most->first.first, most->first.second));
    }
    return other;
  });
  return {};
}

// What a picture says of its camera by itself: maker, model and focal length of its EXIF, or
// nothing.
inline std::string exif_camera(const std::filesystem::path& file) {
  constexpr std::size_t kHead = 1 << 16;  // EXIF is at the beginning
  std::ifstream stream(file, std::ios::binary);
  std::string head(kHead, '\0');
  stream.read(head.data(), static_cast<std::streamsize>(kHead));
  head.resize(static_cast<std::size_t>(std::max<std::streamsize>(stream.gcount(), 0)));
  constexpr std::string_view kMark("Exif\0\0", 6);
  const std::size_t at = head.find(kMark);
  if (at == std::string::npos) return "";
  const std::string exif = head.substr(at + kMark.size());
  if (exif.size() < 8) return "";
  g_autoptr(GstBuffer) buffer = gst_buffer_new_memdup(exif.data(), exif.size());
  g_autoptr(GstTagList) tags = gst_tag_list_from_exif_buffer_with_tiff_header(buffer);
  if (tags == nullptr) return "";
  std::string camera;
  for (const char* tag : {GST_TAG_DEVICE_MANUFACTURER, GST_TAG_DEVICE_MODEL}) {
    g_autofree char* text = nullptr;
    if (gst_tag_list_get_string(tags, tag, &text)) camera += fmt::format("{} ", text);
  }
  double focal = 0;
  if (gst_tag_list_get_double(tags, GST_TAG_CAPTURING_FOCAL_LENGTH, &focal)) {
    camera += fmt::format("at {:g} mm ", focal);
  }
  if (!camera.empty()) camera.pop_back();
  return camera;
}

// "left" of "left01.jpg", as stereo cameras and their programs name pictures.
inline std::string series(const Picture& picture) {
  std::string stem = picture.path.stem().string();
  while (!stem.empty() && std::strchr("0123456789_-. ", stem.back()) != nullptr) stem.pop_back();
  return stem;
}

inline constexpr std::size_t kSeries = 3;  // pictures; fewer have like names by chance

// Fails where the pictures are of several cameras, by their EXIF or else by two series of names.
inline calvin::Status check_one_camera(const std::vector<Picture>& pictures) {
  std::map<std::string, std::size_t> cameras;
  std::map<std::string, std::size_t> names;
  for (const Picture& picture : pictures) {
    if (const std::string camera = exif_camera(picture.path); !camera.empty()) ++cameras[camera];
    ++names[series(picture)];
  }
  const bool by_exif = !cameras.empty();
  if (!by_exif) {
    std::erase_if(names, [](const auto& of) { return of.second < kSeries; });
    for (const auto& [name, count] : names) cameras[fmt::format("'{}*'", name)] = count;
  }
  if (cameras.size() < 2) return {};
  std::string list;
  for (const auto& [name, count] : cameras) {
    list += fmt::format("{}{} of {}", list.empty() ? "" : ", ", count, name);
  }
  return calvin::make_error(
      calvin::ErrorCode::kInvalidArgument,
      fmt::format("The pictures seem to be of several cameras, by {}: {}. Each camera has a "
                  "calibration of its own: leave the others out (--leave-out 'right*'), or say "
                  "--one-camera where it is one.",
                  by_exif ? "what they say of them" : "their names", list));
}

}  // namespace calibrate_images
