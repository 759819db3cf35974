"""The settings of Betaflight and iNav: `settings.txt`, PID controllers, display items and serial ports."""

from __future__ import annotations

from importlib.resources import files
from typing import TYPE_CHECKING, Any, cast

from mavstack.msp.messages.config import (
    BAUD_RATES,
    INAV_BAUD_RATES,
    CfSerialConfig,
    SerialConfig,
    SetCfSerialConfig,
    SetSerialConfig,
)
from mavstack.msp.messages.filters import SetFilterConfig
from mavstack.msp.messages.osd import FLIGHT_SCREEN, OsdConfig, SetOsdConfig, SetOsdItem, SetOsdTimer
from mavstack.msp.messages.osd_items import OSD_ITEMS
from mavstack.msp.messages.pid import BETAFLIGHT_PID_NAMES, INAV_PID_NAMES, InavPid, Pid, SetInavPid, SetPid
from mavstack.msp.messages.registry import all_messages
from mavstack.msp.messages.vtx import SetVtxConfig, VtxConfig
from mavstack.msp.serial_ports import PORT_IDENTIFIERS
from mavstack.msp.settings.definition import SettingDefinition, define

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from mavstack.msp.messages.layout import TableMessage
    from mavstack.msp.settings.definition import Value, WriteBuilder

_TERMS = {"P": "Proportional", "I": "Integral", "D": "Derivative", "F": "Feedforward"}
#: Descriptions of the gains of Betaflight's LEVEL controller, which differ from the usual meaning.
_LEVEL_MEANINGS = {
    "P": "Strength of the mode ANGLE",
    "I": "Strength of levelling in the mode HORIZON",
    "D": "Deflection of the stick at which the mode HORIZON no longer levels",
}
_CHANNELS_OF_A_BAND = 8
#: The rates of a serial port: the end of the setting's name, the field, and the functions.
_PORT_RATES = (
    ("MSP", "msp_baud", "MSP"),
    ("GPS", "gps_baud", "GPS"),
    ("TLM", "telemetry_baud", "telemetry"),
    ("BBX", "blackbox_baud", "blackbox"),
)


# Functions that build a write message whose fields differ from those of the read message


def _filter_message(current: TableMessage, field: str, value: object) -> TableMessage:
    """Return the filters with one changed; the gyro's low pass also has an old field of one byte."""
    changes = {field: value}
    if field == "gyro_lpf1_static_hz":
        changes["gyro_lpf1_static_hz_8"] = min(int(str(value)), 255)
    return SetFilterConfig.from_message(current, **changes)


def _vtx_message(current: TableMessage, field: str, value: int) -> TableMessage:
    """Return the video transmitter's settings with one changed.

    A frequency takes effect only without a band. Old firmwares and iNav know band and channel, or the
    frequency, as one number.
    """
    old = cast("VtxConfig", current)
    changes: dict[str, Any] = {
        field: value,
        "table_bands": None,
        "table_channels": None,
        "table_powers": None,
    }
    if field == "frequency" and value:
        changes["band"] = 0
    band = int(changes.get("band", old.band) or 0)
    channel = int(changes.get("channel", old.channel) or 0)
    frequency = int(changes.get("frequency", old.frequency) or 0)
    by_band = _CHANNELS_OF_A_BAND * (band - 1) + max(channel, 1) - 1
    return SetVtxConfig.from_message(current, combined=by_band if band else frequency, **changes)


def _warnings_message(current: TableMessage, field: str, value: int) -> TableMessage:
    """Return the display's settings with other warnings, which also stand in a field of sixteen bits."""
    return SetOsdConfig.from_message(current, warnings=value, warnings_low=value & 0xFFFF)


#: The functions that build the write message, by its name or by the name of a setting.
_BUILDERS: Mapping[str, WriteBuilder] = {
    "SetFilterConfig": _filter_message,
    "SetVtxConfig": _vtx_message,
    "BF_OSD_WARNINGS": _warnings_message,
}


# Settings in `settings.txt`


def _read_settings() -> Iterator[SettingDefinition]:
    """Yield the settings of the file, whose head describes its lines."""
    messages = {message.__name__: message for message in all_messages()}
    read: type[TableMessage] = OsdConfig
    write: type[TableMessage] = SetOsdConfig
    variants: tuple[str, ...] | None = None
    for line in (files(__package__) / "settings.txt").read_text("ascii").splitlines():
        if line.startswith("["):
            names = line.strip("[]").split()
            read, write = (messages[name] for name in names[:2])
            variants = tuple(names[2:]) or None
        elif line and not line.startswith("#"):
            name, place, values, options, description = (part.strip() for part in line.split("|"))
            minimum, maximum = _limits(values)
            versions_and_alias: dict[str, str] = dict(option.split("=") for option in options.split())
            yield define(
                name,
                place,
                description,
                minimum,
                maximum,
                messages=(read, write),
                variants=variants,
                values=tuple(values.split(" / ")) if " / " in values else (),
                build=_BUILDERS.get(write.__name__) or _BUILDERS.get(name),
                **versions_and_alias,
            )


def _limits(values: str) -> tuple[Value, Value] | tuple[None, None]:
    """Return the smallest and the largest value of a range; None for meanings, or without a range."""
    if not values or " / " in values:
        return None, None
    low, high = values.split("..")
    return _number(low), _number(high)


def _number(text: str) -> Value:
    return float(text) if "." in text else int(text)


# Settings of the PID controllers and the OSD items


def _gains(
    messages: tuple[type[TableMessage], type[TableMessage]], axes: tuple[str, ...], terms: str, maximum: int
) -> Iterator[SettingDefinition]:
    """Yield the gains of the controllers of a firmware."""
    variant = "BTFL" if messages[0] is Pid else "INAV"
    for index, axis in enumerate(axes):
        for term in terms:
            meaning = f"{_TERMS[term]} gain of the controller {axis}"
            if (variant, axis) == ("BTFL", "LEVEL"):
                meaning = _LEVEL_MEANINGS[term]
            name, place = f"BF_PID_{axis}_{term}", f"controllers[{index}].{term.lower()}"
            yield define(name, place, meaning, 0, maximum, messages=messages, variants=(variant,))


def _timer(index: int) -> SettingDefinition:
    def build(current: TableMessage, field: str, value: int) -> TableMessage:
        return SetOsdTimer(index=index, timer=value)

    return define(
        f"BF_OSD_TIMER_{index + 1}",
        f"timers[{index}]",
        f"Timer {index + 1}: source, precision and alarm as bits",
        messages=(OsdConfig, SetOsdTimer),
        variants=("BTFL",),
        build=build,
    )


def _item(index: int, name: str) -> SettingDefinition:
    def build(current: TableMessage, field: str, value: int) -> TableMessage:
        return SetOsdItem(index, value, FLIGHT_SCREEN)

    return define(
        f"BF_OSD_{index}_POS",
        f"items[{index}]",
        f"Position of the item {name.replace('_', ' ').lower()}: column, row and profiles as bits",
        messages=(OsdConfig, SetOsdItem),
        variants=("BTFL",),
        alias=f"BF_OSD_ITEM_{index}_POS",
        build=build,
    )


def _ports() -> Iterator[SettingDefinition]:
    """Yield the functions and rates of the serial ports, which differ between firmwares."""
    new, old = (SerialConfig, SetSerialConfig), (CfSerialConfig, SetCfSerialConfig)
    for name in PORT_IDENTIFIERS:
        yield from _port(name, new, "BTFL", BAUD_RATES, until="1.48")
        yield from _port(name, old, "BTFL", BAUD_RATES, until="1.42")
        yield from _port(name, new, "INAV", INAV_BAUD_RATES)


def _port(
    name: str,
    messages: tuple[type[TableMessage], type[TableMessage]],
    variant: str,
    rates: tuple[int, ...],
    until: str = "",
) -> Iterator[SettingDefinition]:
    identifiers = "/".join(map(str, PORT_IDENTIFIERS[name]))
    prefix, place = f"BF_{name.replace('SOFTSERIAL', 'SOFT')}", f"ports[port={identifiers}]"
    common: dict[str, Any] = {"messages": messages, "variants": (variant,), "until": until}
    yield define(f"{prefix}_FUNC", f"{place}.functions", f"Functions of the port {name} as bits", **common)
    meanings = {number: f"{rate} bit/s" if rate else "automatic" for number, rate in enumerate(rates)}
    for end, field, functions in _PORT_RATES:
        description = f"Rate of the port {name} for {functions}"
        yield define(f"{prefix}_B_{end}", f"{place}.{field}", description, values=meanings, **common)


ALL_SETTINGS = (
    *_gains((Pid, SetPid), BETAFLIGHT_PID_NAMES, "PID", 250),
    *_read_settings(),
    *map(_timer, range(2)),
    *map(_item, range(len(OSD_ITEMS)), OSD_ITEMS),
    *_gains((InavPid, SetInavPid), INAV_PID_NAMES, "PIDF", 255),
    *_ports(),
)
