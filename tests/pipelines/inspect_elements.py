#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Whether every element of the plugin reads in gst-inspect-1.0 like one of GStreamer's own.

    inspect_elements.py DOCS_DIR
"""

import pathlib
import re
import sys

import gi

gi.require_version("Gst", "1.0")
from gi.repository import GObject, Gst  # noqa: E402

from enum_values import enum_values  # noqa: E402

CLASSES = {"Filter", "Analyzer", "Video", "Effect", "Source", "Converter"}
MUTABLE = [1 << (GObject.PARAM_USER_SHIFT + n) for n in (2, 3, 4)]
NUMBERS = {
    "gint", "guint", "gint64", "guint64", "glong", "gulong", "gfloat", "gdouble"
}
# One of these is in the blurb of every number: its unit, or what it counts or compares.
UNITS = re.compile(
    r"\bpx\b|\bns\b|\bms\b|\bin s\b|\bin m\b|degrees|per second|grey levels|[Ff]actor|[Vv]iews|threads|Number of|in the units of"
    r"|\b0: .*\b1: |\b0\.\.1\b|[Cc]hoice of")
SMALL_WORDS = {"a", "of", "to", "and", "in", "the"}


def describe_enum(spec):
    """What is wrong with the values of an enum property."""
    kind = spec.value_type
    if not Gst.type_is_plugin_api(kind)[0]:
        yield f"{kind.name} is not marked as plugin API"
    if not kind.name.startswith("GstCalib"):
        yield f"{kind.name} is not named after its element"
    for value in enum_values(spec).values():
        if not re.fullmatch(r"[a-z][a-z0-9]*(-[a-z0-9]+)*", value.value_nick):
            yield f"the nick '{value.value_nick}' is not in lower case"
        if len(value.value_name.split()) < 2 or not value.value_name[0].isupper():
            yield f"'{value.value_nick}' is not described: '{value.value_name}'"


def describe_number(spec):
    """What is wrong with a number's range or unit."""
    if not UNITS.search(spec.blurb):
        yield f"no unit: {spec.blurb}"
    if not spec.minimum <= spec.default_value <= spec.maximum:
        yield "the default is out of range"
    if spec.value_type.name in ("gdouble", "gfloat") and max(-spec.minimum, spec.maximum) > 1e9:
        yield f"the range {spec.minimum}..{spec.maximum} says nothing"


def describe_property(spec):
    """What is wrong with one property."""
    if not re.fullmatch(r"[a-z]+(-[a-z]+)*", spec.name):
        yield "the name is not kebab-case"
    words = spec.nick.split() if spec.nick else []
    if not words or spec.nick == spec.name:
        yield "no nick"
    if any(w[0].islower() and w not in SMALL_WORDS for w in words):
        yield f"the nick is not in title case: {spec.nick}"
    blurb = spec.blurb or ""
    if len(blurb.split()) < 3 or not blurb[0].isupper() or blurb.endswith("."):
        yield f"the blurb is no phrase: '{blurb}'"
    writable = bool(spec.flags & GObject.ParamFlags.WRITABLE)
    if writable and sum(bool(spec.flags & bit) for bit in MUTABLE) != 1:
        yield "it does not say when it may change"
    if not spec.flags & GObject.ParamFlags.READABLE:
        yield "it cannot be read"
    if spec.__gtype__.name == "GParamEnum":
        yield from describe_enum(spec)
    if spec.value_type.name in NUMBERS:
        yield from describe_number(spec)


def describe_element(factory, page):
    """What is wrong with one element."""
    element = factory.create(None)
    texts = {key: factory.get_metadata(key) for key in ("long-name", "klass", "description", "author")}
    for key, text in texts.items():
        if not text:
            yield f"no {key}"
    if not set(texts["klass"].split("/")) <= CLASSES:
        yield f"klass {texts['klass']}"
    if len(texts["description"].split()) < 4 or texts["description"].endswith("."):
        yield f"description '{texts['description']}'"
    if element.__gtype__.name.lower() != "gst" + factory.get_name():
        yield f"the type is called {element.__gtype__.name}"
    for template in factory.get_static_pad_templates():
        caps = template.get_caps()
        if caps.is_any() or caps.is_empty():
            yield f"the pad template {template.name_template} says {caps.to_string()}"
    for spec in element.list_properties():
        if spec.owner_type == element.__gtype__:
            for problem in describe_property(spec):
                yield f"{spec.name}: {problem}"
    for signal in GObject.signal_list_names(element.__gtype__):
        if f"`{signal}`" not in page:
            yield f"the page in docs/elements does not tell of the signal {signal}"


def main():
    Gst.init(None)
    docs = pathlib.Path(sys.argv[1])
    factories = Gst.Registry.get().get_feature_list_by_plugin("calvin")
    problems = []
    for factory in factories:
        name = factory.get_name()
        page = (docs / f"{name}.md").read_text()
        problems += [f"{name}: {problem}" for problem in describe_element(factory, page)]
    plugin = Gst.Registry.get().find_plugin("calvin")
    if plugin.get_license() != "LGPL" or not plugin.get_description():
        problems.append("the plugin's licence or description")
    print("\n".join(problems))
    return 0 if factories and not problems else 1


if __name__ == "__main__":
    sys.exit(main())
