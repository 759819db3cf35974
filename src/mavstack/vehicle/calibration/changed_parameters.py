"""The parameters that a calibration changes: they are read again at its end, so that no old value is shown.

Vehicles announce the parameters that they store (PARAM_VALUE), but an announcement may be lost. Only those
that the program knows already, and that were not announced meanwhile, are read.
"""

from __future__ import annotations

import asyncio
from contextlib import suppress
from fnmatch import fnmatchcase
from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.errors import MavstackError
from mavstack.vehicle.calibration.kinds import CalibrationKind

if TYPE_CHECKING:
    from collections.abc import Mapping

    from mavstack.vehicle.vehicle import Vehicle

#: Timeout in seconds of the refresh of all parameters together.
REFRESH_TIMEOUT: Final = 5.0
#: Patterns of the names of the ArduPilot and PX4 parameters that each calibration changes.
CALIBRATED: Final[Mapping[CalibrationKind, tuple[str, ...]]] = MappingProxyType(
    {
        CalibrationKind.ACCELEROMETER: ("INS*_ACC*", "AHRS_TRIM_?", "CAL_ACC*"),
        CalibrationKind.GYROSCOPE: ("INS*_GYR*", "CAL_GYRO*"),
        CalibrationKind.COMPASS: (
            "COMPASS_OFS*",
            "COMPASS_DIA*",
            "COMPASS_ODI*",
            "COMPASS_SCALE*",
            "COMPASS_ORIENT*",
            "COMPASS_DEV_ID*",
            "COMPASS_PRIO*",
            "CAL_MAG*",
        ),
        CalibrationKind.LEVEL: ("AHRS_TRIM_?", "SENS_BOARD_?_OFF"),
        CalibrationKind.AIRSPEED: ("ARSPD*_OFFSET", "SENS_DPRES_OFF"),
        CalibrationKind.BAROMETER: ("BARO*_GND_PRESS", "CAL_BARO*_OFF"),
        CalibrationKind.RADIO: ("RC*_MIN", "RC*_MAX", "RC*_TRIM", "TRIM_*"),
        CalibrationKind.ESC: ("ESC_CALIBRATION",),
        CalibrationKind.COMPASS_MOTOR: ("COMPASS_MOT*",),
    }
)


class ChangedParameters:
    """The parameters that a calibration of a vehicle changes; made before it begins.

    Args:
        vehicle: The vehicle.
        kind: The kind of the calibration.
    """

    def __init__(self, vehicle: Vehicle, kind: CalibrationKind) -> None:
        self._vehicle = vehicle
        self._patterns = CALIBRATED[kind]
        self._announced: set[str] = set()
        self._listener = vehicle.add_listener(common.ParamValue, self._note)

    async def refresh(self) -> None:
        """Read those that are known and were not announced; a vehicle that does not answer keeps them."""
        params = self._vehicle.component.params
        names = [each for each in params.cached if self._is_changed(each) and each not in self._announced]
        with suppress(TimeoutError):
            async with asyncio.timeout(REFRESH_TIMEOUT):
                await asyncio.gather(*map(self._read, names))

    def close(self) -> None:
        """Stop listening."""
        self._listener.close()

    async def _read(self, name: str) -> None:
        with suppress(MavstackError):
            await self._vehicle.component.params.get(name)

    def _note(self, message: common.ParamValue) -> None:
        self._announced.add(message.param_id)

    def _is_changed(self, name: str) -> bool:
        return any(fnmatchcase(name, pattern) for pattern in self._patterns)
