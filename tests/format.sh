#!/bin/sh
# SPDX-License-Identifier: LGPL-2.1-or-later
# clang-format 14 has nothing to change. Other versions format otherwise: without it the test is
# skipped.
set -eu
cd "$(dirname "$0")/.."
command -v clang-format-14 >/dev/null || {
  echo "clang-format 14 is not here, and no other version formats this tree: skipped."
  exit 77
}
clang-format-14 --dry-run -Werror $(find lib gst tests examples -name '*.[ch]pp')
