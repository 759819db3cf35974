"""ArduPilot's apm.pdef.json: parameters by name in groups, with numbers in texts."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

from mavstack.files.parameter_metadata import value_readers
from mavstack.services.parameters.metadata import ParameterMetadata

if TYPE_CHECKING:
    from collections.abc import Iterator

#: The key of the facts about the file; all other keys are groups of parameters.
_HEAD: Final = "json"
#: Keys of a parameter's description; every parameter has at least one of them.
_DESCRIPTIONS: Final = ("DisplayName", "Description", "displayName", "description")


def recognises(document: dict[str, Any]) -> bool:
    """Return whether a document has this form."""
    return _HEAD in document or any(True for _ in read(document))


def read(document: dict[str, Any]) -> Iterator[ParameterMetadata]:
    """Yield the metadata of each parameter."""
    for group, entries in document.items():
        if group == _HEAD or not isinstance(entries, dict):
            continue
        for key, entry in entries.items():
            name = value_readers.name_of(key)
            if name is not None and isinstance(entry, dict) and any(each in entry for each in _DESCRIPTIONS):
                yield _parameter(name, entry, group)


def _parameter(name: str, entry: dict[str, Any], group: str) -> ParameterMetadata:
    low, high = _range(entry.get("Range"))
    return ParameterMetadata(
        name=name,
        short_description=value_readers.text_of(entry.get("DisplayName") or entry.get("displayName")),
        long_description=value_readers.text_of(entry.get("Description") or entry.get("description")),
        unit=value_readers.text_of(entry.get("Units")),
        minimum=low,
        maximum=high,
        increment=value_readers.number_of(entry.get("Increment")),
        values=value_readers.values_of(_pairs(entry.get("Values"))),
        bitmask=value_readers.bits_of(_pairs(entry.get("Bitmask"))),
        reboot_required=value_readers.flag_of(entry.get("RebootRequired")),
        read_only=value_readers.flag_of(entry.get("ReadOnly")),
        volatile=value_readers.flag_of(entry.get("Volatile")),
        group=value_readers.text_of(group),
        category=value_readers.text_of(entry.get("User") or entry.get("user")),
    )


def _range(value: object) -> tuple[float | None, float | None]:
    if isinstance(value, dict):
        return value_readers.ordered(
            value_readers.number_of(value.get("low")), value_readers.number_of(value.get("high"))
        )
    return value_readers.range_of(value)


def _pairs(entries: object) -> list[tuple[Any, Any]]:
    return list(entries.items()) if isinstance(entries, dict) else []
