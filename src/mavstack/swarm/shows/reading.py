"""Show files: `.skyc` of Skybrush Studio, and CSV, one file for each vehicle.

A `.skyc` file is a ZIP archive with `show.json`; parts of it may be other entries (`{"$ref": "./…"}`). The
points of a trajectory are `[time, [x, y, z], [control points]]`, with the control points of the curve that
ends there, and times since the takeoff of the vehicle. CSV files have the columns `Time [msec]`, `x [m]`,
`y [m]`, `z [m]`, `Red`, `Green`, `Blue`; they are the entries of a ZIP archive.

Files come from elsewhere: sizes are bounded, and each problem is a `PlanFileError` with its place.
"""

from __future__ import annotations

import base64
import binascii
import csv
import io
import json
import posixpath
import zipfile
from itertools import pairwise
from typing import TYPE_CHECKING, Any, Final

from mavstack.errors import InvalidArgumentError, PlanFileError
from mavstack.swarm.shows.lights import light_program
from mavstack.swarm.shows.show import Curve, Show, ShowVehicle, Trajectory

if TYPE_CHECKING:
    from collections.abc import Sequence

#: Maximum bytes of a file, of one entry and of all entries that are read; maximum number of vehicles.
MAX_FILE: Final = 64 << 20
MAX_ENTRY: Final = 32 << 20
MAX_TOTAL: Final = 256 << 20
MAX_VEHICLES: Final = 5000
#: Maximum depth of references from one entry to another.
_MAX_DEPTH: Final = 8
_COLUMNS: Final = ("time", "x", "y", "z")


def parse_show(data: bytes, name: str = "") -> Show:
    """Read a show.

    Args:
        data: The content of a `.skyc` file, of a ZIP archive of CSV files, or of one CSV file.
        name: The name of the file, for errors and as the title of a show that has none.

    Raises:
        PlanFileError: It is not a show, or a part of it is not possible.
    """
    if len(data) > MAX_FILE:
        raise PlanFileError(f"it has {len(data)} bytes, at most {MAX_FILE} are read", name)
    if not data.startswith(b"PK"):
        vehicle = _csv_vehicle(data, "", name)
        return Show(vehicle.name, (vehicle,))
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            return _Archive(archive, name).show()
    except (zipfile.BadZipFile, NotImplementedError, RuntimeError, EOFError) as error:
        raise PlanFileError(f"it is not a ZIP archive that can be read ({error})", name) from None


class _Archive:
    """An archive while it is read."""

    def __init__(self, archive: zipfile.ZipFile, name: str) -> None:
        self._archive, self._name = archive, name
        self._left = MAX_TOTAL

    def show(self) -> Show:
        names = self._archive.namelist()
        if "show.json" in names:
            return self._skyc()
        tables = sorted(each for each in names if each.lower().endswith(".csv"))
        if not tables:
            raise PlanFileError("it has neither show.json nor CSV files", self._name)
        if len(tables) > MAX_VEHICLES:
            raise PlanFileError(f"it has {len(tables)} vehicles, at most {MAX_VEHICLES} are read", self._name)
        vehicles = [_csv_vehicle(self._entry(each), posixpath.basename(each), self._name) for each in tables]
        return Show(self._name, vehicles)

    def _skyc(self) -> Show:
        root = self._json("show.json")
        drones = _member(_member(root, "swarm", dict, self._name), "drones", list, self._name)
        if not 1 <= len(drones) <= MAX_VEHICLES:
            raise PlanFileError(f"it has {len(drones)} vehicles, 1 to {MAX_VEHICLES} are read", self._name)
        meta = root.get("meta") if isinstance(root, dict) else None
        title = meta.get("title") if isinstance(meta, dict) else None
        vehicles = [self._vehicle(index, each) for index, each in enumerate(drones)]
        return Show(title if isinstance(title, str) else self._name, vehicles)

    def _vehicle(self, index: int, drone: Any) -> ShowVehicle:  # noqa: ANN401 (JSON)
        where = f"vehicle {index + 1}"
        settings = self._resolve(_member(self._resolve(drone), "settings", dict, self._name, where))
        trajectory = self._resolve(_member(settings, "trajectory", dict, self._name, where))
        lights = self._resolve(settings.get("lights")) or {}
        name = settings.get("name")
        try:
            return ShowVehicle(
                name if isinstance(name, str) else where, _trajectory(trajectory), _lights(lights)
            )
        except (InvalidArgumentError, TypeError, ValueError, KeyError, IndexError) as error:
            raise PlanFileError(str(error) or "its trajectory cannot be read", self._name, where) from None

    def _resolve(self, value: Any, depth: int = 0) -> Any:  # noqa: ANN401 (JSON)
        """Return a value, or the entry to which it refers."""
        reference = value.get("$ref") if isinstance(value, dict) else None
        if not isinstance(reference, str):
            return value
        if depth >= _MAX_DEPTH:
            raise PlanFileError("its references are nested too deeply", self._name)
        return self._resolve(self._json(posixpath.normpath(reference.partition("#")[0])), depth + 1)

    def _json(self, entry: str) -> Any:  # noqa: ANN401 (JSON)
        try:
            return json.loads(self._entry(entry))
        except (ValueError, RecursionError):
            raise PlanFileError(f"{entry} is not JSON", self._name) from None

    def _entry(self, entry: str) -> bytes:
        try:
            with self._archive.open(entry) as opened:
                data = opened.read(min(MAX_ENTRY, self._left) + 1)
        except KeyError:
            raise PlanFileError(f"it has no entry {entry}", self._name) from None
        if len(data) > min(MAX_ENTRY, self._left):
            raise PlanFileError(f"{entry} is too large", self._name)
        self._left -= len(data)
        return data


def _trajectory(value: dict[str, Any]) -> Trajectory:
    takeoff = float(value.get("takeoffTime") or 0.0)
    points = value["points"]
    curves: list[Curve] = []
    before = (takeoff + float(points[0][0]), _triple(points[0][1]))
    for time, place, *rest in points[1:]:
        begin, start = before
        end = takeoff + float(time)
        controls = [_triple(each) for each in (rest[0] if rest else None) or ()]
        before = (end, _triple(place))
        if end > begin:
            curves.append(Curve(begin, end - begin, (start, *controls, before[1])))
        elif end < begin:
            raise InvalidArgumentError("the times of its points are not in order")
    return Trajectory(curves or [Curve(before[0], 1.0, (before[1], before[1]))])


def _lights(value: Any) -> bytes:  # noqa: ANN401 (JSON)
    data = value.get("data") if isinstance(value, dict) else None
    try:
        return base64.b64decode(data, validate=True) if isinstance(data, str) else b""
    except binascii.Error:
        raise InvalidArgumentError("its light program is not base64") from None


def _triple(value: Sequence[Any]) -> tuple[float, float, float]:
    x, y, z = (float(each) for each in value)
    return x, y, z


def _csv_vehicle(data: bytes, entry: str, name: str) -> ShowVehicle:
    """Return the vehicle of a CSV file."""
    try:
        rows = [row for row in csv.reader(io.StringIO(data.decode("utf-8-sig"))) if row]
        head = [each.strip().lower().split(" ")[0] for each in rows[0]]
        if tuple(head[:4]) != _COLUMNS:
            raise PlanFileError("its columns are not Time [msec], x [m], y [m], z [m] …", name, entry)
        numbers = [[float(each) for each in row] for row in rows[1:]]
        places = [(row[0] / 1e3, (row[1], row[2], row[3])) for row in numbers]
        curves = [
            Curve(begin, end - begin, (start, place)) for (begin, start), (end, place) in pairwise(places)
        ]
        colours = [(row[0] / 1e3, (int(row[4]), int(row[5]), int(row[6]))) for row in numbers if len(row) > 6]
        return ShowVehicle((entry or name).removesuffix(".csv"), Trajectory(curves), light_program(colours))
    except (UnicodeDecodeError, ValueError, IndexError, OverflowError, csv.Error) as error:
        raise PlanFileError(f"it is not a table of a show ({error})", name, entry) from None
    except InvalidArgumentError as error:
        raise PlanFileError(str(error), name, entry) from None


def _member(value: Any, key: str, kind: type, name: str, where: str = "") -> Any:  # noqa: ANN401 (JSON)
    found = value.get(key) if isinstance(value, dict) else None
    if not isinstance(found, kind):
        raise PlanFileError(f"{key} is missing", name, where)
    return found
