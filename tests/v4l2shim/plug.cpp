// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Cables that are pulled out and put in again.

#include "plug.hpp"

#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <atomic>

namespace calvin::v4l2 {

namespace {

// By camera; of those without a file.
std::array<std::atomic<bool>, kMaxCameras> pulled;

}  // namespace

bool is_plugged_in(const Settings& settings) {
  if (pulled[static_cast<std::size_t>(settings.camera)]) return false;
  return settings.plug.empty() || ::access(settings.plug.c_str(), F_OK) == 0;
}

void pull_plug(const Settings& settings) {
  if (settings.plug.empty()) {
    pulled[static_cast<std::size_t>(settings.camera)] = true;
  } else {
    ::unlink(settings.plug.c_str());
  }
}

Doorbell::Doorbell() {
  int ends[2] = {-1, -1};
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0, ends) != 0) return;
  caller_ = ends[0];
  own_ = ends[1];
  // An end that is closed before it has read everything is an error (ECONNRESET) at the other end.
  ::send(caller_, "", 1, MSG_NOSIGNAL);
}

Doorbell::~Doorbell() {
  hang_up();
  ::close(caller_);
}

void Doorbell::ring() const { ::send(own_, "", 1, MSG_NOSIGNAL); }

bool Doorbell::answer() const {
  char byte = 0;
  return ::recv(caller_, &byte, 1, 0) == 1;
}

void Doorbell::hang_up() {
  if (own_ >= 0) ::close(own_);
  own_ = -1;
}

}  // namespace calvin::v4l2
