// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The boards of a rig as shapes in space. Internal.
#pragma once

#include "calvin/core/rig.hpp"
#include "calvin/draw/scene/scene.hpp"

namespace calvin {

// Each board as a sheet, that in the middle of all with its squares, or its columns and rows, and a
// label. Boards whose texts are not known here are left out.
void add_boards(const Rig& rig, Scene& to);

}  // namespace calvin
