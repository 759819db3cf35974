"""The metadata files of simulated vehicles: of parameters (parameter.schema.json) and of PX4's events.

The files in `descriptions` describe the parameters on which the simulation acts, in plain text with one
parameter per line, in sections by vehicle type:

    [copter vtol]
    NAME | UNIT | MIN..MAX | FLAGS | DESCRIPTION | VALUE=TEXT, VALUE=TEXT

A name may be a series, as in the tables. `FLAGS` are `reboot`, `read-only` and `bits` (the values are numbers
of bits). Units, ranges and numbers are those of the firmwares. Every other parameter is listed with its type
and its default. PX4's have a translation of some descriptions, in `px4.de_DE.txt`: `NAME | TEXT`.
"""

from __future__ import annotations

import json
from functools import cache
from importlib.resources import files
from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.files.parameter_metadata.component_json import to_json
from mavstack.services.component_metadata import (
    GENERAL_NAME,
    PARAMETER_RULES,
    ServedMetadata,
    summary_name,
    translation_name,
)
from mavstack.services.ftp import VirtualFile
from mavstack.services.parameters import ParameterMetadata
from mavstack.sim.event_metadata import event_metadata
from mavstack.sim.parameters.tables import expand, rows
from mavstack.sim.vehicle_types import Firmware

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from mavstack.services.parameters import Value
    from mavstack.sim.parameters.tables import Row
    from mavstack.sim.vehicle_types import VehicleType

#: The folder in which MAVLink FTP serves the metadata files. A real PX4 serves them there; a real ArduPilot
#: has no such files.
FOLDERS: Final[Mapping[Firmware, str]] = MappingProxyType(
    {Firmware.PX4: "etc/extras", Firmware.ARDUPILOT: "@ROMFS/metadata"}
)
#: The locale of the translation.
LOCALE: Final = "de_DE"
_FILE: Final = "parameters.json"
_EVENTS_FILE: Final = "all_events.json"
_VERSION: Final = 3
_FIELDS: Final = 6
_SCHEMA_TYPES: Final[Mapping[int, str]] = MappingProxyType({common.MavParamType.REAL32: "Float"})


@cache
def served_metadata(firmware: Firmware, vehicle_type: VehicleType) -> ServedMetadata:
    """Return the metadata files of a vehicle: the same for all vehicles of a firmware and a type."""
    document = {"version": _VERSION, "parameters": list(_entries(firmware, vehicle_type))}
    content = json.dumps({**document, "translation": PARAMETER_RULES})
    contents = {int(common.CompMetadataType.PARAMETER): (_FILE, content.encode())}
    if firmware is Firmware.PX4:
        contents[common.CompMetadataType.EVENTS] = (_EVENTS_FILE, event_metadata())
    translations = {int(common.CompMetadataType.PARAMETER): _translations(firmware)}
    return ServedMetadata(FOLDERS[firmware], contents, translations)


def metadata_files(firmware: Firmware, vehicle_type: VehicleType) -> dict[str, VirtualFile]:
    """Return the metadata files for a file store, by path; their content is made when it is first needed."""

    def file(name: str) -> VirtualFile:
        path = f"{FOLDERS[firmware]}/{name}.xz"
        return VirtualFile(lambda query: served_metadata(firmware, vehicle_type).files[path])

    names = [GENERAL_NAME, _FILE]
    if firmware is Firmware.PX4:
        names += [_EVENTS_FILE, summary_name(_FILE), translation_name(_FILE, LOCALE)]
    return {f"{FOLDERS[firmware]}/{name}.xz": file(name) for name in names}


def described(firmware: Firmware, vehicle_type: VehicleType) -> dict[str, ParameterMetadata]:
    """Return the descriptions for a vehicle type, by parameter name.

    Raises:
        ValueError: A line is invalid.
    """
    text = (files(__package__) / "descriptions" / f"{firmware}.txt").read_text(encoding="ascii")
    found: dict[str, ParameterMetadata] = {}
    applies = False
    for number, line in enumerate(text.splitlines(), 1):
        if line.startswith("["):
            applies = line == "[all]" or str(vehicle_type) in line.strip("[]").split()
        elif applies and line and not line.startswith("#"):
            found.update((each.name, each) for each in _parse(line, number))
    return found


def _translations(firmware: Firmware) -> dict[str, dict[str, str]]:
    """Return the translated descriptions by locale, then by their places in the file."""
    if firmware is not Firmware.PX4:
        return {}
    text = (files(__package__) / "descriptions" / f"{firmware}.{LOCALE}.txt").read_text(encoding="utf-8")
    rows = (line.split(" | ") for line in text.splitlines() if not line.startswith("#"))
    return {LOCALE: {f"/parameters/{name}/shortDesc": words for name, words in rows}}


def _entries(firmware: Firmware, vehicle_type: VehicleType) -> Iterator[dict[str, object]]:
    known = described(firmware, vehicle_type)
    for row in rows(firmware, vehicle_type):
        entry = to_json(known.get(row.name) or ParameterMetadata(name=row.name), _type_name(row))
        stated: dict[str, object] = {"default": row.value, "group": row.name.partition("_")[0]}
        yield entry | stated | _flags(row)


def _flags(row: Row) -> dict[str, object]:
    flags = {"readOnly": row.read_only, "volatile": row.volatile}
    return {key: value for key, value in flags.items() if value}


def _type_name(row: Row) -> str:
    return _SCHEMA_TYPES.get(row.type, row.type.name.capitalize())


def _parse(line: str, number: int) -> Iterator[ParameterMetadata]:
    """Yield the metadata of a line; several for a series."""
    fields = [field.strip() for field in line.split("|")]
    if len(fields) != _FIELDS:
        raise ValueError(f"line {number} of the descriptions has {len(fields)} fields, not {_FIELDS}: {line}")
    name, unit, span, flags, text, names = fields
    low, _, high = span.partition("..")
    values = dict(_named_value(each) for each in names.split(", ")) if names else {}
    bits = "bits" in flags
    for each in expand(name):
        yield ParameterMetadata(
            name=each,
            short_description=text.rstrip("."),
            unit=unit,
            minimum=float(low) if low else None,
            maximum=float(high) if high else None,
            values={} if bits else values,
            bitmask={int(bit): label for bit, label in values.items()} if bits else {},
            reboot_required="reboot" in flags,
            read_only="read-only" in flags,
        )


def _named_value(text: str) -> tuple[Value, str]:
    value, _, name = text.partition("=")
    return int(value), name
