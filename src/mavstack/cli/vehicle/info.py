"""The identity and state of a vehicle, gathered once, and shown as a page or as one JSON object."""

from __future__ import annotations

import asyncio
from contextlib import suppress
from dataclasses import asdict, replace
from math import isfinite
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final

from mavstack.cli.common.identity import entry_words
from mavstack.cli.common.output import DEFAULT_COLUMNS, coloured, wrapped
from mavstack.cli.common.text import printable
from mavstack.cli.vehicle.flight_progress import distance_to_home
from mavstack.dialects import common
from mavstack.errors import MavstackError

if TYPE_CHECKING:
    from mavstack.dialects import Message
    from mavstack.services.version import AutopilotVersion
    from mavstack.vehicle import Vehicle

#: Seconds to wait for the version and for the start of the arming checks.
REQUEST_TIMEOUT: Final = 6.0
#: Seconds in which the vehicle sends the results of its arming checks.
CHECK_DURATION: Final = 1.0
#: Maximum age of a received message in seconds; if it is older, the next one is awaited for the same time.
_MAX_AGE: Final = 3.0
_MESSAGES: Final[tuple[type[Message], ...]] = (
    common.SysStatus,
    common.GpsRawInt,
    common.GlobalPositionInt,
    common.ExtendedSysState,
)
#: Width of the indentation and of the label of a row, in characters.
_INDENT: Final = 13
_FIXES: Final = ("no receiver", "no fix", "2D fix", "3D fix", "DGPS fix", "RTK float", "RTK fixed")
#: Names of features that contain abbreviations.
_FEATURE_NAMES: Final = {
    "ftp": "FTP",
    "roi": "region of interest",
    "home": "home position",
    "vtol": "VTOL",
    "osd": "OSD",
    "mavlink2": "MAVLink 2",
    "command_int": "COMMAND_INT",
    "ekf_sources": "EKF sources",
}


async def gather_facts(vehicle: Vehicle) -> dict[str, Any]:
    """Return identity and state of a vehicle as values for JSON; an unknown value is None."""
    messages = (_recent(vehicle, message) for message in _MESSAGES)
    version, *_ = await asyncio.gather(_version(vehicle), vehicle.telemetry.request_home(), *messages)
    if vehicle.health.ready is False and not vehicle.armed:
        with suppress(MavstackError):
            await vehicle.component.command(common.MavCmd.RUN_PREARM_CHECKS, timeout=REQUEST_TIMEOUT)
            await asyncio.sleep(CHECK_DURATION)
    features = {"features": asdict(vehicle.capabilities)}
    return {**_identity(vehicle), **_build(version), **features, **_state(vehicle), **_components(vehicle)}


def health_facts(vehicle: Vehicle) -> dict[str, Any]:
    """Return whether a vehicle is ready to arm in its mode, its problems and its warnings."""
    health = vehicle.health
    return {
        "ready": health.ready,
        "armed": vehicle.armed,
        "mode": health.mode,
        "problems": [printable(str(problem)) for problem in health.problems],
        "warnings": [printable(str(warning)) for warning in health.warnings],
    }


def health_lines(facts: dict[str, Any]) -> list[str]:
    """Return the facts of `health_facts` as lines: the readiness, then problems and warnings."""
    warnings = (f"warning: {text}" for text in facts["warnings"])
    return [readiness(facts), *facts["problems"], *warnings]


def readiness(facts: dict[str, Any]) -> str:
    """Return what `health_facts` say of the readiness to arm; an armed vehicle is not to be armed."""
    mode = f" in mode {facts['mode']}" if facts["mode"] else ""
    if facts["armed"]:
        return f"armed{mode}"
    heads = {True: f"ready to arm{mode}", False: "not ready to arm", None: "readiness to arm unknown"}
    return heads[facts["ready"]]


def _identity(vehicle: Vehicle) -> dict[str, Any]:
    mav_type = vehicle.mav_type
    return {
        "system": vehicle.system,
        "component": vehicle.address.component,
        "type": None if mav_type is None else entry_words(_name(mav_type)),
        "class": str(vehicle.vehicle_type),
        "firmware": vehicle.firmware.NAME or _name(vehicle.autopilot),
    }


def _build(version: AutopilotVersion | None) -> dict[str, Any]:
    if version is None:
        return dict.fromkeys(("version", "git_hash", "board", "unique_id", "capabilities"))
    flags = common.MavProtocolCapability(version.capabilities)
    return {
        "version": str(version.flight),
        "git_hash": version.git_hash or None,
        "board": {"vendor": version.vendor_id, "product": version.product_id, "board": version.board_version},
        "unique_id": version.unique_id or None,
        "capabilities": [flag.name for flag in common.MavProtocolCapability if flag in flags],
    }


def _state(vehicle: Vehicle) -> dict[str, Any]:
    status = vehicle.system_status
    velocity = vehicle.velocity
    return {
        "alive": vehicle.alive,
        "mode": vehicle.mode,
        "armed": vehicle.armed,
        "in_air": vehicle.in_air,
        "status": None if status is None else entry_words(_name(status)),
        "position": _position(vehicle),
        "ground_speed": None if velocity is None else round(velocity.ground_speed, 2),
        "home": _plain(vehicle.home),
        "home_distance": None if (distance := distance_to_home(vehicle)) is None else round(distance, 1),
        "batteries": [_plain(battery) for battery in vehicle.batteries.values()],
        "gps": _plain(vehicle.gps),
        "health": health_facts(vehicle),
    }


def _components(vehicle: Vehicle) -> dict[str, Any]:
    others = vehicle.components
    return {
        "components": [
            {"component": number, "kind": info.description, "alive": info.alive}
            for number, info in others.items()
        ]
    }


def page(facts: dict[str, Any], columns: int = DEFAULT_COLUMNS) -> list[str]:
    """Return the facts as lines of text, wrapped between words."""
    firmware = " ".join(filter(None, (facts["firmware"], facts["version"])))
    commit = f" ({facts['git_hash']})" if facts["git_hash"] else ""
    head = f"vehicle {facts['system']}: {facts['type'] or 'of an unknown type'}, {firmware}{commit}"
    rows = [
        ("state", _state_text(facts)),
        ("position", _position_text(facts)),
        ("home", _home_text(facts)),
        *[("battery", _battery_text(battery)) for battery in facts["batteries"]],
        ("GPS", _gps_text(facts["gps"])),
        *_health_rows(facts["health"]),
        *[("component", f"{each['kind']} ({each['component']})") for each in facts["components"]],
        *_attached_rows(facts),
        ("supports", ", ".join(_feature_names(facts["features"]))),
        ("calibrates", ", ".join(facts["features"]["calibrations"])),
        ("board", _board_text(facts)),
    ]
    lines = [coloured(line, "bold") for line in wrapped(head, columns, "  ")]
    previous = ""
    for name, text in rows:
        if text:
            first, *rest = wrapped(text, columns - _INDENT)
            lines.append(f"  {'' if name == previous else name:10} {first}")
            lines += [f"{'':{_INDENT}}{line}" for line in rest]
            previous = name
    return lines


def _state_text(facts: dict[str, Any]) -> str:
    armed = {True: coloured("armed", "red"), False: "disarmed", None: ""}[facts["armed"]]
    air = {True: "in the air", False: "on the ground", None: ""}[facts["in_air"]]
    silent = "" if facts["alive"] else coloured("silent", "red")
    return ", ".join(filter(None, (silent, facts["mode"], armed, air, facts["status"])))


def _position(vehicle: Vehicle) -> dict[str, Any] | None:
    """Return the position; without the altitude above home of a vehicle that has none, such as a rover."""
    position = vehicle.position
    if position is not None and not vehicle.vehicle_type.has_altitude:
        position = replace(position, relative_altitude=None)
    return _plain(position)


def _position_text(facts: dict[str, Any]) -> str:
    place = facts["position"]
    if place is None:
        return "unknown"
    parts = [f"{place['latitude']:.7f}, {place['longitude']:.7f}"]
    for key, reference in (("altitude", "above sea"), ("relative_altitude", "above home")):
        if place[key] is not None:
            parts.append(f"{round(place[key], 1) + 0.0:.1f} m {reference}")  # adding 0.0 turns -0.0 into 0.0
    if place["heading"] is not None:
        parts.append(f"heading {round(place['heading']) % 360}°")
    if facts["ground_speed"] is not None:
        parts.append(f"{facts['ground_speed']:.1f} m/s")
    return ", ".join(parts)


def _home_text(facts: dict[str, Any]) -> str:
    home = facts["home"]
    if home is None:
        return "not set"
    distance = facts["home_distance"]
    return f"{home['latitude']:.7f}, {home['longitude']:.7f}, {home['altitude']:.1f} m above sea" + (
        "" if distance is None else f", {distance:.0f} m away"
    )


def _battery_text(battery: dict[str, Any]) -> str:
    units = (("voltage", "{:.2f} V"), ("current", "{:.1f} A"), ("remaining", "{:.0f} % left"))
    parts = [template.format(battery[key]) for key, template in units if battery[key] is not None]
    return ", ".join(parts) or "unknown"


def _gps_text(gps: dict[str, Any] | None) -> str:
    if gps is None:
        return "unknown"
    fix = int(gps["fix"])
    parts = [_FIXES[fix] if fix < len(_FIXES) else f"fix {fix}"]
    if gps["satellites"] is not None:
        parts.append(f"{gps['satellites']} satellites")
    if gps["hdop"] is not None:
        parts.append(f"HDOP {gps['hdop']:.1f}")
    return ", ".join(parts)


def _health_rows(health: dict[str, Any]) -> list[tuple[str, str]]:
    head, *others = health_lines(health)
    colour = {True: "green", False: "red"}.get(health["ready"])
    first = head if colour is None else coloured(head, colour)
    return [("health", first), *[("health", coloured(text, "yellow")) for text in others]]


def _attached_rows(facts: dict[str, Any]) -> list[tuple[str, str]]:
    """Return the cameras and gimbals that are no components, but attached to the autopilot."""
    components = {each["component"] for each in facts["components"]}
    return [
        ("attached", f"{kind} ({number})")
        for kind in ("camera", "gimbal")
        for number in facts["features"][f"{kind}s"]
        if number not in components
    ]


def _feature_names(features: dict[str, Any]) -> list[str]:
    """Return the features that the vehicle has, as words; components and calibrations have their own rows."""
    had = [name for name, value in features.items() if value is True]
    return [_FEATURE_NAMES.get(name, name.replace("_", " ")) for name in had]


_NUMBERS: Final = MappingProxyType({"vendor": "vendor {}", "product": "product {}", "board": "version {}"})


def _board_text(facts: dict[str, Any]) -> str:
    board, unique = facts["board"], facts["unique_id"]
    known = {} if board is None else {name: value for name, value in board.items() if value}
    numbers = [_NUMBERS[name].format(value) for name, value in known.items()]
    return ", ".join([*numbers, *([f"id {unique}"] if unique else [])])


async def _recent(vehicle: Vehicle, message: type[Message]) -> None:
    """Wait for a message unless it was received recently."""
    age = vehicle.age(message)
    if age is None or age > _MAX_AGE:
        with suppress(MavstackError):
            await vehicle.wait_for_message(message, timeout=_MAX_AGE)


async def _version(vehicle: Vehicle) -> AutopilotVersion | None:
    try:
        return await vehicle.component.get_version(timeout=REQUEST_TIMEOUT)
    except MavstackError:
        return None


def _name(value: int) -> str:
    return str(getattr(value, "name", int(value)))


def _plain(value: object) -> dict[str, Any] | None:
    """Return a telemetry value as values for JSON."""
    if value is None:
        return None
    fields: dict[str, Any] = asdict(value)  # type: ignore[call-overload]
    return {key: _number(each) for key, each in fields.items()}


def _number(value: Any) -> Any:  # noqa: ANN401 (whatever JSON has)
    if isinstance(value, float):
        return value if isfinite(value) else None
    return int(value) if isinstance(value, int) and not isinstance(value, bool) else value
