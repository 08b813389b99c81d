// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Reads places line by line.

#include "calvin/io/camera_places.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "calvin/core/file.hpp"
#include "calvin/core/text.hpp"
#include "calvin/core/utf8.hpp"
#include "calvin/io/file_text.hpp"
#include "calvin/io/rig_io.hpp"

namespace calvin {

namespace {

// Why a line is refused; empty where it is not.
std::string read_line(std::string_view line, std::vector<CameraPlace>& places) {
  constexpr double kFarthest = 1e6;  // m
  const auto words = words_of(line.substr(0, line.find('#')));
  if (words.empty()) return "";
  CameraPlace place;
  place.camera = words.front();
  bool is_place = words.size() == 1 + place.place.size();
  for (std::size_t k = 0; k < place.place.size() && is_place; ++k) {
    const auto number = parse_double(words[1 + k]);
    is_place = number && std::abs(*number) <= kFarthest;
    place.place[k] = number.value_or(0);
  }
  if (!is_place) return "is not 'name x y z', in metres";
  if (std::ranges::find(places, place.camera, &CameraPlace::camera) != places.end()) {
    return fmt::format("has '{}', which an earlier line has too", shortened(place.camera, 60));
  }
  places.push_back(std::move(place));
  return "";
}

// Where the cameras of a rig stand, in its frame.
Result<std::vector<CameraPlace>> places_of(const Result<Rig>& rig) {
  if (!rig) return tl::unexpected(rig.error());
  std::vector<CameraPlace> places;
  for (const RigCamera& camera : rig->cameras) {
    places.push_back({camera.calibration.camera, camera.rig_from_camera.translation});
  }
  return places;
}

}  // namespace

Result<std::vector<CameraPlace>> parse_camera_places(std::string_view content,
                                                     std::string_view name) {
  std::vector<CameraPlace> places;
  std::size_t number = 0;
  for (const std::string_view line : io::lines_of(content)) {
    ++number;
    if (const std::string why = read_line(line, places); !why.empty()) {
      return make_error(ErrorCode::kMalformed,
                        fmt::format("'{}' cannot be used as places of cameras: line {} {}.",
                                    shortened(name, 400), number, why));
    }
  }
  if (places.empty()) {
    return make_error(ErrorCode::kMalformed,
                      fmt::format("'{}' has no place of a camera: it takes a line 'name x y z' for "
                                  "each.",
                                  shortened(name, 400)));
  }
  return places;
}

Result<std::vector<CameraPlace>> read_camera_places(const std::filesystem::path& path) {
  if (is_rig_folder(path)) return places_of(read_rig(path));
  const auto content = read_file(path.string());
  if (!content) return tl::unexpected(content.error());
  if (is_rig(*content)) return places_of(parse_rig(*content, path.string()));
  return parse_camera_places(*content, path.string());
}

}  // namespace calvin
