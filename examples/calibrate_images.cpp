// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// calvin-calibrate-images [OPTION...] FOLDER: calibrates a camera from a folder of pictures of any
// format that GStreamer decodes, says how good it is, and undistorts the first of them. A folder
// for the files that is not there is made.
//
// The pictures go through one pipeline, one after the other:
//   appsrc ! queue ! calibrate ! fakesink
#include <algorithm>
#include <filesystem>
#include <string>
#include <system_error>
#include <vector>

#include <fmt/format.h>
#include <gst/gst.h>

#include "calibrate_images_board.hpp"
#include "calibrate_images_folder.hpp"
#include "calibrate_images_pair.hpp"
#include "calibrate_images_run.hpp"
#include "calvin/core/file.hpp"
#include "calvin/core/text.hpp"
#include "calvin/detect/board_identifier.hpp"
#include "calvin/io/board_names.hpp"
#include "calvin/session/files/calibration_files.hpp"
#include "calvin/solve/solve.hpp"
#include "print_calibration.hpp"
#include "tool_main.hpp"

namespace {

using calibrate_images::Folder;
using calibrate_images::Options;
using calibrate_images::Outcome;

constexpr int kFailed = 1;
constexpr int kUsage = 2;
constexpr int kNotGood = 3;

// Before the work: whether there is a folder that the files can go to. One level of it is made.
bool prepare(const Options& options) {
  std::error_code error;
  std::filesystem::create_directory(options.output, error);
  if (!error) {
    calvin::Status status = calvin::check_writable(options.location());
    if (status) status = calibrate_images::check_pair(options.output);
    // How they are written was checked before.
    const auto exports = calvin::parse_calibration_files("", options.exports);
    if (status && exports) status = calvin::can_write_all(*exports);
    if (!status) fmt::print(stderr, "{}\n", status.error().message);
    return status.has_value();
  }
  fmt::print(stderr,
             "There is no folder {}, and it cannot be made: {}. Give --output a folder that is "
             "there, or a new one in such a folder.\n",
             options.output.string(), error.message());
  return false;
}

// The pictures of one camera and one size; empty where there are none, which is said.
Folder choose_pictures(const Options& options) {
  Folder folder = calibrate_images::find_pictures(options.folder, options.leave_out);
  if (folder.pictures.empty()) {
    fmt::print(stderr, "There is no picture in {} that GStreamer can decode{}.\n",
               options.folder.string(),
               options.leave_out.empty() ? "" : ", but for those that --leave-out names");
    return folder;
  }
  calvin::Status status = calibrate_images::keep_one_size(folder.pictures);
  if (status && !options.one_camera) status = calibrate_images::check_one_camera(folder.pictures);
  if (!status) {
    fmt::print(stderr, "{}\n", status.error().message);
    folder.pictures.clear();
  }
  return folder;
}

// Whether each picture is in the result.
std::vector<bool> used_of(const Folder& folder, const Outcome& outcome) {
  std::vector<bool> used(folder.pictures.size());
  if (!outcome.calibration) return used;
  for (const calvin::ViewRecord& view : outcome.calibration->views) {
    const std::size_t at = calibrate_images::picture_at(view.timestamp);
    if (at < used.size()) used[at] = true;
  }
  return used;
}

const calibrate_images::Picture& first_used(const Folder& folder, const Outcome& outcome) {
  const std::vector<bool> used = used_of(folder, outcome);
  const auto at =
      static_cast<std::size_t>(std::find(used.begin(), used.end(), true) - used.begin());
  return at < used.size() ? folder.pictures[at] : folder.pictures.front();
}

// Pictures that are left out, by the reason, both in the order in which they came.
class LeftOut {
 public:
  void add(const std::filesystem::path& picture, const std::string& why) {
    auto known =
        std::find_if(all_.begin(), all_.end(), [&](const auto& r) { return r.why == why; });
    if (known == all_.end()) {
      all_.push_back({picture, why, {}});
    } else {
      known->others += (known->others.empty() ? "" : ", ") + picture.filename().string();
    }
  }
  void print() const {
    for (const Reason& reason : all_) {
      calibrate_images::leave_out(reason.first, reason.why);
      if (reason.others.empty()) continue;
      fmt::print(stderr, "  The same: {}\n", reason.others);
    }
  }

 private:
  struct Reason {
    std::filesystem::path first;
    std::string why;
    std::string others;
  };
  std::vector<Reason> all_;
};

// Each picture that is not in the result and why, then how many are.
void print_pictures(const Folder& folder, const Outcome& outcome) {
  const auto& pictures = folder.pictures;
  const std::vector<bool> used = used_of(folder, outcome);
  std::size_t blank = 0;
  LeftOut left_out;
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    const bool looked_at = outcome.seen.contains(i);
    if (looked_at && !outcome.corners.contains(i)) ++blank;
    const auto reason = outcome.reasons.find(i);
    if (used[i] || (reason == outcome.reasons.end() && !looked_at)) continue;
    if (reason != outcome.reasons.end()) {
      left_out.add(pictures[i].path, reason->second);
    } else if (outcome.calibration) {
      left_out.add(pictures[i].path, calibrate_images::kNothingNew);
    }
  }
  left_out.print();
  const auto count = static_cast<std::size_t>(std::count(used.begin(), used.end(), true));
  fmt::print("{} of {} pictures used: {} left out, {} without a board\n", count, folder.files,
             folder.files - count - blank, blank);
}

// Whether the result is what was asked for, in a line of its own.
bool print_verdict(const Options& options, const calvin::Calibration& c) {
  const double accuracy = 2 * c.expected_error.value_or(0);
  const bool poor = options.accuracy && !(c.expected_error && accuracy <= *options.accuracy);
  const bool misfit = calvin_tools::has_misfit(c);
  if (poor && !misfit && !c.expected_error) {
    fmt::print("verdict: nothing is known of its accuracy, where {:.3g} px were asked for\n",
               *options.accuracy);
  } else if (poor && !misfit) {
    fmt::print("verdict: not good enough, accurate to {:.3g} px where {:.3g} px were asked for\n",
               accuracy, *options.accuracy);
  } else {
    calvin_tools::print_verdict(c);
  }
  return !misfit && !poor;
}

bool parse(int argc, char** argv, Options& options) {
  g_autofree char* board = nullptr;
  g_autofree char* model = nullptr;
  g_autofree char* fix = nullptr;
  g_autofree char* initial = nullptr;
  g_autofree char* exports = nullptr;
  g_autofree char* output = nullptr;
  g_auto(GStrv) unwanted = nullptr;
  gboolean one_camera = FALSE;
  gboolean verdict = FALSE;
  double accuracy = 0;
  // What may name a file is of any bytes, as file names are; GLib asks text to be of the locale.
  const GOptionEntry entries[] = {
      {"board", 0, 0, G_OPTION_ARG_FILENAME, &board, "The board in the pictures", "TEXT"},
      {"model", 0, 0, G_OPTION_ARG_STRING, &model,
       "The camera model (default auto: the one that the pictures ask for; with --fix or "
       "--initial brown5)",
       "NAME"},
      {"fix", 0, 0, G_OPTION_ARG_STRING, &fix, "Parameters that are held or tied", "aspect,k3"},
      {"initial", 0, 0, G_OPTION_ARG_FILENAME, &initial, "A calibration to start from", "FILE"},
      {"export", 0, 0, G_OPTION_ARG_FILENAME, &exports,
       "Further files, as the property export of calibsolve has them", "FORMAT:PATH,..."},
      {"leave-out", 0, 0, G_OPTION_ARG_FILENAME_ARRAY, &unwanted,
       "Pictures to leave out; may be given again", "'right*'"},
      {"one-camera", 0, 0, G_OPTION_ARG_NONE, &one_camera,
       "All pictures are of one camera, whatever they are called", nullptr},
      {"verdict", 0, 0, G_OPTION_ARG_NONE, &verdict, "Exit with 3 where the result is not good",
       nullptr},
      {"accuracy", 0, 0, G_OPTION_ARG_DOUBLE, &accuracy,
       "As --verdict, and where it is not accurate to so many px", "PX"},
      {"output", 0, 0, G_OPTION_ARG_FILENAME, &output, "Where the files go; made if need be",
       "DIR"},
      {nullptr, 0, 0, G_OPTION_ARG_NONE, nullptr, nullptr, nullptr}};
  g_autoptr(GOptionContext) context = g_option_context_new("FOLDER");
  g_autoptr(GError) error = nullptr;
  g_option_context_add_main_entries(context, entries, nullptr);
  g_option_context_add_group(context, gst_init_get_option_group());
  const bool known = g_option_context_parse(context, &argc, &argv, &error) != FALSE;
  if (!known || argc != 2 || !(accuracy >= 0)) {
    g_autofree char* help = g_option_context_get_help(context, TRUE, nullptr);
    fmt::print(stderr, "{}{}", error != nullptr ? std::string(error->message) + "\n" : "", help);
    return false;
  }
  if (board != nullptr) options.board = board;
  // What is held or started from belongs to a model.
  if (fix == nullptr && initial == nullptr) options.model = "auto";
  if (model != nullptr) options.model = model;
  if (fix != nullptr) options.fix = fix;
  if (initial != nullptr) options.initial = initial;
  if (exports != nullptr) options.exports = exports;
  if (output != nullptr) options.output = output;
  for (char** p = unwanted; p != nullptr && *p != nullptr; ++p) options.leave_out.emplace_back(*p);
  options.one_camera = one_camera != FALSE;
  if (accuracy > 0) options.accuracy = accuracy;
  options.verdict = verdict != FALSE || options.accuracy.has_value();
  options.folder = argv[1];
  return true;
}

// A board, several, or whichever is seen.
calvin::Status check_board(const std::string& text) {
  if (const auto any = calvin::parse_auto_board(text)) {
    return *any ? calvin::Status() : tl::unexpected(any->error());
  }
  const auto boards = calvin::parse_boards(text);
  return boards ? calvin::Status() : tl::unexpected(boards.error());
}

// The board, and what the elements take as texts of properties.
calvin::Status check_texts(const Options& options) {
  if (calvin::Status board = check_board(options.board); !board) return board;
  calvin::SolveOptions solve;
  solve.model = options.model;
  for (const std::string_view word : calvin::split(options.fix, ',')) {
    if (!word.empty()) solve.fix.emplace_back(word);
  }
  // What is held may be that of a calibration, which the element reads.
  calvin::Status known = options.initial.empty() ? calvin::check(solve) : calvin::Status();
  if (!known) return known;
  const auto exports = calvin::parse_calibration_files("", options.exports);
  return exports ? calvin::Status() : tl::unexpected(exports.error());
}

// The element asks so once in a while; of few pictures it would not.
void print_other_board(const Options& options, const Folder& folder, const Outcome& outcome) {
  const std::string other = calibrate_images::other_board(options.board, folder.pictures);
  const bool is_said = std::ranges::any_of(
      outcome.reasons, [&](const auto& reason) { return reason.second.starts_with(other); });
  if (!other.empty() && !is_said) fmt::print(stderr, "{}: see --board.\n", other);
}

int run_tool(int argc, char** argv) {
  Options options;
  if (!parse(argc, argv, options)) return kUsage;
  if (const calvin::Status good = check_texts(options); !good) {
    fmt::print(stderr, "{}\n", good.error().message);
    return kUsage;
  }
  if (!calibrate_images::check_elements() || !prepare(options)) return kFailed;
  const Folder folder = choose_pictures(options);
  if (folder.pictures.empty()) return kFailed;
  if (const auto seen = calibrate_images::board_seen(options.board, folder.pictures)) {
    fmt::print("The pictures show {}\n", *seen);
    options.board = *seen;
  }
  GstElement* pipeline = calibrate_images::make_pipeline(options, folder.pictures);
  const Outcome outcome = calibrate_images::run(pipeline, folder.pictures, options.board);
  gst_object_unref(pipeline);
  print_pictures(folder, outcome);
  if (outcome.corners.empty()) print_other_board(options, folder, outcome);
  if (!outcome.calibration) return kFailed;
  calvin_tools::print(*outcome.calibration);
  const bool good = print_verdict(options, *outcome.calibration);
  if (!outcome.good) return kFailed;  // a file was not written, which was said
  const calibrate_images::Picture& shown = first_used(folder, outcome);
  if (!calibrate_images::draw_pair(options, shown.path)) return kFailed;
  fmt::print("camera.json, and {} as before.png and after.png, are in {}\n", shown.name(),
             options.output.string());
  return options.verdict && !good ? kNotGood : 0;
}

}  // namespace

int main(int argc, char** argv) {
  return calvin_tools::run("calvin-calibrate-images", run_tool, argc, argv);
}
