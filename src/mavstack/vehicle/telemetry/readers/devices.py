"""The readers of devices that report about themselves: motor controllers, generator, engine, modem.

PX4 sends ESC_INFO and ESC_STATUS for each four motor controllers, ArduPilot ESC_TELEMETRY_1_TO_4 and its
followers, whose values are whole numbers.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.dialects import ardupilotmega, common
from mavstack.vehicle.telemetry.readers.conversions import INT16_MAX, INT32_MAX, UINT16_MAX, finite, scaled
from mavstack.vehicle.telemetry.values import Engine, Esc, Generator, Modem

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.vehicle.telemetry.telemetry import Telemetry

_CENTI: Final = 100.0
_UINT32_MAX: Final = 0xFFFFFFFF
_UINT8_MAX: Final = 0xFF
_PER_MESSAGE: Final = 4
_MAX_ESCS: Final = 32
#: The messages of ArduPilot, each for four motor controllers.
ESC_TELEMETRY: Final = tuple(
    getattr(ardupilotmega, f"EscTelemetry{first}To{first + 3}")
    for first in range(1, _MAX_ESCS + 1, _PER_MESSAGE)
)


def read_generator(telemetry: Telemetry) -> Generator | None:
    """Return the generator of GENERATOR_STATUS."""
    message = telemetry.latest(common.GeneratorStatus)
    if message is None:
        return None
    return Generator(
        message.status,
        scaled(message.generator_speed, UINT16_MAX, 1.0),
        finite(message.power_generated),
        finite(message.bus_voltage),
        finite(message.battery_current),
        finite(message.load_current),
        scaled(message.generator_temperature, INT16_MAX, 1.0),
        scaled(message.rectifier_temperature, INT16_MAX, 1.0),
        scaled(message.runtime, _UINT32_MAX, 1.0),
        scaled(message.time_until_maintenance, INT32_MAX, 1.0),
    )


def read_engine(telemetry: Telemetry) -> Engine | None:
    """Return the engine of EFI_STATUS."""
    message = telemetry.latest(common.EfiStatus)
    if message is None:
        return None
    return Engine(
        bool(message.health),
        finite(message.rpm),
        finite(message.engine_load),
        finite(message.throttle_position),
        finite(message.fuel_consumed),
        finite(message.fuel_flow),
        finite(message.cylinder_head_temperature),
        finite(message.exhaust_gas_temperature),
        finite(message.intake_manifold_temperature),
        finite(message.intake_manifold_pressure),
    )


def read_modem(message: common.CellularStatus) -> Modem:
    """Return the modem of a CELLULAR_STATUS."""
    return Modem(
        message.id,
        message.status,
        message.failure_reason,
        message.type,
        scaled(message.quality, _UINT8_MAX, 1.0),
        None if message.mcc == UINT16_MAX else message.mcc,
        None if message.mnc == UINT16_MAX else message.mnc,
        message.rx_level or None,
    )


def read_escs(
    telemetry: Telemetry, statuses: dict[int, common.EscStatus], infos: dict[int, common.EscInfo]
) -> dict[int, Esc]:
    """Return the motor controllers by their numbers, from 1."""
    found: dict[int, Esc] = {}
    for number, kind in enumerate(ESC_TELEMETRY):
        message = telemetry.latest(kind)
        if message is not None:
            found |= dict(enumerate(_of_telemetry(message), start=number * _PER_MESSAGE + 1))
    for first in sorted(statuses.keys() | infos.keys()):
        found |= dict(enumerate(_of_status(statuses.get(first), infos.get(first)), start=first + 1))
    return found


def _of_telemetry(message: ardupilotmega.EscTelemetry1To4) -> Iterator[Esc]:
    for place in range(_PER_MESSAGE):
        yield Esc(
            float(message.rpm[place]),
            message.voltage[place] / _CENTI,
            message.current[place] / _CENTI,
            float(message.temperature[place]),
            bool(message.count[place]),
        )


def _of_status(status: common.EscStatus | None, info: common.EscInfo | None) -> Iterator[Esc]:
    first = info.index if info is not None else 0
    count = _PER_MESSAGE if info is None or not info.count else min(max(info.count - first, 0), _PER_MESSAGE)
    for place in range(count):
        yield Esc(
            None if status is None else float(status.rpm[place]),
            None if status is None else finite(status.voltage[place]),
            None if status is None else finite(status.current[place]),
            None if info is None else scaled(info.temperature[place], INT16_MAX, _CENTI),
            None if info is None else bool(info.info >> place & 1),
            0 if info is None else info.failure_flags[place],
            None if info is None else info.error_count[place],
        )
