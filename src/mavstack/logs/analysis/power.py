"""Rules about power: the battery under load, its charge, the supply of the board, and logs that break off."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from mavstack.logs.analysis.findings import Finding, Severity
from mavstack.logs.analysis.rules import Rule

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.logs.analysis.flight import Flight

#: Share of the initial voltage that a battery keeps under load.
_USUAL_SAG: Final = 0.80
_LOW_CHARGE: Final = 20.0
_EMPTY: Final = 10.0
#: Volts of the 5 V supply below which ArduPilot's documentation warns.
_LOW_BOARD_VOLTAGE: Final = 4.6
#: Minimum height above home of a flying vehicle, in metres.
_IN_FLIGHT: Final = 3.0
#: A log was cut off if it ends less than this many seconds after the vehicle was in the air.
_END: Final = 3.0


def voltage_sag(flight: Flight) -> Iterator[Finding]:
    """Look for a battery that falls below 80 % of its voltage at the beginning while armed."""
    signal = flight.armed_signal("voltage")
    signal = None if signal is None else signal.during(signal.values > 1)
    if signal is None or len(signal) < 10:
        return
    values = signal.values
    full, lowest = float(np.median(values[: max(len(values) // 20, 3)])), float(values.min())
    if lowest < full * _USUAL_SAG:
        yield Finding(
            "voltage_sag",
            Severity.CRITICAL,
            f"battery fell from {full:.1f} V to {lowest:.1f} V",
            f"The voltage fell to {lowest / full:.0%} of that at the beginning ({full:.1f} V). More than "
            f"{_USUAL_SAG:.0%} is usual: the battery is weak, too small, or was flown empty.",
            float(signal.times[signal.values.argmin()]),
            {"full_v": full, "lowest_v": lowest},
        )


def charge(flight: Flight) -> Iterator[Finding]:
    """Look for a battery below 20 % (warning) or 10 % (critical) while armed."""
    signal = flight.armed_signal("remaining")
    signal = None if signal is None else signal.during(signal.values >= 0)
    if signal is None or not len(signal) or signal.values.min() >= _LOW_CHARGE:
        return
    lowest = float(signal.values.min())
    yield Finding(
        "charge",
        Severity.CRITICAL if lowest < _EMPTY else Severity.WARNING,
        f"battery at {lowest:.0f} %",
        f"The battery had {lowest:.0f} % left at the lowest. Land with {_LOW_CHARGE:.0f} % or more.",
        float(signal.times[signal.values.argmin()]),
        {"remaining_percent": lowest},
    )


def board_supply(flight: Flight) -> Iterator[Finding]:
    """Look for a supply of the autopilot below 4.6 V."""
    signal = flight.signal("board_voltage")
    if signal is None:
        return
    powered = signal.during(signal.values > 1)
    if len(powered) and powered.values.min() < _LOW_BOARD_VOLTAGE:
        lowest = float(powered.values.min())
        text = f"The supply of the autopilot fell to {lowest:.2f} V; 4.6 to 5.4 V are right. It may reboot."
        time = float(powered.times[powered.values.argmin()])
        title = f"board supply {lowest:.2f} V"
        yield Finding("board_supply", Severity.CRITICAL, title, text, time, {"lowest_v": lowest})


def ends_in_flight(flight: Flight) -> Iterator[Finding]:
    """Look for a log that ends while the vehicle is armed and in the air: no power, a crash, a lost link."""
    altitude = flight.signal("altitude")
    if altitude is None or not flight.states.armed.is_known:
        return
    last = flight.duration - _END
    final = altitude.during(altitude.times >= last)
    if not len(final) or final.values[-1] < _IN_FLIGHT or not flight.is_armed(final.times[-1:])[0]:
        return
    height = float(final.values[-1])
    own = flight.log.format not in ("tlog", "raw", "pcap")
    yield Finding(
        "ends_in_flight",
        Severity.CRITICAL if own else Severity.WARNING,
        f"the log ends {height:.0f} m above home",
        "The vehicle was armed and in the air at the end of the log. "
        + (
            "It lost its power or crashed."
            if own
            else "The recording was ended, the link was lost, or it crashed."
        ),
        float(final.times[-1]),
        {"altitude_m": height},
    )


RULES: Final = (
    Rule("voltage_sag", str(voltage_sag.__doc__), voltage_sag),
    Rule("charge", str(charge.__doc__), charge),
    Rule("board_supply", str(board_supply.__doc__), board_supply),
    Rule("ends_in_flight", str(ends_in_flight.__doc__), ends_in_flight),
)
