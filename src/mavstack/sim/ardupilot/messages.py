"""Messages that ArduPilot handles besides commands: banner requests, SET_HOME_POSITION, guided items."""

from __future__ import annotations

from math import isfinite
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.services.addressing import Address, message_ids
from mavstack.services.command import Command
from mavstack.services.service import Service
from mavstack.sim.ardupilot.identity import banner_of
from mavstack.sim.ardupilot.motor_calibration import compass_motor_of
from mavstack.sim.ardupilot.sensor_calibration import calibrations_of
from mavstack.sim.autopilot.commands import CommandRefusedError, place_of
from mavstack.sim.autopilot.commands.guiding import guide_to
from mavstack.sim.vehicle_types import VehicleType

if TYPE_CHECKING:
    from mavstack.services.mission import MissionItem
    from mavstack.sim.vehicle import SimulatedVehicle
    from mavstack.wire import Packet

_RESULT = common.MavMissionResult
#: Minimum interval in seconds between two banners; a client that requests all parameters gets a banner.
_BANNER_INTERVAL = 10.0
_MAX_LATITUDE, _MAX_LONGITUDE = 900_000_000, 1_800_000_000


class ArdupilotMessages(Service):
    """Service that handles these messages for the vehicle."""

    handles = message_ids(common.ParamRequestList, common.SetHomePosition, common.CommandAck)

    def __init__(self, vehicle: SimulatedVehicle) -> None:
        super().__init__(vehicle.address)
        self._vehicle = vehicle
        self._banner_at = float("-inf")

    def receive(self, packet: Packet, now: float) -> None:
        match packet.message:
            case common.ParamRequestList() if now - self._banner_at >= _BANNER_INTERVAL:
                self._banner_at = now
                for line in banner_of(self._vehicle):
                    self._vehicle.send_statustext(line, common.MavSeverity.INFO)
            case common.SetHomePosition(target_system=self.local.system) as message:
                self._set_home(message)
            case common.CommandAck() as message:
                source = Address(packet.system, packet.component)
                calibrations_of(self._vehicle.autopilot).acknowledged(message, source)
                if (compass_motor := compass_motor_of(self._vehicle.autopilot)) is not None:
                    compass_motor.end()

    def _set_home(self, message: common.SetHomePosition) -> None:
        """Handle SET_HOME_POSITION."""
        if abs(message.latitude) > _MAX_LATITUDE or abs(message.longitude) > _MAX_LONGITUDE:
            return
        autopilot = self._vehicle.autopilot
        if message.latitude == 0 and message.longitude == 0:
            if autopilot.has_position:
                autopilot.set_home_here()
                autopilot.home_locked = True
            return
        autopilot.set_home(message.latitude / 1e7, message.longitude / 1e7, message.altitude / 1e3)
        autopilot.home_locked = True


def guided_item(vehicle: SimulatedVehicle, item: MissionItem, *, altitude_only: bool) -> int:
    """Fly to a mission item in GUIDED; return a MAV_MISSION_RESULT."""
    autopilot = vehicle.autopilot
    if autopilot.mode.number != autopilot.profile.guided or not isfinite(item.param7):
        return _RESULT.ERROR
    try:
        command = Command(
            common.MavCmd.NAV_WAYPOINT,
            param5=item.param5,
            param6=item.param6,
            param7=item.param7,
            frame=int(item.frame),
        )
        north, east, down = place_of(autopilot, command)
    except CommandRefusedError:
        return _RESULT.ERROR
    if altitude_only:
        north, east, _ = autopilot.target or autopilot.maneuvers.place
    if vehicle.vehicle_type is VehicleType.SUB:
        down = max(down, 0.0)
    guide_to(autopilot, (north, east, 0.0 if vehicle.vehicle_type.on_surface else down))
    return _RESULT.ACCEPTED
