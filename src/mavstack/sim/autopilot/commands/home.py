"""Commands of home and of the regions of interest."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.sim.autopilot.command_positions import GLOBAL, has_place, place_of
from mavstack.sim.autopilot.commands.registration import CommandGroup, Handlers, number
from mavstack.sim.autopilot.refusal import CommandRefusedError

if TYPE_CHECKING:
    from mavstack.services.command import CommandRequest
    from mavstack.sim.vehicle import SimulatedVehicle

_CMD, _RESULT = common.MavCmd, common.MavResult


class HomeCommands(CommandGroup):
    """DO_SET_HOME, GET_HOME_POSITION and the regions of interest."""

    def handlers(self) -> Handlers:
        return {
            _CMD.DO_SET_HOME: self.set_home,
            _CMD.GET_HOME_POSITION: self.send_home,
            _CMD.DO_SET_ROI: self.set_region,
            _CMD.DO_SET_ROI_LOCATION: self.set_region,
            _CMD.DO_SET_ROI_NONE: self.clear_region,
        }

    def set_home(self, request: CommandRequest) -> common.MavResult:
        """DO_SET_HOME: the current position if param 1 is 1, else params 5 to 7, above mean sea level."""
        command = request.command
        if command.param1 == 1:
            if not self.autopilot.has_position:
                return _RESULT.FAILED
            self.autopilot.set_home_here()
            return _RESULT.ACCEPTED
        if not has_place(command):
            return _RESULT.DENIED
        point = place_of(self.autopilot, command, usual=common.MavFrame.GLOBAL)
        self.autopilot.set_home(*self.autopilot.body.frame.to_global(*point), yaw=self._home_yaw())
        return _RESULT.ACCEPTED

    def send_home(self, request: CommandRequest) -> common.MavResult:
        """GET_HOME_POSITION, the legacy request of HOME_POSITION."""
        message = home_position(self.vehicle)
        if message is None:
            return _RESULT.FAILED
        self.vehicle.services.send(message, request.source)
        return _RESULT.ACCEPTED

    def set_region(self, request: CommandRequest) -> common.MavResult:
        """DO_SET_ROI_LOCATION, DO_SET_ROI: look at a position; all zeros clears it."""
        command = request.command
        if command.command == _CMD.DO_SET_ROI and command.param1 not in {0.0, float(common.MavRoi.LOCATION)}:
            raise CommandRefusedError(_RESULT.DENIED)
        if not has_place(command):
            return self.clear_region(request)
        self.autopilot.payload.region_of_interest = place_of(self.autopilot, command, frames=GLOBAL)
        return _RESULT.ACCEPTED

    def clear_region(self, request: CommandRequest) -> common.MavResult:
        """DO_SET_ROI_NONE."""
        self.autopilot.payload.clear_region()
        return _RESULT.ACCEPTED

    def _home_yaw(self) -> float:
        return number(self.autopilot.body.estimate.yaw)


def home_position(vehicle: SimulatedVehicle) -> common.HomePosition | None:
    """Return HOME_POSITION; None if there is no home yet."""
    autopilot = vehicle.autopilot
    if autopilot.home is None:
        return None
    north, east, down = autopilot.home_position
    return common.HomePosition(
        latitude=round(autopilot.home.latitude * 1e7),
        longitude=round(autopilot.home.longitude * 1e7),
        altitude=round(autopilot.home.altitude * 1e3),
        x=north,
        y=east,
        z=down,
        q=(1.0, 0.0, 0.0, 0.0),
        time_usec=int(vehicle.uptime * 1e6),
    )
