"""Messages of devices: ArduPilot's generator and engine, which GEN_TYPE and EFI_TYPE fit, and a modem."""

from __future__ import annotations

from math import nan
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common

if TYPE_CHECKING:
    from mavstack.dialects import Message
    from mavstack.sim.telemetry.view import VehicleView

_FLAG: Final = common.MavGeneratorStatusFlag
#: Engine speeds at idle and at full throttle, in revolutions per minute.
_IDLE, _FULL = 1800.0, 6500.0
#: Fuel flow at idle and at full throttle in cm3/min. Temperatures in degrees Celsius: engine off, engine
#: idle, and increase from idle to full throttle.
_IDLE_FLOW, _FULL_FLOW = 3.0, 30.0
_COLD, _WARM, _HOT = 20.0, 90.0, 60.0
_GENERATOR_POWER: Final = 1200.0
_GENERATOR_SPEED: Final = 7000
_MAINTENANCE: Final = 100 * 3600


class DeviceMessages:
    """Producers of messages about devices."""

    def __init__(self, view: VehicleView) -> None:
        self._view = view
        self._body = view.body
        self._consumed = 0.0
        self._measured_at: float | None = None

    def generator_if_fitted(self, now: float) -> Message | None:
        """Return GENERATOR_STATUS if GEN_TYPE is set: it runs while the vehicle is armed."""
        if not self._view.parameter("GEN_TYPE", 0.0):
            return None
        runs, battery = self._view.autopilot.armed, self._body.battery
        load = battery.current if runs else 0.0
        return common.GeneratorStatus(
            status=_FLAG.GENERATING | _FLAG.CHARGING if runs else _FLAG.OFF | _FLAG.READY,
            generator_speed=_GENERATOR_SPEED if runs else 0,
            battery_current=2.0 if runs else 0.0,
            load_current=load,
            power_generated=min((load + 2.0) * battery.voltage, _GENERATOR_POWER) if runs else 0.0,
            bus_voltage=battery.voltage,
            rectifier_temperature=45,
            bat_current_setpoint=nan,
            generator_temperature=80 if runs else 20,
            runtime=int(self._view.vehicle.uptime),
            time_until_maintenance=_MAINTENANCE - int(self._view.vehicle.uptime),
        )

    def engine_if_fitted(self, now: float) -> Message | None:
        """Return EFI_STATUS if EFI_TYPE is set: it runs while the vehicle is armed."""
        if not self._view.parameter("EFI_TYPE", 0.0):
            return None
        runs = self._view.autopilot.armed
        throttle = min(max(self._body.throttle, 0.0), 1.0) if runs else 0.0
        flow = _IDLE_FLOW + (_FULL_FLOW - _IDLE_FLOW) * throttle if runs else 0.0
        if self._measured_at is not None:
            self._consumed += flow * max(now - self._measured_at, 0.0) / 60.0
        self._measured_at = now
        return common.EfiStatus(
            health=1,
            rpm=_IDLE + (_FULL - _IDLE) * throttle if runs else 0.0,
            fuel_consumed=self._consumed,
            fuel_flow=flow,
            engine_load=throttle * 100.0,
            throttle_position=throttle * 100.0,
            barometric_pressure=self._view.sensors.pressure / 10.0,
            intake_manifold_pressure=self._view.sensors.pressure / 10.0 * (0.4 + 0.6 * throttle),
            intake_manifold_temperature=_COLD,
            cylinder_head_temperature=_WARM + _HOT * throttle if runs else _COLD,
            exhaust_gas_temperature=(_WARM + _HOT * throttle) * 4 if runs else _COLD,
            throttle_out=throttle * 100.0,
            ignition_voltage=nan,
            fuel_pressure=nan,
        )

    def modem(self, now: float) -> Message:
        """Return CELLULAR_STATUS of a modem with LTE."""
        return common.CellularStatus(
            status=common.CellularStatusFlag.CONNECTED,
            type=common.CellularNetworkRadioType.LTE,
            quality=76,
            mcc=228,
            mnc=1,
            id=1,
            rx_level=-84.0,
        )
