"""PX4's calibrations: PREFLIGHT_CALIBRATION starts one, and status texts that begin with "[cal] " report it.

    [cal] calibration started: 2 accel          [cal] progress <17>
    [cal] pending: back front left right up     [cal] left orientation detected
    [cal] left side done, rotate to a different side       [cal] left side calibration: progress <21>
    [cal] calibration done: accel               [cal] calibration failed: …      [cal] calibration cancelled

The vehicle detects by itself which side is down. Each text may arrive twice or be lost. The same command with
all params 0 cancels a calibration; the commander and the calibration answer it differently, so that only the
text tells that it was cancelled. The radio control calibration is that of `radio`.
"""

from __future__ import annotations

import asyncio
import re
from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.errors import CommandDenied
from mavstack.services.statustext import StatusText
from mavstack.vehicle.calibration.conversation import STALL_TIMEOUT, TURN_TIMEOUT
from mavstack.vehicle.calibration.kinds import CalibrationKind, CalibrationTask, Pose
from mavstack.vehicle.calibration.procedure import Procedure
from mavstack.vehicle.calibration.radio import calibrate_radio
from mavstack.vehicle.vehicle_type import VehicleType

if TYPE_CHECKING:
    from collections.abc import Mapping

    from mavstack.vehicle.calibration.conversation import Conversation
    from mavstack.vehicle.vehicle import Vehicle

_CMD: Final = common.MavCmd
PREFIX: Final = "[cal] "
_ARGUMENTS: Final[Mapping[CalibrationKind, tuple[int, ...]]] = MappingProxyType(
    {
        CalibrationKind.GYROSCOPE: (1,),
        CalibrationKind.COMPASS: (0, 1),
        CalibrationKind.BAROMETER: (0, 0, 1),
        CalibrationKind.RADIO: (0, 0, 0, 1),
        CalibrationKind.ACCELEROMETER: (0, 0, 0, 0, 1),
        CalibrationKind.LEVEL: (0, 0, 0, 0, 2),
        CalibrationKind.AIRSPEED: (0, 0, 0, 0, 0, 1),
        CalibrationKind.ESC: (0, 0, 0, 0, 0, 0, 1),
    }
)
#: PX4 names a side by the end of the vehicle that points down, with one exception: "up" means upside down.
_POSES: Final[Mapping[str, Pose]] = MappingProxyType(
    {
        "down": Pose.LEVEL,
        "left": Pose.LEFT,
        "right": Pose.RIGHT,
        "front": Pose.NOSE_DOWN,
        "back": Pose.NOSE_UP,
        "up": Pose.BACK,
    }
)
_TURNED: Final = frozenset({CalibrationKind.ACCELEROMETER, CalibrationKind.COMPASS})
#: The beginnings of the texts that name a task.
_TASKS: Final[tuple[tuple[str, CalibrationTask], ...]] = (
    ("Rotate vehicle", CalibrationTask.ROTATE),
    ("Continue rotation", CalibrationTask.ROTATE),
    ("Hold still", CalibrationTask.HOLD_STILL),
    ("detected rest position", CalibrationTask.HOLD_STILL),
    ("Ensure sensor is not measuring wind", CalibrationTask.SHIELD_PITOT),
    ("Blow into front of pitot", CalibrationTask.BLOW_PITOT),
    ("Create air pressure", CalibrationTask.BLOW_PITOT),
    ("Connect battery", CalibrationTask.CONNECT_BATTERY),
)
#: The largest number of requests to cancel.
_CANCELLATIONS: Final = 4
#: Seconds between two requests to cancel.
_CANCEL_INTERVAL: Final = 1.0
#: The largest number of requests to start: PX4 refuses a calibration for about a second after it has reported
#: the end of another one.
_STARTS: Final = 8
#: Seconds between two requests to start.
_START_INTERVAL: Final = 0.5
#: A progress report; the compass calibration adds the side that is turned.
_PROGRESS: Final = re.compile(r"(?:\w+ side calibration: )?progress <(\d+)>")
_SIDE: Final = re.compile(r"(\w+) (orientation detected|side done|side already completed)")


class _Reader:
    """Reads the status texts of one calibration."""

    def __init__(self, conversation: Conversation) -> None:
        self._conversation = conversation
        self.done = False
        self._begun = False
        self._pending: tuple[Pose, ...] = ()
        self._progress: int | None = None
        self._turns = conversation.kind in _TURNED

    def read(self, text: str) -> None:
        """Take in a status text."""
        if not text.startswith(PREFIX):
            return
        words = text.removeprefix(PREFIX).strip()
        if words.startswith("calibration "):
            self._read_state(words.removeprefix("calibration "))
        elif found := _PROGRESS.match(words):
            self._begun, self._progress = True, min(int(found[1]), 100)
            self._emit_progress()
        elif words.startswith("pending:"):
            names = words.removeprefix("pending:").split()
            self._pending = tuple(_POSES[name] for name in names if name in _POSES)
            self._emit_pending()
        elif (found := _SIDE.match(words)) and found[1] in _POSES:
            self._read_side(_POSES[found[1]], found[2])
        else:
            self._emit_text(words)

    def _read_state(self, words: str) -> None:
        conversation = self._conversation
        state, _, rest = words.partition(":")
        if state == "started":
            self._begun = True
        elif state == "done":
            self.done = True
        elif state == "failed":
            reason = rest.strip()  # a reason, or the name of the sensor
            conversation.problem = reason if " " in reason else "the vehicle reported a failure"
        elif state == "cancelled" and self._begun:  # otherwise an earlier calibration was cancelled
            conversation.problem = "it was cancelled"

    def _read_side(self, pose: Pose, what: str) -> None:
        if what == "orientation detected":
            task = self._side_task
            text = f"Detected {pose}: " + (
                "rotate it around that axis." if self._rotates else "hold it still."
            )
            self._conversation.emit_step(
                task, text, pose=pose, pending=self._pending, progress=self._progress
            )
        else:
            self._pending = tuple(each for each in self._pending if each is not pose)
            self._emit_pending()

    @property
    def _rotates(self) -> bool:
        return self._conversation.kind is CalibrationKind.COMPASS

    @property
    def _side_task(self) -> CalibrationTask:
        return CalibrationTask.ROTATE if self._rotates else CalibrationTask.HOLD_STILL

    def _emit_pending(self) -> None:
        if self._pending:
            text = f"Place the vehicle {' or '.join(self._pending)}, and hold it still."
            pending, progress = self._pending, self._progress
            self._conversation.emit_step(CalibrationTask.PLACE, text, pending=pending, progress=progress)

    def _emit_progress(self) -> None:
        step = self._conversation.step
        if step is not None:
            self._conversation.emit_step(
                step.task, step.text, pose=step.pose, pending=step.pending, progress=self._progress
            )

    def _emit_text(self, words: str) -> None:
        step = self._conversation.step
        task = next((task for start, task in _TASKS if words.startswith(start)), None)
        if task is None or (self._turns and step is not None and step.task is task):
            return  # a remark of PX4, or a text that repeats the present step
        pose = None if step is None else step.pose
        text = f"{words.rstrip('.')}."
        self._conversation.emit_step(task, text, pose=pose, pending=self._pending, progress=self._progress)


async def _calibrate(conversation: Conversation) -> None:
    kind, reader = conversation.kind, _Reader(conversation)
    conversation.on_text = reader.read
    if kind is CalibrationKind.ESC:
        text = "Take the propellers off and disconnect the battery; power the vehicle by USB."
        conversation.emit_step(CalibrationTask.WAIT, text)
    elif kind not in _TURNED:
        conversation.emit_step(CalibrationTask.HOLD_STILL, "Hold the vehicle still.")
    await _start(conversation)
    await conversation.wait(lambda: reader.done, TURN_TIMEOUT if kind in _TURNED else STALL_TIMEOUT)
    conversation.running = False


async def _start(conversation: Conversation) -> None:
    for left in reversed(range(_STARTS)):
        try:
            return await conversation.start(*_ARGUMENTS[conversation.kind])
        except CommandDenied as denial:
            if not (left and _is_busy(denial, conversation)):
                raise
        await asyncio.sleep(_START_INTERVAL)
    return None


def _is_busy(denial: CommandDenied, conversation: Conversation) -> bool:
    """Return whether PX4 has not ended another calibration yet; it gives reasons for other refusals."""
    rejected = denial.code == common.MavResult.TEMPORARILY_REJECTED
    return rejected and not denial.status_texts and not conversation.vehicle.armed


async def _radio(conversation: Conversation) -> None:
    async def ignore_sticks(ignored: bool) -> None:
        arguments = _ARGUMENTS[CalibrationKind.RADIO] if ignored else ()
        await conversation.start(*arguments)

    await calibrate_radio(conversation, ignore_sticks)


async def _cancel(vehicle: Vehicle) -> None:
    """Send the request to cancel until a text says that the calibration has ended."""
    async with vehicle.connection.events(StatusText) as texts:
        for _ in range(_CANCELLATIONS):
            vehicle.component.send(common.CommandLong(command=_CMD.PREFLIGHT_CALIBRATION))
            await asyncio.sleep(_CANCEL_INTERVAL)
            ends = ("cancelled", "done", "failed")
            if any(
                event.source == vehicle.address
                and event.text.startswith(tuple(f"{PREFIX}calibration {end}" for end in ends))
                for event in texts.drain()
            ):
                return


async def _cancel_radio(vehicle: Vehicle) -> None:
    await vehicle.component.command(_CMD.PREFLIGHT_CALIBRATION)


#: The procedure of each kind of calibration. Only the radio calibration needs confirmations of the user; the
#: vehicle detects the end of all other steps.
PROCEDURES: Final[Mapping[CalibrationKind, Procedure]] = MappingProxyType(
    {kind: Procedure(_calibrate, _cancel) for kind in _ARGUMENTS}
    | {CalibrationKind.RADIO: Procedure(_radio, _cancel_radio, needs_confirmation=True)}
)


def lacking(vehicle_type: VehicleType) -> frozenset[CalibrationKind]:
    """Return the kinds that a vehicle type lacks."""
    winged = vehicle_type in (VehicleType.PLANE, VehicleType.VTOL)
    return frozenset() if winged else frozenset({CalibrationKind.AIRSPEED})
