"""Arming, disarming, and asking whether it could be done."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.sim.autopilot.commands.refusal import CommandRefusedError
from mavstack.sim.autopilot.commands.registration import CommandGroup, Handlers, accept

if TYPE_CHECKING:
    from mavstack.services.command import CommandRequest

_CMD, _RESULT = common.MavCmd, common.MavResult
#: In param 2: do it whatever the checks say.
FORCE = 21196.0


class ArmingCommands(CommandGroup):
    """COMPONENT_ARM_DISARM, RUN_PREARM_CHECKS, DO_FLIGHTTERMINATION."""

    #: What a vehicle answers that may not be armed or disarmed now.
    refusal = _RESULT.FAILED

    def handlers(self) -> Handlers:
        return {
            _CMD.COMPONENT_ARM_DISARM: self.arm_or_disarm,
            _CMD.RUN_PREARM_CHECKS: self.run_checks,
            _CMD.DO_FLIGHTTERMINATION: self.terminate,
        }

    def arm_or_disarm(self, request: CommandRequest) -> common.MavResult:
        """COMPONENT_ARM_DISARM: 1 arms, 0 disarms, anything else is no order."""
        wanted, force = request.command.param1, request.command.param2 == FORCE
        if wanted == 1:
            return self.arm(force=force)
        if wanted == 0:
            return self.disarm(force=force)
        return _RESULT.UNSUPPORTED

    def arm(self, *, force: bool) -> common.MavResult:
        """Arm, or say why not."""
        problems = self.autopilot.arm(force=force)
        for problem in problems:
            self.vehicle.send_statustext(problem, common.MavSeverity.CRITICAL)
        return self.refusal if problems else _RESULT.ACCEPTED

    def disarm(self, *, force: bool) -> common.MavResult:
        """Disarm; in the air only if it is forced."""
        if not self.autopilot.armed:
            return _RESULT.ACCEPTED
        if not force and self.may_not_disarm():
            raise CommandRefusedError(self.refusal, self.may_not_disarm())
        self.autopilot.disarm("commanded")
        return _RESULT.ACCEPTED

    def may_not_disarm(self) -> str:
        """Why it may not be disarmed without force; "" if it may."""
        airborne = self.vehicle.type.flies and not self.autopilot.landed
        return "Disarming denied: not landed" if airborne else ""

    def run_checks(self, request: CommandRequest) -> common.MavResult:
        """RUN_PREARM_CHECKS: says everything that keeps the vehicle from arming."""
        if self.autopilot.armed:
            return _RESULT.TEMPORARILY_REJECTED
        for problem in self.autopilot.profile.arming_problems(self.autopilot):
            self.vehicle.send_statustext(problem, common.MavSeverity.CRITICAL)
        return _RESULT.ACCEPTED

    def terminate(self, request: CommandRequest) -> common.MavResult:
        """DO_FLIGHTTERMINATION: motors off, for good."""
        if request.command.param1 > 0.5:
            self.autopilot.terminate()
        return accept(request.command.param1 > 0.5)
