"""A command and its two messages.

COMMAND_LONG has seven floats and no frame; its repetition has a higher `confirmation`. COMMAND_INT has a
frame, and params 5 and 6 as scaled integers; it has no confirmation and is repeated unchanged. Only the
vehicle's answer tells which of the two it accepts for a command.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.dialects.enums import MavEnum
from mavstack.errors import InvalidArgumentError
from mavstack.services.command_names import command_name
from mavstack.services.frames import commands_with_location, from_integer, scale_of, to_integer

if TYPE_CHECKING:
    from collections.abc import Sequence
    from typing import Self

    from mavstack.services.addressing import Address

#: The frame of a location for which no frame is given: most vehicles read COMMAND_LONG in this frame.
DEFAULT_FRAME = common.MavFrame.GLOBAL_RELATIVE_ALT

PARAMETERS = 7


@dataclass(frozen=True, slots=True)
class Command:
    """A MAV_CMD and its parameters.

    Attributes:
        command: The MAV_CMD.
        param1: Parameter 1; likewise the others. If the command has a location, 5 and 6 are latitude and
            longitude in degrees (or x and y in metres in a local frame), and 7 is the altitude in metres.
        frame: The MAV_FRAME of the location; the command is then sent as COMMAND_INT. None: COMMAND_LONG.
    """

    command: int
    param1: float = 0.0
    param2: float = 0.0
    param3: float = 0.0
    param4: float = 0.0
    param5: float = 0.0
    param6: float = 0.0
    param7: float = 0.0
    frame: int | None = None

    @classmethod
    def of(cls, command: int, params: Sequence[float], frame: int | None = None) -> Self:
        """Return a command with its first parameters; the others are 0.

        Raises:
            InvalidArgumentError: There are more than seven parameters.
        """
        if len(params) > PARAMETERS:
            raise InvalidArgumentError(f"a command has {PARAMETERS} parameters, got {len(params)}")
        one, two, three, four, five, six, seven = (*params, *(0.0,) * (PARAMETERS - len(params)))
        # error texts show the name of an enum member
        number = command if isinstance(command, MavEnum) else int(command)
        return cls(number, one, two, three, four, five, six, seven, frame=frame)

    @property
    def name(self) -> str:
        """The command's official name without MAV_CMD_, or its number if unknown."""
        return command_name(self.command)

    def to_long(self, target: Address, confirmation: int = 0) -> common.CommandLong:
        """Return the COMMAND_LONG."""
        return common.CommandLong(
            target_system=target.system,
            target_component=target.component,
            command=self.command,
            confirmation=confirmation,
            param1=self.param1,
            param2=self.param2,
            param3=self.param3,
            param4=self.param4,
            param5=self.param5,
            param6=self.param6,
            param7=self.param7,
        )

    def to_int(self, target: Address) -> common.CommandInt:
        """Return the COMMAND_INT; a command without a frame gets the default frame."""
        frame = self._integer_frame()
        scale = scale_of(self.command, frame)
        return common.CommandInt(
            target_system=target.system,
            target_component=target.component,
            frame=frame,
            command=self.command,
            param1=self.param1,
            param2=self.param2,
            param3=self.param3,
            param4=self.param4,
            x=to_integer(self.param5, scale),
            y=to_integer(self.param6, scale),
            z=self.param7,
        )

    def supersedes(self, running: Command) -> bool:
        """Return whether this command ends a running one: disarming and termination end an arming."""
        arm_or_disarm = common.MavCmd.COMPONENT_ARM_DISARM
        if running.command != arm_or_disarm or running.param1 == 0:
            return False
        disarms = self.command == arm_or_disarm and self.param1 == 0
        return disarms or (self.command == common.MavCmd.DO_FLIGHTTERMINATION and self.param1 > 0.5)

    def in_frame(self, frame: int | None) -> Self:
        """Return a copy with another frame."""
        return replace(self, frame=frame)

    @classmethod
    def read(cls, message: common.CommandLong | common.CommandInt) -> Self:
        """Return the command in either message."""
        if isinstance(message, common.CommandLong):
            params = (message.param5, message.param6, message.param7)
            frame = None
        else:
            frame = int(message.frame)
            scale = scale_of(message.command, frame)
            params = (from_integer(message.x, scale), from_integer(message.y, scale), message.z)
        first = (message.param1, message.param2, message.param3, message.param4)
        return cls(int(message.command), *first, *params, frame=frame)

    def _integer_frame(self) -> int:
        if self.frame is not None:
            return self.frame
        return DEFAULT_FRAME if self.command in commands_with_location() else common.MavFrame.MISSION
