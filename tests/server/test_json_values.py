from __future__ import annotations

import json
from math import inf, nan

from mavstack.dialects import common
from mavstack.security.tickets import TicketRefusal
from mavstack.server.json_values import to_json
from mavstack.vehicle.telemetry.values import Gps, Position


def test_values_of_telemetry() -> None:
    position = to_json(Position(47.5, 8.5, nan, None, inf))
    assert position == {
        "latitude": 47.5,
        "longitude": 8.5,
        "altitude": None,
        "relative_altitude": None,
        "heading": None,
    }
    assert to_json(Gps(common.GpsFixType(3)))["fix"] == "3D_FIX"


def test_enums_flags_and_collections() -> None:
    values = {
        1: common.MavSeverity.INFO,
        "flags": common.MavModeFlag(129),
        "bytes": b"\x01\xff",
        "tuple": (1, 2.5, None),
        "text": TicketRefusal.USED,
    }
    found = to_json(values)
    assert found == {
        "1": "INFO",
        "flags": 129,
        "bytes": [1, 255],
        "tuple": [1, 2.5, None],
        "text": "the ticket has been used",
    }
    json.dumps(found, allow_nan=False)
