"""The functions that read each value from the received messages; none of them sends or waits."""

from mavstack.vehicle.telemetry.readers.devices import (
    ESC_TELEMETRY,
    read_engine,
    read_escs,
    read_generator,
    read_modem,
)
from mavstack.vehicle.telemetry.readers.motion import (
    read_attitude,
    read_local_position,
    read_position,
    read_velocity,
    read_vfr_hud,
    read_wind,
)
from mavstack.vehicle.telemetry.readers.power import read_batteries
from mavstack.vehicle.telemetry.readers.sensors import read_gps, read_imu, read_odometry, read_rc
from mavstack.vehicle.telemetry.readers.state import (
    read_armed,
    read_home,
    read_in_air,
    read_landed_state,
    read_mode,
    read_system_status,
    read_vtol_state,
)
from mavstack.vehicle.telemetry.readers.surroundings import read_distances, read_obstacles

__all__ = [
    "ESC_TELEMETRY",
    "read_armed",
    "read_attitude",
    "read_batteries",
    "read_distances",
    "read_engine",
    "read_escs",
    "read_generator",
    "read_gps",
    "read_home",
    "read_imu",
    "read_in_air",
    "read_landed_state",
    "read_local_position",
    "read_mode",
    "read_modem",
    "read_obstacles",
    "read_odometry",
    "read_position",
    "read_rc",
    "read_system_status",
    "read_velocity",
    "read_vfr_hud",
    "read_vtol_state",
    "read_wind",
]
