// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// HandEye <-> JSON, around the native form of the camera's calibration.

#include "calvin/io/hand_eye_io.hpp"

#include <exception>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "calvin/core/file.hpp"
#include "calvin/io/file_text.hpp"
#include "calvin/io/native_fields.hpp"
#include "calvin/io/node_map.hpp"
#include "calvin/io/text_document.hpp"

namespace calvin {

namespace {

using io::Fields;
using io::Node;
using io::NodeMap;

constexpr std::string_view kHandEyeFormat = "calvin-hand-eye";
constexpr int kHandEyeVersion = 1;
constexpr std::size_t kPose = 6;

// The names of the two poses say what camera and board are fixed to.
struct SetupNames {
  EyeSetup setup;
  const char* name;
  const char* camera;
  const char* board;
};
constexpr SetupNames kSetups[] = {
    {EyeSetup::kInHand, "in-hand", "hand_from_camera", "base_from_board"},
    {EyeSetup::kToHand, "to-hand", "base_from_camera", "hand_from_board"},
};

const SetupNames& names_of(EyeSetup setup) { return kSetups[setup == EyeSetup::kInHand ? 0 : 1]; }

// ---- Reading ------------------------------------------------------------------------------------

EyeSetup read_setup(Fields& fields) {
  const std::string name = fields.string("eye");
  for (const SetupNames& setup : kSetups) {
    if (name == setup.name) return setup.setup;
  }
  fields.complain("eye", "is neither 'in-hand' nor 'to-hand'");
  return EyeSetup::kInHand;
}

void read_place(Fields& fields, const char* key, const char* covariance_key, Pose& pose,
                std::vector<double>& covariance) {
  pose = io::read_pose(fields.map(key));
  if (const Node* rows = fields.find(covariance_key); rows != nullptr && !rows->items.empty()) {
    covariance =
        io::read_covariance(fields, kPose, "numbers say where something is", covariance_key);
  }
  io::check_place(fields, key, pose, covariance_key, covariance);
}

std::optional<LengthRatio> read_ratio(Fields& fields, const char* key) {
  if (fields.find(key) == nullptr) return std::nullopt;
  Fields ratio = fields.map(key);
  return LengthRatio{ratio.number("value"), ratio.number("sigma")};
}

void read_fields(Fields& fields, HandEye& hand_eye) {
  hand_eye.setup = read_setup(fields);
  const SetupNames& names = names_of(hand_eye.setup);
  hand_eye.calibration = io::read_camera(fields);
  if (fields.failed()) return;
  hand_eye.calibration.camera = fields.optional_string("camera");
  read_place(fields, names.camera, "covariance", hand_eye.mount_from_camera,
             hand_eye.mount_covariance);
  read_place(fields, names.board, "board_covariance", hand_eye.carrier_from_board,
             hand_eye.carrier_covariance);
  hand_eye.poses = fields.integer("poses");
  hand_eye.rms = fields.optional_number("rms");
  hand_eye.corner_factor = fields.optional_number("corner_factor").value_or(1);
  Fields loop = fields.map("loop");
  hand_eye.loop_turn = loop.number("turn");
  hand_eye.loop_place = loop.number("place");
  Fields robot = fields.map("robot_sigma");
  hand_eye.robot_turn_sigma = robot.number("turn");
  hand_eye.robot_place_sigma = robot.number("place");
  hand_eye.scale = read_ratio(fields, "scale");
  hand_eye.aspect = read_ratio(fields, "aspect");
  for (const Node& remark : fields.list("remarks")) {
    if (remark.kind == Node::Kind::kString) hand_eye.remarks.push_back(remark.text);
  }
}

Result<HandEye> hand_eye_of(std::string_view content) {
  const auto root = io::parse_text_document(content);
  if (!root) return tl::unexpected(root.error());
  if (root->kind != Node::Kind::kMap) {
    return make_error(ErrorCode::kMalformed, "it has none of the fields of one");
  }
  std::optional<Error> problem;
  Fields fields(*root, "", problem);
  io::read_head(fields, kHandEyeFormat, kHandEyeVersion, "a hand-eye calibration");
  HandEye hand_eye;
  if (!problem) read_fields(fields, hand_eye);
  if (problem) return tl::unexpected(*problem);
  return hand_eye;
}

constexpr io::FileKind kHandEyeFile = {"The text", "a hand-eye calibration",
                                       "Give a file that calvin-hand-eye has written."};

// ---- Writing ------------------------------------------------------------------------------------

void put_ratio(const char* key, const std::optional<LengthRatio>& ratio, NodeMap& map) {
  if (!ratio) return;
  map.put(key, NodeMap()
                   .put("value", io::number_node(ratio->value))
                   .put("sigma", io::number_node(ratio->sigma))
                   .take());
}

Result<std::string> print_fields(const HandEye& hand_eye) {
  auto calibration = io::camera_node(hand_eye.calibration);
  if (!calibration) return tl::unexpected(calibration.error());
  const SetupNames& names = names_of(hand_eye.setup);
  NodeMap map;
  map.put("format", io::text_node(kHandEyeFormat));
  map.put("version", io::integer_node(kHandEyeVersion));
  map.put("eye", io::text_node(names.name));
  map.put("camera", io::text_node(hand_eye.calibration.camera));
  map.put(names.camera, io::pose_node(hand_eye.mount_from_camera));
  map.put_rows("covariance", hand_eye.mount_covariance, kPose);
  map.put(names.board, io::pose_node(hand_eye.carrier_from_board));
  map.put_rows("board_covariance", hand_eye.carrier_covariance, kPose);
  map.put("poses", io::integer_node(hand_eye.poses));
  map.put("rms", hand_eye.rms);
  map.put("corner_factor", io::number_node(hand_eye.corner_factor));
  map.put("loop", NodeMap()
                      .put("turn", io::number_node(hand_eye.loop_turn))
                      .put("place", io::number_node(hand_eye.loop_place))
                      .take());
  map.put("robot_sigma", NodeMap()
                             .put("turn", io::number_node(hand_eye.robot_turn_sigma))
                             .put("place", io::number_node(hand_eye.robot_place_sigma))
                             .take());
  put_ratio("scale", hand_eye.scale, map);
  put_ratio("aspect", hand_eye.aspect, map);
  Node remarks = {Node::Kind::kList, {}, {}, {}};
  for (const std::string& remark : hand_eye.remarks) remarks.items.push_back(io::text_node(remark));
  map.put("remarks", std::move(remarks));
  map.put("calibration", *std::move(calibration));
  return io::print_json(map.take());
}

}  // namespace

Result<HandEye> parse_hand_eye(std::string_view content, std::string_view name) {
  return io::parse_as<HandEye>(kHandEyeFile, name, hand_eye_of, content);
}

Result<HandEye> read_hand_eye(const std::filesystem::path& path) {
  const auto content = read_file(path.string());
  if (!content) return tl::unexpected(content.error());
  return parse_hand_eye(*content, path.string());
}

Result<std::string> print_hand_eye(const HandEye& hand_eye) {
  try {
    return print_fields(hand_eye);
  } catch (const std::exception& exception) {
    return make_error(
        ErrorCode::kInvalidArgument,
        fmt::format("The hand-eye calibration cannot be written: {}.", exception.what()));
  }
}

Status write_hand_eye(const std::filesystem::path& path, const HandEye& hand_eye) {
  const auto printed = print_hand_eye(hand_eye);
  if (!printed) return tl::unexpected(printed.error());
  return write_file(path.string(), *printed);
}

}  // namespace calvin
