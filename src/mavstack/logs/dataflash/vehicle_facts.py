"""Facts in a DataFlash log: firmware, hardware, parameters, texts and modes."""

from __future__ import annotations

import re
from functools import cache
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from mavstack.dialects import Dialect
from mavstack.logs.records import LogText, ParameterChange, differs
from mavstack.logs.schema import EnumSchema
from mavstack.logs.vehicles import LogVehicle, is_system_id

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from mavstack.logs.log import Log
    from mavstack.logs.message_table import MessageTable

#: Texts that name the firmware: "ArduCopter V4.3.6 (0c5e999c)".
_FIRMWARE: Final = re.compile(
    r"(?P<name>Ardu\w+|APM:\w+|AntennaTracker|Blimp|Rover)\s+V?(?P<version>\d\S*)(?:\s+\((?P<git>\w+)\))?"
)
#: The enum of flight modes and the MAV_TYPE of a firmware, by a part of its name.
_FIRMWARES: Final = (
    ("copter", "COPTER_MODE", "QUADROTOR"),
    ("plane", "PLANE_MODE", "FIXED_WING"),
    ("rover", "ROVER_MODE", "GROUND_ROVER"),
    ("sub", "SUB_MODE", "SUBMARINE"),
    ("tracker", "TRACKER_MODE", "ANTENNA_TRACKER"),
    ("blimp", "", "AIRSHIP"),
)
_SYSTEM_PARAMETERS: Final = ("MAV_SYSID", "SYSID_THISMAV")
_INFO_SEVERITY: Final = 6


def texts(log: Log) -> list[LogText]:
    """Return the texts in MSG; a long text comes in several records.

    Args:
        log: The log, or a view of it.
    """
    table = log.get("MSG")
    if table is None or "Message" not in (table.dtype.names or ()):
        return []
    boot, times = log.boot_times("MSG", table), table["_time"]
    continues = _continuations(table)
    found: list[LogText] = []
    for row, message in enumerate(table["Message"].tolist()):
        text = message.decode("utf-8", "replace") if isinstance(message, bytes) else str(message)
        if continues[row]:
            found[-1] = found[-1]._replace(text=found[-1].text + text)
            continue
        boot_us = None if boot is None or np.isnan(boot[row]) else round(boot[row] * 1e6)
        found.append(LogText(times[row], _INFO_SEVERITY, text, boot_us=boot_us))
    return found


def _continuations(table: MessageTable) -> NDArray[np.bool_]:
    """Return which records of MSG continue the text of the one before them."""
    continues = np.zeros(len(table), bool)
    if table.schema.has_numbers("ID", "Seq"):
        ids = table["ID"]
        continues[1:] = (table["Seq"][1:] > 0) & (ids[1:] == ids[:-1])
    return continues


def info(log: Log) -> dict[str, str]:
    """Return the firmware and the hardware, from VER and the first texts.

    Args:
        log: The log, or a view of it.
    """
    lines = [text.text for text in log.texts]
    facts = {"autopilot": "ArduPilot", "vehicle_type": _firmware_of(lines)[2]}
    named = next((found for line in lines if (found := _FIRMWARE.search(line))), None)
    if named is not None:
        facts |= {
            "firmware": named["name"],
            "firmware_version": named["version"],
            "firmware_git": named["git"] or "",
        }
    facts |= _version_facts(log.get("VER"))
    facts["hardware"] = next((line for line in lines if _is_hardware(line)), "")
    facts["system"] = _system(log)
    return {name: text for name, text in facts.items() if text}


def _version_facts(table: MessageTable | None) -> dict[str, str]:
    """Return the facts of VER."""
    if table is None or not len(table) or not table.schema.has_numbers("Maj", "Min", "Pat"):
        return {}
    row: Any = table[0]
    facts = {"firmware_version": ".".join(f"{row[name]:.0f}" for name in ("Maj", "Min", "Pat"))}
    if table.schema.has_numbers("GH") and table["GH"].dtype.kind in "iu" and row["GH"]:
        facts["firmware_git"] = f"{int(row['GH']):08x}"
    return facts


def _is_hardware(line: str) -> bool:
    """Return whether a text names the board and its serial number, such as "CubeOrange 0025003A 32385107"."""
    return re.fullmatch(r"\S+(?: [0-9A-Fa-f]{8}){2,4}", line) is not None


def _system(log: Log) -> str:
    values = log.parameters
    found = (values[name] for name in _SYSTEM_PARAMETERS if name in values)
    return next((f"{value:.0f}" for value in found if is_system_id(value)), "")


def _firmware_of(lines: list[str]) -> tuple[str, str, str]:
    """Return part of the firmware's name, its enum of modes and its MAV_TYPE."""
    for line in lines:
        if found := _FIRMWARE.search(line):
            name = found["name"].lower()
            return next((entry for entry in _FIRMWARES if entry[0] in name), ("", "", ""))
    return "", "", ""


def vehicles(log: Log) -> dict[int, LogVehicle]:
    """Return the vehicle that wrote the log.

    Args:
        log: The log, or a view of it.
    """
    facts = log.info
    system = int(facts.get("system", "0"))
    return {system: LogVehicle(system, 1, facts.get("vehicle_type", ""), "ARDUPILOTMEGA")}


def parameters(log: Log) -> tuple[dict[str, float], list[ParameterChange]]:
    """Return the first value of each parameter in PARM, and the changes.

    Args:
        log: The log, or a view of it.
    """
    table = log.get("PARM")
    if table is None or "Name" not in table.schema or not table.schema.has_numbers("Value"):
        return {}, []
    boot = log.boot_times("PARM", table)
    initial: dict[str, float] = {}
    latest: dict[str, float] = {}
    changes = []
    values = table["Value"].astype(np.float64).tolist()
    for row, (raw, value) in enumerate(zip(table["Name"].tolist(), values, strict=True)):
        name = raw.decode("latin-1") if isinstance(raw, bytes) else str(raw)
        if name in latest and differs(latest[name], value):
            boot_us = None if boot is None or np.isnan(boot[row]) else round(boot[row] * 1e6)
            changes.append(ParameterChange(table["_time"][row], name, latest[name], value, boot_us=boot_us))
        initial.setdefault(name, value)
        latest[name] = value
    return initial, changes


def mode_enums(lines: list[str]) -> dict[str, EnumSchema]:
    """Return the named values of the fields of MODE.

    Args:
        lines: Texts of the log, of which one names the firmware.
    """
    name = _firmware_of(lines)[1]
    return {field: _mode_enum(name) for field in ("Mode", "ModeNum")} if name else {}


@cache
def _mode_enum(name: str) -> EnumSchema:
    members = Dialect.load("ardupilotmega").enum_class(name)
    return EnumSchema(name, {int(member): text for text, member in members.__members__.items()})
