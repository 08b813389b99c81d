// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The properties of an element as one table, from which GObject gets all that it asks for.
//
// A table belongs to the class behind the element, its Owner, which is derived from SharedSettings.
// What was set is kept in the members of Owner::Settings: their initialisers are the defaults of
// the properties, their types those of the GParamSpecs.
#pragma once

#include <functional>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "common/messages.hpp"
#include "common/property_kinds.hpp"

namespace calvin::gst {

// The value of a property is a member of the settings, or a member of a member:
//   kept_in<&TestSettings::scene, &SceneSettings::board>
template <auto... kMembers>
struct KeptIn {
  // settings.*first.*second and so on.
  static auto& in(auto& settings) { return (settings.*....*kMembers); }
};
template <auto... kMembers>
inline constexpr KeptIn<kMembers...> kept_in;

// The value of a property is what a member function of the owner returns. Without another one that
// takes it, the property is read only. They do their own locking.
template <auto kGet, auto kSet>
struct ReturnedBy {};
template <auto kGet, auto kSet = nullptr>
inline constexpr ReturnedBy<kGet, kSet> returned_by;

// What happens under the lock when a property has been set, to another value or to the same one.
template <typename Settings>
using WasSet = void (*)(Settings&, bool to_another);

// A KeptIn or a ReturnedBy, as functions.
template <typename Owner>
struct Value {
  using Settings = typename Owner::Settings;

  GParamSpec* (*spec)(const SpecText&);
  void (*get)(Owner&, GValue*);
  void (*set)(Owner&, const GValue*, WasSet<Settings>);  // nullptr: read only

  template <auto... kMembers>
  constexpr Value(KeptIn<kMembers...> /*where*/)  // NOLINT(google-explicit-constructor): for rows
      : spec([](const SpecText& text) {
          const Settings defaults;
          return new_spec(text, KeptIn<kMembers...>::in(defaults));
        }),
        get([](Owner& owner, GValue* value) {
          const Settings now = owner.settings();
          write_value(KeptIn<kMembers...>::in(now), value);
        }),
        set([](Owner& owner, const GValue* value, WasSet<Settings> was_set) {
          owner.change_settings([&](Settings& settings) {
            auto& place = KeptIn<kMembers...>::in(settings);
            const auto before = place;
            read_value(value, place);
            if (was_set != nullptr) was_set(settings, place != before);
          });
        }) {}

  template <auto kGet, auto kSet>
  constexpr Value(ReturnedBy<kGet, kSet> /*by*/)  // NOLINT(google-explicit-constructor): for rows
      : spec([](const SpecText& text) {
          return new_spec(text, std::invoke_result_t<decltype(kGet), Owner&>());
        }),
        get([](Owner& owner, GValue* value) { write_value(std::invoke(kGet, owner), value); }),
        set(nullptr) {
    if constexpr (!std::is_null_pointer_v<decltype(kSet)>) {
      set = [](Owner& owner, const GValue* value, WasSet<Settings> /*was_set*/) {
        std::invoke_result_t<decltype(kGet), Owner&> wanted;
        read_value(value, wanted);
        std::invoke(kSet, owner, wanted);
      };
    }
  }
};

// What only some properties have.
template <typename Settings>
struct PropertyTraits {
  std::optional<Range> range = {};      // of a number; absent: all that its type holds
  Choices choices = {};                 // of an enumeration
  GParamFlags flags = kMutablePlaying;  // where it is not read only
  const char* other_name = nullptr;     // another property with the same value: both are notified
  WasSet<Settings> was_set = nullptr;
};

// A text, or a function that puts it together from what the library has; its result is never freed.
struct Blurb {
  const char* text = nullptr;
  const char* (*made)() = nullptr;

  constexpr Blurb(const char* words) : text(words) {}       // NOLINT(google-explicit-constructor)
  constexpr Blurb(const char* (*maker)()) : made(maker) {}  // NOLINT(google-explicit-constructor)
  [[nodiscard]] const char* get() const { return made != nullptr ? made() : text; }
};

// A row.
template <typename Owner>
struct Property {
  const char* name;
  const char* nick;
  Blurb blurb;
  Value<Owner> value;
  PropertyTraits<typename Owner::Settings> traits = {};

  [[nodiscard]] GParamSpec* new_spec() const {
    const GParamFlags flags = value.set != nullptr ? traits.flags : kReadOnly;
    return value.spec({name, nick, blurb.get(), flags, traits.range, traits.choices});
  }
};
template <typename Owner>
using Properties = std::span<const Property<Owner>>;

// For class_init. `kStateOf` finds the owner of an element: Owner& (*)(GObject*). The rows are
// numbered from 1 in their order, which is that of GObject's lists.
template <auto kStateOf, const auto& kTable>
void install_properties(GObjectClass* object_class) {
  object_class->set_property = [](GObject* object, guint id, const GValue* value,
                                  GParamSpec* spec) {
    const auto& row = kTable[id - 1];
    warn_if_late(GST_ELEMENT(object), spec);
    row.value.set(kStateOf(object), value, row.traits.was_set);
    if (row.traits.other_name != nullptr) g_object_notify(object, row.traits.other_name);
  };
  object_class->get_property = [](GObject* object, guint id, GValue* value, GParamSpec* /*spec*/) {
    kTable[id - 1].value.get(kStateOf(object), value);
  };
  guint id = 0;
  for (const auto& row : kTable) {
    g_object_class_install_property(object_class, ++id, row.new_spec());
  }
}

// New, floating GParamSpecs of all rows, for a bin that has the same properties.
template <typename Owner>
[[nodiscard]] std::vector<GParamSpec*> new_specs(Properties<Owner> table) {
  std::vector<GParamSpec*> specs;
  for (const Property<Owner>& row : table) specs.push_back(row.new_spec());
  return specs;
}

}  // namespace calvin::gst
