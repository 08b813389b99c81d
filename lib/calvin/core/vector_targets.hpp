// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Which instruction sets the vector code is compiled for, one list for all of it. Internal: include
// before hwy/foreach_target.h.
//
// Every set costs its share of the time that the library takes to compile, so those are left out
// that hardly a machine gains from. SSSE3 without SSE4.1 is x86 of 2006 to 2008. ZEN4 and SPR add
// floats of 16 bits to what AVX3 and AVX3_DL have. A vector whose size the compiler does not know
// (SVE, RVV) cannot be the member of a struct. Without optimisation, gcc 12 does not take the
// immediates of AVX-512 that Highway passes through functions.
#pragma once

#include <hwy/base.h>

#ifndef HWY_DISABLED_TARGETS
#define CALVIN_SIZELESS_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#ifdef __OPTIMIZE__
#define CALVIN_UNUSED_TARGETS (CALVIN_SIZELESS_TARGETS | HWY_SSSE3)
#else
#define CALVIN_UNUSED_TARGETS (CALVIN_SIZELESS_TARGETS | HWY_SSSE3 | HWY_AVX3 | HWY_AVX3_DL)
#endif
#ifdef HWY_MAJOR  // told by base.h from Highway 1.1 on, which knows more sets
#define HWY_DISABLED_TARGETS (CALVIN_UNUSED_TARGETS | HWY_AVX3_ZEN4 | HWY_AVX3_SPR)
#else
#define HWY_DISABLED_TARGETS CALVIN_UNUSED_TARGETS
#endif
#endif
