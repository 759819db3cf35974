"""The parts of a simulated flight controller, as they see each other."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar, Protocol

if TYPE_CHECKING:
    from collections.abc import Collection

    from mavstack.sim.motion import Body
    from mavstack.sim.msp.arming import Arming
    from mavstack.sim.msp.failsafe import Failsafe
    from mavstack.sim.msp.receiver import Receiver
    from mavstack.sim.msp.settings import SettingStore


class Controller(Protocol):
    """A flight controller, as its firmware sees it."""

    body: Body
    receiver: Receiver
    arming: Arming
    failsafe: Failsafe
    settings: SettingStore
    #: Names of the boxes that the pilot has switched on.
    switched_on: frozenset[str]
    #: Home in metres north and east of the local origin; None until it is known.
    home: tuple[float, float] | None
    #: The time of the simulation, and of the last boot, in seconds.
    now: float
    booted_at: float
    #: Pulse widths of the motors while disarmed, in microseconds, as a motor test sets them.
    motor_test: list[int]
    #: True for iNav.
    is_inav: ClassVar[bool]

    @property
    def altitude(self) -> float:
        """Estimated altitude in metres above the place where the controller was armed."""

    @property
    def has_fix(self) -> bool:
        """True if the GPS receiver has a 3D fix."""

    @property
    def calibrating(self) -> Collection[str]:
        """The sensors that are being calibrated: "gyro", "accelerometer", "compass"."""

    @property
    def in_cli(self) -> bool:
        """True if a peer has entered the command line interface since the last boot."""

    def number(self, name: str) -> int:
        """Return the value of a setting by its CLI name."""

    def announce(self, kind: str, text: str) -> None:
        """Tell the listeners of the vehicle of an event."""
