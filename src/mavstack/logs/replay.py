"""A log of any format as a stream of packets with times, for everything that shows a flight as it happens.

A log of packets is replayed as it is. A log that a vehicle wrote itself has no packets: its positions,
attitude, modes, texts and battery become the messages that a vehicle with such values sends, at the rates of
a telemetry link. The result is a tlog.
"""

from __future__ import annotations

from dataclasses import dataclass
from heapq import merge
from math import isfinite, nan, radians
from typing import TYPE_CHECKING, Final

import numpy as np

from mavstack.dialects import common
from mavstack.errors import LogError
from mavstack.geodesy import METRES_PER_DEGREE
from mavstack.logs.analysis.signals import Signal, read_signal
from mavstack.logs.export.tlog_file import ReceiveClock, StreamClock
from mavstack.logs.flight_states import FlightStates, flight_states
from mavstack.logs.packets.packet_record import PacketRecord
from mavstack.logs.recorder.formats import TLOG
from mavstack.logs.tracks import Track, tracks
from mavstack.security import carries_signing_key, redact
from mavstack.services.modes import mode_number
from mavstack.wire import Encoder

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from numpy.typing import NDArray

    from mavstack.dialects import Message
    from mavstack.logs.log import Log
    from mavstack.logs.records import LogText

_PACKET_FORMATS: Final = ("tlog", "raw", "pcap")
#: Seconds between messages: heartbeat, battery and satellites; attitude; position; speeds.
_SLOW, _ATTITUDE, _POSITION, _SPEEDS = 1.0, 0.1, 0.2, 0.5
#: Start of a log without UTC, as Unix seconds: 2000-01-01, to which the time since boot is added.
_UNKNOWN_DATE: Final = 946_684_800.0
_TEXT_SIZE: Final = 50
_MAX_TEXT_PARTS: Final = 6
#: Maximum distance in seconds between a time and the nearest sample of a signal; beyond it, the value is
#: unknown.
_MAX_GAP: Final = 3.0
_MICRO: Final = 1_000_000
_NO_U8, _NO_U16 = 0xFF, 0xFFFF

_Event = tuple[float, "Message"]


def replay_tlog(log: Log) -> bytes:
    """Return a log as a tlog that shows its flight.

    Args:
        log: The log.

    Returns:
        The bytes of the tlog.

    Raises:
        LogError: The log cannot be read, or holds neither positions nor attitude.
    """
    return b"".join(replay_records(log))


def replay_records(log: Log) -> Iterator[bytes]:
    """Yield the records of the tlog that shows the flight of a log, one packet each; see `replay_tlog`.

    Args:
        log: The log.

    Yields:
        The time in microseconds since 1970, in 8 bytes, and a packet.

    Raises:
        LogError: The log cannot be read, or holds neither positions nor attitude.
    """
    if log.format in _PACKET_FORMATS:
        yield from _own_packets(log)
        return
    flight = _Flight.read(log)
    if not len(flight.roll or ()) and flight.track is None:
        raise LogError(
            f"replaying {log.path.name} failed: the {log.format} log has neither positions nor attitude; "
            "its report shows what it has"
        )
    yield from _made_packets(flight)


def _own_packets(log: Log) -> Iterator[bytes]:
    span = log.time_span
    clock = (
        StreamClock(log.time_base.offset_us or round(_UNKNOWN_DATE * _MICRO))
        if log.format == "raw"
        else ReceiveClock(0 if span is None else round(span[0] * _MICRO))
    )
    for record in log.records():
        if isinstance(record, PacketRecord):
            time = clock.time_of(record.packet)
            if not carries_signing_key(record.packet):
                yield TLOG.record(redact(record.packet), time)


@dataclass(frozen=True, eq=False)
class _Flight:
    """The facts of a flight; times of signals begin at 0, times of states and track at `start`."""

    system: int
    component: int
    autopilot: int
    vehicle: int
    start: float
    end: float
    #: Unix seconds minus the time of the log.
    offset: float
    states: FlightStates
    track: Track | None
    signals: dict[str, Signal | None]
    texts: list[LogText]

    @property
    def roll(self) -> Signal | None:
        return self.signals["roll"]

    @classmethod
    def read(cls, log: Log) -> _Flight:
        """Read a log that a vehicle wrote itself."""
        vehicle = next(iter(log.vehicles.values()), None)
        start, end = log.time_span or (0.0, 0.0)
        names = vehicle and (vehicle.vehicle_type, vehicle.autopilot)
        kind, firmware = names or ("", "")
        # Logs of tests and of old versions lack the firmware name; only PX4 writes ULog.
        firmware = firmware or ("PX4" if log.format == "ulog" else "")
        return cls(
            system=(vehicle.system if vehicle else 0) or 1,
            component=vehicle.component if vehicle else 1,
            autopilot=int(common.MavAutopilot.__members__.get(firmware, common.MavAutopilot.GENERIC)),
            vehicle=int(common.MavType.__members__.get(kind, common.MavType.GENERIC)),
            start=start,
            end=end,
            offset=0.0 if log.time_base.kind == "utc" else _UNKNOWN_DATE,
            states=next(iter(flight_states(log).values())),
            track=next(iter(tracks(log)), None),
            signals={name: read_signal(log, name) for name in _SIGNALS},
            texts=log.texts,
        )

    def at(self, name: str, time: float) -> float:
        """Return a signal at a time of the log; NaN if it has no sample near it."""
        signal = self.signals[name]
        if signal is None:
            return nan
        index = _nearest(signal.times, time - self.start)
        return nan if index is None else float(signal.values[index])


_SIGNALS: Final = (
    *("roll", "pitch", "yaw", "altitude", "ground_speed", "air_speed", "climb_rate", "throttle"),
    *("voltage", "current", "remaining", "satellites", "gps_fix", "hdop"),
)


def _nearest(times: NDArray[np.float64], time: float) -> int | None:
    if not len(times):
        return None
    after = min(int(np.searchsorted(times, time)), len(times) - 1)
    index = after - 1 if after > 0 and time - times[after - 1] < times[after] - time else after
    return index if abs(float(times[index]) - time) <= _MAX_GAP else None


def _made_packets(flight: _Flight) -> Iterator[bytes]:
    encoder = Encoder(system=flight.system, component=flight.component)
    numbers = _mode_numbers(flight)
    streams: list[Iterable[_Event]] = [
        _heartbeats(flight, numbers),
        _attitudes(flight),
        _positions(flight),
        _speeds(flight),
        _texts(flight),
    ]
    for time, message in merge(*streams, key=lambda event: event[0]):
        yield TLOG.record(encoder.encode(message), round((time + flight.offset) * _MICRO))


def _mode_numbers(flight: _Flight) -> dict[str, int]:
    """Return the `custom_mode` of each mode; those without a known number are counted from the end."""
    names = sorted({str(name) for name in flight.states.mode.values.tolist()})
    known = {name: mode_number(flight.autopilot, flight.vehicle, name) for name in names}
    free = iter(range(10_000, 10_000 + len(names)))
    return {name: next(free) if number is None else number for name, number in known.items()}


def _heartbeats(flight: _Flight, numbers: dict[str, int]) -> Iterator[_Event]:
    times = np.arange(flight.start, flight.end + _SLOW, _SLOW)
    armed, modes = flight.states.armed.at(times), flight.states.mode.at(times)
    for time, is_armed, mode in zip(times.tolist(), armed.tolist(), modes.tolist(), strict=True):
        flags = common.MavModeFlag.CUSTOM_MODE_ENABLED
        if is_armed:
            flags |= common.MavModeFlag.SAFETY_ARMED
        state = common.MavState.ACTIVE if is_armed else common.MavState.STANDBY
        yield (
            time,
            common.Heartbeat(
                flight.vehicle, flight.autopilot, flags, numbers.get(mode, 0), state, mavlink_version=3
            ),
        )
        # Sent after the first heartbeat, which makes the vehicle known.
        if time == flight.start:
            yield from ((time, each) for each in _mode_list(numbers))
        yield from _status(flight, time)


def _mode_list(numbers: dict[str, int]) -> Iterator[Message]:
    for index, (name, number) in enumerate(numbers.items()):
        yield common.AvailableModes(len(numbers), index + 1, custom_mode=number, mode_name=name[:35])


def _status(flight: _Flight, time: float) -> Iterator[_Event]:
    voltage, current, remaining = (flight.at(name, time) for name in ("voltage", "current", "remaining"))
    if isfinite(voltage):
        yield (
            time,
            common.SysStatus(
                voltage_battery=_whole(voltage * 1000, _NO_U16, _NO_U16),
                current_battery=_whole(current * 100, -1, 0x7FFF),
                battery_remaining=_whole(remaining, -1, 100),
            ),
        )
    fix = flight.at("gps_fix", time)
    if isfinite(fix):
        yield time, common.GpsRawInt(
            round(time * _MICRO),
            fix_type=_whole(fix, 0, 8),
            eph=_whole(flight.at("hdop", time) * 100, _NO_U16, _NO_U16),
            epv=_NO_U16, vel=_NO_U16, cog=_NO_U16,
            satellites_visible=_whole(flight.at("satellites", time), _NO_U8, _NO_U8),
        )  # fmt: skip


def _attitudes(flight: _Flight) -> Iterator[_Event]:
    signal = flight.roll
    if signal is None:
        return
    for index in _thinned(signal.times, _ATTITUDE):
        time = float(signal.times[index]) + flight.start
        pitch, yaw = flight.at("pitch", time), flight.at("yaw", time)
        angles = (radians(each) if isfinite(each) else 0.0 for each in (signal.values[index], pitch, yaw))
        roll, pitch, yaw = angles
        yield time, common.Attitude(_boot_ms(flight, time), roll, pitch, (yaw + np.pi) % (2 * np.pi) - np.pi)


def _positions(flight: _Flight) -> Iterator[_Event]:
    track = flight.track
    if track is None:
        return
    kept = _thinned(track.times, _POSITION)
    home = float(track.altitudes[kept[0]]) if len(kept) else 0.0
    velocities = _velocities(track, kept)
    for index, (north, east, down) in zip(kept, velocities, strict=True):
        time, altitude = float(track.times[index]), float(track.altitudes[index])
        above, yaw = flight.at("altitude", time), flight.at("yaw", time)
        yield (
            time,
            common.GlobalPositionInt(
                _boot_ms(flight, time),
                round(float(track.latitudes[index]) * 1e7),
                round(float(track.longitudes[index]) * 1e7),
                round(altitude * 1000),
                round((above if isfinite(above) else altitude - home) * 1000),
                vx=_speed(north),
                vy=_speed(east),
                vz=_speed(down),
                hdg=round(yaw % 360 * 100) if isfinite(yaw) else _NO_U16,
            ),
        )


def _speed(metres: float) -> int:
    """Return a speed in m/s as GLOBAL_POSITION_INT holds it."""
    return max(-32768, min(32767, round(metres * 100)))


def _velocities(track: Track, kept: list[int]) -> list[tuple[float, float, float]]:
    """Return the velocity (NED) at each kept place, from the places beside it."""
    if len(kept) < 2:
        return [(0.0, 0.0, 0.0)] * len(kept)
    times = track.times[kept]
    latitudes, longitudes = track.latitudes[kept], np.unwrap(track.longitudes[kept], period=360.0)
    # Rows with the same time would give infinite speeds.
    north = np.gradient(latitudes * METRES_PER_DEGREE, times)
    east = np.gradient(longitudes * METRES_PER_DEGREE, times) * np.cos(np.radians(latitudes))
    down = -np.gradient(track.altitudes[kept], times)
    return list(zip(north.tolist(), east.tolist(), down.tolist(), strict=True))


def _speeds(flight: _Flight) -> Iterator[_Event]:
    ground = flight.signals["ground_speed"]
    if ground is None:
        return
    for index in _thinned(ground.times, _SPEEDS):
        time = float(ground.times[index]) + flight.start
        yaw = flight.at("yaw", time)
        yield (
            time,
            common.VfrHud(
                flight.at("air_speed", time),
                float(ground.values[index]),
                round(yaw % 360) if isfinite(yaw) else 0,
                _whole(flight.at("throttle", time), 0, 100),
                flight.at("altitude", time),
                flight.at("climb_rate", time),
            ),
        )


def _texts(flight: _Flight) -> Iterator[_Event]:
    number = 0
    timed = ((_time_of(flight, text), text) for text in flight.texts)
    known = [(time, text) for time, text in timed if time is not None]
    for time, text in sorted(known, key=lambda each: each[0]):
        data = text.text.encode()[: _TEXT_SIZE * _MAX_TEXT_PARTS]
        parts = [data[at : at + _TEXT_SIZE] for at in range(0, len(data), _TEXT_SIZE)] or [b""]
        # If the last part is full, an empty part marks the end of the text.
        if len(parts) > 1 and len(parts[-1]) == _TEXT_SIZE:
            parts.append(b"")
        number = number % 0xFFFF + 1
        for sequence, part in enumerate(parts):
            chunk = part.decode(errors="replace")[:_TEXT_SIZE]
            yield time, common.Statustext(text.severity, chunk, number if len(parts) > 1 else 0, sequence)


def _time_of(flight: _Flight, text: LogText) -> float | None:
    """Return the time of a text on the time base of the log, None if it is not known."""
    if flight.offset == 0.0:
        time = (
            None if np.isnat(text.time) else float(text.time.astype("datetime64[us]").astype(np.int64)) / 1e6
        )
    else:
        time = None if text.boot_us is None else text.boot_us / 1e6
    return time if time is None else min(max(time, flight.start), flight.end)


def _thinned(times: NDArray[np.float64], interval: float) -> list[int]:
    """Return the indexes of times that are an interval apart at least, ascending."""
    if not len(times):
        return []
    # 1e-3, because times at multiples of the interval are not exact.
    slots = np.floor((times - times[0]) / interval + 1e-3).astype(np.int64)
    newest = np.maximum.accumulate(slots)
    first = np.flatnonzero(np.concatenate([[True], newest[1:] > newest[:-1]]))
    ascending = np.concatenate([[True], np.diff(times[first]) > 0.0])
    return [int(each) for each in first[ascending].tolist()]


def _boot_ms(flight: _Flight, time: float) -> int:
    return max(0, round((time - flight.start) * 1000)) % 2**32


def _whole(value: float, unknown: int, largest: int) -> int:
    """Return a value as a field holds it; `unknown` for NaN."""
    return int(max(min(unknown, 0), min(largest, round(value)))) if isfinite(value) else unknown
