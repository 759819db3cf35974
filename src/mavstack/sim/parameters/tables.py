"""Which parameters each firmware has on each type of vehicle: the files in `tables`, read.

A file is plain text with a line a parameter, and lines that begin with `#`:

    NAME TYPE VALUE [LEAST..MOST] [read-only] [volatile]

`TYPE` is the name of a MAV_PARAM_TYPE. A name may stand for a series: `RC{1..16}_MIN` for sixteen
parameters, `COMPASS_OFS{,2,3}_{X,Y,Z}` for nine. A vehicle's table is made of several files one upon the
other: a line for a name that an earlier file has, replaces it and keeps its place.

Names, types and values are those of the programs: of ArduPilot 4.6, and of PX4 1.17 in its own simulator; a
few speeds fit the simulated bodies better than the values that the programs begin with. ArduPilot lists its
parameters in an order of its own, PX4 by name.
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
    (Firmware.PX4, VehicleType.COPTER): ("common", "multicopter", "copter"),
    (Firmware.PX4, VehicleType.PLANE): ("common", "fixed_wing", "plane"),
    (Firmware.PX4, VehicleType.VTOL): ("common", "multicopter", "fixed_wing", "vtol"),
    (Firmware.PX4, VehicleType.ROVER): ("common", "surface", "rover"),
    (Firmware.PX4, VehicleType.BOAT): ("common", "surface", "boat"),
    (Firmware.PX4, VehicleType.SUB): ("common", "sub"),
}
_LINE = re.compile(
    r"(?P<name>\S+) (?P<kind>[A-Z0-9]+) (?P<value>\S+)"
    r"(?: (?P<least>[^ .]+)\.\.(?P<most>[^ .]+))?(?P<fixed> read-only)?(?P<volatile> volatile)?"
)
_SERIES = re.compile(r"\{([^}]*)\}")
_RANGE = re.compile(r"(\d+)\.\.(\d+)")


class Row(NamedTuple):
    """A line of a file."""

    name: str
    kind: common.MavParamType
    value: Value
    minimum: Value | None
    maximum: Value | None
    read_only: bool
    volatile: bool

    def definition(self) -> ParameterDefinition:
        """A parameter of a vehicle's own."""
        return ParameterDefinition(
            self.name,
            self.value,
            self.kind,
            self.minimum,
            self.maximum,
            self.value,
            self.read_only,
            self.volatile,
        )


def expand(name: str) -> list[str]:
    """The names that a name with series stands for."""
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


def read(text: str) -> Iterator[Row]:
    """The rows of a file; raises ValueError if a line is none."""
    for number, line in enumerate(text.splitlines(), 1):
        if line and not line.startswith("#"):
            yield from _rows_of(line, number)


@cache
def rows(firmware: Firmware, type: VehicleType) -> tuple[Row, ...]:  # noqa: A002 (HEARTBEAT's name for it)
    """The parameters of a vehicle as it leaves the factory, in the order of their indices."""
    found: dict[str, Row] = {}
    folder = files(__package__) / "tables"
    for layer in _LAYERS[firmware, type]:
        text = (folder / f"{firmware}_{layer}.txt").read_text(encoding="ascii")
        found.update((row.name, row) for row in read(text))
    return tuple(sorted(found.values())) if firmware is Firmware.PX4 else tuple(found.values())


def definitions(firmware: Firmware, type: VehicleType) -> list[ParameterDefinition]:  # noqa: A002
    """The same, for one vehicle to keep."""
    return [row.definition() for row in rows(firmware, type)]


def _rows_of(line: str, number: int) -> Iterator[Row]:
    found = _LINE.fullmatch(line)
    if found is None:
        raise ValueError(f"line {number} of a table of parameters is none: {line}")
    kind = common.MavParamType[found["kind"]]
    parse = float if kind is common.MavParamType.REAL32 else int
    least, most = (None if found[side] is None else parse(found[side]) for side in ("least", "most"))
    for name in expand(found["name"]):
        yield Row(
            name, kind, parse(found["value"]), least, most, bool(found["fixed"]), bool(found["volatile"])
        )
