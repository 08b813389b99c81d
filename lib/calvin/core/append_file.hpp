// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A file that only grows, as a journal does: what was appended stays, whatever becomes of the
// program afterwards.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "calvin/core/descriptor.hpp"
#include "calvin/core/result.hpp"

namespace calvin {

// Open for one writer at a time. The file stays open, and others are kept from it, while this or
// what it was moved to lives. sync() may run on another thread than the others.
class AppendFile {
 public:
  // Creates the file where there is none. kIo where the system refuses, where it is no regular
  // file, and where another program, or another place in this one, appends to it: on a file system
  // that has locks.
  [[nodiscard]] static Result<AppendFile> open(const std::string& path);

  [[nodiscard]] const std::string& path() const noexcept { return path_; }

  // All that it holds; kIo for more than `max_bytes`.
  [[nodiscard]] Result<std::string> read(std::size_t max_bytes) const;
  // Forgets what lies behind the first `size` bytes.
  [[nodiscard]] Status cut(std::size_t size) const;
  // All of it or, with an error, nothing: a full disk leaves no half line behind. kIo too where the
  // file was removed, and nobody would find what is written to it.
  [[nodiscard]] Status append(std::string_view bytes);
  // Lets others append to it, though it stays open: for whoever is done, but has a sync() under
  // way.
  void unlock() const noexcept;
  // From when it returns not even a loss of power takes away what was appended.
  [[nodiscard]] Status sync() const;

 private:
  AppendFile(std::string path, std::unique_ptr<Descriptor> file)
      : path_(std::move(path)), file_(std::move(file)) {}

  std::string path_;
  std::unique_ptr<Descriptor> file_;
  // Where half of what could not be appended stands that could not be taken back either.
  std::optional<std::size_t> torn_at_;
};

}  // namespace calvin
