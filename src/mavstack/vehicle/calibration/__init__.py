"""Calibrations: one conversation with the vehicle for each sensor, the same for every firmware."""

from mavstack.vehicle.calibration.calibration import Calibration
from mavstack.vehicle.calibration.kinds import (
    CalibrationKind,
    CalibrationResult,
    CalibrationStep,
    CalibrationTask,
    ChannelRange,
    CompassFit,
    Pose,
)
from mavstack.vehicle.calibration.session import CalibrationSession

__all__ = [
    "Calibration",
    "CalibrationKind",
    "CalibrationResult",
    "CalibrationSession",
    "CalibrationStep",
    "CalibrationTask",
    "ChannelRange",
    "CompassFit",
    "Pose",
]
