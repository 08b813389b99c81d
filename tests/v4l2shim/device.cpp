// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Answers the ioctls of a capture device and fills its buffers with the frames of a Film.

#undef _FILE_OFFSET_BITS  // mmap and ftruncate under their own names
#include "device.hpp"

#include <poll.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <string>
#include <string_view>

namespace calvin::v4l2 {

namespace {

constexpr std::uint32_t kMaxBuffers = 32;

template <std::size_t N>
void copy_text(__u8 (&to)[N], std::string_view text) {
  const std::size_t length = std::min(text.size(), N - 1);
  std::memcpy(to, text.data(), length);
}

// Some arguments arrive with garbage in what the driver fills in.
template <typename T>
T fresh(const T& /*old*/) {
  T value;
  std::memset(&value, 0, sizeof(value));
  return value;
}

template <typename T>
T& as(void* argument) {
  return *static_cast<T*>(argument);
}

}  // namespace

Device::Device(Settings settings, bool blocking)
    : settings_(std::move(settings)),
      blocking_(blocking),
      size_(settings_.sizes.front()),
      fourcc_(settings_.fourccs.front()),
      controls_(Controls::of(settings_.path)) {}

Device::~Device() {
  stop();
  v4l2_requestbuffers none{};
  request_buffers(none);
}

bool Device::is_offered(std::uint32_t fourcc) const {
  const auto& offered = settings_.fourccs;
  return std::find(offered.begin(), offered.end(), fourcc) != offered.end();
}

int Device::describe(v4l2_capability& capability) const {
  capability = fresh(capability);
  copy_text(capability.driver, "uvcvideo");  // v4l2src spares such cameras the interlace probing
  copy_text(capability.card, "Emulated camera");
  copy_text(capability.bus_info, "usb-emulated-" + std::to_string(settings_.camera + 1));
  capability.version = 0x060100;
  capability.device_caps = V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_STREAMING | V4L2_CAP_EXT_PIX_FORMAT;
  capability.capabilities = capability.device_caps | V4L2_CAP_DEVICE_CAPS;
  return 0;
}

int Device::enumerate(v4l2_input& input) {
  if (input.index > 0) return -EINVAL;
  input = fresh(input);
  copy_text(input.name, "Camera 1");
  input.type = V4L2_INPUT_TYPE_CAMERA;
  return 0;
}

int Device::enumerate(v4l2_fmtdesc& format) const {
  if (format.type != V4L2_BUF_TYPE_VIDEO_CAPTURE || format.index >= settings_.fourccs.size())
    return -EINVAL;
  const std::uint32_t index = format.index;
  format = fresh(format);
  format.index = index;
  format.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  format.pixelformat = settings_.fourccs[index];
  const PixelFormat& pixels = *find_pixel_format(format.pixelformat);
  format.flags = pixels.line_bytes == 0 ? V4L2_FMT_FLAG_COMPRESSED : 0;
  copy_text(format.description, pixels.description);
  return 0;
}

int Device::enumerate(v4l2_frmsizeenum& size) const {
  if (size.index >= settings_.sizes.size() || !is_offered(size.pixel_format)) return -EINVAL;
  size.type = V4L2_FRMSIZE_TYPE_DISCRETE;
  size.discrete.width = static_cast<__u32>(settings_.sizes[size.index].width);
  size.discrete.height = static_cast<__u32>(settings_.sizes[size.index].height);
  return 0;
}

int Device::enumerate(v4l2_frmivalenum& interval) const {
  if (interval.index > 0 || !is_offered(interval.pixel_format)) return -EINVAL;
  interval.type = V4L2_FRMIVAL_TYPE_DISCRETE;
  interval.discrete = {1, settings_.rate};
  return 0;
}

int Device::get_rate(v4l2_streamparm& parameters) const {
  if (parameters.type != V4L2_BUF_TYPE_VIDEO_CAPTURE) return -EINVAL;
  parameters.parm.capture = fresh(parameters.parm.capture);
  parameters.parm.capture.capability = V4L2_CAP_TIMEPERFRAME;
  parameters.parm.capture.timeperframe = {1, settings_.rate};
  return 0;
}

// The nearest that the device has, as TRY_FMT promises.
void Device::complete(v4l2_pix_format& pix) const {
  const auto distance = [&](ImageSize size) {
    return std::abs(static_cast<long>(pix.width) - size.width) +
           std::abs(static_cast<long>(pix.height) - size.height);
  };
  const ImageSize size =
      *std::min_element(settings_.sizes.begin(), settings_.sizes.end(),
                        [&](auto a, auto b) { return distance(a) < distance(b); });
  const std::uint32_t fourcc =
      is_offered(pix.pixelformat) ? pix.pixelformat : settings_.fourccs.front();
  pix = fresh(pix);
  pix.width = static_cast<__u32>(size.width);
  pix.height = static_cast<__u32>(size.height);
  pix.pixelformat = fourcc;
  pix.field = V4L2_FIELD_NONE;
  const PixelFormat& pixels = *find_pixel_format(fourcc);
  pix.bytesperline = pix.width * pixels.line_bytes;
  pix.sizeimage = pix.width * pix.height * pixels.frame_bits / 8;
  pix.colorspace = pixels.line_bytes == 0 ? V4L2_COLORSPACE_JPEG : V4L2_COLORSPACE_SRGB;
}

int Device::format(std::uint32_t request, v4l2_format& format) {
  if (format.type != V4L2_BUF_TYPE_VIDEO_CAPTURE) return -EINVAL;
  v4l2_pix_format& pix = format.fmt.pix;
  const std::lock_guard lock(mutex_);
  if (request == VIDIOC_G_FMT) {
    pix.width = static_cast<__u32>(size_.width);
    pix.height = static_cast<__u32>(size_.height);
    pix.pixelformat = fourcc_;
  }
  complete(pix);
  if (request != VIDIOC_S_FMT) return 0;
  if (!buffers_.empty()) return -EBUSY;
  fourcc_ = pix.pixelformat;
  size_ = {static_cast<int>(pix.width), static_cast<int>(pix.height)};
  film_.reset();
  return 0;
}

int Device::request_buffers(v4l2_requestbuffers& request) {
  const std::lock_guard lock(mutex_);
  if (thread_.joinable()) return -EBUSY;
  if (memory_ != nullptr) ::munmap(memory_, buffer_size_ * buffers_.size());
  if (memory_fd_ >= 0) ::close(memory_fd_);
  memory_ = nullptr;
  memory_fd_ = -1;
  buffers_.clear();
  request.capabilities = V4L2_BUF_CAP_SUPPORTS_MMAP;
  if (request.count == 0) return 0;
  if (request.memory != V4L2_MEMORY_MMAP) return -EINVAL;
  request.count = std::min(request.count, kMaxBuffers);
  const auto page = static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
  const auto pixels = static_cast<std::size_t>(size_.width) * size_.height;
  const std::size_t bytes = pixels * find_pixel_format(fourcc_)->frame_bits / 8;
  buffer_size_ = (bytes + page - 1) / page * page;
  const std::size_t all = buffer_size_ * request.count;
  memory_fd_ = ::memfd_create("v4l2shim", MFD_CLOEXEC);
  if (memory_fd_ < 0 || ::ftruncate(memory_fd_, static_cast<off_t>(all)) != 0) return -ENOMEM;
  void* memory = ::mmap(nullptr, all, PROT_READ | PROT_WRITE, MAP_SHARED, memory_fd_, 0);
  if (memory == MAP_FAILED) return -ENOMEM;
  memory_ = static_cast<std::uint8_t*>(memory);
  buffers_.resize(request.count);
  return 0;
}

int Device::fill_in(v4l2_buffer& buffer) const {
  if (buffer.type != V4L2_BUF_TYPE_VIDEO_CAPTURE || buffer.index >= buffers_.size()) return -EINVAL;
  const Buffer& b = buffers_[buffer.index];
  const std::uint32_t index = buffer.index;
  buffer = fresh(buffer);
  buffer.index = index;
  buffer.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  buffer.memory = V4L2_MEMORY_MMAP;
  buffer.field = V4L2_FIELD_NONE;
  buffer.length = static_cast<__u32>(buffer_size_);
  buffer.m.offset = static_cast<__u32>(buffer_size_ * index);
  buffer.bytesused = b.used;
  buffer.sequence = b.sequence;
  buffer.timestamp = b.timestamp;
  // Without the clock's name v4l2src does not trust the timestamps.
  buffer.flags = V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC | (b.queued ? V4L2_BUF_FLAG_QUEUED : 0) |
                 (b.done ? V4L2_BUF_FLAG_DONE : 0);
  return 0;
}

int Device::queue(v4l2_buffer& buffer) {
  const std::lock_guard lock(mutex_);
  if (buffer.memory != V4L2_MEMORY_MMAP || buffer.index >= buffers_.size()) return -EINVAL;
  Buffer& b = buffers_[buffer.index];
  if (b.queued || b.done) return -EINVAL;
  b.queued = true;
  queued_.push_back(buffer.index);
  return fill_in(buffer);
}

int Device::dequeue(v4l2_buffer& buffer) {
  for (;;) {
    {
      const std::lock_guard lock(mutex_);
      if (gone_) return -ENODEV;
      if (!thread_.joinable()) return -EINVAL;
      if (!done_.empty()) {
        if (!ready_.answer()) return -EIO;
        buffer.index = done_.front();
        done_.pop_front();
        const int status = fill_in(buffer);
        buffer.flags &= ~static_cast<__u32>(V4L2_BUF_FLAG_DONE);
        buffers_[buffer.index].done = false;
        return status;
      }
    }
    if (!blocking_) return -EAGAIN;
    pollfd one = {ready_.fd(), POLLIN, 0};
    ::poll(&one, 1, 100);  // not for ever: STREAMOFF may come from another thread
  }
}

int Device::start() {
  const std::lock_guard lock(mutex_);
  if (thread_.joinable()) return 0;
  if (buffers_.empty()) return -EINVAL;
  if (!film_) film_ = std::make_unique<Film>(*find_pixel_format(fourcc_), size_, settings_.camera);
  film_->show(controls_.look());  // also of what is rendered beforehand
  if (settings_.ring > 0) film_->render_all(settings_.ring);
  counters_ = {};
  thread_ = std::jthread([this](const std::stop_token& stop) { play(stop); });
  return 0;
}

int Device::stop() {
  std::jthread thread;
  {
    const std::lock_guard lock(mutex_);
    thread = std::move(thread_);
  }
  if (thread.joinable()) {
    thread.request_stop();
    thread.join();
    report(counters_, settings_);
  }
  const std::lock_guard lock(mutex_);
  while (!done_.empty() && ready_.answer()) done_.pop_front();
  queued_.clear();
  done_.clear();
  for (Buffer& b : buffers_) b.queued = b.done = false;
  return 0;
}

void Device::play(const std::stop_token& stop) {
  const auto begin = std::chrono::steady_clock::now();
  const auto period = std::chrono::nanoseconds(1'000'000'000 / settings_.rate);
  for (std::uint32_t sequence = 0; !stop.stop_requested(); ++sequence) {
    std::unique_lock lock(mutex_);
    wake_.wait_until(lock, stop, begin + (sequence + 1) * period, [] { return false; });
    lock.unlock();
    if (stop.stop_requested()) break;
    if (settings_.unplug > 0 && sequence == settings_.unplug) pull_plug(settings_);
    if (is_gone()) break;
    expose(sequence);
  }
  counters_.stop();
}

// A frame for which no buffer waits is lost, and its number with it, as in hardware.
void Device::expose(std::uint32_t sequence) {
  film_->show(controls_.look());
  const bool is_to_be_lost = settings_.lose > 0 && (sequence + 1) % settings_.lose == 0;
  if (is_to_be_lost) {
    ++counters_.lost_on_request;
  } else if (fill(film_->frame(sequence), sequence)) {
    ++counters_.filled;
  } else {
    ++counters_.lost;
  }
}

bool Device::fill(const std::vector<std::uint8_t>& frame, std::uint32_t sequence) {
  const auto now = std::chrono::duration_cast<std::chrono::microseconds>(
      std::chrono::steady_clock::now().time_since_epoch());
  const std::lock_guard lock(mutex_);
  if (queued_.empty()) return false;
  const std::uint32_t index = queued_.front();
  queued_.pop_front();
  Buffer& b = buffers_[index];
  b.used = static_cast<std::uint32_t>(std::min(frame.size(), buffer_size_));
  std::memcpy(memory_ + buffer_size_ * index, frame.data(), b.used);
  b.sequence = sequence;
  b.timestamp = {now.count() / 1'000'000, now.count() % 1'000'000};
  b.queued = false;
  b.done = true;
  done_.push_back(index);
  ready_.ring();
  return true;
}

// What was filled and not fetched goes with the device, and so it is with the kernel's.
bool Device::is_gone() {
  const std::lock_guard lock(mutex_);
  if (!gone_ && !is_plugged_in(settings_)) {
    gone_ = true;
    ready_.hang_up();
  }
  return gone_;
}

int Device::control(std::uint32_t request, void* argument) {
  return is_gone() ? -ENODEV : answer(request, argument);
}

int Device::answer(std::uint32_t request, void* argument) {
  switch (request) {
    case VIDIOC_QUERYCAP:
      return describe(as<v4l2_capability>(argument));
    case VIDIOC_ENUMINPUT:
      return enumerate(as<v4l2_input>(argument));
    case VIDIOC_G_INPUT:
      return as<int>(argument) = 0;
    case VIDIOC_S_INPUT:
      return as<int>(argument) == 0 ? 0 : -EINVAL;
    case VIDIOC_ENUM_FMT:
      return enumerate(as<v4l2_fmtdesc>(argument));
    case VIDIOC_ENUM_FRAMESIZES:
      return enumerate(as<v4l2_frmsizeenum>(argument));
    case VIDIOC_ENUM_FRAMEINTERVALS:
      return enumerate(as<v4l2_frmivalenum>(argument));
    case VIDIOC_G_PARM:
    case VIDIOC_S_PARM:
      return get_rate(as<v4l2_streamparm>(argument));
    case VIDIOC_G_FMT:
    case VIDIOC_TRY_FMT:
    case VIDIOC_S_FMT:
      return format(request, as<v4l2_format>(argument));
    default:
      return control_buffers(request, argument);
  }
}

int Device::control_buffers(std::uint32_t request, void* argument) {
  switch (request) {
    case VIDIOC_REQBUFS:
      return request_buffers(as<v4l2_requestbuffers>(argument));
    case VIDIOC_QUERYBUF: {
      const std::lock_guard lock(mutex_);
      return fill_in(as<v4l2_buffer>(argument));
    }
    case VIDIOC_QBUF:
      return queue(as<v4l2_buffer>(argument));
    case VIDIOC_DQBUF:
      return dequeue(as<v4l2_buffer>(argument));
    case VIDIOC_STREAMON:
      return start();
    case VIDIOC_STREAMOFF:
      return stop();
    default:
      return controls_.control(request, argument);
  }
}

}  // namespace calvin::v4l2
