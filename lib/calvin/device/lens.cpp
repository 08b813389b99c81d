// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Asks V4L2 for the controls of a lens.

#include "calvin/device/lens.hpp"

#include <fmt/format.h>

#include "calvin_config.h"

#if CALVIN_HAVE_V4L2

#include <fcntl.h>
#include <linux/videodev2.h>
#include <sys/ioctl.h>

#include <cerrno>
#include <cstring>
#include <string_view>
#include <system_error>

#include "calvin/core/descriptor.hpp"

namespace calvin {

namespace {

// 0, or what errno says.
template <typename T>
int ask(const Descriptor& file, unsigned long request, T& argument) {
  while (::ioctl(file.get(), request, &argument) < 0) {
    if (errno != EINTR) return errno;
  }
  return 0;
}

// What to do where the system refuses a node.
std::string_view advice(int error) {
  switch (error) {
    case ENOENT:
    case ENODEV:
    case ENXIO:
      return "Plug the camera in; v4l2-ctl --list-devices lists those that are there.";
    case EACCES:
    case EPERM:
      return "Let the user of this program read it: on most systems those of the group video may.";
    case EBUSY:
      return "End the program that has it for itself alone (fuser -v NODE tells which).";
    case EMFILE:
    case ENFILE:
      return "Close files that the program has open, or raise their limit (ulimit -n).";
    default:
      return "Unplug the camera and plug it in again; dmesg may tell more.";
  }
}

tl::unexpected<Error> not_read(const std::string& node, int error) {
  return make_error(error == ENOENT ? ErrorCode::kNotFound : ErrorCode::kIo,
                    fmt::format("The lens of the camera '{}' cannot be read: {}. {}", node,
                                std::generic_category().message(error), advice(error)));
}

tl::unexpected<Error> no_camera(const std::string& node) {
  return make_error(ErrorCode::kInvalidArgument,
                    fmt::format("'{}' is not the video of a V4L2 camera: name the node that "
                                "v4l2src reads, such as device=/dev/video0 (v4l2-ctl "
                                "--list-devices lists them).",
                                node));
}

// The text of a field that may be full.
template <std::size_t N>
std::string text_of(const __u8 (&field)[N]) {
  std::string text(N, '\0');
  std::memcpy(text.data(), field, N);
  return text.substr(0, text.find('\0'));
}

// The value of a control; absent where the camera has none, and where the driver says that it means
// nothing. One that is inactive, as the focus is while autofocus is on, is what the driver knows.
Result<std::optional<int>> read_control(const Descriptor& file, const std::string& node,
                                        std::uint32_t id) {
  v4l2_queryctrl query{};
  query.id = id;
  const int known = ask(file, VIDIOC_QUERYCTRL, query);
  if (known == EINVAL || known == ENOTTY) return std::nullopt;
  if (known != 0) return not_read(node, known);
  if ((query.flags & (V4L2_CTRL_FLAG_DISABLED | V4L2_CTRL_FLAG_WRITE_ONLY)) != 0) {
    return std::nullopt;
  }
  v4l2_control control{};
  control.id = id;
  const int read = ask(file, VIDIOC_G_CTRL, control);
  if (read == EINVAL || read == EACCES) return std::nullopt;
  if (read != 0) return not_read(node, read);
  return control.value;
}

bool is_camera(const v4l2_capability& capability) {
  const bool of_this_node = (capability.capabilities & V4L2_CAP_DEVICE_CAPS) != 0;
  const std::uint32_t all = of_this_node ? capability.device_caps : capability.capabilities;
  return (all & (V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_VIDEO_CAPTURE_MPLANE)) != 0;
}

}  // namespace

Result<LensState> read_lens(const std::string& node) {
  const Descriptor file(::open(node.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC));
  if (!file) return not_read(node, errno);
  v4l2_capability capability{};
  const int known = ask(file, VIDIOC_QUERYCAP, capability);
  if (known == ENOTTY || known == EINVAL) return no_camera(node);
  if (known != 0) return not_read(node, known);
  if (!is_camera(capability)) return no_camera(node);
  LensState lens;
  lens.device = {node, text_of(capability.card), text_of(capability.bus_info), std::nullopt};
  const auto autofocus = read_control(file, node, V4L2_CID_FOCUS_AUTO);
  const auto focus = read_control(file, node, V4L2_CID_FOCUS_ABSOLUTE);
  const auto zoom = read_control(file, node, V4L2_CID_ZOOM_ABSOLUTE);
  for (const auto* control : {&autofocus, &focus, &zoom}) {
    if (!*control) return tl::unexpected<Error>(control->error());
  }
  if (*autofocus) lens.device.autofocus = **autofocus != 0;
  lens.focus = *focus;
  lens.zoom = *zoom;
  return lens;
}

}  // namespace calvin

#else

namespace calvin {

Result<LensState> read_lens(const std::string& node) {
  return make_error(ErrorCode::kUnsupported,
                    fmt::format("The lens of the camera '{}' cannot be read: this build was made "
                                "without V4L2. Build it with -Dv4l2=enabled.",
                                node));
}

}  // namespace calvin

#endif
