"""Starting, pausing and going on with the mission; the fence's switch."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.sim.autopilot.commands.refusal import CommandRefusedError
from mavstack.sim.autopilot.commands.registration import CommandGroup, Handlers, needed, number, whole

if TYPE_CHECKING:
    from mavstack.services.command import CommandRequest

_CMD, _RESULT = common.MavCmd, common.MavResult


class MissionCommands(CommandGroup):
    """MISSION_START, DO_PAUSE_CONTINUE."""

    def handlers(self) -> Handlers:
        return {_CMD.MISSION_START: self.start, _CMD.DO_PAUSE_CONTINUE: self.pause_or_continue}

    def start(self, request: CommandRequest) -> common.MavResult:
        """MISSION_START: fly the mission from item param 1 to item param 2, 0 being its beginning and end."""
        first, last = (needed(number(value)) for value in (request.command.param1, request.command.param2))
        problem = self.autopilot.mission.start(first, last)
        if problem is not None:
            raise CommandRefusedError(_RESULT.FAILED, problem)
        return _RESULT.ACCEPTED

    def pause_or_continue(self, request: CommandRequest) -> common.MavResult:
        """DO_PAUSE_CONTINUE: 0 waits here, 1 goes on."""
        match whole(request.command.param1):
            case 0:
                return self.pause()
            case 1:
                return self.go_on()
        return _RESULT.DENIED

    def pause(self) -> common.MavResult:
        """Hold where it is."""
        return self.enter(self.autopilot.profile.hold)

    def go_on(self) -> common.MavResult:
        """Go on with the mission."""
        return self.enter(self.autopilot.profile.mission)
