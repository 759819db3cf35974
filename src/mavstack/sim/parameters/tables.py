"""Parameter tables of each firmware and vehicle type, read from the files in `tables`.

A file is plain text with one parameter per line, and comments that start with `#`:

    NAME TYPE VALUE [MIN..MAX] [read-only] [volatile]

`TYPE` is the name of a MAV_PARAM_TYPE. A name may be a series: `RC{1..16}_MIN` is sixteen parameters,
`COMPASS_OFS{,2,3}_{X,Y,Z}` nine. A vehicle's table combines several files in order: a later line for the same
name replaces the earlier one and keeps its position.

Names, types and values are those of ArduPilot 4.6, and of PX4 1.17 in its own simulator; a few speeds are
changed to fit the simulated bodies. ArduPilot lists its parameters in its own order, PX4 by name.
"""

from __future__ import annotations

import re
from functools import cache
from importlib.resources import files
from typing import TYPE_CHECKING, NamedTuple

from mavstack.dialects import common
from mavstack.services.parameters import ParameterDefinition
from mavstack.sim.vehicle_types import Firmware, VehicleType

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.services.parameters import Value

_LAYERS = {
    (Firmware.ARDUPILOT, VehicleType.COPTER): ("common", "hover", "copter"),
    (Firmware.ARDUPILOT, VehicleType.PLANE): ("common", "plane"),
    (Firmware.ARDUPILOT, VehicleType.VTOL): ("common", "plane", "vtol"),
    (Firmware.ARDUPILOT, VehicleType.ROVER): ("common", "rover"),
    (Firmware.ARDUPILOT, VehicleType.BOAT): ("common", "rover", "boat"),
    (Firmware.ARDUPILOT, VehicleType.SUB): ("common", "hover", "sub"),
    (Firmware.PX4, VehicleType.COPTER): ("common", "transponder", "multicopter", "copter"),
    (Firmware.PX4, VehicleType.PLANE): ("common", "transponder", "fixed_wing", "plane"),
    (Firmware.PX4, VehicleType.VTOL): ("common", "transponder", "multicopter", "fixed_wing", "vtol"),
    (Firmware.PX4, VehicleType.ROVER): ("common", "transponder", "surface", "rover"),
    (Firmware.PX4, VehicleType.BOAT): ("common", "transponder", "surface", "boat"),
    (Firmware.PX4, VehicleType.SUB): ("common", "transponder", "sub"),
}
_LINE = re.compile(
    r"(?P<name>\S+) (?P<kind>[A-Z0-9]+) (?P<value>\S+)"
    r"(?: (?P<low>[^ .]+)\.\.(?P<high>[^ .]+))?(?P<fixed> read-only)?(?P<volatile> volatile)?"
)
_SERIES = re.compile(r"\{([^}]*)\}")
_RANGE = re.compile(r"(\d+)\.\.(\d+)")


class Row(NamedTuple):
    """A line of a file."""

    name: str
    type: common.MavParamType
    value: Value
    minimum: Value | None
    maximum: Value | None
    read_only: bool
    volatile: bool

    def definition(self) -> ParameterDefinition:
        """Return a new parameter for one vehicle."""
        return ParameterDefinition(
            self.name,
            self.value,
            self.type,
            minimum=self.minimum,
            maximum=self.maximum,
            default=self.value,
            read_only=self.read_only,
            volatile=self.volatile,
        )


def expand(name: str) -> list[str]:
    """Return the names of a series."""
    series = _SERIES.search(name)
    if series is None:
        return [name]
    bounds = _RANGE.fullmatch(series[1])
    members = (
        [str(number) for number in range(int(bounds[1]), int(bounds[2]) + 1)]
        if bounds
        else series[1].split(",")
    )
    head, tail = name[: series.start()], name[series.end() :]
    return [head + member + rest for member in members for rest in expand(tail)]


def parse(text: str) -> Iterator[Row]:
    """Return the rows of a file.

    Raises:
        ValueError: A line is invalid.
    """
    for number, line in enumerate(text.splitlines(), 1):
        if line and not line.startswith("#"):
            yield from _rows_of(line, number)


@cache
def rows(firmware: Firmware, vehicle_type: VehicleType) -> tuple[Row, ...]:
    """Return the factory parameters of a vehicle, in the order of their indices."""
    found: dict[str, Row] = {}
    for layer in _LAYERS[firmware, vehicle_type]:
        found.update((row.name, row) for row in _file(firmware, layer))
    return tuple(sorted(found.values())) if firmware is Firmware.PX4 else tuple(found.values())


def definitions(firmware: Firmware, vehicle_type: VehicleType) -> list[ParameterDefinition]:
    """Return new parameters for one vehicle."""
    return [row.definition() for row in rows(firmware, vehicle_type)]


def group_definitions(firmware: Firmware, group: str) -> list[ParameterDefinition]:
    """Return new parameters of a group that is shown when it is enabled."""
    return [row.definition() for row in _file(firmware, group)]


@cache
def _file(firmware: Firmware, name: str) -> tuple[Row, ...]:
    """Return the rows of a file."""
    return tuple(
        parse((files(__package__) / "tables" / f"{firmware}_{name}.txt").read_text(encoding="ascii"))
    )


def _rows_of(line: str, number: int) -> Iterator[Row]:
    """Return the rows of a line."""
    found = _LINE.fullmatch(line)
    if found is None:
        raise ValueError(f"line {number} of a parameter table is invalid: {line}")
    kind = common.MavParamType[found["kind"]]
    parse = float if kind is common.MavParamType.REAL32 else int
    low, high = (None if found[side] is None else parse(found[side]) for side in ("low", "high"))
    for name in expand(found["name"]):
        yield Row(name, kind, parse(found["value"]), low, high, bool(found["fixed"]), bool(found["volatile"]))
