// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Answers the ioctls of a capture device and fills its buffers with the frames of a Film.

#undef _FILE_OFFSET_BITS  // mmap and ftruncate under their own names
#include "device.hpp"

#include <poll.h>
#include <sys/eventfd.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <sstream>
#include <string>
#include <string_view>

#include "calvin/core/text.hpp"

namespace calvin::v4l2 {

namespace {

constexpr std::uint32_t kMaxBuffers = 32;

std::uint32_t rate_of_environment() {
  const char* text = std::getenv("CALVIN_V4L2_FPS");
  const int rate = parse_int(text == nullptr ? "" : text).value_or(30);
  return static_cast<std::uint32_t>(std::clamp(rate, 1, 1000));
}

std::string environment(const char* name, const char* otherwise) {
  const char* text = std::getenv(name);
  return text == nullptr ? otherwise : text;
}

// The first is what the device begins with.
std::vector<std::uint32_t> fourccs_of_environment() {
  const std::string wanted = environment("CALVIN_V4L2_FORMATS", "YUYV,MJPG");
  std::vector<std::uint32_t> fourccs;
  for (const PixelFormat& format : pixel_formats()) {
    if (wanted.find(format.name) != std::string::npos) fourccs.push_back(format.fourcc);
  }
  if (fourccs.empty()) fourccs.push_back(V4L2_PIX_FMT_YUYV);
  return fourccs;
}

std::vector<ImageSize> sizes_of_environment() {
  std::istringstream wanted(environment("CALVIN_V4L2_SIZES", "640x480,320x240"));
  std::vector<ImageSize> sizes;
  ImageSize size;
  for (char by = 0, comma = 0; wanted >> size.width >> by >> size.height; wanted >> comma) {
    if (size.width >= 16 && size.height >= 16) sizes.push_back({size.width & ~1, size.height & ~1});
  }
  if (sizes.empty()) sizes.push_back(kFullSize);
  return sizes;
}

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

Device::Device(bool blocking)
    : blocking_(blocking),
      rate_(rate_of_environment()),
      sizes_(sizes_of_environment()),
      size_(sizes_.front()),
      fourccs_(fourccs_of_environment()),
      fourcc_(fourccs_.front()) {
  ready_fd_ = ::eventfd(0, EFD_SEMAPHORE | EFD_CLOEXEC | EFD_NONBLOCK);
}

Device::~Device() {
  stop();
  v4l2_requestbuffers none{};
  request_buffers(none);
  ::close(ready_fd_);
}

bool Device::is_offered(std::uint32_t fourcc) const {
  return std::find(fourccs_.begin(), fourccs_.end(), fourcc) != fourccs_.end();
}

int Device::describe(v4l2_capability& capability) {
  capability = fresh(capability);
  copy_text(capability.driver, "uvcvideo");  // v4l2src spares such cameras the interlace probing
  copy_text(capability.card, "Emulated camera");
  copy_text(capability.bus_info, "usb-emulated-1");
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
  if (format.type != V4L2_BUF_TYPE_VIDEO_CAPTURE || format.index >= fourccs_.size()) return -EINVAL;
  const std::uint32_t index = format.index;
  format = fresh(format);
  format.index = index;
  format.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  format.pixelformat = fourccs_[index];
  const PixelFormat& pixels = *find_pixel_format(format.pixelformat);
  format.flags = pixels.line_bytes == 0 ? V4L2_FMT_FLAG_COMPRESSED : 0;
  copy_text(format.description, pixels.description);
  return 0;
}

int Device::enumerate(v4l2_frmsizeenum& size) const {
  if (size.index >= sizes_.size() || !is_offered(size.pixel_format)) return -EINVAL;
  size.type = V4L2_FRMSIZE_TYPE_DISCRETE;
  size.discrete.width = static_cast<__u32>(sizes_[size.index].width);
  size.discrete.height = static_cast<__u32>(sizes_[size.index].height);
  return 0;
}

int Device::enumerate(v4l2_frmivalenum& interval) const {
  if (interval.index > 0 || !is_offered(interval.pixel_format)) return -EINVAL;
  interval.type = V4L2_FRMIVAL_TYPE_DISCRETE;
  interval.discrete = {1, rate_};
  return 0;
}

int Device::get_rate(v4l2_streamparm& parameters) const {
  if (parameters.type != V4L2_BUF_TYPE_VIDEO_CAPTURE) return -EINVAL;
  parameters.parm.capture = fresh(parameters.parm.capture);
  parameters.parm.capture.capability = V4L2_CAP_TIMEPERFRAME;
  parameters.parm.capture.timeperframe = {1, rate_};
  return 0;
}

// The nearest that the device has, as TRY_FMT promises.
void Device::complete(v4l2_pix_format& pix) const {
  const auto distance = [&](ImageSize size) {
    return std::abs(static_cast<long>(pix.width) - size.width) +
           std::abs(static_cast<long>(pix.height) - size.height);
  };
  const ImageSize size = *std::min_element(
      sizes_.begin(), sizes_.end(), [&](auto a, auto b) { return distance(a) < distance(b); });
  const std::uint32_t fourcc = is_offered(pix.pixelformat) ? pix.pixelformat : fourccs_.front();
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
      if (!thread_.joinable()) return -EINVAL;
      if (!done_.empty()) {
        std::uint64_t count = 0;
        if (::read(ready_fd_, &count, sizeof(count)) < 0) return -EIO;
        buffer.index = done_.front();
        done_.pop_front();
        const int status = fill_in(buffer);
        buffer.flags &= ~static_cast<__u32>(V4L2_BUF_FLAG_DONE);
        buffers_[buffer.index].done = false;
        return status;
      }
    }
    if (!blocking_) return -EAGAIN;
    pollfd one = {ready_fd_, POLLIN, 0};
    ::poll(&one, 1, 100);  // not for ever: STREAMOFF may come from another thread
  }
}

int Device::start() {
  const std::lock_guard lock(mutex_);
  if (thread_.joinable()) return 0;
  if (buffers_.empty()) return -EINVAL;
  if (!film_) film_ = std::make_unique<Film>(*find_pixel_format(fourcc_), size_);
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
  }
  const std::lock_guard lock(mutex_);
  std::uint64_t count = 0;
  while (::read(ready_fd_, &count, sizeof(count)) > 0) {
  }
  queued_.clear();
  done_.clear();
  for (Buffer& b : buffers_) b.queued = b.done = false;
  return 0;
}

void Device::play(const std::stop_token& stop) {
  const auto begin = std::chrono::steady_clock::now();
  const auto period = std::chrono::nanoseconds(1'000'000'000 / rate_);
  for (std::uint32_t sequence = 0; !stop.stop_requested(); ++sequence) {
    std::unique_lock lock(mutex_);
    wake_.wait_until(lock, stop, begin + (sequence + 1) * period, [] { return false; });
    lock.unlock();
    if (!stop.stop_requested()) expose(sequence);
  }
}

// A frame for which no buffer waits is lost, and its number with it, as in hardware.
void Device::expose(std::uint32_t sequence) {
  const auto& frame = film_->frame(sequence);
  const auto now = std::chrono::duration_cast<std::chrono::microseconds>(
      std::chrono::steady_clock::now().time_since_epoch());
  const std::lock_guard lock(mutex_);
  if (queued_.empty()) return;
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
  const std::uint64_t one = 1;
  [[maybe_unused]] const auto written = ::write(ready_fd_, &one, sizeof(one));
}

int Device::control(std::uint32_t request, void* argument) {
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
    case VIDIOC_QUERYCTRL:
    case VIDIOC_QUERY_EXT_CTRL:
    case VIDIOC_G_CTRL:
    case VIDIOC_S_CTRL:
      return -EINVAL;  // there are no controls
    default:
      return -ENOTTY;
  }
}

}  // namespace calvin::v4l2
