// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// calvin-hand-eye [OPTIONS] HAND_EYE.json CALIBRATION VIEWS POSES: where a camera is on the hand of
// a robot, or before one, from what it has seen of a board and the poses that the robot told. With
// --method strobl one camera or several are calibrated with that, and the board is measured.
#include <cmath>
#include <cstdio>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "calvin/core/text.hpp"
#include "calvin/geometry/se3.hpp"
#include "calvin/io/calibration_io.hpp"
#include "calvin/io/hand_eye_io.hpp"
#include "calvin/io/robot_poses.hpp"
#include "calvin/rig/hand_eye.hpp"

#include "hand_eye_joint.hpp"
#include "hand_eye_match.hpp"
#include "output_files.hpp"
#include "rig_views.hpp"
#include "tool_main.hpp"

namespace {

constexpr int kFailed = 1;
constexpr int kWrongUsage = 2;
constexpr double kMillimetre = 1e-3;  // m
constexpr double kDegree = std::numbers::pi / 180;

constexpr std::string_view kUsage =
    R"(Usage: calvin-hand-eye [OPTIONS] HAND_EYE.json CALIBRATION VIEWS POSES
Finds where a camera is on the hand of a robot, or before one, and writes it to HAND_EYE.json. It
takes the calibration of the camera; what it has seen of a board: a folder of pictures,
FOLDER/PREFIX* in quotes, or a file of observations (the journal of calibsolve); and where the robot
said that its hand was: a line 'x y z qx qy qz qw' (m) for each picture, in their order, or with the
name of the picture or its time in front. 12 or 16 numbers are the rows of a matrix.

  --board BOARD     the board in the pictures, checkerboard:9x6:25mm if not given; of a file of
                    observations, which has its board, another size of it
  --eye in-hand     the camera is on the hand, the board stands still (if not given)
  --eye to-hand     the camera stands still, the board is on the hand
  --inverted        POSES has hand_from_base; else it has base_from_hand
  --turn-sigma DEG  the noise of the robot's turns, 1 sigma per axis; else it is estimated
  --place-sigma MM  that of its places
  --free-scale      the size of the board is not believed: all lengths are the robot's
  --method strobl   cameras, places, pitch and aspect of the board in one solve, as CalLab does;
                    CALIBRATION is where it begins. Of cameras beside each other
                    CALIBRATION VIEWS CALIBRATION VIEWS ... POSES
    --fix pitch     the pitch of the board is as BOARD has it
    --fix aspect    its rows are as far apart as its columns
    --calibration FILE  is written, of each camera in turn
    --rig FILE      is written: where several cameras stand, in the robot's metres
  --help            this text
)";

struct Arguments {
  std::string board;  // that of --board; empty: as the views have it
  bool inverted = false;
  calvin::HandEyeOptions options;
  bool is_joint = false;  // --method strobl
  hand_eye_joint::Arguments joint;
  std::vector<std::string> words;
};

int wrong_usage(std::string_view why) {
  fmt::print(stderr, "calvin-hand-eye: {}\n\n{}", why, kUsage);
  return kWrongUsage;
}

int failed(const calvin::Error& error) {
  fmt::print(stderr, "calvin-hand-eye: {}\n", error.message);
  return kFailed;
}

// One of the options of --method strobl.
bool set_joint_option(std::string_view option, std::string_view value, Arguments& arguments) {
  hand_eye_joint::Arguments& joint = arguments.joint;
  if (option == "--method" && value == "strobl") {
    arguments.is_joint = true;
  } else if (option == "--fix" && value == "pitch") {
    joint.options.pitch_known = true;
  } else if (option == "--fix" && value == "aspect") {
    joint.options.aspect_known = true;
  } else if (option == "--calibration") {
    joint.calibrations.emplace_back(value);
  } else if (option == "--rig") {
    joint.rig = value;
  } else {
    return false;
  }
  return true;
}

// An option with a value; false where the value is wrong.
bool set_option(std::string_view option, std::string_view value, Arguments& arguments) {
  const auto number = [&](double unit, std::optional<double>& to) {
    const auto given = calvin::parse_double(value);
    if (given && *given > 0) to = *given * unit;
    return to.has_value();
  };
  if (option == "--board") {
    arguments.board = value;
    return true;
  }
  if (option == "--turn-sigma") return number(kDegree, arguments.options.turn_sigma);
  if (option == "--place-sigma") return number(kMillimetre, arguments.options.place_sigma);
  if (set_joint_option(option, value, arguments)) return true;
  if (option != "--eye" || (value != "in-hand" && value != "to-hand")) return false;
  arguments.options.setup =
      value == "in-hand" ? calvin::EyeSetup::kInHand : calvin::EyeSetup::kToHand;
  return true;
}

// What is wrong with an option that was not understood.
std::string wrong_option(std::string_view option) {
  struct Wanted {
    std::string_view option;
    std::string_view value;
  };
  constexpr Wanted kAll[] = {{"--board", "the text of a board, as checkerboard:9x6:25mm"},
                             {"--eye", "in-hand or to-hand"},
                             {"--turn-sigma", "a number of degrees, more than 0"},
                             {"--place-sigma", "a number of mm, more than 0"},
                             {"--method", "strobl"},
                             {"--fix", "pitch or aspect"},
                             {"--calibration", "a file to write"},
                             {"--rig", "a file to write"}};
  for (const Wanted& wanted : kAll) {
    if (wanted.option == option) return fmt::format("{} takes {}.", option, wanted.value);
  }
  return fmt::format("'{}' is no option.", option);
}

// What is wrong with how many files there are, and which; empty where nothing is.
std::string wrong_words(const Arguments& arguments) {
  const hand_eye_joint::Arguments& joint = arguments.joint;
  const std::size_t words = arguments.words.size();
  if (!arguments.is_joint) {
    if (joint.is_asked_for()) {
      return "--fix, --calibration and --rig go with --method strobl.";
    }
    return words == 4 ? "" : "it takes a file to write, a calibration, views and poses.";
  }
  if (words < 4 || words % 2 != 0) {
    return "--method strobl takes a file to write, a calibration and views of each camera, and "
           "poses.";
  }
  const std::size_t cameras = words / 2 - 1;
  if (!joint.rig.empty() && cameras == 1) return "--rig takes two cameras or more.";
  if (joint.calibrations.size() > cameras) return "there are more --calibration than cameras.";
  return "";
}

// Whether the files to write are neither some that are read nor some that hold something else.
calvin::Status check_outputs(const Arguments& arguments) {
  std::vector<output_files::Output> outputs = {{arguments.words[0], {output_files::kHandEye}}};
  for (const std::string& file : arguments.joint.calibrations) {
    outputs.push_back({file, {output_files::kCalibration}});
  }
  if (!arguments.joint.rig.empty()) outputs.push_back({arguments.joint.rig, {output_files::kRig}});
  return output_files::check(outputs, std::span(arguments.words).subspan(1), kUsage);
}

// Absent for wrong usage, which was said.
std::optional<Arguments> parse(std::span<char*> given) {
  Arguments arguments;
  for (std::size_t i = 0; i < given.size(); ++i) {
    const std::string_view word = given[i];
    if (word == "--inverted") {
      arguments.inverted = true;
    } else if (word == "--free-scale") {
      arguments.options.free_scale = true;
    } else if (!word.starts_with("--")) {
      arguments.words.emplace_back(word);
    } else if (i + 1 == given.size() || !set_option(word, given[++i], arguments)) {
      wrong_usage(wrong_option(word));
      return std::nullopt;
    }
  }
  const std::string why = wrong_words(arguments);
  if (!why.empty()) {
    wrong_usage(why);
    return std::nullopt;
  }
  return arguments;
}

// A pose as a line of a robot's file has it, with its errors.
void print_pose(const char* name, const calvin::Pose& pose, const std::vector<double>& covariance) {
  const Eigen::Quaterniond q(calvin::to_se3(pose).rotation);
  const auto& t = pose.translation;
  fmt::print("{}: {:.6f} {:.6f} {:.6f} {:.6f} {:.6f} {:.6f} {:.6f} (x y z qx qy qz qw)\n", name,
             t[0], t[1], t[2], q.x(), q.y(), q.z(), q.w());
  const auto sigma = [&](std::size_t k, double unit) {
    return calvin::two_digits(std::sqrt(covariance[7 * k]) / unit);
  };
  fmt::print("  place +-{} {} {} mm, turn +-{} {} {} degrees\n", sigma(3, kMillimetre),
             sigma(4, kMillimetre), sigma(5, kMillimetre), sigma(0, kDegree), sigma(1, kDegree),
             sigma(2, kDegree));
}

void print(const calvin::HandEye& found) {
  const bool in_hand = found.setup == calvin::EyeSetup::kInHand;
  print_pose(in_hand ? "hand_from_camera" : "base_from_camera", found.mount_from_camera,
             found.mount_covariance);
  print_pose(in_hand ? "base_from_board" : "hand_from_board", found.carrier_from_board,
             found.carrier_covariance);
  fmt::print(
      "{} poses: the loops close within {} degrees and {} mm, corners within {:.3f} "
      "px (rms)\n",
      found.poses, calvin::two_digits(found.loop_turn / kDegree),
      calvin::two_digits(found.loop_place / kMillimetre), found.rms.value_or(0));
  fmt::print("noise of the robot: {} degrees and {} mm per axis\n",
             calvin::two_digits(found.robot_turn_sigma / kDegree),
             calvin::two_digits(found.robot_place_sigma / kMillimetre));
  if (found.scale) {
    fmt::print("lengths of the robot over those of the board: {:.5f} (+-{:.2g})\n",
               found.scale->value, found.scale->sigma);
  }
  if (found.aspect) {
    fmt::print("distances of rows of the board over those of columns: {:.5f} (+-{:.2g})\n",
               found.aspect->value, found.aspect->sigma);
  }
  for (const std::string& remark : found.remarks) fmt::print("{}\n", remark);
}

// What the robot told, as base_from_hand.
calvin::Result<std::vector<calvin::RobotPose>> read_poses(const Arguments& arguments) {
  auto poses = calvin::read_robot_poses(arguments.words.back());
  if (!poses || !arguments.inverted) return poses;
  for (calvin::RobotPose& pose : *poses) {
    pose.base_from_hand = calvin::to_pose(calvin::to_se3(pose.base_from_hand).inverse());
  }
  return poses;
}

// What is solved: views with the poses that belong to them.
calvin::Result<hand_eye_match::Matched> read(const Arguments& arguments,
                                             const std::string& source) {
  auto views = rig_views::read(source, arguments.board);
  if (!views) return tl::unexpected<calvin::Error>(views.error());
  const auto poses = read_poses(arguments);
  if (!poses) return tl::unexpected<calvin::Error>(poses.error());
  const std::size_t seen = views->size();
  auto matched = hand_eye_match::match(source, *std::move(views), *poses);
  if (!matched) return matched;
  fmt::print("{} views in {}, {} poses in {}: {} go together, by their {}\n", seen, source,
             poses->size(), arguments.words.back(), matched->views.size(), matched->by);
  return matched;
}

// Of --method strobl.
int run_jointly(Arguments arguments) {
  std::vector<calvin::RobotCamera> cameras;
  for (std::size_t i = 1; i + 2 < arguments.words.size(); i += 2) {
    auto calibration = hand_eye_joint::read_named(arguments.words[i]);
    if (!calibration) return failed(calibration.error());
    auto matched = read(arguments, arguments.words[i + 1]);
    if (!matched) return failed(matched.error());
    cameras.push_back(
        {{*std::move(calibration), std::move(matched->views)}, std::move(matched->lines)});
  }
  calvin::StroblOptions& options = arguments.joint.options;
  options.setup = arguments.options.setup;
  options.turn_sigma = arguments.options.turn_sigma;
  options.place_sigma = arguments.options.place_sigma;
  const auto poses = read_poses(arguments);
  if (!poses) return failed(poses.error());
  std::vector<calvin::Pose> hands;
  for (const calvin::RobotPose& pose : *poses) hands.push_back(pose.base_from_hand);
  const auto solved = calvin::solve_strobl(cameras, hands, options);
  if (!solved) return failed(solved.error());
  const auto written = hand_eye_joint::write(arguments.words[0], arguments.joint, *solved);
  print(solved->hand_eye);
  hand_eye_joint::print(*solved);
  return written ? 0 : failed(written.error());
}

int run(const Arguments& arguments) {
  auto calibration = calvin::read_calibration(arguments.words[1]);
  if (!calibration) return failed(calibration.error());
  auto matched = read(arguments, arguments.words[2]);
  if (!matched) return failed(matched.error());
  const auto solved = calvin::solve_hand_eye({*std::move(calibration), std::move(matched->views)},
                                             matched->poses, arguments.options);
  if (!solved) return failed(solved.error());
  const auto written = calvin::write_hand_eye(arguments.words[0], solved->result);
  print(solved->result);
  return written ? 0 : failed(written.error());
}

int run_tool(int argc, char** argv) {
  const std::span<char*> given(argv + 1, static_cast<std::size_t>(argc - 1));
  if (given.size() == 1 && std::string_view(given[0]) == "--help") {
    fmt::print("{}", kUsage);
    return 0;
  }
  const auto arguments = parse(given);
  if (!arguments) return kWrongUsage;
  if (const auto good = check_outputs(*arguments); !good) return failed(good.error());
  return arguments->is_joint ? run_jointly(*arguments) : run(*arguments);
}

}  // namespace

int main(int argc, char** argv) {
  return calvin_tools::run("calvin-hand-eye", run_tool, argc, argv);
}
