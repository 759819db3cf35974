"""ArduPilot's apm.pdef.xml: parameters of the vehicle and of libraries, with facts in `field` elements."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.files.parameter_metadata import value_readers
from mavstack.services.parameters.metadata import ParameterMetadata

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.dialects.xml_reader import Element


def recognises(root: Element) -> bool:
    """Return whether a document has this form."""
    return root.tag == "paramfile"


def read(root: Element) -> Iterator[ParameterMetadata]:
    """Yield the metadata of each parameter."""
    for part in root.children:  # the elements `vehicles` and `libraries`
        for group in part.named("parameters"):
            for element in group.named("param"):
                name = value_readers.name_of(element.attributes.get("name"))
                if name is not None:
                    yield _parameter(name, element, group.attributes.get("name", ""))


def _parameter(name: str, element: Element, group: str) -> ParameterMetadata:
    fields = {each.attributes.get("name", ""): each.text for each in element.named("field")}
    low, high = value_readers.range_of(fields.get("Range"))
    return ParameterMetadata(
        name=name,
        short_description=value_readers.text_of(element.attributes.get("humanName")),
        long_description=value_readers.text_of(element.attributes.get("documentation")),
        unit=value_readers.text_of(fields.get("Units")),
        minimum=low,
        maximum=high,
        increment=value_readers.number_of(fields.get("Increment")),
        values=value_readers.values_of(
            _pairs(element, "values", "value") or _listed(fields.get("Values", ""))
        ),
        bitmask=value_readers.bits_of(
            _pairs(element, "bitmask", "bit") or _listed(fields.get("Bitmask", ""))
        ),
        reboot_required=value_readers.flag_of(fields.get("RebootRequired")),
        read_only=value_readers.flag_of(fields.get("ReadOnly")),
        volatile=value_readers.flag_of(fields.get("Volatile")),
        group=value_readers.text_of(group),
        category=value_readers.text_of(element.attributes.get("user")),
    )


def _pairs(element: Element, list_tag: str, tag: str) -> list[tuple[str | None, str]]:
    """Return code and name of each entry of a list."""
    found = element.first(list_tag)
    return [] if found is None else [(each.attributes.get("code"), each.text) for each in found.named(tag)]


def _listed(text: str) -> list[tuple[str, str]]:
    """Return code and name of each entry of a text: "0:None,1:Analog"."""
    entries = [each.partition(":") for each in text.split(",")]
    return [(code, name) for code, mark, name in entries if mark]
