"""Arming, modes and sticks by RC channels, where the receiver of the flight controller takes them by MSP.

Betaflight and iNav have no command to arm: a channel arms them. The pilot here sends all channels at a steady
rate while a MAVLink component is in control, and gives up control by the dead-man rule of `rc_channels`. A
component takes control by arming, by a mode, or by sticks; another one is refused meanwhile. Arming keeps to
the checks of the firmware: the reasons are reported, and never overridden.
"""

from __future__ import annotations

import asyncio
import logging
from typing import TYPE_CHECKING, Final

from mavstack.bridges.msp.arming_reasons import PREFIX, reason_texts
from mavstack.bridges.msp.boxes import ARM, BEEPER
from mavstack.bridges.msp.rc_channels import DEFAULT_RATE, RcChannels
from mavstack.dialects import common
from mavstack.errors import InvalidStateError, LinkError, MspError, RemoteCancelled
from mavstack.msp import Priority
from mavstack.msp.messages.rc import SetRawRc

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.bridges.msp.controller_facts import ControllerFacts
    from mavstack.bridges.msp.flight_controller import FlightController
    from mavstack.bridges.msp.mode_switches import Switch
    from mavstack.bridges.msp.status import ControllerStatus
    from mavstack.services import Address
    from mavstack.services.manual_control import ManualInput

#: Seconds in which the reasons not to arm must end after the bridge begins to send channels.
READY_TIMEOUT: Final = 6.0
#: Seconds in which the firmware must arm, disarm or enter a mode after its switch moved.
SWITCH_TIMEOUT: Final = 2.0
#: Seconds for which the beeper sounds.
BEEP_TIME: Final = 1.0
#: Seconds for which the firmware must see the arm switch off before the bridge switches it on.
_SETTLING_TIME: Final = 0.3
_CHECK_INTERVAL: Final = 0.02
_SEND_TIMEOUT: Final = 0.2

_RESULT: Final = common.MavResult

logger = logging.getLogger("mavstack.bridges.msp")


class Pilot:
    """The RC channels of one flight controller.

    Args:
        controller: The flight controller.
        channels: The channels.
        status: Returns its latest status.
        report: Sends a status text with a MAV_SEVERITY.
        now: Returns the time of the node, Unix seconds.
    """

    def __init__(
        self,
        controller: FlightController,
        channels: RcChannels,
        *,
        status: Callable[[], ControllerStatus],
        report: Callable[[str, int], None],
        now: Callable[[], float],
    ) -> None:
        self._controller, self._channels = controller, channels
        self._status, self._report, self._now = status, report, now
        self._facts: ControllerFacts | None = None
        self._wake = asyncio.Event()
        self._manual = False
        #: The event loop time until which the firmware may still arm.
        self._may_arm_until = 0.0
        #: The switch positions for the latest mode that was requested.
        self._mode_pulses: dict[int, int] = {}

    @property
    def is_possible(self) -> bool:
        """True if the receiver of the flight controller takes channels by MSP."""
        return self._facts is not None and self._facts.receives_msp

    @property
    def in_control(self) -> bool:
        """True while channels are sent."""
        return self._channels.pilot is not None

    def set_facts(self, facts: ControllerFacts) -> None:
        """Take the facts of the flight controller, new ones after a restart."""
        self._facts = facts
        self._channels.release_control()
        if facts.has_channel_map:
            self._channels.channel_map = facts.channel_map

    # The transmitter

    async def run(self) -> None:
        """Send the channels at a steady rate while a component is in control, for ever."""
        loop = asyncio.get_running_loop()
        due = loop.time()
        while True:
            if not self.in_control:
                self._wake.clear()
                await self._wake.wait()
                due = loop.time()
            if self._channels.check_pilot(self._now()):
                self._manual = False
                self._report("RC channels stopped: no component is in control", common.MavSeverity.WARNING)
                continue
            await self._send_channels()
            due = max(due + 1 / DEFAULT_RATE, loop.time())
            await asyncio.sleep(due - loop.time())

    async def _send_channels(self) -> None:
        message = SetRawRc(tuple(self._channels.pulses()))
        try:
            await self._controller.send(message, priority=Priority.CONTROL, timeout=_SEND_TIMEOUT)
        except (MspError, LinkError, RemoteCancelled, InvalidStateError) as error:
            logger.debug("%s", error)

    # Signs of life

    def sign_of_life(self, source: Address) -> None:
        """Note a heartbeat; it keeps the control of a component that moves no sticks."""
        if not self._manual:
            self._channels.sign_of_life(source, self._now())

    def end_manual(self, source: Address) -> None:
        """Give up control, because the component that moved the sticks moves them no more."""
        if source == self._channels.pilot and self._manual:
            self._manual = False
            self._channels.release_control()
            self._report("RC channels stopped: sticks are lost", common.MavSeverity.WARNING)

    # Sticks

    def move_sticks(self, source: Address, sticks: ManualInput) -> None:
        """Move the sticks: MANUAL_CONTROL, whose z is the throttle."""
        if self._take(source):
            self._manual = True
            self._channels.set_sticks(roll=sticks.y, pitch=sticks.x, yaw=sticks.r, throttle=sticks.z)

    def override(self, source: Address, channels: dict[int, int]) -> None:
        """Override channels; empty: none any more."""
        if self._take(source):
            self._manual = True
            self._channels.set_overrides(channels)

    # Commands

    async def arm(self, source: Address) -> common.MavResult:
        """Arm; the status texts name the reasons of a refusal. If it is cancelled, the switch moves back."""
        if self._status().armed:
            return _RESULT.ACCEPTED
        switch = self._facts.switches.find(ARM) if self._facts is not None else None
        if (reason := self._refusal(source)) is not None or switch is None:
            return self._refuse_arming(reason or "no channel is set up as its arm switch")
        result: common.MavResult | None = None
        try:
            result = await self._arm_by(switch, source)
        finally:  # also when a disarm request cancels this task
            if result != _RESULT.ACCEPTED and self._channels.may_control(source):
                self._switch_off(ARM)
            self._may_arm_until = asyncio.get_running_loop().time() + _SETTLING_TIME
        return result

    async def _arm_by(self, switch: Switch, source: Address) -> common.MavResult:
        was_in_control = self.in_control
        self._take(source)
        self._switch_off(ARM)  # ARM may still be on if the firmware disarmed by itself
        if not was_in_control:
            await asyncio.sleep(_SETTLING_TIME)
        if not await self._wait(lambda: not self._status().failed_checks(by_channels=False), READY_TIMEOUT):
            return self._report_reasons()
        if self._channels.pilot != source:
            return self._refuse_arming("control was lost meanwhile")
        if not self._channels.throttle_is_low():
            return self._refuse_arming("throttle is not low")
        self._channels.set_aux(switch.aux, switch.middle)
        armed = await self._wait(lambda: self._status().armed, SWITCH_TIMEOUT)
        return _RESULT.ACCEPTED if armed else self._report_reasons()

    async def disarm(self, source: Address) -> common.MavResult:
        """Disarm; an arming that waited for the firmware was cancelled by the command server before."""
        armed, in_control = self._status().armed, self._channels.pilot == source
        if armed and not in_control:
            self._report("Disarm: the transmitter in control disarms it", common.MavSeverity.WARNING)
            return _RESULT.DENIED
        if in_control:
            self._switch_off(ARM)
        settling_time = max(0.0, self._may_arm_until - asyncio.get_running_loop().time())
        if not (armed or settling_time):
            return _RESULT.ACCEPTED
        return await self._wait_until_disarmed(settling_time)

    async def _wait_until_disarmed(self, settling_time: float) -> common.MavResult:
        before = self._status()
        await asyncio.sleep(settling_time)  # the firmware may arm before it sees that the switch is off
        if await self._wait(
            lambda: self._status() is not before and not self._status().armed, SWITCH_TIMEOUT
        ):
            return _RESULT.ACCEPTED
        self._report("Disarm: the firmware did not disarm", common.MavSeverity.CRITICAL)
        return _RESULT.FAILED

    async def set_mode(self, source: Address, custom_mode: int) -> str | None:
        """Enter a flight mode; returns the reason of a refusal, None if it was entered."""
        facts = self._facts
        if (reason := self._refusal(source)) is not None or facts is None:
            return reason or "not connected"
        flight_modes = facts.boxes.flight_modes()
        pulses = facts.switches.pulses_for(custom_mode, flight_modes)
        if pulses is None:
            return f"no channel is set up for {facts.boxes.name(custom_mode)}"
        if not facts.switches.channels(ARM).isdisjoint(pulses):
            return "its channel is that of arming"
        self._take(source)
        before = {aux: self._channels.aux(aux) for aux in pulses}
        self._mode_pulses = pulses
        self._move_switches(pulses)
        boxes = facts.boxes
        if await self._wait(lambda: boxes.custom_mode(self._status().active) == custom_mode, SWITCH_TIMEOUT):
            return None
        if self._mode_pulses is pulses:  # unless a later request moved the switches
            self._move_switches(before)
        return "the firmware did not enter it"

    async def beep(self, source: Address) -> str | None:
        """Sound the beeper by its switch; returns the reason of a refusal."""
        reason, facts = self._refusal(source), self._facts
        switch = facts.switches.find(BEEPER) if facts is not None else None
        if reason is not None or facts is None or switch is None:
            return reason or "no channel is set up for the beeper"
        if switch.aux in facts.switches.channels(ARM):
            return "its channel is that of arming"
        self._take(source)
        before = self._channels.aux(switch.aux)
        self._channels.set_aux(switch.aux, switch.middle)
        await asyncio.sleep(BEEP_TIME)
        if self._channels.aux(switch.aux) == switch.middle:  # unless a mode or another tune moved it
            self._channels.set_aux(switch.aux, before)
        return None

    # Parts

    def _refusal(self, source: Address) -> str | None:
        if not self.is_possible:
            return "only its transmitter can (no MSP receiver)"
        if self._facts is not None and not self._facts.has_channel_map:
            return "its channel map is not known"
        if not self._channels.may_control(source):
            return f"component {self._channels.pilot} is in control"
        if self._facts is not None and self._facts.switches.off_pulses(ARM) is None:
            return "its arm switch has no off position"
        return None

    def _take(self, source: Address) -> bool:
        if self._refusal(source) is not None:
            return False
        if not self.in_control:
            self._switch_off(ARM)  # all switches are low at first, and low may mean on
        self._channels.take_control(source, self._now())
        self._wake.set()
        return True

    def _move_switches(self, pulses: dict[int, int]) -> None:
        for aux, pulse in pulses.items():
            self._channels.set_aux(aux, pulse)

    def _switch_off(self, box: int) -> None:
        if self._facts is not None:
            self._move_switches(self._facts.switches.off_pulses(box) or {})

    def _refuse_arming(self, reason: str) -> common.MavResult:
        self._report(f"{PREFIX}{reason}", common.MavSeverity.WARNING)
        return _RESULT.DENIED

    def _report_reasons(self) -> common.MavResult:
        texts = reason_texts(self._status().reasons) or (f"{PREFIX}the firmware did not arm",)
        for text in texts:
            self._report(text, common.MavSeverity.WARNING)
        return _RESULT.FAILED

    async def _wait(self, condition: Callable[[], bool], seconds: float) -> bool:
        """Wait until a status fulfils a condition; returns False if none does in time."""
        loop = asyncio.get_running_loop()
        end = loop.time() + seconds
        while not condition():
            if loop.time() >= end:
                return False
            await asyncio.sleep(_CHECK_INTERVAL)
        return True
