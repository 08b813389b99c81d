// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Memory that ends where the program may neither read nor write: who goes beyond it, crashes.
#pragma once

#include <atomic>
#include <cstring>

#include <gst/gst.h>
#include <sys/mman.h>
#include <unistd.h>

namespace calvin::check {

namespace detail {

struct GuardedMemory {
  GstMemory base;
  guint8* pages;
  gsize length;  // of the pages, of which the last is the guard
  guint8* begin;
};

inline GstMemory* alloc_guarded(GstAllocator* allocator, gsize size, GstAllocationParams* params) {
  const gsize page = static_cast<gsize>(sysconf(_SC_PAGESIZE));
  auto* memory = g_new0(GuardedMemory, 1);
  memory->length = (size + page - 1) / page * page + page;
  void* pages =
      mmap(nullptr, memory->length, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  g_assert_true(pages != MAP_FAILED);
  memory->pages = static_cast<guint8*>(pages);
  guint8* guard = memory->pages + memory->length - page;
  g_assert_cmpint(mprotect(guard, page, PROT_NONE), ==, 0);
  memory->begin = guard - size;
  std::memset(memory->begin, 0x55, size);
  gst_memory_init(&memory->base, params->flags, allocator, nullptr, size, 0, 0, size);
  return &memory->base;
}

inline void free_guarded(GstAllocator* /*allocator*/, GstMemory* base) {
  auto* memory = reinterpret_cast<GuardedMemory*>(base);
  munmap(memory->pages, memory->length);
  g_free(memory);
}

inline gpointer map_guarded(GstMemory* memory, gsize /*size*/, GstMapFlags /*flags*/) {
  return reinterpret_cast<GuardedMemory*>(memory)->begin;
}

// Of memory that is for reading alone.
inline gpointer map_to_read(GstMemory* memory, gsize size, GstMapFlags flags) {
  return (flags & GST_MAP_WRITE) != 0 ? nullptr : map_guarded(memory, size, flags);
}
inline GstMemory* copy_none(GstMemory* /*memory*/, gssize /*begin*/, gssize /*size*/) {
  return nullptr;
}
inline GstMemory* copy_half(GstMemory* memory, gssize /*begin*/, gssize /*size*/) {
  return gst_allocator_alloc(nullptr, memory->size / 2, nullptr);
}

// Of memory that gives no access the first time, and then every other time.
inline std::atomic<unsigned> maps;
inline gpointer map_every_other_time(GstMemory* memory, gsize size, GstMapFlags flags) {
  return maps++ % 2 == 0 ? nullptr : map_guarded(memory, size, flags);
}

inline void unmap_guarded(GstMemory* /*memory*/) {}

}  // namespace detail

struct GuardedAllocator {
  GstAllocator parent;
};
struct GuardedAllocatorClass {
  GstAllocatorClass parent;
};
G_GNUC_UNUSED static GType guarded_allocator_get_type();
G_DEFINE_TYPE(GuardedAllocator, guarded_allocator, GST_TYPE_ALLOCATOR)

static void guarded_allocator_class_init(GuardedAllocatorClass* klass) {
  klass->parent.alloc = detail::alloc_guarded;
  klass->parent.free = detail::free_guarded;
}

static void guarded_allocator_init(GuardedAllocator* self) {
  GstAllocator* allocator = &self->parent;
  allocator->mem_type = "guarded";
  allocator->mem_map = detail::map_guarded;
  allocator->mem_unmap = detail::unmap_guarded;
}

inline GstAllocator* new_guarded_allocator() {
  gpointer allocator = g_object_new(guarded_allocator_get_type(), nullptr);
  return static_cast<GstAllocator*>(gst_object_ref_sink(allocator));
}

// Whose memory can be neither written nor copied.
inline GstAllocator* new_read_only_allocator() {
  GstAllocator* allocator = new_guarded_allocator();
  allocator->mem_map = detail::map_to_read;
  allocator->mem_copy = detail::copy_none;
  return allocator;
}

// Whose memory cannot be written; a copy has the first half of it.
inline GstAllocator* new_halving_allocator() {
  GstAllocator* allocator = new_read_only_allocator();
  allocator->mem_copy = detail::copy_half;
  return allocator;
}

// Whose memory can be mapped every other time only, of all that the program asks for, and not be
// copied.
inline GstAllocator* new_fickle_allocator() {
  GstAllocator* allocator = new_guarded_allocator();
  allocator->mem_map = detail::map_every_other_time;
  allocator->mem_copy = detail::copy_none;
  detail::maps = 0;
  return allocator;
}

}  // namespace calvin::check
