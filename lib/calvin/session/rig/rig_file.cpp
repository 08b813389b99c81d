// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Tells what the session has written from what others have.

#include "calvin/session/rig/rig_file.hpp"

#include <utility>

#include "calvin/core/file.hpp"
#include "calvin/io/rig_io.hpp"
#include "calvin/session/files/calibration_files.hpp"

namespace calvin {

Status RigFile::write(const std::string& path, const Rig& rig) {
  auto text = print_rig(rig);
  if (!text) return tl::unexpected<Error>(text.error());
  if (!is_stream(path)) {
    const auto there = read_file(path);
    const bool is_foreign = there ? *there != ours_ : there.error().code != ErrorCode::kNotFound;
    if (is_foreign) {
      if (Status kept = keep_copy(path); !kept) return kept;
    }
  }
  Status written = write_file(path, *text);
  if (written) ours_ = *std::move(text);
  return written;
}

}  // namespace calvin
