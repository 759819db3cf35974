"""iNav on a quad: its modes, its reasons not to arm, its navigation, and its answers to requests."""

from __future__ import annotations

from math import hypot
from typing import TYPE_CHECKING, ClassVar, Final

from mavstack.msp.messages.rc import FailsafeConfig, InavRateProfile, RcDeadband, RxConfig, RxMap
from mavstack.sim.msp.arming import INAV_REASONS
from mavstack.sim.msp.boxes import INAV_BOXES
from mavstack.sim.msp.inav_answers import make_handlers
from mavstack.sim.msp.inav_navigation import NAVIGATION_BOXES, InavNavigation
from mavstack.sim.msp.inav_settings import CLI_SETTINGS, inav_facts
from mavstack.sim.msp.manual_flight import ManualFlight
from mavstack.sim.msp.rates import inav_rate
from mavstack.sim.msp.system import System
from mavstack.sim.msp.waypoints import Mission

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterable, Mapping

    from mavstack.sim.msp.boxes import BoxTable
    from mavstack.sim.msp.cli_settings import SettingTable
    from mavstack.sim.msp.controller import SimulatedFlightController
    from mavstack.sim.msp.port import MspPort
    from mavstack.sim.msp.settings import SettingFacts

#: Maximum roll and pitch for arming, in degrees.
SMALL_ANGLE: Final = 25.0
#: Boxes that are reported as active by the state of the flight, not by their switch.
_FLIGHT_BOXES: Final = frozenset(("ARM", "FAILSAFE", *NAVIGATION_BOXES))


class Inav(System):
    """The running firmware."""

    is_inav: ClassVar[bool] = True
    reasons: ClassVar[Mapping[str, int]] = INAV_REASONS
    boxes: ClassVar[BoxTable] = INAV_BOXES

    def __init__(self, host: SimulatedFlightController, eeprom: bytes) -> None:
        self._navigates = ""
        super().__init__(host, eeprom)
        self._manual = ManualFlight(self.body, self._rates)
        self.configure()

    @classmethod
    def facts(cls) -> SettingFacts:
        """Return the settings and their defaults."""
        return inav_facts()

    @property
    def cli_settings(self) -> SettingTable:
        """The settings by their CLI names."""
        return CLI_SETTINGS

    def _load(self, eeprom: bytes) -> Mission:
        return Mission(tuple(self.settings.decode(eeprom)))

    def make_handlers(self) -> Mapping[int, Callable[[bytes, MspPort], bytes]]:
        """Return the handlers of requests by command."""
        self.navigation = InavNavigation(self, self.mission)
        return make_handlers(self, self.navigation)

    def configure(self) -> None:
        """Apply settings to the receiver and the failsafe."""
        settings = self.settings.get(FailsafeConfig)
        self.failsafe.delay, self.failsafe.recovery = settings.delay, settings.recovery_delay or 0.0
        self.receiver.channel_map = self.settings.get(RxMap).positions

    # --- arming

    def arming_reasons(self) -> Iterable[str]:
        """Return what forbids arming now, without the switch."""
        has_signal = self.receiver.has_signal(self.now)
        checks = (
            ("FAILSAFE_SYSTEM", self.failsafe.is_active),
            ("NOT_LEVEL", self.tilt > SMALL_ANGLE),
            ("SENSORS_CALIBRATING", bool(self.calibrating)),
            ("NAVIGATION_UNSAFE", self._is_navigation_unsafe()),
            ("BOXFAILSAFE", "FAILSAFE" in self.switched_on),
            ("RC_LINK", not has_signal),
            ("THROTTLE", self.receiver.channels[3] >= self.settings.get(RxConfig).min_check),
            ("CLI", self.in_cli),
            ("NO_PREARM", self._has_range("PREARM") and "PREARM" not in self.switched_on),
        )
        return [name for name, holds in checks if holds]

    def _has_range(self, name: str) -> bool:
        number = self.boxes.id_of(name)
        return any(each.is_used and each.permanent_id == number for each in self.settings.mode_ranges)

    def _is_navigation_unsafe(self) -> bool:
        """Return whether navigation is on, or has no position, or a mission that is too far away."""
        if not any(self._has_range(name) for name in NAVIGATION_BOXES):
            return False
        if self.switched_on & frozenset(NAVIGATION_BOXES):
            return True
        return not self.has_fix or self._is_mission_too_far()

    def _is_mission_too_far(self) -> bool:
        limit = self.number("nav_wp_max_safe_distance")
        first = self.navigation.first_place()
        if not limit or first is None:
            return False
        here = self.body.estimate
        return hypot(first[0] - here.north, first[1] - here.east) > limit

    # --- flight

    def step(self, now: float) -> None:
        """Advance to a time; home is where the vehicle has its first fix, and then where it is armed."""
        super().step(now)
        if self.home is None and self.has_fix:
            here = self.body.estimate
            self.home = here.north, here.east
        if not self.arming.armed:
            self._navigates = self.navigation.fly()

    def fly(self) -> None:
        """Fly one step of the armed vehicle."""
        self._navigates = self.navigation.fly()
        if self._navigates:
            return
        deadband = self.settings.get(RcDeadband)
        min_check = self.settings.get(RxConfig).min_check
        sticks = self.receiver.sticks(min_check, deadband.deadband, deadband.yaw_deadband)
        self._manual.fly(sticks, self.switched_on, self.number("max_angle_inclination_rll") / 10)

    def _rates(self, roll: float, pitch: float, yaw: float) -> tuple[float, float, float]:
        """Return the turn rates of the sticks in degrees per second."""
        profile = self.settings.get(InavRateProfile)
        return (
            inav_rate(roll, profile.roll_rate, profile.rc_expo),
            inav_rate(pitch, profile.pitch_rate, profile.rc_expo),
            inav_rate(yaw, profile.yaw_rate, profile.yaw_expo),
        )

    def active_boxes(self) -> Collection[str]:
        """Return the boxes whose bits are set in the status."""
        active = set(self.switched_on - _FLIGHT_BOXES)
        if self.arming.armed:
            active.add("ARM")
        if self.failsafe.is_active:
            active |= {"FAILSAFE", "ANGLE"}
        if self._navigates in NAVIGATION_BOXES:
            active |= {self._navigates, "ANGLE"}
            if self._navigates in ("NAV RTH", "NAV WP", "NAV POSHOLD", "NAV CRUISE"):
                active.add("NAV ALTHOLD")
        return active

    def mode_name(self) -> str:
        """Return the name of the flight mode."""
        active = self.active_boxes()
        names = ("FAILSAFE", *NAVIGATION_BOXES, "ANGLE", "HORIZON")
        return next((name for name in names if name in active), "ACRO")
