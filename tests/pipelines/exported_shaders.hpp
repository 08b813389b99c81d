// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Shaders that the build has let export-warp write, as C++.
#pragma once

#include "glsl_shim.hpp"

// That a keyword gets another meaning is the point.
#ifdef __clang__
#pragma clang diagnostic push
#pragma clang diagnostic ignored "-Wkeyword-macro"
#endif
#define float double
#define varying inline
#define uniform inline

namespace glsl {

#include "lens_shaders.inc"

namespace shader_brown {
#include "brown.frag"
}
namespace shader_fisheye {
#include "fisheye.frag"
}
namespace shader_doublesphere {
#include "doublesphere.frag"
}
namespace shader_ucm {
#include "ucm.frag"
}
namespace shader_tilted {
#include "tilted.frag"
}

}  // namespace glsl

#undef float
#undef varying
#undef uniform
#ifdef __clang__
#pragma clang diagnostic pop
#endif
