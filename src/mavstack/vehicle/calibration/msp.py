"""The calibrations of Betaflight and iNav: one command each, acknowledged at its end.

The bridge of the vehicle starts them by MSP_ACC_CALIBRATION and MSP_MAG_CALIBRATION, and watches the
arming-disable flag for calibrations, since MSP itself reports no progress. The gyroscope is calibrated at
each start of the firmware.
"""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from mavstack.errors import ActionUnsupported
from mavstack.vehicle.calibration.kinds import CalibrationKind, CalibrationTask
from mavstack.vehicle.calibration.procedure import Procedure

if TYPE_CHECKING:
    from collections.abc import Mapping

    from mavstack.vehicle.calibration.conversation import Conversation
    from mavstack.vehicle.vehicle import Vehicle


async def _calibrate_accelerometer(conversation: Conversation) -> None:
    text = "Place the vehicle level, and hold it still."
    conversation.emit_step(CalibrationTask.HOLD_STILL, text)
    await conversation.start(0, 0, 0, 0, 1)
    conversation.running = False


async def _calibrate_compass(conversation: Conversation) -> None:
    text = "Turn the vehicle around each of its axes for half a minute."
    conversation.emit_step(CalibrationTask.ROTATE, text)
    await conversation.start(0, 1)
    conversation.running = False


async def _cancel(vehicle: Vehicle) -> None:
    raise ActionUnsupported(f"vehicle {vehicle.address} cannot cancel a calibration: it ends by itself")


PROCEDURES: Final[Mapping[CalibrationKind, Procedure]] = MappingProxyType(
    {
        CalibrationKind.ACCELEROMETER: Procedure(_calibrate_accelerometer, _cancel, can_cancel=False),
        CalibrationKind.COMPASS: Procedure(_calibrate_compass, _cancel, can_cancel=False),
    }
)
