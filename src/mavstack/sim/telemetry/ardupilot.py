"""ArduPilot's streams: groups of messages, each at the rate of a parameter.

A group's rate in hertz is the parameter SR0_ (from 4.7 on MAV1_) plus the group's name; a new value applies
immediately. REQUEST_DATA_STREAM sets the rate of a group by its number, SET_MESSAGE_INTERVAL the rate of one
message.
Measured on ArduPlane 4.1 in SITL with SR0_* 1: each message of its groups at 1 Hz, 26 messages in total;
after a request for 4 Hz as MAVProxy makes it, 4.0 of each and 100 in total. On ArduCopter 3.5.7, whose rates
are 0: nothing but HEARTBEAT until a request, then 4.2 of each and 110 in total, because the interval of a
stream is a whole number of scheduler ticks. Newer versions have other groups: AHRS3, SENSOR_OFFSETS, HWSTATUS
and RC_CHANNELS_RAW were removed, FENCE_STATUS, POSITION_TARGET_GLOBAL_INT, WIND and DISTANCE_SENSOR were
added.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.dialects import ardupilotmega as dialect
from mavstack.sim.telemetry.producers import Producers, change_rates, message_ids, publish_all
from mavstack.sim.vehicle_types import VehicleType

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.services.message_request.server import Producer
    from mavstack.services.parameters import Value
    from mavstack.sim.telemetry.producers import MessageType
    from mavstack.sim.vehicle import SimulatedVehicle

_GROUP = dialect.MavDataStream
_ALL, _WINGED = frozenset(VehicleType), frozenset({VehicleType.PLANE, VehicleType.VTOL})
_FLYING = _WINGED | {VehicleType.COPTER}

#: Stream groups: suffix of the parameter's name, stream id in REQUEST_DATA_STREAM, and messages.
GROUPS: tuple[tuple[str, int, tuple[MessageType, ...]], ...] = (
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
            dialect.ObstacleDistance,
            *(dialect.SystemTime, dialect.TerrainReport, dialect.BatteryStatus),
            *(dialect.EkfStatusReport, dialect.Vibration, dialect.WinchStatus),
            *(dialect.GeneratorStatus, dialect.EfiStatus),
        ),
    ),
)
#: Vehicle types that send a message; messages not listed are sent by every type.
TYPES_SENDING: dict[MessageType, frozenset[VehicleType]] = {
    dialect.Airspeed: _WINGED,
    dialect.AoaSsa: _WINGED,
    dialect.EscTelemetry1To4: frozenset({VehicleType.COPTER, VehicleType.VTOL}),
    dialect.Wind: _FLYING,
    dialect.WaterDepth: frozenset({VehicleType.BOAT}),
    dialect.WinchStatus: frozenset({VehicleType.COPTER}),
}
#: Rate in hertz of a group that has no parameter, equal to the rate that ground stations usually request.
DEFAULT_RATE = 4.0
_PREFIXES = ("SR0_", "MAV1_")


def publish_ardupilot(vehicle: SimulatedVehicle) -> None:
    """Publish ArduPilot's streams on a vehicle's message server."""
    producers = {
        message_type: produce
        for message_type, produce in ardupilot_producers(Producers(vehicle)).items()
        if vehicle.vehicle_type in TYPES_SENDING.get(message_type, _ALL)
    }
    rates, data_streams = {}, {}
    for ending, number, message_types in GROUPS:
        members = tuple(message_type for message_type in message_types if message_type in producers)
        rate, name = _rate(vehicle, ending)
        rates.update(dict.fromkeys(members, rate))
        data_streams[int(number)] = message_ids(members)
        if name is not None:
            vehicle.parameters.on_change(name, _rate_setter(vehicle, members))
    publish_all(vehicle, producers, rates)
    data_streams[int(_GROUP.ALL)] = frozenset().union(*data_streams.values())
    vehicle.messages.data_streams = data_streams


def _rate(vehicle: SimulatedVehicle, ending: str) -> tuple[float, str | None]:
    """Return a group's rate in hertz, and the name of the parameter that sets it."""
    for prefix in _PREFIXES:
        if prefix + ending in vehicle.parameters:
            return float(vehicle.parameters[prefix + ending]), prefix + ending
    return DEFAULT_RATE, None


def _rate_setter(
    vehicle: SimulatedVehicle, message_types: tuple[MessageType, ...]
) -> Callable[[Value], None]:
    """Return the callback that applies a parameter's new rate to messages."""

    def set_rate(rate: Value) -> None:
        change_rates(vehicle, dict.fromkeys(message_types, float(rate)))

    return set_rate


def ardupilot_producers(producers: Producers) -> dict[MessageType, Producer]:
    """Return the producers of all messages that ArduPilot can send, streamed ones first."""
    return {**_grouped_producers(producers), **_requestable_producers(producers)}


def _grouped_producers(producers: Producers) -> dict[MessageType, Producer]:
    """Return the producers of messages in stream groups."""
    motion, sensors, status, control = (
        producers.motion,
        producers.sensors,
        producers.status,
        producers.control,
    )
    return {
        dialect.Attitude: motion.attitude,
        dialect.GlobalPositionInt: motion.global_position,
        dialect.LocalPositionNed: motion.local_position_if_known,
        dialect.VfrHud: motion.vfr_hud,
        dialect.Simstate: motion.simstate,
        dialect.Ahrs: motion.ahrs,
        dialect.Ahrs2: motion.ahrs2,
        dialect.AoaSsa: motion.flow_angles,
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
        dialect.WinchStatus: status.winch_if_fitted,
        dialect.FenceStatus: status.fence,
        dialect.RcChannels: control.channels,
        dialect.ServoOutputRaw: control.servos,
        dialect.NavControllerOutput: control.navigation,
        dialect.PositionTargetGlobalInt: control.global_target,
        dialect.EscTelemetry1To4: control.esc_telemetry,
        **producers.distances.ardupilot_producers(),
        dialect.GeneratorStatus: producers.devices.generator_if_fitted,
        dialect.EfiStatus: producers.devices.engine_if_fitted,
    }


def _requestable_producers(producers: Producers) -> dict[MessageType, Producer]:
    """Return the producers of messages that are sent on request only."""
    motion, sensors, status, control = (
        producers.motion,
        producers.sensors,
        producers.status,
        producers.control,
    )
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
