# SPDX-License-Identifier: GPL-3.0-or-later
"""Declarations of case and campaign files: sections with keys, each with unit, range, default and source.

A section is an attrs class; the functions of this module declare its keys::

    @definition
    class Link(Section):
        length_m: float = parameter(..., "m", 0, 1e3, "Table 1", above=True)

A key is checked when its section is created, from a file (:func:`.structure.structure`) or in Python. Only this package
uses attrs.
"""
from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, ClassVar, TypeVar, cast

import attrs

from statejump.core.errors import Range
from statejump.schema.rules import ATTACHED, NUMBER, NUMBERS, SWITCH, TEXT, TEXTS, WHOLE, Attached, Rule

CHOICE = "choice, the paper is silent"
RULE, SECTION, TABLES, READ = "rule", "section", "tables", "read"
TABLES_BESIDE = "tables"  # section that lists files of items, if a kind has it

SectionType = TypeVar("SectionType", bound="Section")
Names = Sequence[str] | Callable[[], Sequence[str]]


def definition(model: type[SectionType]) -> type[SectionType]:
    """Class decorator for sections: makes them immutable, with keyword arguments, and compares them by value."""
    return attrs.define(model, frozen=True, kw_only=True, slots=False, repr=not model.NAMED,
                        hash=False if model.NAMED else None)


def _check(instance: Any, attribute: attrs.Attribute[Any], value: Any) -> None:
    rule_of(attribute).check(attribute.name, value)


def _as_float(value: Any) -> Any:
    """Convert an integer to a float. Return other values unchanged; the check of the key judges them."""
    try:
        return float(value) if type(value) is int else value
    except OverflowError:  # larger than any range
        return value


def _as_floats(value: Any) -> Any:
    return [_as_float(item) for item in value] if isinstance(value, (list, tuple)) else value


def _key(default: Any, rule: Rule, converter: Callable[[Any], Any] | None = None) -> Any:
    if default is ...:
        default = attrs.NOTHING
    elif isinstance(default, list):
        given = tuple(default)
        default = attrs.Factory(lambda: list(given))
    return attrs.field(default=default, validator=_check, converter=converter, metadata={RULE: rule})


def parameter(default: Any, unit: str, low: float, high: float, source: str, *, above: bool = False) -> Any:
    """Declare a key whose value is a number.

    :param default: default value; ``...`` for a required key, None for an optional one
    :param unit: unit; ``-`` for a ratio
    :param low: lower end of the allowed range
    :param high: upper end of the allowed range, itself allowed
    :param source: source of the default
    :param above: whether ``low`` itself is not allowed
    """
    rule = Rule(NUMBER, source, Range(low, high, unit, above), optional=default is None)
    return _key(default, rule, _as_float)


def whole(default: Any, low: float, high: float, source: str) -> Any:
    """Declare an integer; parameters as for :func:`parameter`."""
    return _key(default, Rule(WHOLE, source, Range(low, high), optional=default is None))


def switch(default: Any, source: str) -> Any:
    """Declare a key that is true or false."""
    return _key(default, Rule(SWITCH, source))


def text(default: Any, source: str, *, pattern: str | Callable[[], str] | None = None) -> Any:
    """Declare a key whose value is a text.

    :param pattern: regular expression that the whole text must match, or a function that returns one on demand
    """
    return _key(default, Rule(TEXT, source, pattern=pattern, optional=default is None))


def _called(names: Names) -> Callable[[], Sequence[str]]:
    if callable(names):
        return names
    given = names
    return lambda: given


def choice(default: Any, names: Names, source: str) -> Any:
    """Declare a key whose value is one of several names.

    :param names: allowed names, or a function that returns them on demand
    """
    return _key(default, Rule(TEXT, source, known=_called(names), optional=default is None))


def numbers(default: Any, unit: str, low: float, high: float, source: str, *, length: int | None = None) -> Any:
    """Declare a key whose value is a list of numbers, all within one range.

    :param length: number of entries; None: any number
    """
    rule = Rule(NUMBERS, source, Range(low, high, unit), optional=default is None, length=length)
    return _key(default, rule, _as_floats)


def attached_to_json(value: Any) -> dict[str, Any]:
    """Return a JSON value for a value of a case that json.dumps cannot write."""
    if isinstance(value, Attached):
        return value.to_json()
    raise TypeError(f"{type(value).__name__} is no value of a case")


def attached(source: str) -> Any:
    """Declare a key whose value is an :class:`Attached`; files and schemas do not contain such keys."""
    return _key(None, Rule(ATTACHED, source, optional=True))


def texts(
    default: Any, source: str, names: Names | None = None, *, pattern: str | Callable[[], str] | None = None
) -> Any:
    """Declare a list of texts, optionally restricted to given names; ``pattern`` as for :func:`text`, for editors."""
    return _key(default, Rule(TEXTS, source, known=None if names is None else _called(names), pattern=pattern,
                              optional=default is None))


def section(
    model: type[Section], *, required: bool = False, made: Callable[[], Section] | None = None, name: str | None = None
) -> Any:
    """Declare a section of a file. If an optional section is missing, all its keys have their defaults.

    :param made: function that returns a missing section; None: all keys have their defaults
    :param name: name in files, if it differs from that of the attribute
    """
    default: Any = attrs.NOTHING if required else attrs.Factory(made or model)
    return attrs.field(default=default, metadata={SECTION: model}, alias=name)


def optional_section(model: type[Section]) -> Any:
    """Declare a section that may be missing. The value of a missing section is None."""
    return attrs.field(default=None, metadata={SECTION: model})


def tables(
    model: type[Section], source: str, *, required: bool = False,
    read: Callable[[str, Any], list[Any]] | None = None,
) -> Any:
    """Declare a list of tables, for example ``[[node]]``.

    :param model: class of a table, an :class:`~statejump.schema.items.Item` unless ``read`` is given
    :param source: description of the tables
    :param read: function that returns the items, from the name of the list and its tomllib value
    """
    default: Any = attrs.NOTHING if required else attrs.Factory(list)
    return attrs.field(default=default, metadata={TABLES: model, READ: read, RULE: Rule(TEXT, source)})


@definition
class Section:
    """A table of a file: unknown keys are refused, numbers are strict and in range."""

    # For each choice of the section: keys that some of its names require and its other names refuse.
    GOES_WITH: ClassVar[dict[str, dict[str, tuple[str, ...]]]] = {}
    # For each choice of the section: groups of keys. A name requires one whole group; other names refuse all of them.
    ONE_OF: ClassVar[dict[str, dict[str, tuple[tuple[str, ...], ...]]]] = {}
    # New paths of moved keys by their old paths; both are accepted, see :func:`statejump.schema.paths.current`.
    MOVED: ClassVar[Mapping[str, str]] = {}
    # Whether the name identifies the section: ``repr`` and ``hash`` then use only the name.
    NAMED: ClassVar[bool] = False

    if TYPE_CHECKING:
        # attrs generates this method for each class. Its arguments are the keys, which the rules check.
        def __init__(self, **keys: Any) -> None: ...

    def to_dict(self) -> dict[str, Any]:
        """Return keys and values in the order of their declaration. Sections become dicts."""
        return {name: _plain(self.value_named(name)) for name in fields_of(type(self))}

    def value_named(self, name: str) -> Any:
        """Return the value of a key, a section or a list of tables, by its name in files."""
        return getattr(self, fields_of(type(self))[name].name)


def section_class(name: str, documentation: str, keys: Mapping[str, Any]) -> type[Section]:
    """Return a new section class with given keys, for programs that handle keys as data."""
    return definition(type(name, (Section,), {**keys, "__doc__": documentation}))


def _plain(value: Any) -> Any:
    if isinstance(value, Section):
        return value.to_dict()
    # Items in columns are no list, but a sequence like one.
    return [_plain(item) for item in value] if isinstance(value, Sequence) and not isinstance(value, str) else value


_KNOWN: dict[type[Section], Mapping[str, attrs.Attribute[Any]]] = {}


def evolved(made: SectionType, **values: Any) -> SectionType:
    """Return a section with other values, checked again."""
    changed: SectionType = attrs.evolve(cast(Any, made), **values)  # every section class is an attrs class
    return changed


def fields_of(model: type[Section]) -> Mapping[str, attrs.Attribute[Any]]:
    """Return the keys of a section, or the sections of a file, by their names in files, in the order of their first
    declaration. If a kind declares a name again, its position does not change."""
    if model not in _KNOWN:
        known = {attribute.alias: attribute for attribute in attrs.fields(model)}  # type: ignore[arg-type]
        order = dict.fromkeys(
            attribute.alias for base in reversed(model.__mro__)
            for attribute in base.__dict__.get("__attrs_attrs__", ())
        )
        _KNOWN[model] = MappingProxyType({name: known[name] for name in order})
    return _KNOWN[model]


def rule_of(attribute: attrs.Attribute[Any]) -> Rule:
    """Return what a key takes."""
    found: Rule = attribute.metadata[RULE]
    return found


def section_of(attribute: attrs.Attribute[Any]) -> type[Section] | None:
    """Return the class of a section of a file; None if the attribute is a list of tables."""
    found: type[Section] | None = attribute.metadata.get(SECTION)
    return found


def tables_of(attribute: attrs.Attribute[Any]) -> type[Section] | None:
    """Return the class of the tables in a list; None if the attribute is a section."""
    found: type[Section] | None = attribute.metadata.get(TABLES)
    return found


def is_required(attribute: attrs.Attribute[Any]) -> bool:
    """Return whether a key, section or list is required."""
    return attribute.default is attrs.NOTHING


def default_of(attribute: attrs.Attribute[Any]) -> Any:
    """Return the default of a key that is not required."""
    made: Any = attribute.default
    return made.factory() if isinstance(made, attrs.Factory) else made  # type: ignore[arg-type]  # it is a class
