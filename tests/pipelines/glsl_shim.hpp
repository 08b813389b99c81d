// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// As much of GLSL as the shaders of export-warp use, for a C++ compiler.
#pragma once

#include <cmath>

namespace glsl {

struct vec2 {
  vec2() = default;
  vec2(double a, double b) : x(a), y(b) {}
  double x = 0, y = 0;
};
struct vec3 {
  vec3(double a, double b, double c) : x(a), y(b), z(c) {}
  double x = 0, y = 0, z = 0;
};
struct vec4 {
  vec4() = default;
  vec4(double a, double b, double c, double d) : x(a), y(b), z(c), w(d) {}
  double x = 0, y = 0, z = 0, w = 0;
};
struct sampler2D {};

inline double abs(double a) { return std::abs(a); }
inline double sin(double a) { return std::sin(a); }
inline double cos(double a) { return std::cos(a); }
inline double tan(double a) { return std::tan(a); }
inline double sqrt(double a) { return std::sqrt(a); }
inline double max(double a, double b) { return std::fmax(a, b); }
inline double atan(double y, double x) { return std::atan2(y, x); }
inline double length(const vec2& a) { return std::hypot(a.x, a.y); }
inline double length(const vec3& a) { return std::hypot(a.x, a.y, a.z); }
inline vec3 normalize(const vec3& a) {
  const double n = std::hypot(a.x, a.y, a.z);
  return {a.x / n, a.y / n, a.z / n};
}
inline vec4 texture2D(const sampler2D& /*picture*/, const vec2& /*place*/) { return {}; }

inline vec4 gl_FragColor;

}  // namespace glsl
