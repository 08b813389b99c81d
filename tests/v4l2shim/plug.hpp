// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Whether the cable of an emulated camera is in, and how a program hears that it is not.
#pragma once

#include "settings.hpp"

namespace calvin::v4l2 {

// With a file of CALVIN_V4L2_PLUG the cable is in while that exists, whoever makes or removes it;
// else until it is pulled, for the rest of the process.
[[nodiscard]] bool is_plugged_in(const Settings& settings);
void pull_plug(const Settings& settings);

// What a program polls: readable while something is posted; once hung up, poll() says POLLERR and
// POLLHUP for ever, as of a device that is gone. One end of a pair of sockets: the kernel lets
// nobody but itself put an eventfd into error.
class Doorbell {
 public:
  Doorbell();
  Doorbell(const Doorbell&) = delete;
  Doorbell& operator=(const Doorbell&) = delete;
  ~Doorbell();

  // To be duplicated for the caller.
  [[nodiscard]] int fd() const noexcept { return caller_; }
  void ring() const;
  // Takes back one ring; false where there is none.
  [[nodiscard]] bool answer() const;
  void hang_up();

 private:
  int caller_ = -1;
  int own_ = -1;
};

}  // namespace calvin::v4l2
