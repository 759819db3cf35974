"""The components that control a gimbal: primary and secondary, as DO_GIMBAL_MANAGER_CONFIGURE assigns them.

    0: no component    -1: unchanged    -2: the sender    -3: the sender gives up control, if it has it

Setpoints of other components are not accepted (guide: gimbal protocol v2). The guide leaves open how the two
are combined: here both may set the gimbal, and the newest setpoint counts.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.services.addressing import Address

if TYPE_CHECKING:
    from mavstack.services.command import Command

UNCHANGED, SENDER, RELEASE = -1, -2, -3
MAX_ID = 255


class GimbalControl:
    """The components in control of one gimbal."""

    def __init__(self) -> None:
        self.primary: Address | None = None
        self.secondary: Address | None = None

    def accepts(self, source: Address) -> bool:
        """Return whether a setpoint of a component counts."""
        return source in (self.primary, self.secondary)

    def configure(self, command: Command, source: Address) -> bool:
        """Assign control by a command; return False if its parameters mean nothing."""
        primary = _assigned((command.param1, command.param2), self.primary, source)
        secondary = _assigned((command.param3, command.param4), self.secondary, source)
        if primary is _INVALID or secondary is _INVALID:
            return False
        self.primary, self.secondary = primary, secondary
        return True


_INVALID = Address(-1, -1)


def _assigned(ids: tuple[float, float], present: Address | None, source: Address) -> Address | None:
    """Return the component that is in control after a command; `_INVALID` for senseless ids."""
    system, component = ids
    if system == UNCHANGED and component == UNCHANGED:
        return present
    if system == SENDER and component == SENDER:
        return source
    if system == RELEASE and component == RELEASE:
        return None if present == source else present
    if not all(0 <= each <= MAX_ID and each == int(each) for each in ids):
        return _INVALID
    return Address(int(system), int(component)) if system and component else None
