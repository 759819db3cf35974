"""MAVSDK by its own Python package: every message as JSON, or the values of its telemetry plugin.

The plugin calls a function with its own value type for the messages that it supports, whose ids are listed
below. The other messages never reach the program, but MAVSDK receives them too.
"""

from __future__ import annotations

import importlib
import json
from operator import attrgetter, itemgetter
from threading import Event
from typing import TYPE_CHECKING, Any

from mavstack.dialects import Dialect

from .child import FIELDS, MessageRecorder, serve

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

CONNECT_TIMEOUT = 15.0
PLUGIN: Mapping[str, tuple[int, str]] = {
    "attitude_quaternion": (31, "w x y"),
    "position": (33, "latitude_deg longitude_deg absolute_altitude_m"),
    "position_velocity_ned": (32, "position.north_m position.east_m position.down_m"),
    "raw_gps": (24, "latitude_deg longitude_deg absolute_altitude_m"),
    "fixedwing_metrics": (74, "airspeed_m_s throttle_percentage climb_rate_m_s"),
}


class _Station:
    """A connection, whose threads do the work, and the autopilot found on it."""

    def __init__(self, recorder: MessageRecorder) -> None:
        mavsdk: Any = importlib.import_module("mavsdk")
        configuration = mavsdk.Configuration.create_with_component_type(mavsdk.ComponentType.GROUND_STATION)
        self._mavsdk = mavsdk.Mavsdk(configuration)
        self._mavsdk.add_any_connection(f"udpin://127.0.0.1:{recorder.port}")
        self.system = self._mavsdk.first_autopilot(CONNECT_TIMEOUT)
        if self.system is None:
            raise SystemExit("MAVSDK found no autopilot")


def _direct(recorder: MessageRecorder) -> None:
    dialect = Dialect.load("all")
    ids = {name: dialect[name].__mavlink_row__[0] for name in dialect.names}
    readers = {name: itemgetter(*fields) for name, fields in FIELDS.items()}
    plugin = importlib.import_module("mavsdk.plugins.mavlink_direct").MavlinkDirect

    def callback(message: Any, _: Any) -> None:  # noqa: ANN401
        read = readers.get(message.message_name)
        if read is not None:
            read(json.loads(message.fields_json))
        recorder.record(ids[message.message_name])

    station = _Station(recorder)
    direct = plugin(station.system)
    direct.subscribe_message("", callback)
    Event().wait()


def _plugin(recorder: MessageRecorder) -> None:
    plugin = importlib.import_module("mavsdk.plugins.telemetry").Telemetry
    station = _Station(recorder)
    telemetry = plugin(station.system)
    for name, (message_id, fields) in PLUGIN.items():
        getattr(telemetry, f"subscribe_{name}")(_callback(recorder, message_id, attrgetter(*fields.split())))
    Event().wait()


def _callback(
    recorder: MessageRecorder, message_id: int, read: Callable[[Any], object]
) -> Callable[[Any, Any], None]:
    def callback(value: Any, _: Any) -> None:  # noqa: ANN401
        read(value)
        recorder.record(message_id)

    return callback


if __name__ == "__main__":
    importlib.import_module("mavsdk")
    serve({"direct": _direct, "plugin": _plugin})
