"""PX4's parameters.xml: parameters in groups, with facts in elements of their own."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.files.parameter_metadata import value_readers
from mavstack.services.parameters.metadata import ParameterMetadata

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.dialects.xml_reader import Element


def recognises(root: Element) -> bool:
    """Return whether a document has this form."""
    return root.tag == "parameters"


def read(root: Element) -> Iterator[ParameterMetadata]:
    """Yield the metadata of each parameter."""
    for group in root.named("group"):
        for element in group.named("parameter"):
            name = value_readers.name_of(element.attributes.get("name"))
            if name is not None:
                yield _parameter(name, element, group.attributes.get("name", ""))


def _parameter(name: str, element: Element, group: str) -> ParameterMetadata:
    fields = {each.tag: each.text for each in element.children}
    low, high = value_readers.ordered(
        value_readers.number_of(fields.get("min")), value_readers.number_of(fields.get("max"))
    )
    values = value_readers.values_of(_pairs(element, "values", "value", "code"))
    is_boolean = "boolean" in fields or value_readers.flag_of(element.attributes.get("boolean"))
    return ParameterMetadata(
        name=name,
        short_description=value_readers.text_of(fields.get("short_desc")),
        long_description=value_readers.text_of(fields.get("long_desc")),
        unit=value_readers.text_of(fields.get("unit")),
        minimum=low,
        maximum=high,
        default=value_readers.number_of(element.attributes.get("default")),
        increment=value_readers.number_of(fields.get("increment")),
        decimal_places=value_readers.decimals_of(fields.get("decimal")),
        values=values or ({0: "Disabled", 1: "Enabled"} if is_boolean else {}),
        bitmask=value_readers.bits_of(_pairs(element, "bitmask", "bit", "index")),
        reboot_required=value_readers.flag_of(fields.get("reboot_required")),
        volatile=value_readers.flag_of(element.attributes.get("volatile")),
        group=value_readers.text_of(group),
        category=value_readers.text_of(element.attributes.get("category")),
        type=value_readers.type_of(element.attributes.get("type")),
    )


def _pairs(element: Element, list_tag: str, tag: str, key: str) -> list[tuple[str | None, str]]:
    """Return number and name of each entry of a list."""
    found = element.first(list_tag)
    return [] if found is None else [(each.attributes.get(key), each.text) for each in found.named(tag)]
