"""An item of a plan, and its two messages.

MISSION_ITEM_INT carries params 5 and 6 as integers, degrees times 1e7 or metres times 1e4; the older
MISSION_ITEM carries them as float32, which for a longitude is precise to about a metre.

The global frames with and without `_INT` mean the same, and the frame of a command without a location has no
meaning: autopilots return the frame that they prefer (ArduPilot: GLOBAL). Two items are therefore equal if
their MISSION_ITEM_INT are equal apart from such frames. `current` is not part of the plan: in a download it
marks the vehicle's current item.

The default frame depends on the command, since PX4 refuses a command without a location in a global frame:
MISSION for such a command, GLOBAL_RELATIVE_ALT for one that has a location.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import isnan, nan
from typing import TYPE_CHECKING, Any

from mavstack.dialects import common
from mavstack.services.addressing import BROADCAST
from mavstack.services.command_names import command_name
from mavstack.services.frames import (
    GLOBAL_FRAMES,
    as_float32,
    commands_with_location,
    from_integer,
    is_known_command,
    scale_of,
    to_integer,
)
from mavstack.services.mission.item_factories import ItemFactories

if TYPE_CHECKING:
    from typing import Self

    from mavstack.services.addressing import Address

#: The default of `MissionItem.frame`; it is replaced by the frame that suits the command.
FRAME_OF_COMMAND = -1
_SYNONYMS: dict[int, int] = {
    common.MavFrame.GLOBAL_INT: common.MavFrame.GLOBAL,
    common.MavFrame.GLOBAL_RELATIVE_ALT_INT: common.MavFrame.GLOBAL_RELATIVE_ALT,
    common.MavFrame.GLOBAL_TERRAIN_ALT_INT: common.MavFrame.GLOBAL_TERRAIN_ALT,
}


@dataclass(frozen=True, slots=True, eq=False)
class MissionItem(ItemFactories):
    """A MAV_CMD in a plan; params 5 and 6 are degrees in a global frame and metres in a local one.

    Without a `frame`, an item with a location has GLOBAL_RELATIVE_ALT, any other one MISSION.
    """

    command: int
    param1: float = 0.0
    param2: float = 0.0
    param3: float = 0.0
    param4: float = 0.0
    param5: float = 0.0
    param6: float = 0.0
    param7: float = 0.0
    frame: int = FRAME_OF_COMMAND
    autocontinue: bool = True
    current: bool = False

    def __post_init__(self) -> None:
        if self.frame == FRAME_OF_COMMAND:
            object.__setattr__(self, "frame", self._default_frame())

    def __eq__(self, other: object) -> bool:
        return isinstance(other, MissionItem) and self.to_bytes() == other.to_bytes()

    def __hash__(self) -> int:
        return hash(self.to_bytes())

    @property
    def name(self) -> str:
        """The command's official name without MAV_CMD_, or its number if unknown."""
        return command_name(self.command)

    @property
    def frame_name(self) -> str:
        """The MAV_FRAME's name without MAV_FRAME_, or its number if unknown."""
        try:
            return common.MavFrame(self.frame).name
        except ValueError:
            return str(int(self.frame))

    @property
    def description(self) -> str:
        """The command and its frame, for errors: NAV_WAYPOINT in frame GLOBAL."""
        return f"{self.name} in frame {self.frame_name}"

    @property
    def location(self) -> tuple[float, float] | None:
        """Latitude and longitude in degrees; None if the item has no location (0, 0 and NaN mean none)."""
        located = self.frame in GLOBAL_FRAMES and self.command in commands_with_location()
        unknown = isnan(self.param5) or isnan(self.param6) or (self.param5 == 0.0 == self.param6)
        return None if unknown or not located else (self.param5, self.param6)

    def to_int(
        self, target: Address, seq: int, plan_type: int, *, current: bool | None = None
    ) -> common.MissionItemInt:
        """Return the MISSION_ITEM_INT; `current` replaces the item's own."""
        scale = scale_of(self.command, self.frame)
        return common.MissionItemInt(
            **self._common_fields(target, seq, plan_type, current),
            x=to_integer(self.param5, scale),
            y=to_integer(self.param6, scale),
        )

    def to_float(
        self, target: Address, seq: int, plan_type: int, *, current: bool | None = None
    ) -> common.MissionItem:
        """Return the MISSION_ITEM, for programs that support nothing newer."""
        return common.MissionItem(
            **self._common_fields(target, seq, plan_type, current),
            x=_single(self.param5),
            y=_single(self.param6),
        )

    @classmethod
    def read(cls, message: common.MissionItemInt | common.MissionItem) -> Self:
        """Return the item in either message."""
        command, frame = int(message.command), int(message.frame)
        if isinstance(message, common.MissionItem):
            position = (message.x, message.y, message.z)
        else:
            scale = scale_of(command, frame)
            position = (from_integer(message.x, scale), from_integer(message.y, scale), message.z)
        first = (message.param1, message.param2, message.param3, message.param4)
        return cls(
            command,
            *first,
            *position,
            frame=frame,
            autocontinue=bool(message.autocontinue),
            current=message.current == 1,
        )

    def to_bytes(self) -> bytes:
        """Return the bytes by which items are compared."""
        message = self.to_int(BROADCAST, 0, 0, current=False)
        frameless = is_known_command(self.command) and self.command not in commands_with_location()
        message.frame = common.MavFrame.MISSION if frameless else _SYNONYMS.get(self.frame, self.frame)
        return message.to_payload()

    def _default_frame(self) -> int:
        has_position = any((self.param5, self.param6, self.param7))
        takes_location = self.command in commands_with_location()
        needs_location = takes_location and self.command < common.MavCmd.NAV_LAST
        # A command that is not known may belong to a user's dialect: then its parameters show whether it has
        # a location.
        may_have_location = takes_location or not is_known_command(self.command)
        located = needs_location or (may_have_location and has_position)
        return common.MavFrame.GLOBAL_RELATIVE_ALT if located else common.MavFrame.MISSION

    def _common_fields(
        self, target: Address, seq: int, plan_type: int, current: bool | None
    ) -> dict[str, Any]:
        return {
            "target_system": target.system,
            "target_component": target.component,
            "seq": seq,
            "frame": self.frame,
            "command": self.command,
            "current": self.current if current is None else current,
            "autocontinue": self.autocontinue,
            "param1": _single(self.param1),
            "param2": _single(self.param2),
            "param3": _single(self.param3),
            "param4": _single(self.param4),
            "z": _single(self.param7),
            "mission_type": plan_type,
        }


def _single(value: float) -> float:
    return nan if isnan(value) else as_float32(value)
