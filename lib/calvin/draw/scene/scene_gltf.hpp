// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A scene for other programs: binary glTF 2.0, in one file.
#pragma once

#include <string>

#include "calvin/draw/scene/scene.hpp"

namespace calvin {

// The bytes of a GLB file. Metres; `up` of the scene is up (glTF: +y). Lines and faces of one
// colour are a mesh, without light; labels are nodes of that name where they are, since glTF has no
// text.
[[nodiscard]] std::string print_glb(const Scene& scene);

}  // namespace calvin
