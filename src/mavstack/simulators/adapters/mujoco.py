"""Bodies of MuJoCo: `mujoco:FILE`, a model in MJCF with a free joint.

The first body with a free joint is the vehicle, in axes forward, left, up; the world's axes are north, west,
up. The model's actuators are its outputs in their order: 0 to 1 fills a range of control that begins at 0 or
above, -1 to 1 a range on both sides of 0. Steps are divided so that the model's own time step is kept.
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mavstack.errors import InvalidArgumentError, MissingExtraError
from mavstack.rotation import from_euler, rotate_back
from mavstack.simulators.state import GRAVITY, State

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mavstack.rotation import Quaternion, Vector
    from mavstack.sim.vehicle_types import Home


class MujocoPhysics:
    """A vehicle of MuJoCo.

    Args:
        file: The path of an MJCF file.

    Raises:
        MissingExtraError: MuJoCo is not installed.
        InvalidArgumentError: The file is missing or wrong, or its first joint is not free.
    """

    def __init__(self, file: str) -> None:
        try:
            import mujoco
        except ImportError:
            raise MissingExtraError("mujoco", "simulators") from None
        if not Path(file).is_file():
            raise InvalidArgumentError(f"the physics mujoco:{file} cannot be made: there is no such file")
        self._mujoco: Any = mujoco
        try:
            self._model: Any = mujoco.MjModel.from_xml_path(file)
        except ValueError as error:
            line = " ".join(str(error).split())
            raise InvalidArgumentError(f"the physics mujoco:{file} cannot be made: {line}") from None
        if not self._model.njnt or self._model.jnt_type[0] != mujoco.mjtJoint.mjJNT_FREE:
            raise InvalidArgumentError(
                f"the physics mujoco:{file} cannot be made: its first joint must be a free joint"
            )
        self._data: Any = mujoco.MjData(self._model)
        self._max_step = float(self._model.opt.timestep)
        self._start = self._data.qpos.copy()
        self._force: Vector = (0.0, 0.0, -GRAVITY)

    def reset(self, home: Home, heading: float) -> State:
        """Put it at home; see `Physics`."""
        self._mujoco.mj_resetData(self._model, self._data)
        w, x, y, z = from_euler(0.0, 0.0, math.radians(heading))
        self._data.qpos[3:7] = (w, x, -y, -z)
        self._mujoco.mj_forward(self._model, self._data)
        self._force = (0.0, 0.0, -GRAVITY)
        return self._state()

    def step(self, actuators: Sequence[float], dt: float) -> State:
        """Move it by its actuators; see `Physics`."""
        model, data = self._model, self._data
        for index in range(model.nu):
            command = actuators[index] if index < len(actuators) else 0.0
            data.ctrl[index] = _control(
                command, model.actuator_ctrllimited[index], model.actuator_ctrlrange[index]
            )
        before = data.qvel[:3].copy()
        count = max(math.ceil(dt / self._max_step - 1e-9), 1)
        model.opt.timestep = dt / count
        self._mujoco.mj_step(model, data, count)
        north, west, up = (data.qvel[:3] - before) / dt
        self._force = rotate_back(self._attitude(), (float(north), -float(west), -float(up) - GRAVITY))
        return self._state()

    def _attitude(self) -> Quaternion:
        w, x, y, z = self._data.qpos[3:7].tolist()
        return w, x, -y, -z

    def _state(self) -> State:
        offset = self._data.qpos[:3] - self._start[:3]
        north, west, up = offset.tolist()
        v_north, v_west, v_up, p, q, r = self._data.qvel[:6].tolist()
        return State(
            (north, -west, -up), (v_north, -v_west, -v_up), self._attitude(), (p, -q, -r), self._force
        )


def _control(command: float, is_limited: bool, limits: Any) -> float:  # noqa: ANN401 (of numpy)
    """Return the control of an actuator by its command."""
    if not is_limited:
        return command
    low, high = float(limits[0]), float(limits[1])
    if low < 0.0 < high:
        return max(-1.0, min(1.0, command)) * (high if command > 0.0 else -low)
    return low + max(0.0, min(1.0, command)) * (high - low)
