"""What ArduPilot sends by itself: groups of messages, each at the rate that a parameter gives.

A group's rate in hertz is the parameter SR0_ (from 4.7 on MAV1_) and the group's name; it counts from the
moment that it is set. REQUEST_DATA_STREAM asks for a group by its number, and SET_MESSAGE_INTERVAL for one
message. Counted on ArduPlane 4.1 in SITL with SR0_* 1: each message of its groups once a second, 26 messages
together; asked for 4 Hz as MAVProxy does, 4.0 of each and 100 together. On ArduCopter 3.5.7, whose rates are
0: nothing but HEARTBEAT until somebody asks, then 4.2 of each and 110 together, for a stream comes a whole
number of scheduler ticks apart. Newer versions have other groups: AHRS3, SENSOR_OFFSETS, HWSTATUS and
RC_CHANNELS_RAW went out, FENCE_STATUS, POSITION_TARGET_GLOBAL_INT, WIND and DISTANCE_SENSOR came in.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.dialects import ardupilotmega as dialect
from mavstack.sim.telemetry.producers import Producers, change_rates, ids_of, provide_all
from mavstack.sim.vehicle_types import VehicleType

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.services.message_request.server import Producer
    from mavstack.services.parameters import Value
    from mavstack.sim.autopilot.interfaces import Vehicle
    from mavstack.sim.telemetry.producers import Kind

_GROUP = dialect.MavDataStream
_ALL, _WINGED = frozenset(VehicleType), frozenset({VehicleType.PLANE, VehicleType.VTOL})
_FLYING = _WINGED | {VehicleType.COPTER}

#: The groups: the end of the parameter's name, the number in REQUEST_DATA_STREAM, and the messages.
GROUPS: tuple[tuple[str, int, tuple[Kind, ...]], ...] = (
    (
        "RAW_SENS",
        _GROUP.RAW_SENSORS,
        (
            *(dialect.RawImu, dialect.ScaledImu2, dialect.ScaledImu3),
            *(dialect.ScaledPressure, dialect.ScaledPressure2, dialect.Airspeed),
        ),
    ),
    (
        "EXT_STAT",
        _GROUP.EXTENDED_STATUS,
        (
            *(dialect.SysStatus, dialect.PowerStatus, dialect.McuStatus, dialect.Meminfo),
            *(dialect.MissionCurrent, dialect.GpsRawInt, dialect.NavControllerOutput),
            *(dialect.FenceStatus, dialect.PositionTargetGlobalInt),
        ),
    ),
    ("POSITION", _GROUP.POSITION, (dialect.GlobalPositionInt, dialect.LocalPositionNed)),
    ("RC_CHAN", _GROUP.RC_CHANNELS, (dialect.ServoOutputRaw, dialect.RcChannels)),
    (
        "EXTRA1",
        _GROUP.EXTRA1,
        (dialect.Attitude, dialect.Simstate, dialect.Ahrs2, dialect.AoaSsa, dialect.EscTelemetry1To4),
    ),
    ("EXTRA2", _GROUP.EXTRA2, (dialect.VfrHud,)),
    (
        "EXTRA3",
        _GROUP.EXTRA3,
        (
            *(dialect.Ahrs, dialect.Wind, dialect.WaterDepth, dialect.DistanceSensor, dialect.Rangefinder),
            *(dialect.SystemTime, dialect.TerrainReport, dialect.BatteryStatus),
            *(dialect.EkfStatusReport, dialect.Vibration),
        ),
    ),
)
#: Messages that only some types send; all others are sent by every type.
ONLY: dict[Kind, frozenset[VehicleType]] = {
    dialect.Airspeed: _WINGED,
    dialect.AoaSsa: _WINGED,
    dialect.EscTelemetry1To4: frozenset({VehicleType.COPTER, VehicleType.VTOL}),
    dialect.Wind: _FLYING,
    dialect.WaterDepth: frozenset({VehicleType.BOAT}),
}
#: The rate of all groups, if the vehicle has no parameter for it: what ground stations ask for.
USUAL_RATE = 4.0
_PREFIXES = ("SR0_", "MAV1_")


def provide_ardupilot(vehicle: Vehicle) -> None:
    """Let a vehicle send what ArduPilot sends."""
    producers = {
        kind: produce
        for kind, produce in ardupilot_producers(Producers(vehicle)).items()
        if vehicle.type in ONLY.get(kind, _ALL)
    }
    rates, data_streams = {}, {}
    for ending, number, kinds in GROUPS:
        members = tuple(kind for kind in kinds if kind in producers)
        rate, name = _rate(vehicle, ending)
        rates.update(dict.fromkeys(members, rate))
        data_streams[int(number)] = ids_of(members)
        if name is not None:
            vehicle.parameters.on_change(name, _follow(vehicle, members))
    provide_all(vehicle, producers, rates)
    data_streams[int(_GROUP.ALL)] = frozenset().union(*data_streams.values())
    vehicle.messages.data_streams = data_streams


def _rate(vehicle: Vehicle, ending: str) -> tuple[float, str | None]:
    """A group's rate, and the parameter that it comes from."""
    for prefix in _PREFIXES:
        if prefix + ending in vehicle.parameters:
            return float(vehicle.parameters[prefix + ending]), prefix + ending
    return USUAL_RATE, None


def _follow(vehicle: Vehicle, kinds: tuple[Kind, ...]) -> Callable[[Value], None]:
    def follow(rate: Value) -> None:
        change_rates(vehicle, dict.fromkeys(kinds, float(rate)))

    return follow


def ardupilot_producers(of: Producers) -> dict[Kind, Producer]:
    """Everything that ArduPilot can send, those first that it sends by itself."""
    return {**_grouped(of), **_on_request(of)}


def _grouped(of: Producers) -> dict[Kind, Producer]:
    motion, sensors, status, control = of.motion, of.sensors, of.status, of.control
    return {
        dialect.Attitude: motion.attitude,
        dialect.GlobalPositionInt: motion.global_position,
        dialect.LocalPositionNed: motion.local_position_if_known,
        dialect.VfrHud: motion.vfr_hud,
        dialect.Simstate: motion.simstate,
        dialect.Ahrs: motion.ahrs,
        dialect.Ahrs2: motion.ahrs2,
        dialect.AoaSsa: motion.angles_of_air,
        dialect.Wind: motion.wind,
        dialect.EkfStatusReport: motion.ekf_status,
        dialect.RawImu: sensors.raw_imu,
        dialect.ScaledImu2: sensors.scaled_imu(2),
        dialect.ScaledImu3: sensors.scaled_imu(3),
        dialect.ScaledPressure: sensors.pressure,
        dialect.ScaledPressure2: sensors.second_pressure,
        dialect.Airspeed: sensors.airspeed,
        dialect.GpsRawInt: sensors.gps_raw,
        dialect.Vibration: sensors.vibration,
        dialect.Rangefinder: sensors.rangefinder_if_fitted,
        dialect.DistanceSensor: sensors.distance_sensor_if_fitted,
        dialect.WaterDepth: sensors.water_depth,
        dialect.SysStatus: status.system,
        dialect.PowerStatus: status.power,
        dialect.McuStatus: status.processor,
        dialect.Meminfo: status.memory,
        dialect.BatteryStatus: status.battery,
        dialect.MissionCurrent: status.mission,
        dialect.SystemTime: status.time,
        dialect.TerrainReport: status.terrain,
        dialect.FenceStatus: status.fence,
        dialect.RcChannels: control.channels,
        dialect.ServoOutputRaw: control.servos,
        dialect.NavControllerOutput: control.navigation,
        dialect.PositionTargetGlobalInt: control.global_target,
        dialect.EscTelemetry1To4: control.esc_telemetry,
    }


def _on_request(of: Producers) -> dict[Kind, Producer]:
    motion, sensors, status, control = of.motion, of.sensors, of.status, of.control
    return {
        dialect.AttitudeQuaternion: motion.attitude_quaternion,
        dialect.ScaledImu: sensors.scaled_imu(1),
        dialect.HighresImu: sensors.highres_imu,
        dialect.ExtendedSysState: status.extended,
        dialect.FlightInformation: status.flight,
        dialect.Hwstatus: status.hardware,
        dialect.HomePosition: status.home,
        dialect.GpsGlobalOrigin: status.origin,
        dialect.RcChannelsRaw: control.raw_channels,
        dialect.AttitudeTarget: control.attitude_target,
        dialect.PositionTargetLocalNed: control.local_target_if_guided,
    }
