// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// calvin-light [OPTIONS] RIG.json SEEN...: cameras and where they stand, from what they have seen
// of one light, or of a wand of lights, that was moved before them.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <iterator>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "calvin/core/text.hpp"
#include "calvin/io/blueccal.hpp"
#include "calvin/io/calibration_io.hpp"
#include "calvin/io/camera_baselines.hpp"
#include "calvin/io/camera_places.hpp"
#include "calvin/io/observations.hpp"
#include "calvin/io/rig_io.hpp"
#include "calvin/rig/solve_light.hpp"
#include "calvin/target/board.hpp"

#include "camera_names.hpp"
#include "output_files.hpp"
#include "rig_export.hpp"
#include "tool_main.hpp"

namespace {

constexpr int kFailed = 1;
constexpr int kWrongUsage = 2;

constexpr std::string_view kUsage =
    R"(Usage: calvin-light [OPTIONS] RIG.json SEEN...
Calibrates cameras by one light that was moved before them in the dark, three or more seeing it at a
time, and writes lenses and places to RIG.json. SEEN is a file of observations for each camera (the
journal of calibsolve), or one folder with points.dat, IdMat.dat and Res.dat as BlueCCal has them.

  --wand D1[+D2...]
                  several lights on a wand, each a fixed distance from the one before it: 500mm, or
                  150mm+350mm. Points of observations have their numbers, from 0. Not needed for
                  files of calibdetect board=wand:150mm+350mm. The rig is in m
  --wand-sigma LENGTH
                  how well the place of each light is known, 0.2mm if not given; 0: exactly
  --places FILE   where some cameras stand: lines 'name x y z', m. Three or more give the frame of
                  the rig, two its unit; else the first camera is the rig, without a unit if
                  there is no wand
  --baseline A:B:DISTANCE[:SIGMA]
                  a known distance between two cameras, as cam0:cam2:4.98m:5mm; of two cameras
                  4.98m is enough. It gives the unit, or is held against the wand; not with --places
  --calibration CAMERA=FILE
                  the lens of a camera is known, and only its place is to be found; where that of
                  every camera is, two are enough
  --model MODEL   the lens of the others, brown4 if not given
  --fix NAME,...  what is held of it, aspect,p1,p2 if not given: also center, k2, or none
  --center-sigma SHARE
                  how far the axis may be from the middle of a picture, of its width, 0.03 if not
                  given; 0: by any distance
  --tolerance MS  how far pictures of one instant may be apart, 10 if not given
  --export FORMAT:PATH,...
                  further files, as of calvin-rig: kalibr, caliscope, mrcal, colmap, calvin, gltf;
                  of two cameras opencv, ros
  --help          this text
)";

struct Arguments {
  calvin::LightOptions options;
  std::map<std::string, std::string> calibrations;  // file, by camera
  std::string places;                               // file
  std::optional<calvin::CameraBaseline> baseline;
  std::uint64_t tolerance = 10'000'000;  // ns
  rig_export::Exports exports;
  std::vector<std::string> words;
};

int failed(const calvin::Error& error) {
  fmt::print(stderr, "calvin-light: {}\n", error.message);
  return kFailed;
}

std::vector<std::string> names_in(std::string_view text) {
  std::vector<std::string> names;
  for (const std::string_view name : calvin::split(text, ',')) {
    if (name != "none" && !name.empty()) names.emplace_back(name);
  }
  return names;
}

bool parse_tolerance(std::string_view value, std::uint64_t& tolerance) {
  constexpr double kMillisecond = 1e6;  // ns
  constexpr double kMost = 1e6;         // ms
  const auto ms = calvin::parse_double(value);
  if (!ms || !(*ms >= 0 && *ms <= kMost)) return false;
  tolerance = static_cast<std::uint64_t>(*ms * kMillisecond);
  return true;
}

// The places of lights along a wand, from the distances of each to the next.
bool parse_wand(std::string_view value, std::vector<double>& places) {
  const auto board = calvin::parse_board(fmt::format("wand:{}", value));
  if (!board) return false;
  places.clear();
  for (const Eigen::Vector3d& light : board->points()) places.push_back(light.x());
  return true;
}

// Whether the option and its value are understood.
bool parse_option(std::string_view option, std::string_view value, Arguments& arguments) {
  if (option == "--places") {
    arguments.places = value;
  } else if (option == "--baseline") {
    const auto known = calvin::parse_camera_baselines(value);
    if (!known || known->size() != 1) return false;
    arguments.baseline = known->front();
  } else if (option == "--wand") {
    return parse_wand(value, arguments.options.wand);
  } else if (option == "--wand-sigma") {
    const auto sigma = value == "0" ? calvin::Result<double>(0) : calvin::parse_length(value);
    arguments.options.wand_sigma = sigma.value_or(0);
    return sigma.has_value();
  } else if (option == "--model") {
    arguments.options.model = value;
  } else if (option == "--fix") {
    arguments.options.fix = names_in(value);
  } else if (option == "--tolerance") {
    return parse_tolerance(value, arguments.tolerance);
  } else if (option == "--export") {
    return rig_export::parse(value, arguments.exports);
  } else if (option == "--center-sigma") {
    const auto share = calvin::parse_double(value);
    arguments.options.center_sigma = share.value_or(0);
    return share.has_value();
  } else if (option == "--calibration") {
    const auto equals = value.find('=');
    if (equals == std::string_view::npos) return false;
    arguments.calibrations.emplace(value.substr(0, equals), value.substr(equals + 1));
  } else {
    return false;
  }
  return true;
}

// What is wrong with the usage; empty where nothing is.
std::string parse(std::span<char*> given, Arguments& arguments) {
  for (std::size_t i = 0; i < given.size(); ++i) {
    const std::string_view word = given[i];
    if (!word.starts_with("--")) {
      arguments.words.emplace_back(word);
      continue;
    }
    const std::string_view value = i + 1 < given.size() ? given[++i] : "";
    if (!parse_option(word, value, arguments)) {
      return fmt::format("'{} {}' is no option, or its value does not suit it.", word, value);
    }
  }
  if (arguments.baseline && !arguments.places.empty()) {
    return "--baseline and --places both say how far cameras are apart: give one of them.";
  }
  if (arguments.words.size() < 2) {
    return "it takes a file for the rig, then what each camera has seen.";
  }
  return "";
}

calvin::Result<std::vector<calvin::ObservationFile>> read_files(
    std::span<const std::string> sources) {
  std::vector<calvin::ObservationFile> all;
  for (const std::string& source : sources) {
    std::error_code none;
    if (std::filesystem::is_directory(source, none)) {
      auto files = calvin::read_blueccal(source);
      if (!files) return files;
      std::ranges::move(*files, std::back_inserter(all));
      continue;
    }
    auto file = calvin::read_observations(source);
    if (!file) return tl::unexpected(file.error());
    // A camera without a name is called after its file.
    for (calvin::Observation& seen : file->observations) {
      if (seen.camera.empty()) seen.camera = std::filesystem::path(source).stem().string();
    }
    all.push_back(*std::move(file));
  }
  return all;
}

// The wand that detectors have looked for, where none was named.
calvin::Status take_wand(const std::vector<calvin::ObservationFile>& files,
                         calvin::LightOptions& options) {
  constexpr std::string_view kWand = "wand:";
  if (!options.wand.empty()) return {};
  for (const calvin::ObservationFile& file : files) {
    std::vector<double> wand;
    if (!file.board.starts_with(kWand)) continue;
    if (!parse_wand(file.board.substr(kWand.size()), wand)) continue;
    if (options.wand.empty()) options.wand = wand;
    if (options.wand == wand) continue;
    return calvin::make_error(calvin::ErrorCode::kInvalidArgument,
                              "The files are of different wands: take those of one, or say by "
                              "--wand which is right.");
  }
  return {};
}

calvin::Result<calvin::LightCameras> read_cameras(Arguments& arguments) {
  auto files = read_files(std::span(arguments.words).subspan(1));
  if (!files) return tl::unexpected(files.error());
  if (const auto wand = take_wand(*files, arguments.options); !wand) {
    return tl::unexpected(wand.error());
  }
  std::vector<calvin::Observation> seen;
  for (calvin::ObservationFile& file : *files) {
    for (calvin::Observation& one : file.observations) {
      if (one.found()) seen.push_back(std::move(one));
    }
  }
  const std::size_t lights = std::max<std::size_t>(arguments.options.wand.size(), 1);
  auto cameras = calvin::light_cameras(seen, arguments.tolerance, lights);
  if (!cameras) return cameras;
  std::vector<camera_names::Use> names;
  for (const auto& [name, file] : arguments.calibrations) {
    const auto camera = std::ranges::find(cameras->cameras, name, &calvin::LightCamera::name);
    if (camera == cameras->cameras.end()) {
      return calvin::make_error(calvin::ErrorCode::kNotFound,
                                fmt::format("No camera is called '{}', of which there is a "
                                            "calibration.",
                                            name));
    }
    auto calibration = calvin::read_calibration(file);
    if (!calibration) return tl::unexpected(calibration.error());
    names.push_back({file, calibration->camera, name});
    camera->calibration = *std::move(calibration);
  }
  const auto theirs = camera_names::check(std::move(names), "as the calibration of");
  if (!theirs) return tl::unexpected(theirs.error());
  return cameras;
}

// Without names it is that of two cameras.
calvin::Status take_baseline(const std::vector<calvin::LightCamera>& cameras,
                             Arguments& arguments) {
  if (!arguments.baseline) return {};
  calvin::CameraBaseline known = *arguments.baseline;
  if (known.a.empty() && known.b.empty()) {
    if (cameras.size() != 2) {
      return calvin::make_error(
          calvin::ErrorCode::kInvalidArgument,
          fmt::format("A known distance without names is that of two cameras, and there are {}: "
                      "name two, as --baseline {}:{}:4.98m.",
                      cameras.size(), cameras.front().name, cameras.back().name));
    }
    known.a = cameras[0].name;
    known.b = cameras[1].name;
  }
  calvin::set_known_distance(known, arguments.options);
  return {};
}

void print(const calvin::LightSolution& solved) {
  const calvin::Rig& rig = solved.rig;
  std::size_t places = 0;
  for (const auto& point : solved.points) places += point ? 1 : 0;
  for (std::size_t c = 0; c < rig.cameras.size(); ++c) {
    const calvin::RigCamera& camera = rig.cameras[c];
    const auto& at = camera.rig_from_camera.translation;
    const calvin::LightCameraErrors& errors = solved.errors[c];
    fmt::print("'{}' at {}{}, rms {:.3f} px, {} of {} sightings, f {:.1f}\n",
               camera.calibration.camera,
               rig.is_metric
                   ? fmt::format("{:.1f} {:.1f} {:.1f} mm", 1e3 * at[0], 1e3 * at[1], 1e3 * at[2])
                   : fmt::format("{:.4f} {:.4f} {:.4f}", at[0], at[1], at[2]),
               rig.is_metric ? rig_export::place_sigmas(camera) : "", errors.rms, errors.used,
               errors.seen, camera.calibration.parameters.front().value);
  }
  fmt::print("{} of {} places of the light, mean error {:.3f} px, rms {:.3f} px\n", places,
             solved.points.size(), solved.mean_error, rig.rms.value_or(0));
  if (solved.places_rms) {
    fmt::print("Cameras are {} mm from where they were known to be.\n",
               calvin::two_digits(1e3 * *solved.places_rms));
  }
  if (solved.wand) {
    fmt::print("Cameras alone see the wand {} mm too {} in the mean, rms {} mm, of {} instants.\n",
               calvin::two_digits(1e3 * std::abs(solved.wand->mean)),
               solved.wand->mean < 0 ? "short" : "long", calvin::two_digits(1e3 * solved.wand->rms),
               solved.wand->instants);
  }
  for (const std::string& remark : solved.remarks) fmt::print("{}\n", remark);
}

// Whether the files to write are neither some that are read nor some that hold something else.
calvin::Status check_outputs(const Arguments& arguments) {
  std::vector<std::string> inputs(arguments.words.begin() + 1, arguments.words.end());
  for (const auto& [name, file] : arguments.calibrations) inputs.push_back(file);
  if (!arguments.places.empty()) inputs.push_back(arguments.places);
  return output_files::check(rig_export::outputs(arguments.words[0], arguments.exports), inputs,
                             kUsage);
}

int run(Arguments arguments) {
  if (const auto good = check_outputs(arguments); !good) return failed(good.error());
  const auto seen = read_cameras(arguments);
  if (!seen) return failed(seen.error());
  if (seen->left_out > 0) {
    fmt::print("{} pictures have several lights and are left out: a wand is told by --wand.\n",
               seen->left_out);
  }
  if (const auto taken = take_baseline(seen->cameras, arguments); !taken) {
    return failed(taken.error());
  }
  if (!arguments.places.empty()) {
    auto places = calvin::read_camera_places(arguments.places);
    if (!places) return failed(places.error());
    arguments.options.places = *std::move(places);
  }
  auto solved = calvin::solve_light(seen->cameras, arguments.options);
  if (!solved) return failed(solved.error());
  solved->rig.pairing_tolerance = arguments.tolerance;
  const auto written = calvin::write_rig(arguments.words[0], solved->rig);
  print(*solved);
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
  Arguments arguments;
  if (const std::string wrong = parse(given, arguments); !wrong.empty()) {
    fmt::print(stderr, "calvin-light: {}\n\n{}", wrong, kUsage);
    return kWrongUsage;
  }
  return run(std::move(arguments));
}

}  // namespace

int main(int argc, char** argv) { return calvin_tools::run("calvin-light", run_tool, argc, argv); }
