// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Reads the properties `calibration` and `recheck` beside the streaming thread.

#include "common/calibration_reader.hpp"

#include <utility>

namespace calvin::gst {

// A worker that takes longer over the file before is left to it, so many times.
constexpr auto kPatience = std::chrono::seconds(1);
constexpr std::size_t kMostHung = 8;

void CalibrationReader::set(const std::string& text) {
  text_ = text;
  // What is still being read is of the text before, and stays on its desk.
  desk_ = std::make_shared<Desk>();
  desk_->setting.set(text);
}

Status CalibrationReader::leave_worker() {
  worker_->stop();
  hung_.push_back(std::exchange(worker_, std::make_unique<Worker>()));
  set(text_);
  return worker_->start();
}

void CalibrationReader::ask(Clock::time_point now) {
  asked_ = now;
  const std::lock_guard guard(desk_->lock);
  desk_->begun = false;
  desk_->busy =
      worker_->offer([desk = desk_, now](const std::stop_token& /*stop*/) { look(*desk, now); });
}

void CalibrationReader::look(Desk& desk, Clock::time_point now) {
  {
    const std::lock_guard guard(desk.lock);
    desk.begun = true;
  }
  auto read = desk.setting.poll(now);
  const std::lock_guard guard(desk.lock);
  desk.read = std::move(read);
  desk.busy = false;
}

std::optional<CalibrationReader::ReadResult> CalibrationReader::poll(Clock::time_point now) {
  bool hangs = false;
  {
    const std::lock_guard guard(desk_->lock);
    if (desk_->read) return std::exchange(desk_->read, std::nullopt);
    hangs = desk_->busy && !desk_->begun && now - asked_ > kPatience && hung_.size() < kMostHung;
    if (desk_->busy && !hangs) return std::nullopt;
  }
  if (hangs) {
    if (const Status left = leave_worker(); !left) return tl::unexpected(left.error());
  }
  CalibrationSetting& setting = desk_->setting;
  if (!setting.is_due(now)) return std::nullopt;
  if (!setting.may_wait()) return setting.poll(now);
  ask(now);
  return std::nullopt;
}

}  // namespace calvin::gst
