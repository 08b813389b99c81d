// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The promises of each parser: what it accepts is sound and survives being written and read again.

#include "targets.hpp"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>

#include <Eigen/LU>

#include "calvin/camera/camera.hpp"
#include "calvin/camera/zoom_interpolation.hpp"
#include "calvin/core/file.hpp"
#include "calvin/geometry/se3.hpp"
#include "calvin/io/blueccal.hpp"
#include "calvin/io/board_names.hpp"
#include "calvin/io/calibration_io.hpp"
#include "calvin/io/camera_places.hpp"
#include "calvin/io/key_list.hpp"
#include "calvin/io/observations.hpp"
#include "calvin/io/point_rows.hpp"
#include "calvin/io/rig_io.hpp"
#include "calvin/io/robot_poses.hpp"
#include "calvin/io/settings.hpp"
#include "calvin/io/zoom_io.hpp"
#include "calvin/session/files/calibration_files.hpp"
#include "calvin/solve/solve.hpp"
#include "calvin_config.h"
#include "common/metas.hpp"

namespace calvin::fuzz {

namespace {

void require(bool kept, const char* promise) {
  if (kept) return;
  std::fprintf(stderr, "broken: %s\n", promise);
  std::abort();
}

// An error tells the user something; a calibration makes a camera.
void require_sound(const Result<Calibration>& parsed) {
  if (!parsed) {
    require(!parsed.error().message.empty(), "an error has a message");
    return;
  }
  for (const Parameter& p : parsed->parameters) {
    require(std::isfinite(p.value), "a parameter is a finite number");
  }
  Calibration sized = *parsed;
  if (sized.image_size.width == 0) sized.image_size = {640, 480};
  require(Camera::make(sized).has_value(), "what is parsed makes a camera");
}

// What is parsed, prints and parses again to the same: all of it in the native format, what the
// format can hold in the others.
void require_round_trip(const Calibration& calibration) {
  for (const std::string_view format : calibration_formats()) {
    const auto printed = print_calibration(calibration, format);
    if (!printed) {
      require(!printed.error().message.empty(), "a refusal to print has a message");
      continue;
    }
    const auto again = parse_calibration(*printed);
    // Every build writes YAML and XML, though not every one can read them.
    if (!CALVIN_HAVE_FORMATS && !printed->starts_with('{')) {
      require(!again && again.error().code == ErrorCode::kUnsupported, "such a build says so");
      continue;
    }
    require(again.has_value(), "what is printed can be parsed");
    // Kalibr has another alpha for one of the lenses, and COLMAP another origin of pixels.
    const bool is_exact = format != "colmap" && (format != "kalibr" || calibration.model != "ucm");
    const auto twice = print_calibration(*again, format);
    require(twice.has_value(), "what is parsed again prints");
    require(!is_exact || *twice == *printed, "what is parsed again prints the same");
    for (const Parameter& p : calibration.parameters) {
      const Parameter* same = again->find(p.name);
      const double change = same == nullptr ? p.value : same->value - p.value;
      require(std::abs(change) <= (is_exact ? 0 : 1e-9 * std::max(1.0, std::abs(p.value))),
              "no number changes");
    }
  }
}

void calibration(std::string_view bytes) {
  const auto parsed = parse_calibration(bytes, "fuzzed");
  require_sound(parsed);
  if (parsed) require_round_trip(*parsed);
  // The same as the property of an element, unless it is taken for a path.
  if (!is_calibration_path(bytes)) require_sound(parse_calibration_setting(bytes));
}

void key_list(std::string_view bytes) {
  const auto parsed = parse_key_list(bytes);
  require_sound(parsed);
  if (parsed && parsed->image_size.width > 0) require_round_trip(*parsed);
}

void require_sound(const Board& board) {
  const double side = board.cell_size(board.ids().front());
  require(side > 0 && std::isfinite(side), "a square has a size");
  require(board.point_count() > 0, "a board has points");
  const auto again = parse_board(board.text());
  require(again.has_value() && again->text() == board.text(), "the text of a board names it");
}

void boards(std::string_view bytes) {
  // A '#' is a file, which board_names takes.
  if (bytes.find('#') != std::string_view::npos) return;
  const auto parsed = parse_boards(bytes);
  require(parsed || !parsed.error().message.empty(), "an error has a message");
  if (!parsed) return;
  for (const Board& board : *parsed) require_sound(board);
}

// A file of this process, removed at its end.
class ScratchFile {
 public:
  ScratchFile()
      : path_(std::filesystem::temp_directory_path() /
              ("calvin-fuzz-" + std::to_string(getpid()) + ".json")) {}
  ScratchFile(const ScratchFile&) = delete;
  ScratchFile& operator=(const ScratchFile&) = delete;
  ~ScratchFile() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  [[nodiscard]] std::string path() const { return path_.string(); }

 private:
  std::filesystem::path path_;
};

void board_names(std::string_view bytes) {
  static const ScratchFile kFile;
  const std::string path = kFile.path();
  require(write_file(path, bytes).has_value(), "the scratch file can be written");
  const auto before = list_boards(path);
  require(before || !before.error().message.empty(), "an error has a message");
  const Status added = add_board(path, "added", "checkerboard:5x4:1cm");
  if (!added) {
    require(!added.error().message.empty(), "an error has a message");
    require(*read_file(path) == bytes, "a file that is refused is left alone");
    return;
  }
  const auto after = list_boards(path);
  require(after.has_value(), "a file that was written can be read");
  require(parse_boards(path + "#added").has_value(), "a board that was added is found");
  for (const NamedBoard& board : *after) {
    if (board.measured_by == 0) continue;
    const auto measured = read_measurement(path + "#" + board.name);
    require(measured || !measured.error().message.empty(), "an error has a message");
    break;
  }
  if (!before) return;
  for (const NamedBoard& board : *before) {
    bool kept = board.name == "added";
    for (const NamedBoard& now : *after) kept |= now.name == board.name && now.text == board.text;
    require(kept, "adding a board keeps the others");
  }
}

void exports(std::string_view bytes) {
  const auto files = parse_calibration_files("", std::string(bytes));
  require(files || !files.error().message.empty(), "an error has a message");
  if (!files) return;
  for (const CalibrationFile& file : *files) {
    require(!file.format.empty() && !file.path.empty(), "an export has a format and a path");
  }
}

// The structure of the meta and of the event, whoever made it, and what the solver says to it.
void observations(std::string_view bytes) {
  g_autoptr(GstStructure) structure =
      gst_structure_from_string(std::string(bytes).c_str(), nullptr);
  if (structure == nullptr) return;
  const auto found = gst::observations_from_structure(structure);
  for (const Observation& o : found) {
    require(o.ids.size() == o.uv.size() && o.ids.size() == o.sigma.size(), "lists are of a length");
    const auto board = parse_board(o.board);
    if (board) (void)check({o, *board}, o.image_size);
  }
  g_autoptr(GstStructure) again = gst::observations_to_structure(found);
  const auto same = gst::observations_from_structure(again);
  require(same.size() == found.size(), "no observation is lost");
  for (std::size_t i = 0; i < same.size(); ++i) {
    require(same[i].ids == found[i].ids && same[i].board == found[i].board, "nothing changes");
  }
}

void require_sound(const std::vector<Observation>& observations) {
  for (const Observation& o : observations) {
    require(o.ids.size() == o.uv.size() && o.ids.size() == o.sigma.size(), "lists are of a length");
    for (std::size_t i = 0; i < o.ids.size(); ++i) {
      require(o.ids[i] >= 0 && std::isfinite(o.uv[i].u) && std::isfinite(o.uv[i].v) &&
                  o.sigma[i] > 0 && std::isfinite(o.sigma[i]),
              "a corner has an id, a place and a sigma");
    }
  }
}

void observation_file(std::string_view bytes) {
  const auto parsed = parse_observations(bytes, "fuzzed");
  require(parsed || !parsed.error().message.empty(), "an error has a message");
  if (parsed) {
    require_sound(parsed->observations);
    require(parsed->whole_bytes <= bytes.size(), "no more is whole than there is");
    const auto cut = parse_observations(bytes.substr(0, parsed->whole_bytes));
    require(cut && cut->whole_bytes == parsed->whole_bytes, "what is whole is read alone");
    const auto printed = print_observations(*parsed);
    require(printed.has_value(), "what was read can be printed");
    const auto again = parse_observations(*printed);
    require(again.has_value(), "what is printed can be parsed");
    require(print_observations(*again) == *printed, "what is parsed again prints the same");
  }
  constexpr std::string_view kBoard = "checkerboard:3x2:10mm";
  const auto corners = parse_corners_vnl(bytes, kBoard, {640, 480}, "fuzzed");
  require(corners || !corners.error().message.empty(), "an error has a message");
  if (!corners) return;
  require_sound(*corners);
  const auto printed = print_corners_vnl(*corners);
  require(printed.has_value(), "corners that were read can be printed");
  const auto again = parse_corners_vnl(*printed, kBoard, {640, 480});
  require(again && again->size() == corners->size(), "no picture is lost");
}

// The four files of BlueCCal, a line "--" between each two; and places of cameras.
void light_text(std::string_view bytes) {
  constexpr std::string_view kBetween = "\n--\n";
  std::string_view parts[4];
  std::string_view left = bytes;
  for (std::string_view& part : parts) {
    const auto end = left.find(kBetween);
    part = left.substr(0, end);
    left = end == std::string_view::npos ? "" : left.substr(end + kBetween.size());
  }
  const auto files = parse_blueccal({parts[0], parts[1], parts[2], parts[3]}, "fuzzed");
  require(files || !files.error().message.empty(), "an error has a message");
  for (std::size_t f = 0; files && f < files->size(); ++f) {
    require_sound((*files)[f].observations);
    const auto printed = print_observations((*files)[f]);
    require(printed.has_value(), "what is read can be printed as observations");
    const auto again = parse_observations(*printed);
    require(again && again->observations.size() == (*files)[f].observations.size(),
            "what is read can be written as observations");
  }
  const auto places = parse_camera_places(bytes, "fuzzed");
  require(places || !places.error().message.empty(), "an error has a message");
  for (std::size_t p = 0; places && p < places->size(); ++p) {
    require(!(*places)[p].camera.empty(), "a place is that of a camera");
    for (const double x : (*places)[p].place) require(std::isfinite(x), "a place is finite");
  }
}

// Rows of points and the columns that they name; and poses of a robot.
void point_text(std::string_view bytes) {
  const auto columns = parse_point_columns(bytes.substr(0, bytes.find('\n')));
  require(columns || !columns.error().message.empty(), "an error has a message");
  const auto rows = parse_point_rows(bytes, {}, "fuzzed");
  require(rows || !rows.error().message.empty(), "an error has a message");
  if (rows) {
    require(!rows->empty(), "there is a row");
    for (const PointRow& row : *rows) {
      require(row.point || row.seen, "a row has a point or its place in a picture");
      require(!row.seen || (std::isfinite(row.seen->u) && std::isfinite(row.seen->v)),
              "a place in a picture is finite");
      require(row.id.value_or(0) >= 0, "an id is no negative number");
    }
    const auto board = board_of_rows(*rows, "fuzzed");
    require(board || !board.error().message.empty(), "an error has a message");
    if (board) {
      require(board->point_count() == static_cast<int>(rows->size()), "no point is lost");
      for (const Eigen::Vector3d& p : board->points()) require(p.allFinite(), "a point is finite");
    }
  }
  const auto poses = parse_robot_poses(bytes, "fuzzed");
  require(poses || !poses.error().message.empty(), "an error has a message");
  for (std::size_t p = 0; poses && p < poses->size(); ++p) {
    const SE3 pose = to_se3((*poses)[p].base_from_hand);
    require(pose.translation.allFinite(), "a place is finite");
    require(std::abs(pose.rotation.determinant() - 1) < 1e-9, "a rotation is one");
  }
}

// A rig that is read is one that can be written, and each of its cameras is one.
void rig(std::string_view bytes) {
  const auto parsed = parse_rig(bytes, "fuzzed");
  require(parsed || !parsed.error().message.empty(), "an error has a message");
  if (!parsed) return;
  require(!parsed->cameras.empty(), "a rig has cameras");
  for (const RigCamera& camera : parsed->cameras) {
    require_sound(Result<Calibration>(camera.calibration));
    const Pose& pose = camera.rig_from_camera;
    for (const double x : pose.rotation) require(std::isfinite(x), "a turn is finite");
    for (const double x : pose.translation) require(std::isfinite(x), "a place is finite");
  }
  for (const std::string_view format : rig_formats()) {
    const auto printed = print_rig(*parsed, format);
    require(printed || !printed.error().message.empty(), "a refusal to print has a message");
    if (!printed || (!CALVIN_HAVE_FORMATS && !printed->starts_with('{'))) continue;
    const auto again = parse_rig(*printed);
    require(again && again->cameras.size() == parsed->cameras.size(), "it is read again");
  }
}

// A table that is read is one that can be written, and has a calibration everywhere.
void zoom_table(std::string_view bytes) {
  const auto parsed = parse_zoom_table(bytes, "fuzzed");
  require(parsed || !parsed.error().message.empty(), "an error has a message");
  if (!parsed) return;
  const auto printed = print_zoom_table(*parsed);
  require(printed.has_value(), "a table that was read can be printed");
  const auto again = parse_zoom_table(*printed);
  require(again && print_zoom_table(*again).value() == *printed, "it is read again as the same");
  const Calibration& first = parsed->settings.front().calibration;
  const Calibration& last = parsed->settings.back().calibration;
  for (const double t : {-0.5, 0.0, 0.3, 0.5, 0.9, 1.0, 2.0}) {
    const LensPosition position = {*first.zoom + t * (*last.zoom - *first.zoom),
                                   first.focus ? std::optional(*first.focus + t) : std::nullopt};
    const auto found = interpolate(*parsed, position);
    require_sound(found ? Result<Calibration>(found->calibration)
                        : tl::unexpected<Error>(found.error()));
  }
}

constexpr Target kTargets[] = {
    {"calibration", calibration},
    {"key_list", key_list},
    {"boards", boards},
    {"board_names", board_names},
    {"exports", exports},
    {"observations", observations},
    {"observation_file", observation_file},
    {"light_text", light_text},
    {"point_text", point_text},
    {"zoom_table", zoom_table},
    {"rig", rig},
};

}  // namespace

std::span<const Target> targets() { return kTargets; }

const Target* find_target(std::string_view name) {
  for (const Target& target : kTargets) {
    if (target.name == name) return &target;
  }
  return nullptr;
}

}  // namespace calvin::fuzz
