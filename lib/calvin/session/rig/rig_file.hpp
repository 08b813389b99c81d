// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The file that a session of several cameras writes.
#pragma once

#include <string>

#include "calvin/core/result.hpp"
#include "calvin/core/rig.hpp"

namespace calvin {

// One thread at a time.
class RigFile {
 public:
  // Writes whole files. What others have left there is kept as FILE~ before it is replaced, and is
  // not replaced where it cannot be kept.
  [[nodiscard]] Status write(const std::string& path, const Rig& rig);

 private:
  std::string ours_;  // what was written last
};

}  // namespace calvin
