// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Builds undistorters on the spot, or beside the streaming thread.

#include "undistort/undistorter_builder.hpp"

#include <ctime>
#include <span>
#include <utility>

namespace calvin::gst {

namespace {

UndistorterBuilder::Time thread_time() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return std::chrono::seconds(now.tv_sec) + std::chrono::nanoseconds(now.tv_nsec);
}

}  // namespace

Status UndistorterBuilder::start() {
  const std::lock_guard guard(lock_);
  stop_ = std::stop_source();
  finished_.reset();
  past_ = {};
  return worker_.start();
}

void UndistorterBuilder::cancel() {
  worker_.cancel();
  const std::lock_guard guard(lock_);
  stop_.request_stop();
}

void UndistorterBuilder::stop() {
  cancel();
  worker_.stop();
}

UndistorterBuilder::Built UndistorterBuilder::build(const Request& request) {
  std::stop_token stop;
  {
    const std::lock_guard guard(lock_);
    stop = stop_.get_token();
  }
  return make(request, stop);
}

void UndistorterBuilder::offer(Request request) {
  worker_.offer([this, request = std::move(request)](const std::stop_token& stop) {
    Built built = make(request, stop);
    const std::lock_guard guard(lock_);
    finished_ = std::move(built);
  });
}

std::optional<UndistorterBuilder::Built> UndistorterBuilder::take() {
  const std::lock_guard guard(lock_);
  return std::exchange(finished_, std::nullopt);
}

std::optional<UndistorterBuilder::Time> UndistorterBuilder::estimate(const Key& key) {
  const std::lock_guard guard(lock_);
  const Past& p = past(key);
  if (p.frames != key.frames || !p.map || !p.search) return std::nullopt;
  return p.knows(key) ? *p.map : *p.map + *p.search;
}

Result<std::shared_ptr<const ViewRange>> UndistorterBuilder::range_of(const Request& request) {
  const Key& key = request.key;
  {
    const std::lock_guard guard(lock_);
    if (past(key).knows(key)) return past(key).range;
  }
  const Time begin = thread_time();
  auto found = request.rectification
                   ? ViewRange::find(std::span(request.rectification->sights), key.view)
                   : ViewRange::find(request.camera, key.view);
  if (!found) return tl::unexpected(found.error());
  auto range = std::make_shared<const ViewRange>(*std::move(found));
  const std::lock_guard guard(lock_);
  Past& p = past(key);
  const std::optional<Time> map = p.frames == key.frames ? p.map : std::nullopt;
  p = {key.frames, key.camera, key.distort, range, thread_time() - begin, map};
  return range;
}

UndistorterBuilder::Built UndistorterBuilder::make(const Request& request,
                                                   const std::stop_token& stop) {
  const Key& key = request.key;
  const Camera& camera = request.camera;
  const auto range = range_of(request);
  if (!range) return {key, tl::unexpected(range.error()), request.turn};
  const Time begin = thread_time();
  const std::size_t own = request.rectification ? request.rectification->own : 0;
  const auto view = (*range)->view(key.view, own);
  if (!view) return {key, tl::unexpected(view.error()), request.turn};
  auto made = key.distort ? Undistorter::make_back(camera, *view, request.planes, stop)
                          : Undistorter::make(camera, *view, request.planes, stop);
  if (!made) return {key, tl::unexpected(made.error()), request.turn};
  auto shared = std::make_shared<const Undistorter>(*std::move(made));
  const std::lock_guard guard(lock_);
  if (past(key).frames == key.frames) past(key).map = thread_time() - begin;
  return {key, std::move(shared), request.turn};
}

}  // namespace calvin::gst
