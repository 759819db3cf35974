"""MAVSDK through its own Python package: every message as JSON, or what its telemetry plugin has.

The plugin calls a function with an object of its own kind for the messages that it knows; the ids below are
those whose arrival makes it call. The others are never with the program, but MAVSDK takes them in all the
same.
"""

from __future__ import annotations

import importlib
import json
from operator import attrgetter, itemgetter
from threading import Event
from typing import TYPE_CHECKING, Any

from mavstack.dialects import Dialect

from .child import FIELDS, Ear, serve

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

HEARD_WITHIN = 15.0
PLUGIN: Mapping[str, tuple[int, str]] = {
    "attitude_quaternion": (31, "w x y"),
    "position": (33, "latitude_deg longitude_deg absolute_altitude_m"),
    "position_velocity_ned": (32, "position.north_m position.east_m position.down_m"),
    "raw_gps": (24, "latitude_deg longitude_deg absolute_altitude_m"),
    "fixedwing_metrics": (74, "airspeed_m_s throttle_percentage climb_rate_m_s"),
}


class _Station:
    """A connection, whose own threads do the work, and the autopilot found on it."""

    def __init__(self, ear: Ear) -> None:
        mavsdk: Any = importlib.import_module("mavsdk")
        configuration = mavsdk.Configuration.create_with_component_type(mavsdk.ComponentType.GROUND_STATION)
        self._mavsdk = mavsdk.Mavsdk(configuration)
        self._mavsdk.add_any_connection(f"udpin://127.0.0.1:{ear.port}")
        self.system = self._mavsdk.first_autopilot(HEARD_WITHIN)
        if self.system is None:
            raise SystemExit("MAVSDK heard no autopilot")


def _direct(ear: Ear) -> None:
    dialect = Dialect.load("all")
    ids = {name: dialect[name].__mavlink_row__[0] for name in dialect.names}
    readers = {name: itemgetter(*fields) for name, fields in FIELDS.items()}
    plugin = importlib.import_module("mavsdk.plugins.mavlink_direct").MavlinkDirect

    def take(message: Any, _: Any) -> None:  # noqa: ANN401
        read = readers.get(message.message_name)
        if read is not None:
            read(json.loads(message.fields_json))
        ear.hear(ids[message.message_name])

    station = _Station(ear)
    direct = plugin(station.system)
    direct.subscribe_message("", take)
    Event().wait()


def _plugin(ear: Ear) -> None:
    plugin = importlib.import_module("mavsdk.plugins.telemetry").Telemetry
    station = _Station(ear)
    telemetry = plugin(station.system)
    for name, (message_id, fields) in PLUGIN.items():
        getattr(telemetry, f"subscribe_{name}")(_taker(ear, message_id, attrgetter(*fields.split())))
    Event().wait()


def _taker(ear: Ear, message_id: int, read: Callable[[Any], object]) -> Callable[[Any, Any], None]:
    def take(value: Any, _: Any) -> None:  # noqa: ANN401
        read(value)
        ear.hear(message_id)

    return take


if __name__ == "__main__":
    importlib.import_module("mavsdk")
    serve({"direct": _direct, "plugin": _plugin})
