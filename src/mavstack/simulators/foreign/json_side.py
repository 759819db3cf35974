"""ArduPilot's side of its JSON interface, for simulated vehicles. Sans-IO.

It asks for each step by a datagram of servo outputs, and takes the answer as ArduPilot does: a scanner that
accepts no spaces after names, and needs time, gyroscope, accelerometer, position, velocity and attitude.
"""

from __future__ import annotations

import json
import math
import re
import struct
from typing import TYPE_CHECKING, Any, Final

from mavstack.rotation import from_euler
from mavstack.simulators.foreign.sample import ForeignSample

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mavstack.rotation import Quaternion, Vector

#: The magic number at the beginning of a datagram, by the number of outputs.
_MAGICS: Final = {16: 18458, 32: 29569}
_SPACES: Final = re.compile(rb'"\s*:\s|"\s+:')
_UNIT_TOLERANCE: Final = 0.05
#: Maximum absolute value of a number in an answer, in its unit.
MAX_NUMBER: Final = 1e9


class JsonSide:
    """The conversation with one simulator.

    Args:
        rate: Steps in a second.

    Attributes:
        steps: Answers that were taken.
        problems: What is wrong with the simulator's answers, each once.
    """

    def __init__(self, rate: int = 400) -> None:
        self._rate, self._number = rate, 0
        self._question = b""
        self._time = -math.inf
        self.steps = 0
        self.problems: set[str] = set()

    def ask(self, pulses: Sequence[int]) -> bytes:
        """Return the datagram that asks for the next step.

        Args:
            pulses: Servo outputs in microseconds, up to 32.
        """
        count = 16 if len(pulses) <= 16 else 32
        outputs = [*pulses, *[0] * (count - len(pulses))]
        self._question = struct.pack(
            f"<HHI{count}H", _MAGICS[count], self._rate, self._number & 0xFFFFFFFF, *outputs
        )
        self._number += 1
        return self._question

    def repeat(self) -> bytes:
        """Return the last datagram again: its answer was lost."""
        return self._question

    @property
    def status(self) -> str:
        """The event that each side waits for, in a sentence."""
        if self.problems:
            return f"the simulator's answers are refused: {'; '.join(sorted(self.problems))}"
        if not self.steps:
            return "the vehicle waits for the first answer of the simulator"
        return "the simulator waits for servo outputs, the vehicle for the answer"

    def feed(self, data: bytes) -> ForeignSample | None:
        """Take an answer; returns None if ArduPilot would not accept it."""
        if _SPACES.search(data):
            self.problems.add('the JSON answer has spaces after a name: use separators=(",", ":")')
            return None
        try:
            values = json.loads(data)
        except (ValueError, RecursionError):
            self.problems.add("the answer is not JSON")
            return None
        try:
            sample = _sample(values)
        except KeyError as error:
            self.problems.add(f"the answer has no {error.args[0]}")
            return None
        except (TypeError, ValueError):
            self.problems.add("a field of the answer has not the right number of finite numbers")
            return None
        if sample.time < self._time:
            self.problems.add("the timestamp went back")
        else:
            self.problems.clear()
        self._time = sample.time
        self.steps += 1
        return sample


def _sample(values: Any) -> ForeignSample:  # noqa: ANN401 (JSON)
    """Return the sample of an answer; raises KeyError, TypeError or ValueError."""
    imu = _field(values, "imu", dict)
    return ForeignSample(
        _numbers([_field(values, "timestamp", (int, float))], 1)[0],
        _vector(_field(values, "position", list)),
        _vector(_field(values, "velocity", list)),
        _attitude(values),
        _vector(_field(imu, "gyro", list, "imu.gyro")),
        _vector(_field(imu, "accel_body", list, "imu.accel_body")),
    )


def _field(values: Any, name: str, kind: Any, label: str = "") -> Any:  # noqa: ANN401 (JSON)
    if not isinstance(values, dict):
        raise TypeError
    if name not in values:
        raise KeyError(label or name)
    if not isinstance(values[name], kind):
        raise TypeError
    return values[name]


def _numbers(values: list[Any], count: int) -> tuple[float, ...]:
    numbers = tuple(float(value) for value in values)
    if len(numbers) != count or not all(abs(number) < MAX_NUMBER for number in numbers):
        raise ValueError
    return numbers


def _vector(values: list[Any]) -> Vector:
    a, b, c = _numbers(values, 3)
    return a, b, c


def _attitude(values: Any) -> Quaternion:  # noqa: ANN401 (JSON)
    """Return the quaternion, which wins over the angles."""
    if "quaternion" not in values:
        if "attitude" not in values:
            raise KeyError("attitude or quaternion")
        return from_euler(*_vector(_field(values, "attitude", list)))
    w, x, y, z = _numbers(_field(values, "quaternion", list), 4)
    length = math.hypot(w, x, y, z)
    if abs(length - 1.0) > _UNIT_TOLERANCE:
        raise ValueError
    return w / length, x / length, y / length, z / length
