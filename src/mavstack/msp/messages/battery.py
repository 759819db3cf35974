"""Battery: voltage, current and charge, the meters, and their settings."""

from __future__ import annotations

from enum import IntEnum

from mavstack.msp.commands import MspCommand
from mavstack.msp.messages.fields import Record, i16, items_of, record, u8, u16, u32
from mavstack.msp.messages.layout import BETAFLIGHT_ONLY, INAV_ONLY, TableMessage, reply, request


class BatteryAlert(IntEnum):
    """State of the battery; iNav has no INIT."""

    OK = 0
    WARNING = 1
    CRITICAL = 2
    NOT_PRESENT = 3
    INIT = 4


@reply(MspCommand.MSP_ANALOG)
class Analog(TableMessage):
    """Voltage, current, charge and the strength of the radio signal.

    `coarse_voltage` ends at 25.5 V; `voltage` is more accurate where the firmware sends it.
    `rssi` is 0 to 1023.
    """

    coarse_voltage: float = u8(10, "V")
    consumed_charge: int = u16(unit="mAh")
    rssi: int = u16()
    current: float = i16(100, "A")
    voltage: float | None = u16(100, "V", since="1.41", variant="BTFL", default=None)


@reply(MspCommand.MSP2_INAV_ANALOG, INAV_ONLY)
class InavAnalog(TableMessage):
    """Voltage, current, charge, energy and the strength of the radio signal of iNav; `rssi` is 0 to 1023."""

    flags: int = u8()
    voltage: float = u16(100, "V")
    current: float = i16(100, "A")
    power: float = u32(100, "W")
    consumed_charge: int = u32(unit="mAh")
    consumed_energy: float = u32(1000, "Wh")
    remaining_capacity: int = u32(unit="mAh")
    remaining: int = u8(unit="%")
    rssi: int = u16()

    @property
    def was_full(self) -> bool:
        """True if the battery was full when it was connected."""
        return bool(self.flags & 1)

    @property
    def alert(self) -> BatteryAlert:
        """State of the battery."""
        return BatteryAlert(self.flags >> 2 & 3)

    @property
    def cell_count(self) -> int:
        """Number of cells; 0 if no battery is found."""
        return self.flags >> 4


@reply(MspCommand.MSP_BATTERY_STATE)
class BatteryState(TableMessage):
    """Cells, capacity, voltage, current and charge; `cell_count` is 0 if no battery is found."""

    cell_count: int = u8()
    capacity: int = u16(unit="mAh")
    coarse_voltage: float = u8(10, "V")
    consumed_charge: int = u16(unit="mAh")
    current: float = i16(100, "A")
    alert: BatteryAlert = u8(kind=BatteryAlert)
    voltage: float | None = u16(100, "V", since="1.41", default=None)


@reply(MspCommand.MSP_BATTERY_CONFIG, BETAFLIGHT_ONLY)
class BatteryConfig(TableMessage):
    """Voltages of a cell, capacity, and the sources of the measurements.

    The first three fields have steps of 0.1 V; the last three repeat them in steps of 0.01 V and take
    precedence.
    """

    coarse_cell_min: float = u8(10, "V")
    coarse_cell_max: float = u8(10, "V")
    coarse_cell_warning: float = u8(10, "V")
    capacity: int = u16(unit="mAh")
    voltage_source: int = u8()
    current_source: int = u8()
    cell_min: float | None = u16(100, "V", since="1.41", default=None)
    cell_max: float | None = u16(100, "V", since="1.41", default=None)
    cell_warning: float | None = u16(100, "V", since="1.41", default=None)


@request(MspCommand.MSP_SET_BATTERY_CONFIG, BETAFLIGHT_ONLY)
class SetBatteryConfig(BatteryConfig):
    """Set the voltages of a cell, the capacity, and the sources of the measurements."""


@reply(MspCommand.MSP2_INAV_BATTERY_CONFIG, INAV_ONLY)
class InavBatteryConfig(TableMessage):
    """Voltages of a cell, capacity and meters of iNav; with `capacity_unit` 1 capacities are in mWh."""

    voltage_scale: int = u16()
    voltage_source: int = u8()
    cell_count: int = u8()
    cell_detect: float = u16(100, "V")
    cell_min: float = u16(100, "V")
    cell_max: float = u16(100, "V")
    cell_warning: float = u16(100, "V")
    current_offset: int = i16(unit="mV")
    current_scale: int = i16()
    capacity: int = u32()
    capacity_warning: int = u32()
    capacity_critical: int = u32()
    capacity_unit: int = u8()


@request(MspCommand.MSP2_INAV_SET_BATTERY_CONFIG, INAV_ONLY)
class SetInavBatteryConfig(InavBatteryConfig):
    """Set the voltages of a cell, the capacity and the meters of iNav."""


@record
class VoltageMeter(Record):
    """Voltage of one meter."""

    meter_id: int = u8()
    voltage: float = u8(10, "V")


@reply(MspCommand.MSP_VOLTAGE_METERS, BETAFLIGHT_ONLY)
class VoltageMeters(TableMessage):
    """Voltages of all meters."""

    meters: tuple[VoltageMeter, ...] = items_of(VoltageMeter)


@record
class CurrentMeter(Record):
    """Current and charge of one meter."""

    meter_id: int = u8()
    consumed_charge: int = u16(unit="mAh")
    current: float = u16(1000, "A")


@reply(MspCommand.MSP_CURRENT_METERS, BETAFLIGHT_ONLY)
class CurrentMeters(TableMessage):
    """Currents and charges of all meters."""

    meters: tuple[CurrentMeter, ...] = items_of(CurrentMeter)


@record
class VoltageMeterSettings(Record):
    """Divider of one voltage meter."""

    size: int = u8()
    meter_id: int = u8()
    sensor_type: int = u8()
    scale: int = u8()
    divider: int = u8()
    multiplier: int = u8()


@reply(MspCommand.MSP_VOLTAGE_METER_CONFIG, BETAFLIGHT_ONLY)
class VoltageMeterConfig(TableMessage):
    """Dividers of the voltage meters."""

    meters: tuple[VoltageMeterSettings, ...] = items_of(VoltageMeterSettings, counted=True)


@request(MspCommand.MSP_SET_VOLTAGE_METER_CONFIG, BETAFLIGHT_ONLY)
class SetVoltageMeterConfig(TableMessage):
    """Set the divider of one voltage meter."""

    meter_id: int = u8()
    scale: int = u8()
    divider: int = u8()
    multiplier: int = u8()


@record
class CurrentMeterSettings(Record):
    """Scale of one current meter."""

    size: int = u8()
    meter_id: int = u8()
    sensor_type: int = u8()
    scale: int = i16()
    current_offset: int = i16(unit="mA")


@reply(MspCommand.MSP_CURRENT_METER_CONFIG, BETAFLIGHT_ONLY)
class CurrentMeterConfig(TableMessage):
    """Scales of the current meters."""

    meters: tuple[CurrentMeterSettings, ...] = items_of(CurrentMeterSettings, counted=True)


@request(MspCommand.MSP_SET_CURRENT_METER_CONFIG, BETAFLIGHT_ONLY)
class SetCurrentMeterConfig(TableMessage):
    """Set the scale of one current meter."""

    meter_id: int = u8()
    scale: int = i16()
    current_offset: int = i16(unit="mA")
