"""Commands of the payload: servos, relays, gripper, parachute, winch, sprayer."""

from __future__ import annotations

from math import isfinite
from typing import TYPE_CHECKING

from mavstack.dialects import ardupilotmega, common
from mavstack.sim.autopilot.commands.registration import CommandGroup, Handlers, accept, required_whole, whole

if TYPE_CHECKING:
    from mavstack.services.command import CommandRequest
    from mavstack.sim.autopilot.payload import Payload

_CMD, _RESULT, _ACTIONS = ardupilotmega.MavCmd, common.MavResult, common.GripperActions
MAX_REPETITIONS = 10_000


class EquipmentCommands(CommandGroup):
    """Servos and the devices that they drive."""

    @property
    def payload(self) -> Payload:
        """The payload of the vehicle."""
        return self.autopilot.payload

    def handlers(self) -> Handlers:
        return {
            _CMD.DO_SET_SERVO: self.set_servo,
            _CMD.DO_REPEAT_SERVO: self.repeat_servo,
            _CMD.DO_SET_RELAY: self.set_relay,
            _CMD.DO_REPEAT_RELAY: self.repeat_relay,
            _CMD.DO_GRIPPER: self.grip,
            _CMD.DO_PARACHUTE: self.use_parachute,
            _CMD.DO_WINCH: self.wind,
            _CMD.DO_SPRAYER: self.spray,
        }

    def set_servo(self, request: CommandRequest) -> common.MavResult:
        """DO_SET_SERVO."""
        command = request.command
        return accept(self.payload.set_servo(required_whole(command.param1), required_whole(command.param2)))

    def repeat_servo(self, request: CommandRequest) -> common.MavResult:
        """DO_REPEAT_SERVO."""
        command = request.command
        if not self._may_repeat(command.param3, command.param4):
            return _RESULT.DENIED
        servo, pwm = required_whole(command.param1), required_whole(command.param2)
        return accept(self.payload.repeat_servo(servo, pwm, command.param3, command.param4))

    def set_relay(self, request: CommandRequest) -> common.MavResult:
        """DO_SET_RELAY: 0 off, 1 on."""
        command = request.command
        if command.param2 not in {0.0, 1.0}:
            return _RESULT.DENIED
        return accept(self.payload.set_relay(required_whole(command.param1), on=bool(command.param2)))

    def repeat_relay(self, request: CommandRequest) -> common.MavResult:
        """DO_REPEAT_RELAY."""
        command = request.command
        if not self._may_repeat(command.param2, command.param3):
            return _RESULT.DENIED
        return accept(
            self.payload.repeat_relay(required_whole(command.param1), command.param2, command.param3)
        )

    def grip(self, request: CommandRequest) -> common.MavResult:
        """DO_GRIPPER: open or close."""
        action = whole(request.command.param2)
        if action not in (_ACTIONS.RELEASE, _ACTIONS.GRAB):
            return _RESULT.DENIED
        self.payload.grip(closed=action == _ACTIONS.GRAB)
        return _RESULT.ACCEPTED

    def use_parachute(self, request: CommandRequest) -> common.MavResult:
        """DO_PARACHUTE: disable, enable, release."""
        match whole(request.command.param1):
            case 0:
                self.payload.parachute_enabled = False
            case 1:
                self.payload.parachute_enabled = True
            case 2:
                return accept(self.payload.release_parachute())
            case _:
                return _RESULT.DENIED
        return _RESULT.ACCEPTED

    def wind(self, request: CommandRequest) -> common.MavResult:
        """DO_WINCH: relax, by length, or by speed."""
        command = request.command
        action = whole(command.param2)
        if action not in (0, 1, 2) or not (isfinite(command.param3) and isfinite(command.param4)):
            return _RESULT.DENIED
        self.payload.wind(action, command.param3, command.param4)
        return _RESULT.ACCEPTED

    def spray(self, request: CommandRequest) -> common.MavResult:
        """DO_SPRAYER: 0 off, 1 on."""
        if request.command.param1 not in {0.0, 1.0}:
            return _RESULT.DENIED
        self.payload.sprayer = bool(request.command.param1)
        return _RESULT.ACCEPTED

    def _may_repeat(self, count: float, period: float) -> bool:
        return 0 < count <= MAX_REPETITIONS and isfinite(period) and period > 0
