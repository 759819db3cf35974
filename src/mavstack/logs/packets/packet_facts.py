"""Facts in a log of packets: the vehicles, their firmware, their parameters and their texts."""

from __future__ import annotations

import re
from math import isfinite
from struct import pack, unpack
from typing import TYPE_CHECKING, Final

import numpy as np

from mavstack.logs.records import LogText, ParameterChange, differs
from mavstack.logs.vehicles import LogVehicle

if TYPE_CHECKING:
    from mavstack.logs.log import Log
    from mavstack.logs.message_table import MessageTable

_AUTOPILOT_INVALID: Final = 8  # MAV_AUTOPILOT of components that are not autopilots
_BYTEWISE_AUTOPILOT: Final = "PX4"  # used if the capabilities do not show the encoding
_BYTEWISE_CAPABILITY: Final = 0x10  # MAV_PROTOCOL_CAPABILITY_PARAM_ENCODE_BYTEWISE
_C_CAST_CAPABILITY: Final = 0x20000  # MAV_PROTOCOL_CAPABILITY_PARAM_ENCODE_C_CAST
#: `struct` format of the bits of a value, by MAV_PARAM_TYPE; 9 (REAL32) and 10 (REAL64) are not converted.
_BIT_FORMATS: Final = {1: "<Bxxx", 2: "<bxxx", 3: "<Hxx", 4: "<hxx", 5: "<I", 6: "<i"}
#: Names of FIRMWARE_VERSION_TYPE, from the lowest value of each.
_VERSION_TYPES: Final = ((255, ""), (192, "-rc"), (128, "-beta"), (64, "-alpha"), (0, "-dev"))
#: Maximum length of the text in one STATUSTEXT; a longer text is split over several messages.
_TEXT_LENGTH: Final = 50
#: Texts that APM firmware until 2015 sends when it starts, with the lowest of its five severities.
_STARTS: Final = re.compile(
    r"Initialising APM|GROUND START|\S*Ardu\w+ V[23]\.|(Calibrating )?barometer", re.IGNORECASE
)
_LOWEST, _HIGHEST = 1, 5
#: MAV_SEVERITY by the severities of APM firmware: low, medium, high, critical, and questions to the user.
_OLD_SEVERITIES: Final = {1: 6, 2: 4, 3: 3, 4: 2, 5: 5}


def vehicles(log: Log) -> dict[int, LogVehicle]:
    """Return the systems with an autopilot, by system id.

    Args:
        log: The log, or a view of it.
    """
    table = log.get("HEARTBEAT")
    if table is None:
        return {}
    table = table.where(table["autopilot"] != _AUTOPILOT_INVALID)
    found = {}
    for system in np.unique(table["_system"]).tolist():
        rows = table.where(table["_system"] == system)
        component = int(rows["_component"].min())
        rows = rows.where(rows["_component"] == component)
        vehicle_type, autopilot = rows.enum_names("type")[-1], rows.enum_names("autopilot")[-1]
        found[system] = LogVehicle(system, component, vehicle_type, autopilot, len(rows))
    return found


def info(log: Log) -> dict[str, str]:
    """Return the firmware and the hardware of the first vehicle.

    Args:
        log: The log, or a view of it.
    """
    first = _first_vehicle(log)
    if first is None:
        return {}
    facts = {"system": str(first.system), "vehicle_type": first.vehicle_type, "autopilot": first.autopilot}
    version = _last_row(log, "AUTOPILOT_VERSION", first.system)
    if version is not None:
        facts["firmware_version"] = _version_text(int(version["flight_sw_version"]))
        facts["firmware_git"] = (
            bytes(version["flight_custom_version"]).split(b"\0")[0].decode("ascii", "replace")
        )
        board, uid = int(version["board_version"]) >> 16, int(version["uid"])
        facts["hardware"] = f"board {board}" if board else ""
        facts["uid"] = f"{uid:x}" if uid else ""
    return {name: text for name, text in facts.items() if text}


def parameters(log: Log) -> tuple[dict[str, float], list[ParameterChange]]:
    """Return the first value of each parameter of the first vehicle, and the changes.

    Args:
        log: The log, or a view of it.
    """
    table, first = log.get("PARAM_VALUE"), _first_vehicle(log)
    if table is None or not len(table):
        return {}, []
    system = int(table["_system"].min()) if first is None else first.system
    table = table.where(table["_system"] == system)
    # Leave out the parameters of other components, such as a gimbal or camera.
    if first is not None and (own := table["_component"] == first.component).any():
        table = table.where(own)
    bytewise = _is_bytewise(log, system, "" if first is None else first.autopilot)
    initial: dict[str, float] = {}
    latest: dict[str, float] = {}
    changes = []
    # Read the bits: a conversion to float could change an integer whose bits look like a NaN.
    bits = np.ascontiguousarray(table["param_value"]).view(np.uint32).tolist()
    columns = (table["_time"], table["param_id"].tolist(), bits, table["param_type"].tolist())
    for time, name, raw, kind in zip(*columns, strict=True):
        text, value = name.decode("ascii", "replace"), _decoded(raw, kind, bytewise)
        initial.setdefault(text, value)
        before = latest.setdefault(text, value)
        if differs(before, value):
            changes.append(ParameterChange(time, text, before, value, system))
            latest[text] = value
    return initial, changes


def texts(log: Log, whole: Log) -> list[LogText]:
    """Return the texts of all systems, those of several messages joined, with severities of today.

    Args:
        log: The log, or a view of it.
        whole: The log.
    """
    table = log.get("STATUSTEXT")
    if table is None:
        return []
    old = _systems_with_old_severities(whole["STATUSTEXT"])
    found: list[LogText] = []
    open_texts: dict[tuple[int, int, int], tuple[int, bytes]] = {}  # index in `found`, bytes so far
    for row in table.view(np.ndarray):
        key = (int(row["_system"]), int(row["_component"]), int(row["id"]))
        part, chunk = bytes(row["text"]), int(row["chunk_seq"])
        place, before = open_texts.pop(key, (len(found), b"")) if key[2] and chunk else (len(found), b"")
        # PX4 ends a text with a tab if it also sends the text as an event.
        text = (before + part).decode("utf-8", "replace").removesuffix("\t")
        severity = int(row["severity"])
        known = _OLD_SEVERITIES.get(severity, severity) if key[0] in old else severity
        entry = LogText(row["_time"], known, text, key[0])
        found[place : place + 1] = [entry]
        if key[2] and len(part) == _TEXT_LENGTH:
            open_texts[key] = (place, before + part)
    return found


def _systems_with_old_severities(table: MessageTable) -> set[int]:
    """Return the systems whose firmware counts severities upwards, as that of APM did until 2015.

    A later firmware sends the texts of its start as MAV_SEVERITY_INFO.
    """
    severities, systems = np.asarray(table["severity"]), np.asarray(table["_system"])
    lowest = np.flatnonzero(severities == _LOWEST)
    old = {int(systems[row]) for row in lowest if _STARTS.match(table["text"][row].decode("latin-1"))}
    return old.difference(systems[(severities < _LOWEST) | (severities > _HIGHEST)].tolist())


def _first_vehicle(log: Log) -> LogVehicle | None:
    found = vehicles(log)
    return found[min(found)] if found else None


def _last_row(log: Log, name: str, system: int) -> np.void | None:
    table: MessageTable | None = log.get(name)
    if table is None:
        return None
    rows = table.where(table["_system"] == system)
    return rows[-1] if len(rows) else None


def _version_text(version: int) -> str:
    major, minor, patch, kind = version.to_bytes(4, "big")
    suffix = next(text for lowest, text in _VERSION_TYPES if kind >= lowest)
    return f"{major}.{minor}.{patch}{suffix}" if version else ""


def _is_bytewise(log: Log, system: int, autopilot: str) -> bool:
    """Return whether a vehicle sends the bits of integer parameters instead of their values as floats."""
    version = _last_row(log, "AUTOPILOT_VERSION", system)
    capabilities = 0 if version is None else int(version["capabilities"])
    if capabilities & (_BYTEWISE_CAPABILITY | _C_CAST_CAPABILITY):
        return bool(capabilities & _BYTEWISE_CAPABILITY)
    return autopilot == _BYTEWISE_AUTOPILOT


def _decoded(bits: int, kind: int, bytewise: bool) -> float:
    data = pack("<I", bits)
    value: float = unpack("<f", data)[0]
    if kind not in _BIT_FORMATS:
        return value
    if bytewise:
        number: int = unpack(_BIT_FORMATS[kind], data)[0]
        return number
    return round(value) if isfinite(value) else value
