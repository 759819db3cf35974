"""What PX4 sends by itself: each message at the rate that the kind of link has for it.

Counted on PX4 1.17 in SITL (SIH quadrotor), 20 s each, on the ground: 372.8 messages/s on the link to the
ground station (14550) and 428.8 on the onboard link (14540), each rate as below, but for what a copter lacks
(NAV_CONTROLLER_OUTPUT, WIND_COV) or has only on its way (POSITION_TARGET_GLOBAL_INT, ORBIT_EXECUTION_STATUS).
Among these are HEARTBEAT and CURRENT_MODE, which others send here, and a few that nobody sends here: what is
in development still (GNSS_INTEGRITY, ESTIMATOR_SENSOR_FUSION_STATUS), and the sequence of events.

A step is the shortest interval: at 50 steps/s, ATTITUDE comes 50 times a second on the onboard link.
REQUEST_DATA_STREAM is not heard, as PX4 does not know it.
"""

from __future__ import annotations

from enum import StrEnum
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.sim.telemetry.link_messages import LinkMessages
from mavstack.sim.telemetry.producers import Producers, change_rates, provide_all
from mavstack.sim.vehicle_types import VehicleType

if TYPE_CHECKING:
    from mavstack.services.message_request.server import Producer
    from mavstack.sim.autopilot.interfaces import Vehicle
    from mavstack.sim.telemetry.producers import Kind


class Link(StrEnum):
    """What PX4 has rates for; `GROUND` is the link that its simulation starts for a ground station."""

    GROUND = "ground"
    NORMAL = "normal"
    ONBOARD = "onboard"
    MINIMAL = "minimal"


#: Message, and its rate in hertz on each link: GROUND, NORMAL, ONBOARD, MINIMAL.
RATES: tuple[tuple[Kind, float, float, float, float], ...] = (
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
#: Only a vehicle that flies by its wings estimates the wind unless its parameters say so.
_ESTIMATES_WIND = frozenset({VehicleType.PLANE, VehicleType.VTOL})
_DRAG_FUSION = "EKF2_DRAG_CTRL"
#: What a parameter of links that are no more than serial ports calls them.
_MODES = {0: Link.GROUND, 2: Link.ONBOARD, 7: Link.MINIMAL}
_MODE = "MAV_0_MODE"


def provide_px4(vehicle: Vehicle, link: Link | str | None = None) -> None:
    """Let a vehicle send what PX4 sends over a link; if none is given, MAV_0_MODE says which."""
    if link is None:
        link = _MODES.get(int(vehicle.parameters.get(_MODE, 0)), Link.GROUND)
    vehicle.messages.data_streams = {}
    provide_all(vehicle, px4_producers(Producers(vehicle)), rates_of(vehicle, Link(link)))


def use_link(vehicle: Vehicle, link: Link | str) -> None:
    """Send at another kind of link's rates from now on, until the next boot."""
    change_rates(vehicle, rates_of(vehicle, Link(link)))


def rates_of(vehicle: Vehicle, link: Link) -> dict[Kind, float]:
    """The rates of a kind of link."""
    column = tuple(Link).index(link)
    rates = {kind: each[column] for kind, *each in RATES}
    wind = vehicle.type in _ESTIMATES_WIND or vehicle.parameters.get(_DRAG_FUSION, 0) == 1
    return rates if wind else {**rates, common.WindCov: 0.0}


def px4_producers(of: Producers) -> dict[Kind, Producer]:
    """Everything that PX4 can send."""
    link = LinkMessages(of.view)
    return {
        **_motion(of),
        **_state(of),
        common.LinkNodeStatus: link.node_status,
        common.Ping: link.ping,
        common.Timesync: link.timesync,
        common.OpenDroneIdLocation: link.drone_id_location,
        common.OpenDroneIdSystem: link.drone_id_system,
        common.TimeEstimateToTarget: link.time_estimate,
        common.UtmGlobalPosition: link.traffic,
    }


def _motion(of: Producers) -> dict[Kind, Producer]:
    motion, sensors = of.motion, of.sensors
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


def _state(of: Producers) -> dict[Kind, Producer]:
    status, control = of.status, of.control
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
        common.RcChannels: control.channels_if_heard,
        common.ServoOutputRaw: control.servos,
        common.ActuatorOutputStatus: control.actuators,
        common.EscInfo: control.esc_information,
        common.EscStatus: control.escs,
    }
