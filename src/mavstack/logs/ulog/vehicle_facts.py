"""Facts about the vehicle in a ULog: firmware, parameters, texts; and counts of what was not read."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from mavstack.dialects import common
from mavstack.logs.damage import LogDamage
from mavstack.logs.records import LogText, ParameterChange, differs
from mavstack.logs.vehicles import LogVehicle, is_system_id

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from mavstack._core import UlogIndex
    from mavstack.logs.time_base import TimeBase
    from mavstack.logs.ulog.entries import Entries, LoggedText, Value

#: The names that other log formats use for information messages, by ULog key.
_COMMON_NAMES: Final = {
    "sys_name": "autopilot",
    "ver_sw": "firmware_git",
    "ver_hw": "hardware",
    "sys_uuid": "uid",
}
#: Names of version types, from the lowest value of each.
_VERSION_TYPES: Final = ((255, ""), (192, "-rc"), (128, "-beta"), (64, "-alpha"), (0, "-dev"))
_MAX_BOOT: Final = 1 << 62


def damage(index: UlogIndex, damaged_entries: int) -> LogDamage:
    """Return what of a file was not read.

    Args:
        index: The index of the file.
        damaged_entries: Number of messages whose content makes no sense.
    """
    counts = dict(index.damage)
    other = {
        "unusable definitions": counts["bad_definitions"],
        "unusable offsets of appended data": counts["bad_offsets"],
    }
    other |= {f"messages of unknown kind {kind!r}": count for kind, count in index.unknown_kinds.items()}
    return LogDamage(
        bad_bytes=counts["bad_bytes"],
        bad_records=counts["wrong_size"] + damaged_entries,
        truncated_bytes=counts["truncated_bytes"],
        unknown=index.unsubscribed,
        other={reason: count for reason, count in other.items() if count},
    )


def info(information: Mapping[str, Value]) -> dict[str, str]:
    """Return the information messages as text; some have the names that other formats use.

    Args:
        information: The information messages by name.
    """
    texts = {name: _text(value) for name, value in information.items()}
    known = {common_name: texts.pop(name) for name, common_name in _COMMON_NAMES.items() if texts.get(name)}
    release = information.get("ver_sw_release")
    if isinstance(release, int) and 0 < release < 1 << 32:
        known["firmware_version"] = _version_text(release)
        del texts["ver_sw_release"]
    return known | texts


def _text(value: Value) -> str:
    if isinstance(value, bytes):
        return value.hex()
    return value.rstrip("\0") if isinstance(value, str) else str(value)


def _version_text(version: int) -> str:
    major, minor, patch, kind = version.to_bytes(4, "big")
    suffix = next(text for lowest, text in _VERSION_TYPES if kind >= lowest)
    return f"{major}.{minor}.{patch}{suffix}"


def parameters(
    entries: Entries, base: TimeBase, span: tuple[float, float] | None
) -> tuple[dict[str, float], list[ParameterChange]]:
    """Return the first value of each parameter, and the changes.

    Args:
        entries: The messages of the log.
        base: The clock of the log.
        span: Earliest and latest time of the changes on that clock, in seconds; None for all.
    """
    first = dict(entries.parameters)
    latest: dict[str, float | None] = dict(first)
    changes = []
    for boot_us, name, value in entries.parameter_changes:
        first.setdefault(name, value)
        before = latest.get(name)
        if differs(before, value) and _is_within(boot_us, base, span):
            changes.append(ParameterChange(_utc(boot_us, base), name, before, value, boot_us=boot_us))
        latest[name] = value
    return first, changes


def texts(logged: Iterable[LoggedText], base: TimeBase, span: tuple[float, float] | None) -> list[LogText]:
    """Return the texts, without the white space at their ends.

    Args:
        logged: The texts of the file.
        base: The clock of the log.
        span: Earliest and latest time of the texts on that clock, in seconds; None for all.
    """
    return [
        LogText(_utc(item.boot_us, base), item.severity, item.text.rstrip("\0\t\r\n "), boot_us=item.boot_us)
        for item in logged
        if _is_within(item.boot_us, base, span)
    ]


def _is_within(boot_us: int, base: TimeBase, span: tuple[float, float] | None) -> bool:
    return span is None or span[0] <= (boot_us + (base.offset_us or 0)) / 1e6 <= span[1]


def _utc(boot_us: int, base: TimeBase) -> np.datetime64:
    if base.offset_us is None or boot_us > _MAX_BOOT:
        return np.datetime64("NaT", "us")
    return np.datetime64(boot_us + base.offset_us, "us")


def vehicles(known: Mapping[str, float], autopilot: str) -> dict[int, LogVehicle]:
    """Return the vehicle that wrote a log, by its system id (0 if the log does not hold it).

    Args:
        known: The parameters.
        autopilot: Name of the firmware, or empty.
    """
    system, component = (
        int(value) if is_system_id(value := known.get(name, 0)) else default
        for name, default in (("MAV_SYS_ID", 0), ("MAV_COMP_ID", 1))
    )
    names: dict[float, str] = {int(kind): kind.name for kind in common.MavType}
    return {system: LogVehicle(system, component, names.get(known.get("MAV_TYPE", -1), ""), autopilot)}
