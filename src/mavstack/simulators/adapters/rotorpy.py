"""Multirotors of rotorpy: `rotorpy:MODEL`, such as `rotorpy:hummingbird`.

A model is a module of parameters `rotorpy.vehicles.MODEL_params` of a quadrotor whose rotors are in an X.
Rotors get the numbers and the directions that PX4 and ArduPilot expect of that place; an output from 0 to 1
is the share of a rotor's full thrust. rotorpy's axes are east, north, up, and forward, left, up.
"""

from __future__ import annotations

import importlib
import math
from typing import TYPE_CHECKING, Any, Final

from mavstack.errors import InvalidArgumentError, MissingExtraError
from mavstack.rotation import rotate_back, to_euler
from mavstack.simulators.state import GRAVITY, State

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mavstack.rotation import Quaternion, Vector
    from mavstack.sim.vehicle_types import Home

#: For each motor: the signs of its forward and left coordinates, and its direction of rotation about up.
_PLACES: Final = (((1, -1), -1.0), ((-1, 1), -1.0), ((1, 1), 1.0), ((-1, -1), 1.0))


class RotorpyPhysics:
    """A quadrotor of rotorpy.

    Args:
        model: The name of its parameters, such as "crazyflie", "hummingbird" or "px4_sihsim_quadx".

    Raises:
        MissingExtraError: rotorpy is not installed.
        InvalidArgumentError: It has no such parameters, or they are not those of a quadrotor in an X.
    """

    def __init__(self, model: str) -> None:
        try:
            from rotorpy.vehicles.multirotor import Multirotor
        except ImportError:
            raise MissingExtraError("rotorpy", "simulators") from None
        try:
            found: Any = importlib.import_module(f"rotorpy.vehicles.{model}_params")
        except ImportError:
            raise InvalidArgumentError(f"rotorpy has no parameters of {model!r}") from None
        parameters = dict(found.quad_params)
        self._order = _order(model, parameters)
        directions = parameters["rotor_directions"].astype(float)
        for motor, rotor in enumerate(self._order):
            directions[rotor] = _PLACES[motor][1]
        parameters["rotor_directions"] = directions
        self._top = float(parameters["rotor_speed_max"])
        self._vehicle: Any = Multirotor(parameters, self._rest(0.0), enable_ground=True)
        self._now: Any = self._rest(0.0)
        self._force: Vector = (0.0, 0.0, -GRAVITY)

    def reset(self, home: Home, heading: float) -> State:
        """Put it at home; see `Physics`."""
        self._now = self._rest(heading)
        self._force = (0.0, 0.0, -GRAVITY)
        return self._state()

    def step(self, actuators: Sequence[float], dt: float) -> State:
        """Move it by its motors, 0 to 1 each; see `Physics`."""
        speeds = [0.0] * len(self._order)
        for motor, rotor in enumerate(self._order):
            command = actuators[motor] if motor < len(actuators) else 0.0
            speeds[rotor] = self._top * math.sqrt(min(max(command, 0.0), 1.0))
        before = self._now["v"].copy()
        self._now = self._vehicle.step(self._now, {"cmd_motor_speeds": speeds}, dt)
        self._stand()
        east, north, up = ((self._now["v"] - before) / dt).tolist()
        self._force = rotate_back(_attitude(self._now["q"]), (north, east, -up - GRAVITY))
        return self._state()

    def _stand(self) -> None:
        """Hold it level on the ground: rotorpy's ground stops its fall only."""
        now = self._now
        if now["x"][2] > 1e-3 or now["v"][2] > 1e-3:
            return
        yaw = to_euler(_attitude(now["q"]))[2]
        now["x"][2] = max(now["x"][2], 0.0)
        now["v"] = now["v"] * 0.0
        now["w"] = now["w"] * 0.0
        now["q"] = self._rest(math.degrees(yaw))["q"]

    def _rest(self, heading: float) -> dict[str, Any]:
        """Return rotorpy's state of a vehicle at rest at home."""
        import numpy as np

        half = 0.5 * math.radians(90.0 - heading)
        return {
            "x": np.zeros(3),
            "v": np.zeros(3),
            "q": np.array([0.0, 0.0, math.sin(half), math.cos(half)]),
            "w": np.zeros(3),
            "wind": np.zeros(3),
            "rotor_speeds": np.zeros(len(_PLACES)),
        }

    def _state(self) -> State:
        east, north, up = self._now["x"].tolist()
        v_east, v_north, v_up = self._now["v"].tolist()
        p, q, r = self._now["w"].tolist()
        return State(
            (north, east, -up), (v_north, v_east, -v_up), _attitude(self._now["q"]), (p, -q, -r), self._force
        )


def _attitude(quaternion: Any) -> Quaternion:  # noqa: ANN401 (of numpy)
    """Return an attitude (x, y, z, w; forward, left, up to east, north, up) as ours."""
    x, y, z, w = quaternion.tolist()
    # Rotate the world axes by 180 degrees about north-east, and the body axes by 180 degrees about forward.
    half = math.sqrt(0.5)
    return half * (w + z), half * (x + y), half * (x - y), half * (w - z)


def _order(model: str, parameters: dict[str, Any]) -> tuple[int, ...]:
    """Return the index of the rotor of each motor."""
    signs = [
        (round(math.copysign(1, place[0])), round(math.copysign(1, place[1])))
        for place in parameters["rotor_pos"].values()
        if min(abs(place[0]), abs(place[1])) > 1e-6
    ]
    wanted = [place for place, _ in _PLACES]
    if sorted(signs) != sorted(wanted):
        raise InvalidArgumentError(f"rotorpy's {model!r} is not a quadrotor whose rotors are in an X")
    return tuple(signs.index(place) for place in wanted)
