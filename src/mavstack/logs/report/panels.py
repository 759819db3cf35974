"""The charts of a report: which signals are drawn together. `mav data plot` draws the same ones."""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from mavstack.logs.analysis.spectrum import acceleration_spectrum
from mavstack.logs.report.charts import Band, Chart, Line

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from mavstack.logs.analysis import Flight

#: SiK radios: dBm = value / 1.9 - 127.
_RADIO_SCALE, _RADIO_OFFSET = 1 / 1.9, -127.0


class Panel(NamedTuple):
    """A chart of signals with one unit; `factor` and `offset` convert their values to `unit`.

    `leaves_out_zeros` is true if a signal that is always zero is one that is not connected.
    """

    title: str
    unit: str
    signals: tuple[str, ...]
    factor: float = 1.0
    offset: float = 0.0
    leaves_out_zeros: bool = False


#: The panels by topic; the topics are the presets of `mav data plot`.
PANELS: Final[Mapping[str, tuple[Panel, ...]]] = MappingProxyType(
    {
        "attitude": (
            Panel("Roll", "deg", ("roll", "roll_target")),
            Panel("Pitch", "deg", ("pitch", "pitch_target")),
            Panel("Yaw", "deg", ("yaw",)),
        ),
        "altitude": (
            Panel("Altitude above home", "m", ("altitude",)),
            Panel("Climb rate", "m/s", ("climb_rate",)),
        ),
        "speed": (Panel("Speed", "m/s", ("ground_speed", "air_speed")),),
        "power": (
            Panel("Battery voltage", "V", ("voltage",)),
            Panel("Battery current", "A", ("current",)),
            Panel("Battery remaining", "%", ("remaining",)),
            Panel("Board voltage", "V", ("board_voltage",)),
        ),
        "vibration": (
            Panel("Vibration", "m/s/s", ("vibration_x", "vibration_y", "vibration_z")),
            Panel("Clipped samples", "", ("clipping",)),
        ),
        "estimator": (
            Panel("Test ratios", "", ("compass_variance", "velocity_variance", "position_variance")),
        ),
        "gps": (Panel("Satellites", "", ("satellites",)), Panel("HDOP", "", ("hdop",))),
        "outputs": (
            Panel(
                "Outputs", "us", tuple(f"output_{number}" for number in range(1, 7)), leaves_out_zeros=True
            ),
        ),
        "link": (
            Panel("RC signal", "", ("rc_rssi",)),
            Panel(
                "Telemetry radio (SiK scale)",
                "dBm",
                ("radio_rssi", "radio_remrssi", "radio_noise", "radio_remnoise"),
                _RADIO_SCALE,
                _RADIO_OFFSET,
            ),
        ),
        "processor": (Panel("Processor load", "%", ("cpu_load",)),),
    }
)


def charts_of(flight: Flight, topic: str, marks: Sequence[float] = ()) -> Iterator[Chart]:
    """Yield the charts of a topic for which the flight has values.

    Args:
        flight: The flight.
        topic: A key of `PANELS`.
        marks: Times of findings.
    """
    bands = [Band(span.start, span.end, span.value) for span in flight.mode_spans]
    for panel in PANELS[topic]:
        found = [signal for name in panel.signals if (signal := flight.signal(name)) is not None]
        lines = [
            Line(signal.title, signal.times, signal.values * panel.factor + panel.offset)
            for signal in found
            if signal.values.any() or not panel.leaves_out_zeros
        ]
        if lines:
            yield Chart(panel.title, panel.unit, lines, bands, marks)
    if topic == "vibration" and (spectrum := acceleration_spectrum(flight)) is not None:
        lines = [
            Line(axis, spectrum.frequencies[1:], np.asarray(row[1:]))
            for axis, row in zip("xyz", spectrum.amplitudes, strict=True)
        ]
        title = f"Spectrum of the accelerations ({spectrum.source}, {spectrum.rate:.0f} Hz)"
        yield Chart(title, "m/s/s", lines, axis="Hz")
