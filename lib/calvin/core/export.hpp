// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// CALVIN_API marks what libcalvin exports: what docs/library.md names, and nothing else.
#pragma once

#define CALVIN_API __attribute__((visibility("default")))
