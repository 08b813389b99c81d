// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A file of any of the syntaxes, with all that may be wrong with a text file.
#pragma once

#include <string_view>

#include "calvin/core/result.hpp"
#include "calvin/io/document.hpp"

namespace calvin::io {

// JSON, XML, TOML, YAML, a literal of Python or variables of MATLAB, by how it begins, with or
// without a byte order mark. kMalformed for what is empty or no text, with a clause that says why.
[[nodiscard]] Result<Node> parse_text_document(std::string_view content);

}  // namespace calvin::io
