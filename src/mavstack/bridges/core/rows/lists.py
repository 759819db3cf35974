"""Rows whose samples other parts of the bridge make: plans, parameters, diagnostics, transforms, packets."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

from mavstack.bridges.core.qos import DEFAULT, LATCHED, PACKETS, PARAMETERS
from mavstack.bridges.core.row import Publication, Values
from mavstack.bridges.core.rows.diagnostics import diagnostics
from mavstack.bridges.core.rows.transforms import STATIC_TF, TF
from mavstack.dialects import common

if TYPE_CHECKING:
    from mavstack.bridges.core.view import VehicleView


def item_reached(message: Any, _view: VehicleView) -> Values:
    """Return mavros_msgs/WaypointReached."""
    return (message.seq,)


def _list(name: str, meaning: str) -> Publication:
    return Publication(name, "mavros_msgs/msg/WaypointList", (), None, LATCHED, meaning=meaning)


ROWS: Final = (
    _list("mission/waypoints", "degrees, m; after each transfer, and as the mission goes on"),
    _list("geofence/fences", "degrees, m; after each transfer"),
    _list("rallypoint/rallypoints", "degrees, m; after each transfer"),
    Publication(
        "mission/reached",
        "mavros_msgs/msg/WaypointReached",
        (common.MissionItemReached,),
        item_reached,
        LATCHED,
    ),
    Publication("param/event", "mavros_msgs/msg/ParamEvent", (), None, PARAMETERS, meaning="true types"),
    Publication(
        "/diagnostics",
        "diagnostic_msgs/msg/DiagnosticArray",
        (),
        diagnostics,
        DEFAULT,
        period=1.0,
        meaning="connection, GNSS, battery, estimator, checks before arming",
    ),
    TF,
    STATIC_TF,
    Publication(
        "mavlink_source",
        "mavros_msgs/msg/Mavlink",
        (),
        None,
        PACKETS,
        meaning="packets as received",
        difference="one pair of topics for each vehicle, below its namespace; MAVROS has /uas1/…",
    ),
)
