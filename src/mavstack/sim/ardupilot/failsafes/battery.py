"""The battery of an armed vehicle, low or critical by its voltage or by what is left of BATT_CAPACITY.

It must be so for BATT_LOW_TIMER seconds, and stays so until the motors are disarmed: the voltage rises when
they rest. An action that is less urgent than the one that was taken is not taken any more.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.sim.autopilot.failsafes import Failsafe

if TYPE_CHECKING:
    from mavstack.sim.ardupilot.failsafes.firmware import FirmwareFailsafes

_LEVELS: Final = (("CRT", "critical"), ("LOW", "low"))


class BatteryFailsafes:
    """Low and critical; what is done is the firmware's."""

    def __init__(self, firmware: FirmwareFailsafes) -> None:
        self._firmware = firmware
        self._autopilot = firmware.autopilot
        self._urgency = self._least = len(firmware.battery_priorities)
        for level, word in _LEVELS:
            self._autopilot.watches.append(self._failsafe(level, word))

    def _failsafe(self, level: str, word: str) -> Failsafe:
        return Failsafe(
            self._autopilot,
            f"battery {word}",
            lambda: self._is_below(level, word),
            lambda: self._firmware.number("BATT_LOW_TIMER"),
            lambda: self._act(level, word),
            self._over,
        )

    def _is_below(self, level: str, word: str) -> bool:
        autopilot, number = self._autopilot, self._firmware.number
        if not autopilot.armed or not number("BATT_MONITOR"):
            return False
        if f"battery {word}" in autopilot.failsafes:
            return True
        if level == "LOW" and "battery critical" in autopilot.failsafes:
            return False
        battery = autopilot.body.battery
        left = number("BATT_CAPACITY") - battery.consumed
        return battery.voltage < number(f"BATT_{level}_VOLT") or left < number(f"BATT_{level}_MAH")

    def _act(self, level: str, word: str) -> None:
        battery, firmware = self._autopilot.body.battery, self._firmware
        firmware.send_statustext(
            f"Battery 1 is {word} {battery.voltage:.2f}V used {battery.consumed:.0f} mAh"
        )
        action = int(firmware.number(f"BATT_FS_{level}_ACT"))
        order = firmware.battery_priorities
        urgency = order.index(action) if action in order else self._least
        if urgency <= self._urgency:
            self._urgency = urgency
            firmware.battery_failsafe(word, action)

    def _over(self) -> None:
        if not self._autopilot.armed:
            self._urgency = self._least
