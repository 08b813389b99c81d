// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Where the value of a property is kept: an element names that place once, for reading and writing.
#pragma once

#include <string>
#include <type_traits>

#include "common/properties.hpp"

namespace calvin::gst {

namespace field {

inline void read(const GValue* from, std::string& to) { to = string_of(from); }
inline void read(const GValue* from, bool& to) { to = g_value_get_boolean(from) != FALSE; }
inline void read(const GValue* from, int& to) { to = g_value_get_int(from); }
inline void read(const GValue* from, double& to) { to = g_value_get_double(from); }
inline void read(const GValue* from, guint64& to) { to = g_value_get_uint64(from); }

inline void write(const std::string& from, GValue* to) { set_string(to, from); }
inline void write(bool from, GValue* to) { g_value_set_boolean(to, from); }
inline void write(int from, GValue* to) { g_value_set_int(to, from); }
inline void write(double from, GValue* to) { g_value_set_double(to, from); }
inline void write(guint64 from, GValue* to) { g_value_set_uint64(to, from); }

template <typename T>
requires std::is_enum_v<T>
void read(const GValue* from, T& to) { to = static_cast<T>(g_value_get_enum(from)); }
template <typename T>
requires std::is_enum_v<T>
void write(T from, GValue* to) { g_value_set_enum(to, static_cast<int>(from)); }

}  // namespace field

// A reference to a std::string, bool, int, double, guint64 or enum; or to nothing, for a property
// that is kept nowhere.
class Field {
 public:
  Field() = default;
  template <typename T>
  Field(T& place)  // NOLINT(google-explicit-constructor): `return settings.board;`
      : place_(&place),
        set_([](void* to, const GValue* value) { field::read(value, *static_cast<T*>(to)); }),
        get_([](const void* from, GValue* value) {
          field::write(*static_cast<const T*>(from), value);
        }) {}

  // False where there is nothing.
  bool set(const GValue* value) const {
    if (place_ != nullptr) set_(place_, value);
    return place_ != nullptr;
  }
  bool get(GValue* value) const {
    if (place_ != nullptr) get_(place_, value);
    return place_ != nullptr;
  }

 private:
  void* place_ = nullptr;
  void (*set_)(void*, const GValue*) = nullptr;
  void (*get_)(const void*, GValue*) = nullptr;
};

}  // namespace calvin::gst
