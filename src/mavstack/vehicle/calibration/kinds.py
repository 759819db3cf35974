"""The words of a calibration: its kinds, the poses and tasks that it asks for, its steps and its result."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import StrEnum
from types import MappingProxyType
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping


class CalibrationKind(StrEnum):
    """The kinds of calibrations."""

    ACCELEROMETER = "accelerometer"
    GYROSCOPE = "gyroscope"
    COMPASS = "compass"
    LEVEL = "level"
    AIRSPEED = "airspeed"
    BAROMETER = "barometer"
    RADIO = "radio"
    ESC = "esc"
    COMPASS_MOTOR = "compass-motor"


class Pose(StrEnum):
    """The poses of a vehicle; the value names the pose in texts."""

    LEVEL = "level"
    LEFT = "on its left side"
    RIGHT = "on its right side"
    NOSE_DOWN = "nose down"
    NOSE_UP = "nose up"
    BACK = "on its back"


class CalibrationTask(StrEnum):
    """The task of the person at the vehicle during a step."""

    WAIT = "wait"
    HOLD_STILL = "hold still"
    PLACE = "place"
    ROTATE = "rotate"
    SHIELD_PITOT = "shield the pitot tube"
    BLOW_PITOT = "blow into the pitot tube"
    CONNECT_BATTERY = "connect the battery"
    MOVE_STICKS = "move the sticks"
    CENTER_STICKS = "center the sticks"
    RAISE_THROTTLE = "raise the throttle"


@dataclass(frozen=True, slots=True)
class CalibrationStep:
    """A step of a calibration: the task of the person at the vehicle, and the progress.

    Attributes:
        kind: The calibration.
        task: The task until the next step.
        text: The task, or the vehicle's own text, as one sentence.
        pose: The pose of the task; None: any of `pending`, or none.
        pending: The poses that are left, where the vehicle names them.
        progress: Percent done, 0 to 100; None if it is not known.
        needs_confirmation: True if the calibration waits for `CalibrationSession.confirm`.
    """

    kind: CalibrationKind
    task: CalibrationTask
    text: str
    pose: Pose | None = None
    pending: tuple[Pose, ...] = ()
    progress: int | None = None
    needs_confirmation: bool = False

    def __str__(self) -> str:
        return self.text if self.progress is None else f"{self.text} ({self.progress} %)"


@dataclass(frozen=True, slots=True)
class CompassFit:
    """The result of one compass.

    Attributes:
        id: The number of the compass, from 0.
        fitness: The remaining error, in milligauss.
        offsets: The offsets of its axes, in milligauss.
        saved: True if the vehicle has saved them.
    """

    id: int
    fitness: float
    offsets: tuple[float, float, float]
    saved: bool


@dataclass(frozen=True, slots=True)
class ChannelRange:
    """The calibrated pulses of a radio control channel, in microseconds."""

    minimum: int
    trim: int
    maximum: int


@dataclass(frozen=True, slots=True)
class CalibrationResult:
    """The result of a calibration.

    Attributes:
        kind: The calibration.
        reboot_needed: True if it takes effect after a reboot.
        compasses: The results of the compasses, of a compass calibration with ArduPilot.
        channels: The channels that moved, by number from 1, of a radio calibration.
    """

    kind: CalibrationKind
    reboot_needed: bool = False
    compasses: tuple[CompassFit, ...] = ()
    channels: Mapping[int, ChannelRange] = field(default_factory=lambda: MappingProxyType({}))
