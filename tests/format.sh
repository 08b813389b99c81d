#!/bin/sh
# SPDX-License-Identifier: LGPL-2.1-or-later
# clang-format 14 has nothing to change. Other versions format otherwise.
set -eu
cd "$(dirname "$0")/.."
clang-format-14 --dry-run -Werror $(find lib gst tests examples -name '*.[ch]pp')
