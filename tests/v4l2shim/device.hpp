// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Device: an emulated V4L2 capture device; one per open().
#pragma once

#include <linux/videodev2.h>
#include <unistd.h>

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "controls.hpp"
#include "counters.hpp"
#include "film.hpp"
#include "plug.hpp"
#include "settings.hpp"

namespace calvin::v4l2 {

class Device {
 public:
  // Not `blocking`: DQBUF answers EAGAIN where no filled buffer waits.
  Device(Settings settings, bool blocking);
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;
  ~Device();

  // The answer to ioctl(): 0 or a negative errno. ENOTTY for what is not emulated, ENODEV for ever
  // once the cable was pulled.
  int control(std::uint32_t request, void* argument);

  // To duplicate as the caller's descriptor: readable while a filled buffer waits.
  [[nodiscard]] int ready_fd() const noexcept { return ready_.fd(); }
  // What mmap() at the offset of a buffer maps.
  [[nodiscard]] int memory_fd() const noexcept { return memory_fd_; }

  // Descriptors that the caller holds.
  std::atomic<int> references = 0;
  // The one that opened it.
  const pid_t process = ::getpid();

 private:
  struct Buffer {
    bool queued = false;
    bool done = false;
    std::uint32_t used = 0;
    std::uint32_t sequence = 0;
    timeval timestamp{};
  };

  int answer(std::uint32_t request, void* argument);
  int control_buffers(std::uint32_t request, void* argument);
  int describe(v4l2_capability& capability) const;
  static int enumerate(v4l2_input& input);
  int enumerate(v4l2_fmtdesc& format) const;
  int enumerate(v4l2_frmsizeenum& size) const;
  int enumerate(v4l2_frmivalenum& interval) const;
  int get_rate(v4l2_streamparm& parameters) const;
  void complete(v4l2_pix_format& pix) const;
  int format(std::uint32_t request, v4l2_format& format);
  int request_buffers(v4l2_requestbuffers& request);
  int fill_in(v4l2_buffer& buffer) const;
  int queue(v4l2_buffer& buffer);
  int dequeue(v4l2_buffer& buffer);
  int start();
  int stop();
  void play(const std::stop_token& stop);
  void expose(std::uint32_t sequence);
  bool fill(const std::vector<std::uint8_t>& frame, std::uint32_t sequence);
  bool is_gone();
  [[nodiscard]] bool is_offered(std::uint32_t fourcc) const;

  const Settings settings_;
  const bool blocking_;
  ImageSize size_;
  std::uint32_t fourcc_;
  Controls& controls_;  // of all that have the camera open
  int memory_fd_ = -1;
  std::uint8_t* memory_ = nullptr;
  std::size_t buffer_size_ = 0;  // whole pages
  std::unique_ptr<Film> film_;
  Counters counters_;  // of the thread, while it runs

  mutable std::mutex mutex_;  // guards what follows
  std::condition_variable_any wake_;
  Doorbell ready_;  // rings for each filled buffer
  bool gone_ = false;
  std::vector<Buffer> buffers_;
  std::deque<std::uint32_t> queued_;
  std::deque<std::uint32_t> done_;
  std::jthread thread_;
};

}  // namespace calvin::v4l2
