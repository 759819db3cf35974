"""The parameters of a component as JSON (parameter.schema.json), which PX4 also publishes as parameters.json.

Older files of PX4 have longer keys (`shortDescription`, `minValue`) and numbers in texts.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from mavstack.errors import MetadataError
from mavstack.files.parameter_metadata import value_readers
from mavstack.services.parameters.metadata import ParameterMetadata

if TYPE_CHECKING:
    from collections.abc import Iterator


def recognises(document: dict[str, Any]) -> bool:
    """Return whether a document has this form."""
    return "parameters" in document


def read(document: dict[str, Any]) -> Iterator[ParameterMetadata]:
    """Yield the metadata of each parameter."""
    entries = document["parameters"]
    if not isinstance(entries, list):
        raise MetadataError("'parameters' is not an array")
    for entry in entries:
        name = value_readers.name_of(entry.get("name")) if isinstance(entry, dict) else None
        if name is not None:
            yield _parameter(name, entry)


def _parameter(name: str, entry: dict[str, Any]) -> ParameterMetadata:
    low, high = value_readers.ordered(_number(entry, "min", "minValue"), _number(entry, "max", "maxValue"))
    return ParameterMetadata(
        name=name,
        short_description=_text(entry, "shortDesc", "shortDescription"),
        long_description=_text(entry, "longDesc", "longDescription"),
        unit=_text(entry, "units"),
        minimum=low,
        maximum=high,
        default=_number(entry, "default", "defaultValue"),
        increment=_number(entry, "increment"),
        decimal_places=value_readers.decimals_of(entry.get("decimalPlaces")),
        values=value_readers.values_of(_pairs(entry.get("values"), "value")),
        bitmask=value_readers.bits_of(_pairs(entry.get("bitmask"), "index")),
        reboot_required=value_readers.flag_of(entry.get("rebootRequired")),
        read_only=value_readers.flag_of(entry.get("readOnly")),
        volatile=value_readers.flag_of(entry.get("volatile")),
        group=_text(entry, "group"),
        category=_text(entry, "category"),
        type=value_readers.type_of(entry.get("type")),
    )


def to_json(entry: ParameterMetadata, type_name: str) -> dict[str, object]:
    """Return the entry of a parameter for such a file.

    Args:
        entry: The metadata.
        type_name: The name of the type in the schema: "Int32", "Float".

    Returns:
        The entry, without the facts that are not stated.
    """
    stated = {
        "name": entry.name,
        "type": type_name,
        "shortDesc": entry.short_description,
        "longDesc": entry.long_description,
        "units": entry.unit,
        "default": entry.default,
        "min": entry.minimum,
        "max": entry.maximum,
        "increment": entry.increment,
        "decimalPlaces": entry.decimal_places,
        "values": [{"value": value, "description": name} for value, name in entry.values.items()],
        "bitmask": [{"index": bit, "description": name} for bit, name in entry.bitmask.items()],
        "rebootRequired": entry.reboot_required or None,
        "readOnly": entry.read_only or None,
        "volatile": entry.volatile or None,
        "group": entry.group,
        "category": entry.category,
    }
    return {key: value for key, value in stated.items() if value not in (None, "", [])}


def _number(entry: dict[str, Any], *keys: str) -> float | None:
    return next(
        (found for key in keys if (found := value_readers.number_of(entry.get(key))) is not None), None
    )


def _text(entry: dict[str, Any], *keys: str) -> str:
    return next((found for key in keys if (found := value_readers.text_of(entry.get(key)))), "")


def _pairs(entries: object, key: str) -> list[tuple[Any, Any]]:
    """Return number and description of each entry of an array."""
    found = entries if isinstance(entries, list) else []
    return [(each.get(key), each.get("description")) for each in found if isinstance(each, dict)]
