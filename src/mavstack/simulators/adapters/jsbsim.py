"""Aircraft of JSBSim, such as `jsbsim:c172x`.

JSBSim works in feet and pounds, and integrates with its own step; a step of the simulator is made of whole
steps of JSBSim. Before the first step the aircraft settles on its wheels, engine running and brakes on.
"""

from __future__ import annotations

import math
import os
from typing import TYPE_CHECKING, Any, Final

from mavstack.errors import InvalidArgumentError, MissingExtraError
from mavstack.geodesy import LocalFrame
from mavstack.rotation import from_euler
from mavstack.simulators.state import State

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mavstack.sim.vehicle_types import Home

_FEET: Final = 0.3048
#: The longest step in seconds with which JSBSim's models are stable.
_MAX_STEP: Final = 1 / 200
#: Seconds until the landing gear has settled.
_SETTLING: Final = 5.0
#: Throttle below which the brakes are on.
_BRAKED: Final = 0.15
_CONTROLS: Final = (
    "fcs/aileron-cmd-norm",
    "fcs/elevator-cmd-norm",
    "fcs/throttle-cmd-norm",
    "fcs/rudder-cmd-norm",
)


class JsbsimPhysics:
    """An aircraft of JSBSim; its actuators are aileron, elevator (up), throttle and rudder.

    Args:
        model: The name of an aircraft that comes with JSBSim.

    Raises:
        MissingExtraError: JSBSim is not installed.
        InvalidArgumentError: It has no such aircraft.
    """

    def __init__(self, model: str) -> None:
        self._model = model
        self._exec = _loaded(model)
        self._is_new = True
        self._frame = LocalFrame(0.0, 0.0, 0.0)

    def reset(self, home: Home, heading: float) -> State:
        """Put it on its wheels at home; see `Physics`."""
        if not self._is_new:  # JSBSim cannot open the logs of a model twice
            self._exec = _loaded(self._model)
        self._is_new = False
        fdm = self._exec
        for name, value in (
            ("ic/lat-geod-deg", home.latitude),
            ("ic/long-gc-deg", home.longitude),
            ("ic/terrain-elevation-ft", home.altitude / _FEET),
            ("ic/h-agl-ft", 5.0),
            ("ic/psi-true-deg", heading),
            ("ic/vc-kts", 0.0),
        ):
            fdm[name] = value
        fdm.set_dt(_MAX_STEP)
        fdm.run_ic()
        fdm["propulsion/set-running"] = -1
        fdm["fcs/mixture-cmd-norm"] = 1.0
        self._control((0.0, 0.0, 0.0, 0.0))
        for _ in range(round(_SETTLING / _MAX_STEP)):
            fdm.run()
        self._frame = LocalFrame(home.latitude, home.longitude, fdm["position/h-sl-meters"])
        return self._state()

    def step(self, actuators: Sequence[float], dt: float) -> State:
        """Move it; see `Physics`."""
        self._control(actuators)
        count = max(math.ceil(dt / _MAX_STEP - 1e-9), 1)
        self._exec.set_dt(dt / count)
        for _ in range(count):
            self._exec.run()
        return self._state()

    def _control(self, actuators: Sequence[float]) -> None:
        aileron, elevator, throttle, rudder = actuators
        # JSBSim's elevator and rudder commands are positive for nose down and nose left.
        for name, value in zip(_CONTROLS, (aileron, -elevator, throttle, -rudder), strict=True):
            self._exec[name] = value
        brake = 1.0 if throttle < _BRAKED else 0.0
        for side in ("left", "right", "center"):
            self._exec[f"fcs/{side}-brake-cmd-norm"] = brake

    def _state(self) -> State:
        fdm = self._exec
        position = self._frame.to_local(
            fdm["position/lat-geod-deg"], fdm["position/long-gc-deg"], fdm["position/h-sl-meters"]
        )
        angles = (fdm["attitude/phi-rad"], fdm["attitude/theta-rad"], fdm["attitude/psi-rad"])
        return State(
            position,
            tuple(_FEET * fdm[f"velocities/v-{axis}-fps"] for axis in ("north", "east", "down")),
            from_euler(*angles),
            tuple(fdm[f"velocities/{axis}-rad_sec"] for axis in "pqr"),
            tuple(_FEET * fdm[f"accelerations/a-pilot-{axis}-ft_sec2"] for axis in "xyz"),
            airspeed=_FEET * fdm["velocities/vt-fps"],
        )


def _loaded(model: str) -> Any:  # noqa: ANN401 (jsbsim has no types)
    """Return a JSBSim with this aircraft."""
    try:
        import jsbsim
    except ImportError:
        raise MissingExtraError("jsbsim", "simulators") from None
    base: Any = jsbsim.FGJSBBase
    base().debug_lvl = 0  # disables the text that JSBSim prints at the start
    fdm: Any = jsbsim.FGFDMExec(None)
    if model not in _models(fdm) or not fdm.load_model(model):
        raise InvalidArgumentError(f"JSBSim has no aircraft {model!r}")
    _discard_output(fdm)
    return fdm


def _discard_output(fdm: Any) -> None:  # noqa: ANN401 (jsbsim has no types)
    """Write no files: models log into the current folder, and `disable_output` leaves an empty log."""
    number = 0
    while fdm.set_output_filename(number, os.devnull):
        number += 1
    fdm.disable_output()


def _models(fdm: Any) -> set[str]:  # noqa: ANN401 (jsbsim has no types)
    """Return the names of the aircraft that come with JSBSim."""
    from pathlib import Path

    folder = Path(fdm.get_root_dir()) / fdm.get_aircraft_path()
    return {path.name for path in folder.iterdir() if (path / f"{path.name}.xml").is_file()}
