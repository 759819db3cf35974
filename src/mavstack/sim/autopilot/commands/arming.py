"""Arming, disarming and the arming checks."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.sim.autopilot.commands.registration import CommandGroup, Handlers, accept
from mavstack.sim.autopilot.refusal import CommandRefusedError

if TYPE_CHECKING:
    from mavstack.services.command import CommandRequest
    from mavstack.sim.autopilot.commands.registration import Outcome

_CMD, _RESULT = common.MavCmd, common.MavResult
#: Value of param 2 of COMPONENT_ARM_DISARM that skips the checks.
FORCE = 21196.0


class ArmingCommands(CommandGroup):
    """COMPONENT_ARM_DISARM, RUN_PREARM_CHECKS, DO_FLIGHTTERMINATION."""

    #: The result that is sent if arming or disarming is refused.
    refusal = _RESULT.FAILED

    def handlers(self) -> Handlers:
        return {
            _CMD.COMPONENT_ARM_DISARM: self.arm_or_disarm,
            _CMD.RUN_PREARM_CHECKS: self.run_checks,
            _CMD.DO_FLIGHTTERMINATION: self.terminate,
        }

    def arm_or_disarm(self, request: CommandRequest) -> Outcome:
        """COMPONENT_ARM_DISARM: 1 arms, 0 disarms, other values are denied."""
        wanted, force = request.command.param1, request.command.param2 == FORCE
        if wanted == 1:
            return self.arm(force=force)
        if wanted == 0:
            return self.disarm(force=force)
        return _RESULT.UNSUPPORTED

    def arm(self, *, force: bool) -> common.MavResult:
        """Arm, or send why not."""
        problems = self.autopilot.arm(force=force)
        for problem in problems:
            self.vehicle.send_statustext(problem, common.MavSeverity.CRITICAL)
        return self.refusal if problems else _RESULT.ACCEPTED

    def disarm(self, *, force: bool) -> common.MavResult:
        """Disarm; in the air only if it is forced."""
        if not self.autopilot.armed:
            return _RESULT.ACCEPTED
        if not force and self.disarm_refusal():
            raise CommandRefusedError(self.refusal, self.disarm_refusal())
        self.autopilot.disarm("commanded")
        return _RESULT.ACCEPTED

    def disarm_refusal(self) -> str:
        """Return why the vehicle cannot be disarmed without force; an empty text if it can."""
        airborne = self.vehicle.vehicle_type.flies and not self.autopilot.landed
        return "Disarming denied: not landed" if airborne else ""

    def run_checks(self, request: CommandRequest) -> common.MavResult:
        """RUN_PREARM_CHECKS: send every problem that prevents arming."""
        if self.autopilot.armed:
            return _RESULT.TEMPORARILY_REJECTED
        for problem in self.autopilot.profile.arming_problems(self.autopilot):
            self.vehicle.send_statustext(problem, common.MavSeverity.CRITICAL)
        return _RESULT.ACCEPTED

    def terminate(self, request: CommandRequest) -> common.MavResult:
        """DO_FLIGHTTERMINATION: stop the motors permanently."""
        if request.command.param1 > 0.5:
            self.autopilot.terminate()
        return accept(request.command.param1 > 0.5)
