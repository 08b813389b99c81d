// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Tells cv::fisheye from the Brown family, whose four coefficients look alike, by the words that
// OpenCV's samples and the scripts around it write.

#include "calvin/io/opencv_lens.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "calvin/camera/camera.hpp"
#include "calvin/core/text.hpp"
#include "calvin/core/utf8.hpp"
#include "calvin/io/opencv_camera.hpp"
#include "calvin/io/opencv_storage.hpp"

namespace calvin::io {

namespace {

const KeyNames kFlags = {"fisheyemodel", "fisheye"};
const KeyNames kModels = {"cameramodel", "model",           "modeltype",
                          "lensmodel",   "distortionmodel", "projectionmodel"};
const KeyNames kDevices = {"cameramodel", "model"};  // "C920" as often as a lens

// Names of other programs for the lenses of OpenCV, besides our own (opencv_lens()).
enum class Family { kFisheye, kBrown, kEither };
struct Name {
  std::string_view name;
  Family family;
};
// A pinhole is a projection, and bends as the flag or another field says.
constexpr std::array<Name, 18> kFamilyNames = {{{"fisheye", Family::kFisheye},
                                                {"equidistant", Family::kFisheye},
                                                {"kannala_brandt", Family::kFisheye},
                                                {"kannala_brandt4", Family::kFisheye},
                                                {"kannala_brandt8", Family::kFisheye},
                                                {"kb4", Family::kFisheye},
                                                {"opencv_fisheye", Family::kFisheye},
                                                {"pinhole", Family::kEither},
                                                {"perspective", Family::kEither},
                                                {"plumb_bob", Family::kBrown},
                                                {"brown_conrady", Family::kBrown},
                                                {"radtan", Family::kBrown},
                                                {"rational_polynomial", Family::kBrown},
                                                {"rational", Family::kBrown},
                                                {"thin_prism", Family::kBrown},
                                                {"tilted", Family::kBrown},
                                                {"opencv", Family::kBrown},
                                                {"standard", Family::kBrown}}};

std::optional<Family> family_of(std::string_view word) {
  const std::string plain = plain_key(word);
  const auto known = std::find_if(kFamilyNames.begin(), kFamilyNames.end(),
                                  [&](const Name& name) { return plain_key(name.name) == plain; });
  if (known != kFamilyNames.end()) return known->family;
  const LensTraits* own = opencv_lens(plain);
  if (own == nullptr) return std::nullopt;
  return own->opencv == OpenCvForm::kFisheye ? Family::kFisheye : Family::kBrown;
}

// Whether a word names a lens that OpenCV's numbers are not of.
bool is_other_lens(std::string_view word) {
  static constexpr std::string_view kOthers[] = {
      "omni", "omnidirectional", "mei", "unified", "cahvor", "splined", "stereographic"};
  const std::string plain = plain_key(word);
  const auto is_it = [&](std::string_view name) { return plain_key(name) == plain; };
  return std::ranges::any_of(kOthers, is_it) || std::ranges::any_of(model_names(), is_it);
}

std::optional<bool> read_flag(Fields& fields, const std::string& key) {
  const std::string word = fields.word(key);
  if (word == "1" || word == "true") return true;
  if (word != "0" && word != "false") fields.complain(key, "is neither 0 nor 1");
  return false;
}

std::optional<bool> read_name(Fields& fields, const std::string& key) {
  const std::string word = fields.word(key);
  if (word.empty()) return std::nullopt;
  const auto family = family_of(word);
  if (family) {
    return *family == Family::kEither ? std::nullopt : std::optional(*family == Family::kFisheye);
  }
  if (is_one_of(key, kDevices) && !is_other_lens(word)) return std::nullopt;
  std::vector<std::string_view> names;
  for (const Name& name : kFamilyNames) names.push_back(name.name);
  fields.complain(key,
                  fmt::format("is '{}', which is no lens of OpenCV's; read are {}",
                              shortened(word, 40), join(names, ", ")),
                  ErrorCode::kUnsupported);
  return std::nullopt;
}

}  // namespace

bool read_fisheye(Fields& fields) {
  std::string first;
  std::optional<bool> is_fisheye;
  for (const std::string& key : fields.keys()) {
    const bool is_flag = is_one_of(key, kFlags);
    if (!is_flag && !is_one_of(key, kModels)) continue;
    const auto says = is_flag ? read_flag(fields, key) : read_name(fields, key);
    if (!says) continue;
    if (is_fisheye && *is_fisheye != *says) {
      fields.complain(key, fmt::format("contradicts '{}': only one of them says that the lens is "
                                       "cv::fisheye. Take the wrong one out",
                                       first));
    }
    first = key;
    is_fisheye = says;
  }
  return is_fisheye.value_or(false);
}

}  // namespace calvin::io
