"""The spectrum of the accelerometer: the frequencies at which a vehicle vibrates.

Rotors show as peaks at their rate of turning and multiples of it; a notch filter is set to the first peak.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from mavstack.errors import LogError

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from mavstack.logs.analysis.flight import Flight

#: Tables with accelerations, highest sample rate first: table, fields, factor to m/s/s.
_SOURCES: Final = (
    ("sensor_accel", ("x", "y", "z"), 1.0),
    ("sensor_combined", ("accelerometer_m_s2[0]", "accelerometer_m_s2[1]", "accelerometer_m_s2[2]"), 1.0),
    ("vehicle_acceleration", ("xyz[0]", "xyz[1]", "xyz[2]"), 1.0),
    ("ACC", ("AccX", "AccY", "AccZ"), 1.0),
    ("IMU", ("AccX", "AccY", "AccZ"), 1.0),
    ("HIGHRES_IMU", ("xacc", "yacc", "zacc"), 1.0),
    ("RAW_IMU", ("xacc", "yacc", "zacc"), 9.80665e-3),
)
_MIN_RATE: Final = 20.0  # hertz; a lower sample rate gives no useful spectrum
_WINDOW: Final = 512  # samples


@dataclass(frozen=True, eq=False)
class Spectrum:
    """The mean amplitude of the accelerations over frequency.

    Attributes:
        source: Table that it was computed from.
        rate: Samples per second.
        frequencies: Hertz.
        amplitudes: m/s/s, a row for each axis.
    """

    source: str
    rate: float
    frequencies: NDArray[np.float64]
    amplitudes: NDArray[np.float64]


def acceleration_spectrum(flight: Flight) -> Spectrum | None:
    """Return the spectrum of the accelerations while armed, by Welch's method.

    Args:
        flight: The flight.

    Returns:
        The spectrum, or None if the log has no accelerations at 20 Hz or more.

    Raises:
        LogError: The log cannot be read.
    """
    for name, fields, factor in _SOURCES:
        if name not in flight.log:
            continue
        table = flight.log[name]
        if not all(table.has_number(field) for field in fields):
            continue
        names = table.dtype.names or ()
        if "_instance" in names and len(table):
            table = table.where(table["_instance"] == table["_instance"].min())
        if "_system" in names:
            table = table.where(table["_system"] == flight.system)
        try:
            times = flight.log.seconds_from_start(name, table)
        except LogError:
            continue
        armed = np.isfinite(times)
        if flight.states.armed.is_known:
            armed &= flight.is_armed(times)
        columns = [np.asarray(table[field])[armed].astype(np.float64) * factor for field in fields]
        found = _welch(name, times[armed], np.array(columns))
        if found is not None:
            return found
    return None


def _welch(source: str, times: NDArray[np.float64], columns: NDArray[np.float64]) -> Spectrum | None:
    if len(times) < 2 * _WINDOW:
        return None
    step = float(np.median(np.diff(times)))
    if step <= 0 or 1 / step < _MIN_RATE or not np.isfinite(columns).all():
        return None
    window = np.hanning(_WINDOW)
    starts = range(0, columns.shape[1] - _WINDOW + 1, _WINDOW // 2)
    pieces = np.stack([columns[:, first : first + _WINDOW] for first in starts])
    pieces -= pieces.mean(axis=2, keepdims=True)
    amplitudes = np.abs(np.fft.rfft(pieces * window, axis=2)).mean(axis=0) * 2 / window.sum()
    frequencies = np.fft.rfftfreq(_WINDOW, step).astype(np.float64)
    return Spectrum(source, 1 / step, frequencies, amplitudes.astype(np.float64))
