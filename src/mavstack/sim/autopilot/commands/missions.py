"""Commands that start, pause and resume the mission."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.sim.autopilot.commands.registration import CommandGroup, Handlers, number, required_whole, whole
from mavstack.sim.autopilot.refusal import CommandRefusedError

if TYPE_CHECKING:
    from mavstack.services.command import CommandRequest

_CMD, _RESULT = common.MavCmd, common.MavResult


class MissionCommands(CommandGroup):
    """MISSION_START, DO_PAUSE_CONTINUE."""

    def handlers(self) -> Handlers:
        return {_CMD.MISSION_START: self.start, _CMD.DO_PAUSE_CONTINUE: self.pause_or_continue}

    def start(self, request: CommandRequest) -> common.MavResult:
        """MISSION_START: fly the mission from item param 1 to item param 2; 0 means its start or its end."""
        first, last = (
            required_whole(number(value)) for value in (request.command.param1, request.command.param2)
        )
        problem = self.autopilot.mission.start(first, last)
        if problem is not None:
            raise CommandRefusedError(_RESULT.FAILED, problem)
        return _RESULT.ACCEPTED

    def pause_or_continue(self, request: CommandRequest) -> common.MavResult:
        """DO_PAUSE_CONTINUE: 0 pauses, 1 resumes."""
        match whole(request.command.param1):
            case 0:
                return self.pause()
            case 1:
                return self.resume()
        return _RESULT.DENIED

    def pause(self) -> common.MavResult:
        """Hold the position."""
        return self.enter(self.autopilot.profile.hold)

    def resume(self) -> common.MavResult:
        """Resume the mission."""
        return self.enter(self.autopilot.profile.mission)
