"""Descriptions of HEARTBEAT's type and autopilot for people, and which types are vehicles."""

from __future__ import annotations

from mavstack.dialects import common

_TYPE_NAMES = {
    common.MavType.GENERIC: "component of unknown type",
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
_AUTOPILOT_NAMES = {
    common.MavAutopilot.GENERIC: "a generic autopilot",
    common.MavAutopilot.ARDUPILOTMEGA: "ArduPilot",
    common.MavAutopilot.PX4: "PX4",
}

_Type = common.MavType
_NOT_VEHICLES = frozenset(
    {
        _Type.GCS,
        _Type.ANTENNA_TRACKER,
        _Type.ONBOARD_CONTROLLER,
        _Type.GIMBAL,
        _Type.ADSB,
        _Type.CAMERA,
        _Type.CHARGING_STATION,
        _Type.FLARM,
        _Type.SERVO,
        _Type.ODID,
        _Type.BATTERY,
        _Type.PARACHUTE,
        _Type.LOG,
        _Type.OSD,
        _Type.IMU,
        _Type.GPS,
        _Type.WINCH,
        _Type.ILLUMINATOR,
        _Type.GRIPPER,
        _Type.RADIO,
    }
)


def is_vehicle(type_number: int, autopilot: int) -> bool:
    """Return whether a component of that MAV_TYPE and MAV_AUTOPILOT controls a vehicle."""
    return autopilot != common.MavAutopilot.INVALID and type_number not in _NOT_VEHICLES


def describe_component(type_number: int, autopilot: int) -> str:
    """Return the type and the firmware in words: "camera", "ground station", "quadrotor with ArduPilot"."""
    try:
        known = common.MavType(type_number)
        name = _TYPE_NAMES.get(known) or known.name.lower().replace("_", " ").replace("vtol", "VTOL")
    except ValueError:
        name = f"type {type_number}"
    if autopilot == common.MavAutopilot.INVALID:
        return name
    try:
        firmware = common.MavAutopilot(autopilot)
    except ValueError:
        return f"{name} with autopilot {autopilot}"
    return f"{name} with {_AUTOPILOT_NAMES.get(firmware) or firmware.name}"
