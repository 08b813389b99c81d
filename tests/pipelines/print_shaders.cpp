// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Prints the shader of export-warp for a camera of every lens, for exported_shaders.hpp.

#include <string>

#include <fmt/format.h>

#include "../../examples/export_warp_text.hpp"
#include "calvin/io/settings.hpp"

using namespace calvin;

int main() {
  std::string rows;
  for (const LensTraits& lens : all_lenses()) {
    const int focal = lens.perspective ? 480 : 190;
    std::string setting = fmt::format("model={},fx={},fy={},cx=322,cy=238,width=640,height=480",
                                      lens.model, focal, focal + 1);
    for (std::size_t i = 0; i < lens.coefficients.size(); ++i) {
      const auto& [low, high] = lens.typical[i];
      setting += fmt::format(",{}={:.6g}", lens.coefficients[i], (low + 2 * high) / 3);
    }
    const Camera camera = Camera::make(parse_calibration_setting(setting).value()).value();
    const auto shader = export_warp::glsl({camera, {}, output_view(camera, {}).value()});
    fmt::print("namespace lens_{} {{\n{}}}\n", lens.model, shader.value());
    rows += fmt::format("    {{\"{}\", lens_{}::calvin_source}},\n", setting, lens.model);
  }
  fmt::print("struct LensShader {{\n  const char* setting;\n  vec3 (*source)(vec2);\n}};\n");
  fmt::print("inline const LensShader kLensShaders[] = {{\n{}}};\n", rows);
}
