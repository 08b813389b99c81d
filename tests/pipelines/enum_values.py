# SPDX-License-Identifier: LGPL-2.1-or-later
"""The values of enum properties, which PyGObject lists in another way from version to version."""

from gi.repository import GObject


def enum_values(spec):
    """Number -> value, with value_nick and value_name, of a readable enum property."""
    # PyGObject makes the class of the type for what it reads of an object.
    value = GObject.new(spec.owner_type).get_property(spec.name)
    return type(value).__enum_values__
