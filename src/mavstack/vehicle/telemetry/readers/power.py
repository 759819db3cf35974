"""The reader of batteries, from each battery's BATTERY_STATUS, SYS_STATUS, or HIGH_LATENCY2.

BATTERY_STATUS has a slot for each cell. A sender that knows only the sum puts it into the first slot, and the
part that does not fit there into the next ones; then there are no cells.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.vehicle.telemetry.readers.conversions import INT16_MAX, UINT16_MAX, known, scaled
from mavstack.vehicle.telemetry.values import Battery

if TYPE_CHECKING:
    from mavstack.vehicle.telemetry.telemetry import Telemetry

_MILLI, _CENTI = 1000.0, 100.0
#: The voltage of a full slot in millivolts: the rest of the voltage follows in the next slot.
_FULL_SLOT = 65_534
#: The largest voltage of one cell in millivolts: a slot with more holds a sum of cells.
_MAX_CELL_VOLTAGE = 6_000


def read_batteries(telemetry: Telemetry) -> dict[int, Battery]:
    """Return every battery by its id, in their order."""
    batteries = {
        number: _from_message(message) for number, message in sorted(telemetry.battery_messages().items())
    }
    summary = _summary(telemetry)
    if summary is None:
        return batteries
    if not batteries:
        return {0: summary}
    first = next(iter(batteries))
    batteries[first] = _completed(batteries[first], summary)
    return batteries


def _from_message(message: common.BatteryStatus) -> Battery:
    voltage, cells = _voltages(message)
    return Battery(
        id=message.id,
        voltage=voltage,
        current=scaled(message.current_battery, -1, _CENTI),
        remaining=scaled(message.battery_remaining, -1, 1.0),
        consumed=scaled(message.current_consumed, -1, 1.0),
        temperature=scaled(message.temperature, INT16_MAX, _CENTI),
        cells=cells,
        time_remaining=scaled(message.time_remaining, 0, 1.0),
        charge_state=known(message.charge_state, common.MavBatteryChargeState.UNDEFINED),
        faults=message.fault_bitmask,
    )


def _voltages(message: common.BatteryStatus) -> tuple[float | None, tuple[float, ...]]:
    slots = [value for value in message.voltages if value != UINT16_MAX]
    slots += [value for value in message.voltages_ext if value != 0]
    if not slots:
        return None, ()
    is_sum = len(slots) == 1 or slots[0] == _FULL_SLOT or slots[0] > _MAX_CELL_VOLTAGE
    return sum(slots) / _MILLI, () if is_sum else tuple(value / _MILLI for value in slots)


def _summary(telemetry: Telemetry) -> Battery | None:
    match telemetry.finest(common.SysStatus, common.HighLatency2):
        case common.SysStatus() as fine:
            battery = Battery(
                voltage=scaled(fine.voltage_battery, UINT16_MAX, _MILLI),
                current=scaled(fine.current_battery, -1, _CENTI),
                remaining=scaled(fine.battery_remaining, -1, 1.0),
            )
        case common.HighLatency2() as coarse:
            battery = Battery(remaining=scaled(coarse.battery, -1, 1.0))
        case _:
            return None
    return None if battery == Battery() else battery


def _completed(battery: Battery, summary: Battery) -> Battery:
    """Return a battery with the vehicle's summary for the values that its own message lacks."""
    return replace(
        battery,
        voltage=summary.voltage if battery.voltage is None else battery.voltage,
        current=summary.current if battery.current is None else battery.current,
        remaining=summary.remaining if battery.remaining is None else battery.remaining,
    )
