// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What a session says to its user, in words.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "calvin/core/image.hpp"
#include "calvin/core/reason.hpp"
#include "calvin/core/result.hpp"
#include "calvin/session/files/calibration_files.hpp"
#include "calvin/session/guidance/notice.hpp"
#include "calvin/session/session.hpp"

namespace calvin {

// How often a board was seen and not taken, and why.
using Refusals = std::map<Reason, std::size_t>;

// `obstacle`: what keeps the detector from finding a board, or nothing.
[[nodiscard]] Error too_few_views(std::size_t views, int least, const Refusals& refused,
                                  const std::string& obstacle);
// The same where no frame has come.
[[nodiscard]] Error no_frames();
// The same where no detector has said anything of any frame.
[[nodiscard]] Error nothing_detected();
// The same where manual points are all there is; `hint`: what they lack.
[[nodiscard]] Error too_few_points(const std::string& hint);
// Why there is no final result. `before`: there is one from an earlier solve.
[[nodiscard]] Error solve_failed(const std::string& why, bool before);
// Of settings that were refused while those before them go on.
[[nodiscard]] Error refused_setting(Error why);
// Of a write that has not ended for so long.
[[nodiscard]] Notice late_files(const std::vector<CalibrationFile>& files,
                                std::chrono::seconds waited);
// Of frames of a new size: which views go on with them and which wait, if any do.
[[nodiscard]] std::optional<Notice> other_frames(ImageSize size, std::size_t taken_up,
                                                 const Session::Views& set_aside);
// Of a camera that has not sent for so long, and of one that sends again; `kept`: the number of
// views.
[[nodiscard]] Notice frames_stopped(std::uint64_t seconds, std::size_t kept);
[[nodiscard]] Notice frames_again(std::size_t kept);
// Of a file that stays as another session left it.
[[nodiscard]] Notice kept_file(const std::string& path);

}  // namespace calvin
