// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// calvin-export-warp [OPTIONS] CALIBRATION FORMAT FILE...: what calibundistort does to the pixels,
// in the files of hardware and of other programs.
#include <algorithm>
#include <cstdio>
#include <numbers>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "calvin/camera/frame_fit.hpp"
#include "calvin/core/file.hpp"
#include "calvin/core/text.hpp"
#include "calvin/io/settings.hpp"
#include "export_warp_text.hpp"
#include "output_files.hpp"
#include "tool_main.hpp"

namespace {

using calvin::Result;
using export_warp::Warp;

constexpr std::string_view kUsage =
    R"(Usage: calvin-export-warp [OPTIONS] CALIBRATION FORMAT FILE...
Writes where in the camera's picture each pixel of an undistorted one lies. CALIBRATION is that of one
camera, as the property of calibundistort takes it (of a zoom table calvin-zoom --at makes one); FORMAT
and the number of files that it needs:

  dw100       1  vertex map of NXP's DW100 (i.MX8M Plus), binary
  ffmpeg      2  columns and rows for ffmpeg's remap filter, PGM
  stmap       1  STMap as Nuke has it, y from below, OpenEXR
  stmap-down  1  the same with y from above
  nvdewarper  1  configuration of DeepStream's nvdewarper
  glsl        1  fragment shader, for glshader and others

  --input WxH         size of the camera's frames (default: that of the calibration)
  --output WxH        size of the undistorted frames (default: that of the input)
  --alpha A           0 (default): no invalid pixel, to 1: all pixels of the camera
  --alpha-mode MODE   calvin (default), opencv
  --zoom Z            enlarges the middle (default 1)
  --pan D --tilt D --roll D    looks right, up, and turns clockwise, degrees
  --projection NAME   rectilinear (default), cylindrical, equirectangular, stereographic, panini,
                      fisheye
  --help              this text
)";

struct Format {
  std::string_view name;
  std::vector<Result<std::string> (*)(const Warp&)> files;
};
const std::vector<Format>& formats() {
  static const std::vector<Format> kFormats = {
      {"dw100", {[](const Warp& w) -> Result<std::string> { return export_warp::dw100(w); }}},
      {"ffmpeg",
       {[](const Warp& w) -> Result<std::string> { return export_warp::ffmpeg_map(w, false); },
        [](const Warp& w) -> Result<std::string> { return export_warp::ffmpeg_map(w, true); }}},
      {"stmap",
       {[](const Warp& w) -> Result<std::string> { return export_warp::stmap(w, false); }}},
      {"stmap-down",
       {[](const Warp& w) -> Result<std::string> { return export_warp::stmap(w, true); }}},
      {"nvdewarper", {export_warp::nvdewarper}},
      {"glsl", {export_warp::glsl}},
  };
  return kFormats;
}

constexpr std::string_view kProjections[] = {"rectilinear",   "cylindrical", "equirectangular",
                                             "stereographic", "panini",      "fisheye"};
constexpr std::string_view kAlphaModes[] = {"calvin", "opencv"};

constexpr int kMostPixels = 16384;  // of a side

struct Arguments {
  std::string calibration;
  const Format* format = nullptr;
  std::vector<std::string> files;
  calvin::ImageSize input;
  calvin::ViewOptions view;
};

int wrong_usage(std::string_view why) {
  fmt::print(stderr, "calvin-export-warp: {}\n\n{}", why, kUsage);
  return 2;
}

int failed(const calvin::Error& error) {
  fmt::print(stderr, "calvin-export-warp: {}\n", error.message);
  return 1;
}

// Whether the text is what an option takes, which is written to the last argument.
bool take_size(std::string_view text, calvin::ImageSize& size) {
  const auto sides = calvin::split(text, 'x');
  if (sides.size() != 2) return false;
  size = {calvin::parse_int(sides[0]).value_or(0), calvin::parse_int(sides[1]).value_or(0)};
  return size.width >= 2 && size.height >= 2 && size.width <= kMostPixels &&
         size.height <= kMostPixels;
}

struct Range {
  double low;
  double high;
  double unit = 1;
};
constexpr Range kAlpha = {0, 1};
constexpr Range kZoom = {0.01, 100};
constexpr Range kDegrees = {-180, 180, std::numbers::pi / 180};

bool take_number(std::string_view text, const Range& range, double& value) {
  const auto number = calvin::parse_double(text);
  if (!number || *number < range.low || *number > range.high) return false;
  value = *number * range.unit;
  return true;
}

template <typename E>
bool take_name(std::string_view text, std::span<const std::string_view> names, E& value) {
  const auto it = std::find(names.begin(), names.end(), text);
  value = static_cast<E>(it - names.begin());
  return it != names.end();
}

std::string wanted_size() { return fmt::format("WxH, 2x2 to {0}x{0} px", kMostPixels); }
std::string wanted_number(const Range& range) {
  return fmt::format("a number from {} to {}", range.low, range.high);
}
std::string wanted_name(std::span<const std::string_view> names) {
  return "one of " + calvin::join(names, ", ");
}

// An option: what it takes, in words, and whether a value is that, which is kept then.
struct Option {
  std::string_view name;
  std::string wanted;
  bool (*take)(std::string_view value, Arguments& to);
};
const std::vector<Option>& options() {
  using Text = std::string_view;
  using A = Arguments;
  static const std::vector<Option> kOptions = {
      {"--input", wanted_size(), [](Text v, A& to) { return take_size(v, to.input); }},
      {"--output", wanted_size(), [](Text v, A& to) { return take_size(v, to.view.output); }},
      {"--alpha", wanted_number(kAlpha),
       [](Text v, A& to) { return take_number(v, kAlpha, to.view.alpha); }},
      {"--alpha-mode", wanted_name(kAlphaModes),
       [](Text v, A& to) { return take_name(v, kAlphaModes, to.view.alpha_mode); }},
      {"--zoom", wanted_number(kZoom),
       [](Text v, A& to) { return take_number(v, kZoom, to.view.zoom); }},
      {"--pan", wanted_number(kDegrees),
       [](Text v, A& to) { return take_number(v, kDegrees, to.view.pan); }},
      {"--tilt", wanted_number(kDegrees),
       [](Text v, A& to) { return take_number(v, kDegrees, to.view.tilt); }},
      {"--roll", wanted_number(kDegrees),
       [](Text v, A& to) { return take_number(v, kDegrees, to.view.roll); }},
      {"--projection", wanted_name(kProjections),
       [](Text v, A& to) { return take_name(v, kProjections, to.view.projection); }},
  };
  return kOptions;
}

// What is wrong with an option and its value; empty where nothing is.
std::string take_option(std::string_view name, std::string_view value, Arguments& arguments) {
  for (const Option& option : options()) {
    if (option.name != name) continue;
    if (option.take(value, arguments)) return "";
    return fmt::format("{} takes {}, not '{}'.", name, option.wanted, value);
  }
  return fmt::format("'{}' is not an option.", name);
}

// What is wrong with the arguments; empty where nothing is.
std::string parse(std::span<char* const> words, Arguments& arguments) {
  std::vector<std::string_view> rest;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::string_view word = words[i];
    if (!word.starts_with("--")) {
      rest.push_back(word);
      continue;
    }
    const std::string_view value = i + 1 < words.size() ? words[++i] : std::string_view();
    if (std::string why = take_option(word, value, arguments); !why.empty()) return why;
  }
  if (rest.size() < 2) return "a calibration and a format are needed.";
  arguments.calibration = rest[0];
  const auto it = std::find_if(formats().begin(), formats().end(),
                               [&](const Format& f) { return f.name == rest[1]; });
  if (it == formats().end()) return fmt::format("there is no format '{}'.", rest[1]);
  arguments.format = &*it;
  arguments.files.assign(rest.begin() + 2, rest.end());
  if (arguments.files.size() == it->files.size()) return "";
  return fmt::format("{} needs {}.", it->name, it->files.size() == 1 ? "one file" : "two files");
}

Result<Warp> make_warp(const Arguments& arguments) {
  const auto calibration = calvin::parse_calibration_setting(arguments.calibration);
  if (!calibration) return tl::unexpected(calibration.error());
  const calvin::ImageSize size =
      arguments.input == calvin::ImageSize{} ? calibration->image_size : arguments.input;
  if (size == calvin::ImageSize{}) {
    return calvin::make_error(calvin::ErrorCode::kInvalidArgument,
                              "The calibration does not say its size: add --input WxH.");
  }
  auto fitted = calvin::fit_to_frame(*calibration, size);
  if (!fitted) return tl::unexpected(fitted.error());
  auto view = calvin::output_view(fitted->camera, arguments.view);
  if (!view) return tl::unexpected(view.error());
  return Warp{std::move(fitted->camera), arguments.view, *std::move(view)};
}

// Whether the files to write are two and none that is read or holds something of ours.
calvin::Status check_outputs(const Arguments& arguments) {
  std::vector<output_files::Output> outputs;
  for (const std::string& file : arguments.files) outputs.push_back({file, {}});
  return output_files::check(outputs, {{arguments.calibration}}, kUsage);
}

int export_all(const Arguments& arguments) {
  if (const auto good = check_outputs(arguments); !good) return failed(good.error());
  const auto warp = make_warp(arguments);
  if (!warp) return failed(warp.error());
  if (warp->view.limited) {
    fmt::print(stderr,
               "calvin-export-warp: the view is wider than its projection shows, and limited.\n");
  }
  if (!calvin::shows_any(calvin::VirtualCamera(warp->source), warp->view.camera)) {
    return failed({calvin::ErrorCode::kInvalidArgument,
                   "The view shows nothing of the camera's picture: look less far aside or up "
                   "(--pan, --tilt), or set another --zoom."});
  }
  for (std::size_t i = 0; i < arguments.files.size(); ++i) {
    const auto bytes = arguments.format->files[i](*warp);
    if (!bytes) return failed(bytes.error());
    if (const auto done = calvin::write_file(arguments.files[i], *bytes); !done) {
      return failed(done.error());
    }
    fmt::print("{}: {}, {}x{} px from {}x{} px\n", arguments.files[i], arguments.format->name,
               warp->output().width, warp->output().height, warp->input().width,
               warp->input().height);
  }
  return 0;
}

int run_tool(int argc, char** argv) {
  const std::span<char*> words(argv + 1, static_cast<std::size_t>(std::max(0, argc - 1)));
  if (std::any_of(words.begin(), words.end(), [](std::string_view w) { return w == "--help"; })) {
    fmt::print("{}", kUsage);
    return 0;
  }
  Arguments arguments;
  if (const std::string why = parse(words, arguments); !why.empty()) return wrong_usage(why);
  return export_all(arguments);
}

}  // namespace

int main(int argc, char** argv) {
  return calvin_tools::run("calvin-export-warp", run_tool, argc, argv);
}
