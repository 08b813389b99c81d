// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Warps as text: formulae and numbers for those who compute places themselves.
#pragma once

#include <algorithm>
#include <numbers>
#include <vector>

#include "calvin/camera/lens_table.hpp"
#include "calvin/core/text.hpp"
#include "export_warp_maps.hpp"

namespace export_warp {

// The configuration of DeepStream's nvdewarper (6.2 and newer): straight lines from a Brown or a
// fisheye lens. kUnsupported where it has no words for the warp. Angles are left out: in which
// sense it turns is not documented.
inline calvin::Result<std::string> nvdewarper(const Warp& warp) {
  const calvin::ViewOptions& o = warp.options;
  const calvin::Camera& c = warp.source;
  const auto refuse = [](const char* what) {
    return calvin::make_error(
        calvin::ErrorCode::kUnsupported,
        fmt::format("nvdewarper has no words for {}: take another format.", what));
  };
  if (o.projection != calvin::Projection::kRectilinear) return refuse("this projection");
  if (o.pan != 0 || o.tilt != 0 || o.roll != 0) return refuse("a view that is turned");
  if (c.skew() != 0) return refuse("skew");
  const auto& p = c.parameters();
  const calvin::OpenCvForm form = calvin::find_lens(c.model())->opencv;
  std::vector<double> k(p.begin() + 4, p.end());
  if (form == calvin::OpenCvForm::kBrown && k.size() <= 5) {
    k.resize(5);
    std::rotate(k.begin() + 2, k.begin() + 4, k.end());  // k1 k2 k3, then p1 p2
  } else if (form != calvin::OpenCvForm::kFisheye) {
    return refuse("this camera model");
  }
  const calvin::ImageSize out = warp.output();
  const calvin::Camera& view = warp.view.camera.plane();
  std::string coefficients;
  for (const double value : k) coefficients += calvin::format_double(value) + ";";
  coefficients.pop_back();
  const auto pair = [](double a, double b) {
    return calvin::format_double(a) + ";" + calvin::format_double(b);
  };
  return fmt::format(R"([property]
output-width={0}
output-height={1}
num-batch-buffers=1
[surface0]
# {2} to perspective, for frames of {3}x{4} px
projection-type={5}
surface-index=0
width={0}
height={1}
pitch=0
yaw=0
roll=0
focal-length={6}
src-x0={7}
src-y0={8}
distortion={9}
dst-focal-length={10}
dst-principal-point={11}
)",
                     out.width, out.height, k.size() == 4 ? "fisheye" : "perspective",
                     warp.input().width, warp.input().height, k.size() == 4 ? 4 : 3,
                     pair(c.fx(), c.fy()), calvin::format_double(c.cx()),
                     calvin::format_double(c.cy()), coefficients, pair(view.fx(), view.fy()),
                     pair(view.cx(), view.cy()));
}

// ---- GLSL ---------------------------------------------------------------------------------------

// A constant with a decimal point, as GLSL wants it.
inline std::string real(double value) {
  std::string text = fmt::format("{:.9g}", value);
  if (text.find_first_of(".e") == std::string::npos) text += ".0";
  return text;
}

// The plane of the view -> a direction in its axes.
inline std::string_view glsl_ray(calvin::Projection projection) {
  switch (projection) {
    case calvin::Projection::kRectilinear:
      return "vec3(x, y, 1.0)";
    case calvin::Projection::kCylindrical:
      return "vec3(sin(x), y, cos(x))";
    case calvin::Projection::kEquirectangular:
      return "vec3(sin(x) * cos(y), sin(y), cos(x) * cos(y))";
    case calvin::Projection::kStereographic:
      return "vec3(x, y, 1.0 - 0.25 * (x * x + y * y))";
    case calvin::Projection::kPanini:
      return "vec3(x, y, 1.0 - 0.25 * x * x)";
    case calvin::Projection::kFisheye:
      return "vec3(x, y, max(length(vec2(x, y)), 1e-6) / tan(max(length(vec2(x, y)), 1e-6)))";
  }
  return "";
}

// Leaves where no direction belongs to the point (x0, y0) of the plane.
inline std::string glsl_end(calvin::Projection projection) {
  const auto leave = [](std::string_view condition) {
    return fmt::format("  if ({}) return vec3(0.0, 0.0, 0.0);\n", condition);
  };
  switch (projection) {
    case calvin::Projection::kCylindrical:
      return leave("abs(x0) > 3.14159265");
    case calvin::Projection::kEquirectangular:
      return leave("abs(x0) > 3.14159265 || abs(y0) > 1.57079633");
    case calvin::Projection::kFisheye:
      return leave("length(vec2(x0, y0)) > 3.14159265");
    default:
      return "";
  }
}

// Beyond this angle the lens shows nothing: the least over all directions.
inline double widest_angle(const calvin::Camera& camera) {
  constexpr int kDirections = 64;
  double least = std::numbers::pi;
  for (int i = 0; i < kDirections; ++i) {
    const double turn = 2 * std::numbers::pi * i / kDirections;
    const auto sees = [&](double angle) {
      return camera
          .project(
              {std::cos(turn) * std::sin(angle), std::sin(turn) * std::sin(angle), std::cos(angle)})
          .has_value();
    };
    double low = 0;
    double high = least;
    for (int step = 0; step < 50; ++step) (sees((low + high) / 2) ? low : high) = (low + high) / 2;
    if (!sees(least)) least = low;
  }
  return least;
}

// The direction d, of length 1, -> the distorted point (x, y).
inline std::string glsl_lens(const calvin::Camera& camera) {
  const calvin::LensTraits& lens = *calvin::find_lens(camera.model());
  std::string text;
  for (std::size_t i = 0; i < lens.coefficients.size(); ++i) {
    text += fmt::format("  const float {} = {};\n", lens.coefficients[i],
                        real(camera.parameters()[4 + i]));
  }
  return text + lens.glsl;
}

// A fragment shader for GStreamer's glshader and the like (GLSL ES 1.00, GLSL 1.10): the first row
// of the picture is at v_texcoord.y = 0.
inline calvin::Result<std::string> glsl(const Warp& warp) {
  const calvin::Camera& c = warp.source;
  const calvin::Camera& plane = warp.view.camera.plane();
  const calvin::ImageSize in = warp.input();
  const calvin::ImageSize out = warp.output();
  const Eigen::Matrix3d r = calvin::camera_from_view(warp.options);
  std::string turn;
  for (int i = 0; i < 3; ++i) {
    turn += fmt::format("{}{} * v.x + {} * v.y + {} * v.z", i == 0 ? "" : ", ", real(r(i, 0)),
                        real(r(i, 1)), real(r(i, 2)));
  }
  return fmt::format(
      R"(#ifdef GL_ES
precision highp float;
#endif
// From a picture of {0}x{1} px to one of {2}x{3} px.
varying vec2 v_texcoord;
uniform sampler2D tex;

// A point of the plane of the view -> where it looks, in its axes.
vec3 calvin_ray(float x, float y) {{ return {17}; }}

// px of the output -> px of the source, centres of pixels at whole numbers; z is 0 where there is
// nothing to see.
vec3 calvin_source(vec2 pixel) {{
  float x0 = (pixel.x - {4}) / {5};
  float y0 = (pixel.y - {6}) / {7};
{16}  vec3 v = calvin_ray(x0, y0);
  vec3 d = normalize(vec3({8}));
  if (d.z < {9}) return vec3(0.0, 0.0, 0.0);
{10}  return vec3({11} * x + {12} * y + {13}, {14} * y + {15}, 1.0);
}}

void main() {{
  vec3 p = calvin_source(vec2(v_texcoord.x * {2}.0 - 0.5, v_texcoord.y * {3}.0 - 0.5));
  bool inside = p.z > 0.0 && p.x >= 0.0 && p.y >= 0.0 && p.x <= {0}.0 - 1.0 && p.y <= {1}.0 - 1.0;
  vec4 colour = texture2D(tex, vec2((p.x + 0.5) / {0}.0, (p.y + 0.5) / {1}.0));
  gl_FragColor = inside ? colour : vec4(0.0, 0.0, 0.0, 1.0);
}}
)",
      in.width, in.height, out.width, out.height, real(plane.cx()), real(plane.fx()),
      real(plane.cy()), real(plane.fy()), turn, real(std::cos(widest_angle(c))), glsl_lens(c),
      real(c.fx()), real(c.skew()), real(c.cx()), real(c.fy()), real(c.cy()),
      glsl_end(warp.options.projection), glsl_ray(warp.options.projection));
}

}  // namespace export_warp
