"""`listener`: the newest message of a topic."""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING, Final, TypeAlias

from mavstack.rotation import from_euler

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence

    from mavstack.sim.px4.shell.context import ShellContext
    from mavstack.sim.vehicle import SimulatedVehicle

Fields: TypeAlias = "Mapping[str, object]"
_ARMED, _DISARMED = 2, 1


def listener(context: ShellContext, words: Sequence[str]) -> Iterator[str]:
    """Print a topic's fields, one per line."""
    name = words[0] if words else ""
    topic = _TOPICS.get(name)
    if topic is None:
        yield f"Topic {name} did not match any known topics" if name else f"topics: {', '.join(_TOPICS)}"
        return
    yield f"TOPIC: {name}"
    yield f"    timestamp: {int(context.vehicle.uptime * 1e6)}"
    yield from (f"    {field}: {_text(value)}" for field, value in topic(context.vehicle).items())


def _text(value: object) -> str:
    """Format a value."""
    if isinstance(value, float):
        return f"{value:.5f}"
    if isinstance(value, tuple):
        return f"[{', '.join(map(_text, value))}]"
    return str(value)


def _vehicle_status(vehicle: SimulatedVehicle) -> Fields:
    autopilot = vehicle.autopilot
    return {
        "arming_state": _ARMED if autopilot.armed else _DISARMED,
        "nav_state": autopilot.mode.name,
        "failsafe": bool(autopilot.failsafes),
        "is_vtol": vehicle.vehicle_type == "vtol",
        "system_type": int(vehicle.vehicle_type.mav_type),
        "system_id": vehicle.address.system,
        "component_id": vehicle.address.component,
    }


def _battery_status(vehicle: SimulatedVehicle) -> Fields:
    battery = vehicle.body.battery
    return {
        "voltage_v": battery.voltage,
        "current_a": battery.current,
        "discharged_mah": battery.consumed,
        "remaining": battery.remaining,
        "temperature": battery.temperature,
        "connected": True,
        "cell_count": battery.cells,
    }


def _local_position(vehicle: SimulatedVehicle) -> Fields:
    here, frame = vehicle.body.estimate, vehicle.body.frame
    return {
        "x": here.north,
        "y": here.east,
        "z": here.down,
        "vx": here.velocity_north,
        "vy": here.velocity_east,
        "vz": here.velocity_down,
        "heading": here.yaw,
        "xy_valid": vehicle.autopilot.has_position,
        "ref_lat": frame.latitude,
        "ref_lon": frame.longitude,
        "ref_alt": frame.altitude,
    }


def _global_position(vehicle: SimulatedVehicle) -> Fields:
    here = vehicle.body.estimate
    latitude, longitude, altitude = vehicle.body.frame.to_global(here.north, here.east, here.down)
    return {"lat": latitude, "lon": longitude, "alt": altitude}


def _attitude(vehicle: SimulatedVehicle) -> Fields:
    here = vehicle.body.estimate
    return {"q": from_euler(here.roll, here.pitch, here.yaw)}


def _angular_velocity(vehicle: SimulatedVehicle) -> Fields:
    here = vehicle.body.estimate
    return {"xyz": (here.roll_rate, here.pitch_rate, here.yaw_rate)}


def _gps(vehicle: SimulatedVehicle) -> Fields:
    sensors = vehicle.body.sensors
    return {
        "latitude_deg": sensors.gps_latitude,
        "longitude_deg": sensors.gps_longitude,
        "altitude_msl_m": sensors.gps_altitude,
        "fix_type": sensors.gps_fix,
        "satellites_used": sensors.gps_satellites,
        "eph": sensors.gps_eph,
        "epv": sensors.gps_epv,
    }


def _sensor_combined(vehicle: SimulatedVehicle) -> Fields:
    sensors = vehicle.body.sensors
    return {
        "gyro_rad": (sensors.gyro_x, sensors.gyro_y, sensors.gyro_z),
        "accelerometer_m_s2": (sensors.acceleration_x, sensors.acceleration_y, sensors.acceleration_z),
    }


def _land_detected(vehicle: SimulatedVehicle) -> Fields:
    return {"landed": vehicle.autopilot.landed, "ground_contact": vehicle.body.on_ground}


def _home(vehicle: SimulatedVehicle) -> Fields:
    home = vehicle.autopilot.home
    if home is None:
        return {"valid_hpos": False}
    return {"lat": home.latitude, "lon": home.longitude, "alt": home.altitude, "valid_hpos": True}


_TOPICS: Final[Mapping[str, Callable[[SimulatedVehicle], Fields]]] = MappingProxyType(
    {
        "battery_status": _battery_status,
        "home_position": _home,
        "sensor_combined": _sensor_combined,
        "vehicle_angular_velocity": _angular_velocity,
        "vehicle_attitude": _attitude,
        "vehicle_global_position": _global_position,
        "vehicle_gps_position": _gps,
        "vehicle_land_detected": _land_detected,
        "vehicle_local_position": _local_position,
        "vehicle_status": _vehicle_status,
    }
)
