// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Asks a worker for the lens of a V4L2 camera, again and again.

#include "undistort/lens_follower.hpp"

#include <utility>

#include <fmt/format.h>

namespace calvin::gst {

namespace {

// A reading takes some milliseconds on the bus of a USB camera.
constexpr auto kPause = std::chrono::milliseconds(100);
// The drivers of USB cameras themselves give up after that.
constexpr auto kPatience = std::chrono::seconds(5);

}  // namespace

Status LensFollower::start(const std::string& node, Clock::time_point now) {
  node_ = node;
  desk_ = std::make_shared<Desk>();
  asking_ = unreadable_ = false;
  lens_.reset();
  if (node_.empty()) return {};
  if (const Status started = worker_.start(); !started) return started;
  ask(now);
  return {};
}

void LensFollower::ask(Clock::time_point now) {
  asked_ = now;
  asking_ = true;
  worker_.offer([desk = desk_, node = node_](const std::stop_token& /*stop*/) {
    auto read = read_lens(node);
    const std::lock_guard guard(desk->lock);
    desk->read = std::move(read);
  });
}

void LensFollower::take(Result<LensState> read, std::vector<Error>& errors) {
  if (read) {
    lens_ = *std::move(read);
    unreadable_ = false;
    return;
  }
  if (std::exchange(unreadable_, true)) return;
  read.error().message +=
      lens_ ? " Until it is read again the frames are undistorted as the lens stood."
            : " Until it is read, zoom-position alone says where the lens stands.";
  errors.push_back(std::move(read.error()));
}

void LensFollower::follow(Clock::time_point now, std::vector<Error>& errors) {
  if (node_.empty()) return;
  std::optional<Result<LensState>> read;
  {
    const std::lock_guard guard(desk_->lock);
    read = std::exchange(desk_->read, std::nullopt);
  }
  if (read) {
    asking_ = false;
    take(*std::move(read), errors);
  }
  if (asking_ && !unreadable_ && now - asked_ > kPatience) {
    take(make_error(ErrorCode::kIo,
                    fmt::format("The camera '{}' does not tell where its lens stands: its driver "
                                "waits for it. Unplug the camera and plug it in again; dmesg may "
                                "tell more.",
                                node_)),
         errors);
  }
  if (!asking_ && now - asked_ >= kPause) ask(now);
}

}  // namespace calvin::gst
