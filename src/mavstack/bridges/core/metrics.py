"""Metrics of vehicles and links as a table: names, units, how each is read; nothing costs per message.

Names are those of Prometheus: base units, shares from 0 to 1, and counters that end with `_total` there.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from mavstack.bridges.core.enum_names import enum_name
from mavstack.dialects import common

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from mavstack.vehicle import Connection, Vehicle
    from mavstack.wire import Parser

#: Maximum number of vehicles with metrics; each has a few dozen time series.
MAX_VEHICLES: Final = 1000
_PERCENT: Final = 100.0
_LOAD: Final = 1000.0


@dataclass(frozen=True, slots=True)
class Metric:
    """A metric of vehicles.

    Attributes:
        name: The name, behind `mavstack_vehicle_`.
        text: One line about it.
        read: Returns the value; None if the vehicle does not report it.
    """

    name: str
    text: str
    read: Callable[[Vehicle], float | None]


@dataclass(frozen=True, slots=True)
class Sample:
    """A value of a metric.

    Attributes:
        name: The full name, without `_total`.
        text: One line about the metric.
        labels: The labels by name.
        value: The value.
        is_counter: It only grows while a link is open.
    """

    name: str
    text: str
    labels: dict[str, str]
    value: float
    is_counter: bool = False


def _part(name: str, attribute: str, scale: float = 1.0) -> Callable[[Vehicle], float | None]:
    """Return a function that reads an attribute of a telemetry value."""

    def read(vehicle: Vehicle) -> float | None:
        value = getattr(getattr(vehicle, name), attribute, None)
        return None if value is None else float(value) / scale

    return read


def _flag(read: Callable[[Vehicle], bool | None]) -> Callable[[Vehicle], float | None]:
    def as_number(vehicle: Vehicle) -> float | None:
        value = read(vehicle)
        return None if value is None else float(value)

    return as_number


def _load(vehicle: Vehicle) -> float | None:
    status = vehicle.latest(common.SysStatus)
    return None if status is None else status.load / _LOAD


def _heartbeat_age(vehicle: Vehicle) -> float | None:
    info = vehicle.info
    return None if info is None else max(vehicle.connection.now() - info.last_seen, 0.0)


def _mission_item(vehicle: Vehicle) -> float | None:
    progress = vehicle.mission.progress
    return None if progress is None else float(progress.seq)


METRICS: Final = (
    Metric("up", "1 while heartbeats arrive", _flag(lambda vehicle: vehicle.alive)),
    Metric("heartbeat_age_seconds", "Time since the last heartbeat", _heartbeat_age),
    Metric("armed", "1 if the motors are armed", _flag(lambda vehicle: vehicle.armed)),
    Metric("in_air", "1 if it flies", _flag(lambda vehicle: vehicle.in_air)),
    Metric("ready", "1 if it can be armed", _flag(lambda vehicle: vehicle.health.ready)),
    Metric("problems", "Problems that prevent arming", lambda vehicle: float(len(vehicle.health.problems))),
    Metric("battery_voltage_volts", "Voltage of the battery", _part("battery", "voltage")),
    Metric("battery_current_amperes", "Current of the battery", _part("battery", "current")),
    Metric("battery_remaining_ratio", "Charge that is left, 0 to 1", _part("battery", "remaining", _PERCENT)),
    Metric("latitude_degrees", "Latitude", _part("position", "latitude")),
    Metric("longitude_degrees", "Longitude", _part("position", "longitude")),
    Metric("altitude_meters", "Altitude above mean sea level", _part("position", "altitude")),
    Metric("relative_altitude_meters", "Altitude above home", _part("position", "relative_altitude")),
    Metric("heading_degrees", "Heading, clockwise from north", _part("position", "heading")),
    Metric("roll_degrees", "Roll", _part("attitude", "roll")),
    Metric("pitch_degrees", "Pitch", _part("attitude", "pitch")),
    Metric("ground_speed_meters_per_second", "Speed over ground", lambda vehicle: vehicle.ground_speed),
    Metric("climb_rate_meters_per_second", "Climb rate", lambda vehicle: vehicle.climb_rate),
    Metric("airspeed_meters_per_second", "Speed through the air", _part("vfr_hud", "airspeed")),
    Metric("throttle_ratio", "Throttle, 0 to 1", _part("vfr_hud", "throttle", _PERCENT)),
    Metric("wind_speed_meters_per_second", "Wind", _part("wind", "speed")),
    Metric("gps_satellites", "Satellites that are seen", _part("gps", "satellites")),
    Metric("gps_fix_type", "GPS_FIX_TYPE: 3 and more is a position", _part("gps", "fix")),
    Metric("gps_hdop", "Horizontal dilution of precision", _part("gps", "hdop")),
    Metric("gps_horizontal_accuracy_meters", "Accuracy of the position", _part("gps", "horizontal_accuracy")),
    Metric("cpu_load_ratio", "Load of the autopilot, 0 to 1", _load),
    Metric("mission_item", "Current item of the mission", _mission_item),
)
_LINK_COUNTERS: Final = (
    ("received_packets", "Packets received", "packets"),
    ("received_bytes", "Bytes of packets received", "packet_bytes"),
    ("bad_checksums", "Packets with a wrong checksum", "bad_checksum"),
)
_SYSTEM_COUNTERS: Final = {
    "received": "Packets received from the system",
    "lost": "Packets missing in its sequence numbers",
}
_CORRECTIONS: Final = (
    ("frames", "Frames of corrections (RTCM) from sources of this program"),
    ("data", "Bytes of these frames"),
    ("sent", "Frames sent, on each channel"),
    ("late", "Frames dropped because a channel was too slow"),
    ("too_long", "Frames of more than 720 bytes, which cannot be sent"),
)
VEHICLE: Final = "mavstack_vehicle_"
LINK: Final = "mavstack_link_"
#: The name of the counter of scrapes, without the suffix `_total`.
SCRAPES: Final = "mavstack_scrapes"


def vehicle_labels(vehicle: Vehicle, name: str) -> dict[str, str]:
    """Return the labels of a vehicle."""
    return {"vehicle": name, "system_id": str(vehicle.system)}


def vehicle_samples(vehicle: Vehicle, name: str) -> Iterator[Sample]:
    """Yield the samples of a vehicle."""
    labels = vehicle_labels(vehicle, name)
    for metric in METRICS:
        value = metric.read(vehicle)
        if value is not None:
            yield Sample(f"{VEHICLE}{metric.name}", metric.text, labels, value)
    facts = {
        "autopilot": enum_name(common.MavAutopilot, vehicle.autopilot) or "",
        "type": vehicle.vehicle_type.value,
    }
    yield Sample(f"{VEHICLE}info", "Firmware and type", {**labels, **facts}, 1.0)
    if vehicle.mode is not None:
        mode = {**labels, "mode": vehicle.mode}
        yield Sample(f"{VEHICLE}mode", "The present flight mode", mode, 1.0)


def link_samples(connection: Connection) -> Iterator[Sample]:
    """Yield the samples of all links, and of the packets of each system; both count open channels."""
    links: dict[str, Counter[str]] = {}
    systems: dict[str, Counter[int]] = {"received": Counter(), "lost": Counter()}
    for link in connection.links:
        totals = links.setdefault(link.url.redacted, Counter())
        for channel in link.channels:
            if (state := connection.channel_state(channel)) is not None:
                _add_counts(state.parser, totals, systems)
    for url, totals in links.items():
        for name, text, field in _LINK_COUNTERS:
            yield Sample(f"{LINK}{name}", text, {"link": url}, float(totals[field]), is_counter=True)
    for system in sorted(connection.vehicles)[:MAX_VEHICLES]:
        for name, text in _SYSTEM_COUNTERS.items():
            value, labels = float(systems[name][system]), {"system_id": str(system)}
            yield Sample(f"{VEHICLE}{name}_packets", text, labels, value, is_counter=True)


def correction_samples(connection: Connection) -> Iterator[Sample]:
    """Yield the samples of the corrections for satellite navigation (RTK) that this program sends."""
    counts = connection.corrections.counts
    for name, text in _CORRECTIONS:
        value = float(getattr(counts, name))
        yield Sample(f"mavstack_corrections_{name}", text, {}, value, is_counter=True)


def _add_counts(parser: Parser, totals: Counter[str], systems: dict[str, Counter[int]]) -> None:
    statistics = parser.statistics
    totals.update({field: getattr(statistics, field) for *_, field in _LINK_COUNTERS})
    for (system, _), counts in parser.sources.items():
        systems["received"][system] += counts.received
        systems["lost"][system] += counts.lost
