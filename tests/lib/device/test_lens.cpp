// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What is read of a lens, and the words for nodes that cannot be read.

#include "calvin/device/lens.hpp"

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "calvin_config.h"
#include "fake_lens.hpp"

namespace calvin {

namespace {

class Lens : public ::testing::Test {
 protected:
  void SetUp() override {
    fake_lens::change([](fake_lens::Node& node) { node = {}; });
  }
  static std::string refusal(const std::string& node) {
    const auto read = read_lens(node);
    return read ? "it was read" : read.error().message;
  }
  static bool contains(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
  }
};

#if CALVIN_HAVE_V4L2

TEST_F(Lens, IsReadWithTheNameOfItsCamera) {
  fake_lens::set(V4L2_CID_FOCUS_AUTO, 0);
  fake_lens::set(V4L2_CID_FOCUS_ABSOLUTE, 45);
  fake_lens::set(V4L2_CID_ZOOM_ABSOLUTE, 130);
  const auto lens = read_lens("/dev/lens0");
  ASSERT_TRUE(lens) << lens.error().message;
  EXPECT_EQ(lens->device.node, "/dev/lens0");
  EXPECT_EQ(lens->device.name, "Fake camera");
  EXPECT_EQ(lens->device.bus, "usb-fake-1");
  EXPECT_EQ(lens->device.autofocus, false);
  EXPECT_EQ(lens->focus, 45);
  EXPECT_EQ(lens->zoom, 130);
}

TEST_F(Lens, ACameraWithoutControlsHasNone) {
  const auto lens = read_lens("/dev/lens0");
  ASSERT_TRUE(lens) << lens.error().message;
  EXPECT_EQ(lens->device.name, "Fake camera");
  EXPECT_FALSE(lens->device.autofocus || lens->focus || lens->zoom);
}

// An inactive position is the newest that the driver knows; what is disabled or cannot be read is
// as good as absent.
TEST_F(Lens, FlagsSayWhatCounts) {
  fake_lens::set(V4L2_CID_FOCUS_AUTO, 1);
  fake_lens::set(V4L2_CID_FOCUS_ABSOLUTE, 45, V4L2_CTRL_FLAG_INACTIVE);
  fake_lens::set(V4L2_CID_ZOOM_ABSOLUTE, 130, V4L2_CTRL_FLAG_DISABLED);
  auto lens = read_lens("/dev/lens0");
  ASSERT_TRUE(lens) << lens.error().message;
  EXPECT_EQ(lens->device.autofocus, true);
  EXPECT_EQ(lens->focus, 45);
  EXPECT_FALSE(lens->zoom);
  fake_lens::set(V4L2_CID_FOCUS_ABSOLUTE, 45, V4L2_CTRL_FLAG_WRITE_ONLY);
  lens = read_lens("/dev/lens0");
  ASSERT_TRUE(lens) << lens.error().message;
  EXPECT_FALSE(lens->focus);
}

TEST_F(Lens, ASignalDoesNotEndTheReading) {
  fake_lens::set(V4L2_CID_ZOOM_ABSOLUTE, 130);
  fake_lens::change([](fake_lens::Node& node) { node.interrupted = 3; });
  const auto lens = read_lens("/dev/lens0");
  ASSERT_TRUE(lens) << lens.error().message;
  EXPECT_EQ(lens->zoom, 130);
}

// Each with what to do.
TEST_F(Lens, WhatTheSystemRefusesIsTold) {
  const std::vector<std::pair<int, const char*>> refusals = {{ENOENT, "Plug the camera in"},
                                                             {ENODEV, "Plug the camera in"},
                                                             {ENXIO, "Plug the camera in"},
                                                             {EACCES, "group video"},
                                                             {EBUSY, "fuser"},
                                                             {EMFILE, "ulimit -n"},
                                                             {EIO, "dmesg"}};
  for (const auto& [error, advice] : refusals) {
    fake_lens::change([e = error](fake_lens::Node& node) { node.open_error = e; });
    EXPECT_TRUE(contains(refusal("/dev/lens0"), advice)) << refusal("/dev/lens0");
    EXPECT_TRUE(contains(refusal("/dev/lens0"), "'/dev/lens0'"));
  }
}

TEST_F(Lens, OneThatIsUnpluggedWhileItIsReadIsTold) {
  fake_lens::change([](fake_lens::Node& node) { node.error = ENODEV; });
  EXPECT_TRUE(contains(refusal("/dev/lens0"), "Plug the camera in")) << refusal("/dev/lens0");
  EXPECT_EQ(read_lens("/dev/lens0").error().code, ErrorCode::kIo);
}

TEST_F(Lens, AFileThatIsNotThereIsNotFound) {
  EXPECT_EQ(read_lens("/nowhere/video0").error().code, ErrorCode::kNotFound);
  EXPECT_TRUE(contains(refusal("/nowhere/video0"), "v4l2-ctl --list-devices"));
}

TEST_F(Lens, WhatIsNoCameraIsRefused) {
  for (const char* path : {"/dev/null", "/", "/proc/self/exe"}) {
    EXPECT_TRUE(contains(refusal(path), "is not the video of a V4L2 camera")) << refusal(path);
  }
  // The second node of a UVC camera has its metadata, and no controls.
  fake_lens::change([](fake_lens::Node& node) { node.capabilities = V4L2_CAP_META_CAPTURE; });
  EXPECT_TRUE(contains(refusal("/dev/lens1"), "is not the video of a V4L2 camera"));
}

#else

TEST_F(Lens, ABuildWithoutV4l2SaysSo) {
  EXPECT_EQ(read_lens("/dev/lens0").error().code, ErrorCode::kUnsupported);
  EXPECT_TRUE(contains(refusal("/dev/lens0"), "-Dv4l2=enabled"));
}

#endif

}  // namespace

}  // namespace calvin
