"""Battery failsafes: low and critical, by voltage or by the rest of BATT_CAPACITY.

The condition must hold for BATT_LOW_TIMER seconds, and lasts until disarming, because the voltage recovers
when the motors stop. An action that is less urgent than the one already taken is skipped.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.sim.autopilot.failsafes import Failsafe

if TYPE_CHECKING:
    from mavstack.sim.ardupilot.failsafes.firmware import FirmwareFailsafes

_LEVELS: Final = (("CRT", "critical"), ("LOW", "low"))


class BatteryFailsafes:
    """Low and critical battery; the firmware executes the actions."""

    def __init__(self, firmware: FirmwareFailsafes) -> None:
        self._firmware = firmware
        self._autopilot = firmware.autopilot
        self._urgency = self._lowest_urgency = len(firmware.battery_priorities)
        for level, name in _LEVELS:
            self._autopilot.watches.append(self._failsafe(level, name))

    def _failsafe(self, level: str, name: str) -> Failsafe:
        """Return the failsafe of a level."""
        return Failsafe(
            self._autopilot,
            f"battery {name}",
            lambda: self._is_below(level, name),
            lambda: self._firmware.number("BATT_LOW_TIMER"),
            lambda: self._act(level, name),
            self._on_cleared,
        )

    def _is_below(self, level: str, name: str) -> bool:
        """Return whether the battery is below a level."""
        autopilot, number = self._autopilot, self._firmware.number
        if not autopilot.armed or not number("BATT_MONITOR"):
            return False
        if f"battery {name}" in autopilot.failsafes:
            return True
        if level == "LOW" and "battery critical" in autopilot.failsafes:
            return False
        battery = autopilot.body.battery
        left = number("BATT_CAPACITY") - battery.consumed
        return battery.voltage < number(f"BATT_{level}_VOLT") or left < number(f"BATT_{level}_MAH")

    def _act(self, level: str, name: str) -> None:
        """Report and execute the action of a level."""
        battery, firmware = self._autopilot.body.battery, self._firmware
        firmware.send_statustext(
            f"Battery 1 is {name} {battery.voltage:.2f}V used {battery.consumed:.0f} mAh"
        )
        action = int(firmware.number(f"BATT_FS_{level}_ACT"))
        order = firmware.battery_priorities
        urgency = order.index(action) if action in order else self._lowest_urgency
        if urgency <= self._urgency:
            self._urgency = urgency
            firmware.battery_failsafe(name, action)

    def _on_cleared(self) -> None:
        """Reset the urgency after disarming."""
        if not self._autopilot.armed:
            self._urgency = self._lowest_urgency
