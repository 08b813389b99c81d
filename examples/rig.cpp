// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// calvin-rig [OPTIONS] RIG.json CALIBRATION VIEWS CALIBRATION VIEWS...: where the cameras of a rig
// stand, from what each of them has seen of boards.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "calvin/core/text.hpp"
#include "calvin/io/calibration_io.hpp"
#include "calvin/io/camera_baselines.hpp"
#include "calvin/io/rig_io.hpp"
#include "calvin/io/rig_world.hpp"
#include "calvin/rig/moved_camera.hpp"
#include "calvin/rig/solve_rig.hpp"

#include "rig_export.hpp"
#include "rig_sources.hpp"
#include "tool_main.hpp"

namespace {

constexpr int kFailed = 1;
constexpr int kWrongUsage = 2;

constexpr std::string_view kUsage =
    R"(Usage: calvin-rig [OPTIONS] RIG.json CALIBRATION VIEWS CALIBRATION VIEWS...
Finds where cameras stand, and writes it to RIG.json. For each camera: its calibration, and what it
has seen of boards: a video, a folder of pictures, FOLDER/PREFIX* in quotes, or a file of observations
(the journal of calibsolve). Pictures with the same number in their names were taken at one time,
and frames of videos at the same time since the beginning. Of videos the frames count that show a
board elsewhere than before, and what the other cameras saw at those times.

  --board BOARD   the board in the pictures, checkerboard:9x6:25mm if not given; of a file of
                  observations, which has its board, another size of it
  --floor         the board lies still, and every camera has seen it at any time: the frame of the
                  rig is that of the board. Else the board is carried before two cameras or more at
                  a time, and the frame is that of the first camera
  --fixed-boards  the boards are fixed to each other, as on the sides of a box; --board 'A;B;C' has
                  all of them, and no two alike. Cameras are joined that have seen different ones at
                  one time. How the boards lie is found from pictures that show two of them
  --estimate-intrinsics prior|free
                  the lenses too, together with the places. prior: what the calibrations say counts,
                  with their sigmas, for pictures that they were not made from. free: these pictures
                  alone tell, those that one camera has seen by itself included. The lenses that are
                  found are in RIG.json
  --world FRAME   the frame of the rig: a camera's name, board (where it was at the first picture,
                  which may be the floor), board:N (at picture N, or at that second) or board:last.
                  Quarter turns of its axes may follow: board:x180 has z up from a board on the floor
  --tolerance MS  how far observations of one instant may be apart, 10 if not given
  --start CAMERA:SECONDS,...
                  of videos or observations: how much later than the others a camera began, as
                  right:2.45. A board that moves tells what is left of it, if that is less than the
                  tolerance
  --baseline A:B:DISTANCE[:SIGMA],...
                  known distances between cameras, as left:right:110.03mm:0.05mm; of two cameras
                  110.03mm is enough. They tell how large boards are in truth
  --board-sigma PERCENT
                  with --baseline: how well the size of boards is known, 1 if not given
  --export FORMAT:PATH,...
                  further files: kalibr (a camchain), caliscope (camera_array.toml), calvin, gltf
                  (the scene of calibview, GLB); in the folder PATH mrcal (cameramodels) and colmap
                  (cameras.txt and images.txt); of two cameras opencv (the stereo parameters, YAML,
                  in one file; of a PATH with / at its end OpenCV's intrinsics.yml and
                  extrinsics.yml), and ros (left.yaml and right.yaml in the folder PATH)
  --help          this text
)";

struct Arguments {
  std::string board;                     // that of --board; empty: as the views have it
  std::map<std::string, double> starts;  // s, by the name of a camera
  calvin::RigOptions options;
  rig_export::Exports exports;
  std::vector<std::string> words;
};

int wrong_usage(std::string_view why) {
  fmt::print(stderr, "calvin-rig: {}\n\n{}", why, kUsage);
  return kWrongUsage;
}

int failed(const calvin::Error& error) {
  fmt::print(stderr, "calvin-rig: {}\n", error.message);
  return kFailed;
}

// Whether "CAMERA:SECONDS,..." was understood; names may have colons.
bool parse_starts(std::string_view text, std::map<std::string, double>& starts) {
  constexpr double kMost = 1e6;  // s
  for (const std::string_view part : calvin::split(text, ',')) {
    const auto colon = part.rfind(':');
    if (colon == 0 || colon == std::string_view::npos) return false;
    const auto seconds = calvin::parse_double(part.substr(colon + 1));
    if (!seconds || !(*seconds >= -kMost && *seconds <= kMost)) return false;
    starts[std::string(part.substr(0, colon))] = *seconds;
  }
  return true;
}

// Absent for wrong usage, which was said.
std::optional<Arguments> parse(std::span<char*> given) {
  Arguments arguments;
  for (std::size_t i = 0; i < given.size(); ++i) {
    const std::string_view word = given[i];
    const bool has_value = i + 1 < given.size();
    if (word == "--floor") {
      arguments.options.mode = calvin::RigMode::kFloor;
    } else if (word == "--fixed-boards") {
      arguments.options.fixed_boards = true;
    } else if (word == "--estimate-intrinsics" && has_value) {
      const std::string_view how = given[++i];
      if (how != "prior" && how != "free") {
        wrong_usage("intrinsics are estimated with a prior, or free.");
        return std::nullopt;
      }
      arguments.options.intrinsics =
          how == "free" ? calvin::RigIntrinsics::kFree : calvin::RigIntrinsics::kPrior;
    } else if (word == "--board" && has_value) {
      arguments.board = given[++i];
    } else if (word == "--tolerance" && has_value) {
      constexpr double kMillisecond = 1e6;  // ns
      constexpr double kMost = 1e6;         // ms
      const auto ms = calvin::parse_double(given[++i]);
      if (!ms || !(*ms >= 0 && *ms <= kMost)) {
        wrong_usage("a tolerance is a number of milliseconds.");
        return std::nullopt;
      }
      arguments.options.tolerance = static_cast<std::uint64_t>(*ms * kMillisecond);
    } else if (word == "--start" && has_value) {
      if (!parse_starts(given[++i], arguments.starts)) {
        wrong_usage("--start takes CAMERA:SECONDS, as right:2.45.");
        return std::nullopt;
      }
    } else if (word == "--baseline" && has_value) {
      auto baselines = calvin::parse_camera_baselines(given[++i]);
      if (!baselines) {
        wrong_usage(baselines.error().message);
        return std::nullopt;
      }
      arguments.options.baselines = *std::move(baselines);
    } else if (word == "--world" && has_value) {
      auto world = calvin::parse_rig_world(given[++i]);
      if (!world) {
        wrong_usage(world.error().message);
        return std::nullopt;
      }
      arguments.options.world = *std::move(world);
    } else if (word == "--board-sigma" && has_value) {
      constexpr double kPercent = 0.01;
      const auto percent = calvin::parse_double(given[++i]);
      if (!percent || !(*percent >= 0 && *percent <= 100)) {
        wrong_usage("a sigma of boards is a number of percent, 0 to 100.");
        return std::nullopt;
      }
      arguments.options.board_sigma = kPercent * *percent;
    } else if (word == "--export" && has_value) {
      if (!rig_export::parse(given[++i], arguments.exports)) {
        wrong_usage(rig_export::kUsage);
        return std::nullopt;
      }
    } else if (word.starts_with("--")) {
      wrong_usage(fmt::format("'{}' is no option, or needs a value.", word));
      return std::nullopt;
    } else {
      arguments.words.emplace_back(word);
    }
  }
  const std::size_t least = arguments.options.mode == calvin::RigMode::kFloor ? 3 : 5;
  if (arguments.words.size() < least || arguments.words.size() % 2 == 0) {
    wrong_usage(
        "it takes a file for the rig, then a calibration and views for each camera: two of them, "
        "or "
        "one and --floor.");
    return std::nullopt;
  }
  return arguments;
}

bool differ(const std::vector<std::string>& names) {
  const std::set<std::string> all(names.begin(), names.end());
  return all.size() == names.size() && all.count("") == 0;
}

// Cameras whose files have no names that tell them apart are called after their files: by their
// names alone, by their folders' (left/camera.json), or by both.
void name_cameras(const std::vector<std::string>& files,
                  std::vector<calvin::RigCameraViews>& cameras) {
  std::vector<std::string> own;
  std::vector<std::string> stems;
  std::vector<std::string> folders;
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    own.push_back(cameras[i].calibration.camera);
    const std::filesystem::path file(files[i]);
    stems.push_back(file.stem().string());
    folders.push_back(file.parent_path().filename().string());
  }
  if (differ(own)) return;
  const std::vector<std::string>& names =
      differ(stems) ? stems : (differ(folders) ? folders : files);
  for (std::size_t i = 0; i < cameras.size(); ++i) cameras[i].calibration.camera = names[i];
}

// Whether the board was seen at about the time that --world asks for. The library takes the instant
// next to it, which of a mistyped time would be the first or the last one.
calvin::Status check_world_time(const calvin::RigOptions& options,
                                const std::vector<calvin::RigCameraViews>& cameras) {
  constexpr double kNanosecond = 1e-9;  // s
  constexpr double kSlack = 0.5;        // s: a time in whole seconds may be beside the views
  const bool is_timed = options.mode != calvin::RigMode::kFloor && options.world &&
                        options.world->camera.empty() && options.world->time;
  if (!is_timed || std::isinf(*options.world->time)) return {};
  std::vector<std::uint64_t> times;
  for (const calvin::RigCameraViews& camera : cameras) {
    for (const calvin::View& view : camera.views) {
      const std::uint64_t time = view.observation.timestamp;
      if (time != calvin::kNoTimestamp) times.push_back(time);
    }
  }
  if (times.empty()) return {};
  const double first = kNanosecond * static_cast<double>(std::ranges::min(times));
  const double last = kNanosecond * static_cast<double>(std::ranges::max(times));
  const double time = *options.world->time;
  if (time >= first - kSlack && time <= last + kSlack) return {};
  return calvin::make_error(
      calvin::ErrorCode::kInvalidArgument,
      fmt::format(
          "--world asks for the board at {:g} s, and the views are from {:.3f} s to {:.3f} s "
          "(of pictures: by their numbers): give a time among these, or board:last.",
          time, first, last));
}

// The lenses as RIG.json has them; a remark tells which stay as they were.
void print_lenses(const calvin::RigSolution& solved, calvin::RigIntrinsics how) {
  if (how == calvin::RigIntrinsics::kHeld) return;
  for (const calvin::RigCamera& camera : solved.rig.cameras) {
    std::string line;
    for (const calvin::Parameter& p : camera.calibration.parameters) {
      if (!p.sigma) continue;
      line += fmt::format(" {} {:.6g} (+-{})", p.name, p.value, calvin::two_digits(*p.sigma));
    }
    if (!line.empty()) fmt::print("'{}':{}\n", camera.calibration.camera, line);
  }
}

void print(const calvin::RigSolution& solved, calvin::RigIntrinsics how) {
  const calvin::Rig& rig = solved.rig;
  for (const calvin::RigLink& link : solved.links) {
    fmt::print("{}\n", calvin::to_text(link, rig));
  }
  if (solved.weakest && rig.cameras.size() > 2) {
    const calvin::RigLink& weakest = solved.links[*solved.weakest];
    fmt::print("The weakest link is that of '{}' and '{}'.\n",
               rig.cameras[weakest.a].calibration.camera,
               rig.cameras[weakest.b].calibration.camera);
  }
  for (const calvin::RigCamera& camera : rig.cameras) {
    const auto& at = camera.rig_from_camera.translation;
    fmt::print("'{}' at {:.1f} {:.1f} {:.1f} mm of '{}'{}, rms {:.3f} px\n",
               camera.calibration.camera, 1e3 * at[0], 1e3 * at[1], 1e3 * at[2], rig.world,
               rig_export::place_sigmas(camera), camera.rms.value_or(0));
  }
  print_lenses(solved, how);
  if (solved.board_scale) {
    fmt::print(
        "Boards are {:.5f} (+-{}) times as large as their text says, by the known distances.\n",
        solved.board_scale->scale, calvin::two_digits(solved.board_scale->sigma));
  }
  for (const calvin::FixedBoard& board : rig.fixed_boards) {
    const auto& at = board.on_from_board.translation;
    fmt::print("'{}' is fixed to '{}' at {:.2f} {:.2f} {:.2f} mm\n", board.board, board.on,
               1e3 * at[0], 1e3 * at[1], 1e3 * at[2]);
  }
  if (!solved.rejected.empty()) {
    fmt::print("{} views contradict the others and were left out.\n", solved.rejected.size());
  }
  if (solved.farthest > 0) {
    fmt::print("Pictures of one instant are up to {:.3f} ms apart.\n",
               1e-6 * static_cast<double>(solved.farthest));
  }
  for (const std::string& remark : solved.remarks) fmt::print("{}\n", remark);
}

int run(const Arguments& arguments) {
  std::vector<calvin::RigCameraViews> cameras;
  std::vector<std::string> files;
  std::vector<std::string> sources;
  for (std::size_t i = 1; i + 1 < arguments.words.size(); i += 2) {
    auto calibration = calvin::read_calibration(arguments.words[i]);
    if (!calibration) return failed(calibration.error());
    cameras.push_back({*std::move(calibration), {}});
    files.push_back(arguments.words[i]);
    sources.push_back(arguments.words[i + 1]);
  }
  name_cameras(files, cameras);
  const auto read =
      rig_sources::read(sources, {arguments.board, arguments.starts, arguments.options}, cameras);
  if (!read) return failed(read.error());
  const auto timed = check_world_time(arguments.options, cameras);
  if (!timed) return failed(timed.error());
  auto solved = calvin::solve_rig(cameras, arguments.options);
  if (!solved) return failed(solved.error());
  std::string moved =
      calvin::moved_cameras(calvin::views_of_rig(solved->rig, cameras), arguments.options);
  if (!moved.empty()) solved->remarks.push_back(std::move(moved));
  const auto written = calvin::write_rig(arguments.words[0], solved->rig);
  print(*solved, arguments.options.intrinsics);
  const bool exported = rig_export::write_all(solved->rig, arguments.exports);
  if (!written) return failed(written.error());
  return exported ? 0 : kFailed;
}

int run_tool(int argc, char** argv) {
  const std::span<char*> given(argv + 1, static_cast<std::size_t>(argc - 1));
  if (given.size() == 1 && std::string_view(given[0]) == "--help") {
    fmt::print("{}", kUsage);
    return 0;
  }
  const auto arguments = parse(given);
  if (!arguments) return kWrongUsage;
  const auto good =
      output_files::check(rig_export::outputs(arguments->words[0], arguments->exports),
                          std::span(arguments->words).subspan(1), kUsage);
  if (!good) return failed(good.error());
  return run(*arguments);
}

}  // namespace

int main(int argc, char** argv) { return calvin_tools::run("calvin-rig", run_tool, argc, argv); }
