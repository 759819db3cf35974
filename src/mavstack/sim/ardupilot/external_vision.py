"""Visual odometry on ArduPilot: VISO_TYPE 1 at boot, and EK3_SRCn_… 6 (ExternalNav) for each part.

ODOMETRY counts in LOCAL_FRD with BODY_FRD alone. Without an estimate for 0.3 s the estimator stops using it,
and vehicles do not arm. The position needs an origin, from GPS or SET_GPS_GLOBAL_ORIGIN. Source: ArduPilot,
AP_VisualOdom, AP_NavEKF3, GCS_MAVLink.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.sim.autopilot.external_vision import ExternalVision, VisionUse

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.dialects import Message
    from mavstack.services import Address
    from mavstack.services.parameters import Value
    from mavstack.sim.autopilot.autopilot import SimulatedAutopilot
    from mavstack.sim.autopilot.external_vision import ExternalEstimate
    from mavstack.sim.vehicle import SimulatedVehicle

#: Seconds without a message after which visual odometry is not healthy.
TIMEOUT: Final = 0.3
_EXTERNAL_NAV: Final = 6
_GPS: Final = 3
_POSITION: Final = "EK3_SRC1_POSXY"


def register_external_vision(vehicle: SimulatedVehicle) -> None:
    """Use visual odometry as the parameters of this boot say."""
    body, parameters = vehicle.body, vehicle.parameters

    def use_gps(source: Value) -> None:
        body.use_gps(int(source) == _GPS)

    use_gps(parameters.get(_POSITION, _GPS))
    if _POSITION in parameters:
        parameters.on_change(_POSITION, use_gps)
    if int(parameters.get("VISO_TYPE", 0)):
        vision = ExternalVision(
            vehicle,
            lambda: _use(vehicle),
            timeout=TIMEOUT,
            accepts=_accepts,
            changed=lambda used: _report(vehicle, used),
        )
        vehicle.autopilot.vision = vehicle.engine.add(vision)


def vision_problems(autopilot: SimulatedAutopilot) -> Iterator[str]:
    """Yield the problem of visual odometry for the pre-arm checks."""
    vision = autopilot.vision
    if vision is not None and not vision.is_healthy(autopilot.now):
        yield "VisOdom: not healthy"


def _use(vehicle: SimulatedVehicle) -> VisionUse:
    names = (_POSITION, "EK3_SRC1_POSZ", "EK3_SRC1_VELXY", "EK3_SRC1_YAW")
    return VisionUse(*(int(vehicle.parameters.get(name, 0)) == _EXTERNAL_NAV for name in names))


def _accepts(message: Message, estimate: ExternalEstimate, source: Address) -> bool:
    """Return whether a message is taken: ODOMETRY in one pair of frames, and no failed one."""
    if estimate.quality < 0:
        return False
    if not isinstance(message, common.Odometry):
        return True
    frames = common.MavFrame
    return message.frame_id == frames.LOCAL_FRD and message.child_frame_id == frames.BODY_FRD


def _report(vehicle: SimulatedVehicle, used: bool) -> None:
    if not used:
        vehicle.send_statustext("EKF3 IMU0 stopped aiding", common.MavSeverity.WARNING)
        return
    place = ",".join(f"{each:.1f}" for each in vehicle.body.estimate[:3])
    vehicle.send_statustext("EKF3 IMU0 is using external nav data", common.MavSeverity.INFO)
    vehicle.send_statustext(f"EKF3 IMU0 initial pos NED = {place} (m)", common.MavSeverity.INFO)
