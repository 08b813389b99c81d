// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Builds undistorters on the spot, or beside the streaming thread.

#include "undistorter_builder.hpp"

#include <utility>

namespace calvin::gst {

void UndistorterBuilder::start() {
  const std::lock_guard guard(lock_);
  stop_ = std::stop_source();
  finished_.reset();
  worker_.start();
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

UndistorterBuilder::Built UndistorterBuilder::make(const Request& request,
                                                   const std::stop_token& stop) {
  const auto begin = std::chrono::steady_clock::now();
  ViewOptions view = request.key.view;
  view.output = request.key.distort ? request.input : request.output;
  auto made = request.key.distort ? Undistorter::make_back(request.camera.scaled(request.output),
                                                           view, request.planes, stop)
                                  : Undistorter::make(request.camera, view, request.planes, stop);
  const auto took = std::chrono::steady_clock::now() - begin;
  if (!made) return {request.key, tl::unexpected(made.error()), took};
  return {request.key, std::make_shared<const Undistorter>(*std::move(made)), took};
}

}  // namespace calvin::gst
