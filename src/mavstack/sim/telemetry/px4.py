"""PX4's streams: each message at the rate of the link's MAVLink mode.

Measured on PX4 1.17 in SITL (SIH quadrotor), 20 s each, on the ground: 372.8 messages/s on the link to the
ground station (14550) and 428.8 on the onboard link (14540), each rate as below, except for messages that a
copter lacks (NAV_CONTROLLER_OUTPUT, WIND_COV) or sends only with a target (POSITION_TARGET_GLOBAL_INT,
ORBIT_EXECUTION_STATUS). These include HEARTBEAT and CURRENT_MODE, which other modules send here, and a few
that are not simulated: messages in development (GNSS_INTEGRITY, ESTIMATOR_SENSOR_FUSION_STATUS), and the
event sequence.

A real PX4 has a link for each kind of client. A simulated vehicle has the same streams on all links, so by
default (`SHARED`) it sends what the ground station's link carries, and in addition HIGHRES_IMU, ODOMETRY and
SYSTEM_TIME of the onboard link, which MAVSDK programs wait for.

The shortest interval is one step: at 50 steps/s, ATTITUDE is sent at 50 Hz on the onboard link.
REQUEST_DATA_STREAM is ignored, as PX4 does not implement it.
"""

from __future__ import annotations

from enum import StrEnum
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.sim.telemetry.link_messages import LinkMessages
from mavstack.sim.telemetry.producers import Producers, change_rates, publish_all
from mavstack.sim.vehicle_types import VehicleType

if TYPE_CHECKING:
    from mavstack.services.message_request.server import Producer
    from mavstack.sim.telemetry.producers import MessageType
    from mavstack.sim.vehicle import SimulatedVehicle


class LinkMode(StrEnum):
    """A MAVLink mode of PX4.

    `GROUND` is the link that PX4's simulation starts for a ground station; `SHARED`, the default, adds the
    sensor and time messages of the onboard link.
    """

    SHARED = "shared"
    GROUND = "ground"
    NORMAL = "normal"
    ONBOARD = "onboard"
    MINIMAL = "minimal"


#: Messages, and their rates in hertz in each mode: GROUND, NORMAL, ONBOARD, MINIMAL.
RATES: tuple[tuple[MessageType, float, float, float, float], ...] = (
    (common.Altitude, 1.0, 1.0, 10.0, 0.5),
    (common.Attitude, 50.0, 15.0, 100.0, 10.0),
    (common.AttitudeQuaternion, 50.0, 10.0, 50.0, 0.0),
    (common.AttitudeTarget, 50.0, 2.0, 10.0, 0.0),
    (common.BatteryStatus, 0.5, 0.5, 0.5, 0.0),
    (common.DistanceSensor, 0.5, 0.5, 10.0, 0.0),
    (common.EscInfo, 1.0, 1.0, 10.0, 0.0),
    (common.EscStatus, 1.0, 1.0, 10.0, 0.0),
    (common.EstimatorStatus, 0.5, 0.5, 1.0, 0.0),
    (common.ExtendedSysState, 1.0, 1.0, 5.0, 0.1),
    (common.GlobalPositionInt, 50.0, 5.0, 50.0, 5.0),
    (common.GpsGlobalOrigin, 0.0, 0.0, 0.0, 0.0),
    (common.GpsRawInt, 5.0, 5.0, 8.0, 0.5),
    (common.HighresImu, 0.0, 0.0, 50.0, 0.0),
    (common.HomePosition, 0.5, 0.5, 0.5, 0.1),
    (common.LinkNodeStatus, 1.0, 1.0, 1.0, 1.0),
    (common.LocalPositionNed, 50.0, 1.0, 30.0, 0.0),
    (common.MissionCurrent, 1.0, 1.0, 1.0, 1.0),
    (common.NavControllerOutput, 1.0, 1.0, 10.0, 0.0),
    (common.ObstacleDistance, 1.0, 1.0, 10.0, 0.0),
    (common.Odometry, 0.0, 0.0, 30.0, 0.0),
    (common.OpenDroneIdLocation, 1.0, 1.0, 1.0, 0.0),
    (common.OpenDroneIdSystem, 1.0, 1.0, 1.0, 0.0),
    (common.OrbitExecutionStatus, 2.0, 2.0, 5.0, 0.0),
    (common.Ping, 0.1, 0.1, 1.0, 0.0),
    (common.PositionTargetGlobalInt, 1.0, 1.0, 10.0, 0.0),
    (common.PositionTargetLocalNed, 50.0, 1.5, 10.0, 0.0),
    (common.RcChannels, 20.0, 5.0, 20.0, 0.5),
    (common.ScaledPressure, 1.0, 1.0, 1.0, 0.0),
    (common.ServoOutputRaw, 50.0, 1.0, 10.0, 0.0),
    (common.SysStatus, 1.0, 1.0, 5.0, 0.1),
    (common.SystemTime, 0.0, 0.0, 1.0, 0.0),
    (common.TimeEstimateToTarget, 0.5, 0.5, 0.5, 0.0),
    (common.Timesync, 0.0, 0.0, 10.0, 0.0),
    (common.VfrHud, 4.0, 4.0, 10.0, 1.0),
    (common.Vibration, 0.1, 0.1, 0.5, 0.0),
    (common.WindCov, 0.5, 0.5, 10.0, 0.0),
)
#: Messages of the onboard link that a shared link also sends, and their rates in hertz.
SHARED_RATES: dict[MessageType, float] = {
    common.HighresImu: 10.0,
    common.Odometry: 10.0,
    common.SystemTime: 1.0,
}
#: The link modes in the order of their columns in `RATES`.
_COLUMNS = (LinkMode.GROUND, LinkMode.NORMAL, LinkMode.ONBOARD, LinkMode.MINIMAL)
#: Vehicle types that estimate the wind even without drag fusion.
_ESTIMATES_WIND = frozenset({VehicleType.PLANE, VehicleType.VTOL})
_DRAG_FUSION = "EKF2_DRAG_CTRL"
#: Link modes by the value of MAV_0_MODE.
_MODES = {0: LinkMode.SHARED, 2: LinkMode.ONBOARD, 7: LinkMode.MINIMAL}
_MODE = "MAV_0_MODE"


def publish_px4(vehicle: SimulatedVehicle, link: LinkMode | str | None = None) -> None:
    """Publish PX4's streams on a vehicle's message server.

    Args:
        vehicle: The vehicle.
        link: The MAVLink mode; None to read it from the parameter MAV_0_MODE.
    """
    if link is None:
        link = _MODES.get(int(vehicle.parameters.get(_MODE, 0)), LinkMode.SHARED)
    vehicle.messages.data_streams = {}
    publish_all(vehicle, px4_producers(Producers(vehicle)), link_rates(vehicle, LinkMode(link)))


def set_link_mode(vehicle: SimulatedVehicle, link: LinkMode | str) -> None:
    """Send at the rates of another MAVLink mode until the next boot."""
    change_rates(vehicle, link_rates(vehicle, LinkMode(link)))


def link_rates(vehicle: SimulatedVehicle, link: LinkMode) -> dict[MessageType, float]:
    """Return the rates (hertz) of a MAVLink mode."""
    shared = link is LinkMode.SHARED
    column = _COLUMNS.index(LinkMode.GROUND if shared else link)
    rates = {message_type: each[column] for message_type, *each in RATES}
    if shared:
        rates |= SHARED_RATES
    if not vehicle.proximity:
        del rates[common.ObstacleDistance]
    wind = vehicle.vehicle_type in _ESTIMATES_WIND or vehicle.parameters.get(_DRAG_FUSION, 0) == 1
    return rates if wind else {**rates, common.WindCov: 0.0}


def px4_producers(producers: Producers) -> dict[MessageType, Producer]:
    """Return the producers of all messages that PX4 can send."""
    link = LinkMessages(producers.view)
    return {
        **_motion_producers(producers),
        **_state_producers(producers),
        **producers.distances.producers(),
        common.LinkNodeStatus: link.node_status,
        common.Ping: link.ping,
        common.Timesync: link.timesync,
        common.OpenDroneIdLocation: link.drone_id_location,
        common.OpenDroneIdSystem: link.drone_id_system,
        common.TimeEstimateToTarget: link.time_estimate,
        common.UtmGlobalPosition: link.traffic,
        common.CellularStatus: producers.devices.modem,
    }


def _motion_producers(producers: Producers) -> dict[MessageType, Producer]:
    """Return the producers of motion and sensor messages."""
    motion, sensors = producers.motion, producers.sensors
    return {
        common.Attitude: motion.attitude,
        common.AttitudeQuaternion: motion.attitude_quaternion,
        common.GlobalPositionInt: motion.global_position_if_known,
        common.LocalPositionNed: motion.local_position,
        common.Odometry: motion.odometry,
        common.Altitude: motion.altitude,
        common.VfrHud: motion.vfr_hud_with_sensor,
        common.WindCov: motion.wind_covariance,
        common.EstimatorStatus: motion.estimator_status,
        common.HilStateQuaternion: motion.ground_truth,
        common.HighresImu: sensors.highres_imu,
        common.ScaledImu: sensors.scaled_imu(1),
        common.ScaledImu2: sensors.scaled_imu(2),
        common.ScaledImu3: sensors.scaled_imu(3),
        common.RawImu: sensors.raw_imu,
        common.ScaledPressure: sensors.pressure,
        common.GpsRawInt: sensors.gps_raw_with_date,
        common.DistanceSensor: sensors.distance_sensor,
        common.Vibration: sensors.vibration,
    }


def _state_producers(producers: Producers) -> dict[MessageType, Producer]:
    """Return the producers of status and control messages."""
    status, control = producers.status, producers.control
    return {
        common.SysStatus: status.system,
        common.ExtendedSysState: status.extended,
        common.FlightInformation: status.flight,
        common.BatteryStatus: status.battery,
        common.MissionCurrent: status.mission,
        common.HomePosition: status.home,
        common.GpsGlobalOrigin: status.origin,
        common.SystemTime: status.time,
        common.AttitudeTarget: control.attitude_target,
        common.PositionTargetLocalNed: control.local_target,
        common.PositionTargetGlobalInt: control.global_target_int,
        common.NavControllerOutput: control.navigation_if_steered,
        common.OrbitExecutionStatus: control.orbit,
        common.RcChannels: control.channels_if_received,
        common.ServoOutputRaw: control.servos,
        common.ActuatorOutputStatus: control.actuators,
        common.EscInfo: control.esc_information,
        common.EscStatus: control.escs,
    }
