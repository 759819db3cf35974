"""Betaflight 4.5 on a quad: its modes, its reasons not to arm, its failsafe, and its answers to requests."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar, Final

from mavstack.msp.messages.gps import GpsRescue
from mavstack.msp.messages.pid import PidAdvanced
from mavstack.msp.messages.rc import FailsafeConfig, FailsafeProcedure, RcDeadband, RcTuning, RxConfig, RxMap
from mavstack.sim.msp.arming import BETAFLIGHT_REASONS
from mavstack.sim.msp.betaflight_answers import make_handlers
from mavstack.sim.msp.betaflight_settings import CLI_SETTINGS, betaflight_facts
from mavstack.sim.msp.boxes import BETAFLIGHT_BOXES
from mavstack.sim.msp.gps_rescue import rescue
from mavstack.sim.msp.manual_flight import ManualFlight
from mavstack.sim.msp.rates import ACTUAL_RATES, actual_rate, betaflight_rate
from mavstack.sim.msp.scripts import LandingSpeeds, Script, land
from mavstack.sim.msp.system import System
from mavstack.sim.msp.waypoints import Mission

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterable, Mapping

    from mavstack.sim.msp.boxes import BoxTable
    from mavstack.sim.msp.cli_settings import SettingTable
    from mavstack.sim.msp.controller import SimulatedFlightController
    from mavstack.sim.msp.port import MspPort
    from mavstack.sim.msp.settings import SettingFacts

#: Seconds after boot in which the vehicle cannot arm.
BOOT_GRACE_TIME: Final = 5.0
#: Maximum roll and pitch for arming, in degrees.
SMALL_ANGLE: Final = 25.0
#: Seconds for which the signal must be present until the pilot has control again.
RECOVERY_TIME: Final = 1.0
_LANDING: Final = LandingSpeeds(2.0, 1.0, 3.0)
#: Boxes that are reported as active by the state of the flight, not by their switch.
_FLIGHT_BOXES: Final = frozenset(("ARM", "GPS RESCUE", "FAILSAFE"))


class Betaflight(System):
    """The running firmware."""

    is_inav: ClassVar[bool] = False
    reasons: ClassVar[Mapping[str, int]] = BETAFLIGHT_REASONS
    boxes: ClassVar[BoxTable] = BETAFLIGHT_BOXES

    def __init__(self, host: SimulatedFlightController, eeprom: bytes) -> None:
        self._script = Script()
        self._had_signal = False
        self._must_switch_off = False
        self._rescues = False
        super().__init__(host, eeprom)
        self._manual = ManualFlight(self.body, self._rates)
        self.configure()

    @classmethod
    def facts(cls) -> SettingFacts:
        """Return the settings and their defaults."""
        return betaflight_facts()

    @property
    def cli_settings(self) -> SettingTable:
        """The settings by their CLI names."""
        return CLI_SETTINGS

    def _load(self, eeprom: bytes) -> Mission:
        self.settings.decode(eeprom)
        return Mission()

    def make_handlers(self) -> Mapping[int, Callable[[bytes, MspPort], bytes]]:
        """Return the handlers of requests by command."""
        return make_handlers(self)

    def configure(self) -> None:
        """Apply settings to the receiver and the failsafe."""
        self.failsafe.delay = self.settings.get(FailsafeConfig).delay
        self.failsafe.recovery = RECOVERY_TIME
        self.receiver.channel_map = self.settings.get(RxMap).positions

    # --- arming

    def arming_reasons(self) -> Iterable[str]:
        """Return what forbids arming now, without the switch."""
        has_signal, armed_switch = self.receiver.has_signal(self.now), "ARM" in self.switched_on
        if has_signal and not self._had_signal and armed_switch:
            self._must_switch_off = True
        elif has_signal and not armed_switch:
            self._must_switch_off = False
        self._had_signal = has_signal
        rescue_settings = self.settings.get(GpsRescue)
        satellites = self.body.sensors.gps_satellites
        checks = (
            ("FAILSAFE", self.failsafe.is_active),
            ("RX_FAILSAFE", not has_signal),
            ("NOT_DISARMED", self._must_switch_off),
            ("BOXFAILSAFE", "FAILSAFE" in self.switched_on),
            ("THROTTLE", self.receiver.channels[3] >= self._min_check),
            ("ANGLE", self.tilt > SMALL_ANGLE),
            ("BOOT_GRACE_TIME", self.now - self.booted_at < BOOT_GRACE_TIME),
            ("NOPREARM", self._has_range("PREARM") and "PREARM" not in self.switched_on),
            ("CALIBRATING", bool(self.calibrating)),
            ("CLI", self.in_cli),
            ("MSP", bool(self.arming_disabled_by)),
            ("PARALYZE", "PARALYZE" in self.switched_on),
            (
                "GPS",
                self._uses_rescue()
                and not rescue_settings.allow_arming_without_fix
                and not self.arming.was_ever_armed
                and not (self.has_fix and satellites >= rescue_settings.min_satellites),
            ),
            ("RESC", "GPS RESCUE" in self.switched_on),
        )
        return [name for name, holds in checks if holds]

    def _has_range(self, name: str) -> bool:
        number = self.boxes.id_of(name)
        return any(each.is_used and each.permanent_id == number for each in self.settings.mode_ranges)

    def _uses_rescue(self) -> bool:
        procedure = self.settings.get(FailsafeConfig).procedure
        return procedure == FailsafeProcedure.GPS_RESCUE or self._has_range("GPS RESCUE")

    @property
    def _min_check(self) -> int:
        return self.settings.get(RxConfig).min_check

    # --- flight

    def fly(self) -> None:
        """Fly one step of the armed vehicle."""
        self._rescues = False
        if self.failsafe.is_active:
            self._fly_failsafe()
        elif "GPS RESCUE" in self.switched_on and self.has_fix and self.home is not None:
            self._fly_rescue()
        else:
            self._script.stop()
            deadband = self.settings.get(RcDeadband)
            sticks = self.receiver.sticks(self._min_check, deadband.deadband, deadband.yaw_deadband)
            limit = self.settings.get(PidAdvanced).angle_limit or 60
            self._manual.fly(sticks, self.switched_on, limit)

    def _fly_failsafe(self) -> None:
        procedure = self.settings.get(FailsafeConfig).procedure
        if procedure == FailsafeProcedure.GPS_RESCUE and self.has_fix and self.home is not None:
            self._fly_rescue()
        elif procedure == FailsafeProcedure.AUTO_LANDING:
            self._script.run("failsafe", lambda: land(self.body, _LANDING), self.now)
            if self._script.is_done:
                self.arming.disarm("failsafe")
        else:
            self.arming.disarm("failsafe")

    def _fly_rescue(self) -> None:
        self._rescues = True
        if self.body.on_ground and not self._script.name:
            self.arming.disarm("GPS rescue on the ground")
            return
        self._script.run("rescue", lambda: rescue(self), self.now)

    def _rates(self, roll: float, pitch: float, yaw: float) -> tuple[float, float, float]:
        """Return the turn rates of the sticks in degrees per second."""
        tuning = self.settings.get(RcTuning)
        curve = actual_rate if tuning.rates_type == ACTUAL_RATES else betaflight_rate
        return (
            curve(roll, tuning.rc_rate, tuning.roll_rate, tuning.rc_expo),
            curve(pitch, tuning.pitch_rc_rate or 0, tuning.pitch_rate, tuning.pitch_expo or 0),
            curve(yaw, tuning.yaw_rc_rate or 0, tuning.yaw_rate, tuning.yaw_expo or 0),
        )

    def active_boxes(self) -> Collection[str]:
        """Return the boxes whose bits are set in the status."""
        states = {"ARM": self.arming.armed, "GPS RESCUE": self._rescues, "FAILSAFE": self.failsafe.is_active}
        active = set(self.switched_on - _FLIGHT_BOXES)
        active |= {
            name for name, holds in states.items() if holds and (self.arming.armed or name == "FAILSAFE")
        }
        if states["FAILSAFE"]:
            active.add("ANGLE")
        return active

    def mode_name(self) -> str:
        """Return the name of the flight mode."""
        active = self.active_boxes()
        names = ("FAILSAFE", "GPS RESCUE", "ANGLE", "HORIZON")
        return next((name for name in names if name in active), "ACRO")
