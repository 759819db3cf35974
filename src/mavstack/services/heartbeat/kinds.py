"""What HEARTBEAT's type and autopilot mean, in words for people."""

from __future__ import annotations

from mavstack.dialects import common

_TYPES = {
    common.MavType.GENERIC: "unknown kind of component",
    common.MavType.GCS: "ground station",
    common.MavType.ONBOARD_CONTROLLER: "companion computer",
    common.MavType.ADSB: "ADS-B receiver",
    common.MavType.ODID: "Remote ID transmitter",
    common.MavType.GPS: "GPS receiver",
    common.MavType.OSD: "OSD",
    common.MavType.IMU: "IMU",
    common.MavType.FLARM: "FLARM",
    common.MavType.QUADROTOR: "quadrotor",
    common.MavType.GROUND_ROVER: "rover",
    common.MavType.SURFACE_BOAT: "boat",
}
_AUTOPILOTS = {
    common.MavAutopilot.GENERIC: "a generic autopilot",
    common.MavAutopilot.ARDUPILOTMEGA: "ArduPilot",
    common.MavAutopilot.PX4: "PX4",
}


def describe_kind(type_number: int, autopilot: int) -> str:
    """The kind of a component: "camera", "ground station", "quadrotor with ArduPilot"."""
    try:
        known = common.MavType(type_number)
        name = _TYPES.get(known) or known.name.lower().replace("_", " ").replace("vtol", "VTOL")
    except ValueError:
        name = f"type {type_number}"
    if autopilot == common.MavAutopilot.INVALID:
        return name
    try:
        firmware = common.MavAutopilot(autopilot)
    except ValueError:
        return f"{name} with autopilot {autopilot}"
    return f"{name} with {_AUTOPILOTS.get(firmware) or firmware.name}"
