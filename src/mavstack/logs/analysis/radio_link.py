"""Rules about the links to the vehicle: silence, lost packets, and the margin of a telemetry radio."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

import numpy as np

from mavstack.logs.analysis.findings import Finding, Severity
from mavstack.logs.analysis.rules import Rule

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.logs.analysis.flight import Flight

#: Seconds without a heartbeat after which ground stations report that the link is lost.
_SILENCE: Final = 5.0
_LOSS: Final = 0.05
#: A step of at least this size between two sequence numbers leads backward: late packets and long gaps cause
#: a few. A larger share of backward steps means several packet counters.
_BACKWARD: Final = 128
_MAX_BACKWARD: Final = 0.2
#: RSSI units of SiK radios per decibel: dBm = value / 1.9 - 127.
_DECIBELS: Final = 1.9
_LOW_MARGIN: Final = 10.0


def lost_link(flight: Flight) -> Iterator[Finding]:
    """Look for more than 5 s between two heartbeats of the autopilot while armed."""
    if "HEARTBEAT" not in flight.log:
        return
    times = flight.states.armed.times - flight.start  # one for each heartbeat
    gaps = np.diff(times)
    lost = np.flatnonzero(gaps > _SILENCE)
    lost = lost[flight.is_armed(times[lost])]
    if not len(lost):
        return
    max_gap = float(gaps[lost].max())
    yield Finding(
        "lost_link",
        Severity.WARNING,
        f"link lost for {max_gap:.0f} s",
        f"The vehicle was not heard {len(lost)} times for more than {_SILENCE:.0f} s while armed, at most "
        f"for {max_gap:.0f} s.",
        float(times[lost[gaps[lost].argmax()]]),
        {"max_gap_s": max_gap, "times": float(len(lost))},
    )


def packet_loss(flight: Flight) -> Iterator[Finding]:
    """Look for more than 5 % of lost packets, by the gaps in the sequence numbers.

    A vehicle counts the packets of each of its links by itself. A recording of several links holds several
    counts of one component, which tell nothing about losses.
    """
    sources: dict[tuple[int, int], Any] = getattr(flight.log, "sources", {})
    counts = [item for (system, _), item in sources.items() if system == flight.system]
    received, lost = sum(item.received for item in counts), sum(item.lost for item in counts)
    if not received or lost / (lost + received) <= _LOSS or _has_several_counters(flight):
        return
    share = lost / (lost + received)
    text = f"{lost:,} of {lost + received:,} packets of the vehicle are missing in the recording."
    title = f"{share:.0%} of the packets lost"
    yield Finding("packet_loss", Severity.WARNING, title, text, None, {"share": share, "lost": float(lost)})


def _has_several_counters(flight: Flight) -> bool:
    """Return whether the sequence numbers of the vehicle's autopilot jump back and forth."""
    vehicle = flight.log.vehicles.get(flight.system)
    component = 1 if vehicle is None else vehicle.component
    own = [
        table.where((table["_system"] == flight.system) & (table["_component"] == component))
        for table in flight.log.values()
        if {"_system", "_sequence"} <= set(table.dtype.names or ())
    ]
    if not own:
        return False
    times = np.concatenate([rows["_time"] for rows in own])
    numbers = np.concatenate([rows["_sequence"] for rows in own])[np.argsort(times, kind="stable")]
    steps = np.diff(numbers)  # the numbers are unsigned bytes, so the differences wrap
    return bool(len(steps)) and float((steps >= _BACKWARD).mean()) > _MAX_BACKWARD


def radio_margin(flight: Flight) -> Iterator[Finding]:
    """Look for a telemetry radio whose signal is less than 10 dB above the noise in flight (SiK scale)."""
    for near, noise, side in (
        ("radio_rssi", "radio_noise", "local"),
        ("radio_remrssi", "radio_remnoise", "remote"),
    ):
        signal, floor = flight.flying_signal(near), flight.flying_signal(noise)
        if signal is None or floor is None:
            continue
        margin = (signal.values - np.interp(signal.times, floor.times, floor.values)) / _DECIBELS
        low = float(np.percentile(margin, 5))
        if low < _LOW_MARGIN:
            yield Finding(
                "radio_margin",
                Severity.WARNING,
                f"{side} radio: {low:.0f} dB above the noise",
                f"For 5 % of the flight the signal of the {side} radio was at most {low:.0f} dB above the "
                f"noise; {_LOW_MARGIN:.0f} dB or more are needed for a link without losses.",
                float(signal.times[margin.argmin()]),
                {"margin_db": low},
            )


RULES: Final = (
    Rule("lost_link", str(lost_link.__doc__), lost_link),
    Rule("packet_loss", str(packet_loss.__doc__), packet_loss),
    Rule("radio_margin", str(radio_margin.__doc__), radio_margin),
)
