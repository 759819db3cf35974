"""Physics: what moves a vehicle. A user's own takes two calls.

    class Balloon:
        def reset(self, home, heading):
            self.height = 0.0
            return State()

        def step(self, actuators, dt):
            self.height += actuators[0] * dt
            return State(position=(0.0, 0.0, -self.height))

Units are SI; positions and velocities are north, east, down (NED) of home; body axes are forward, right, down
(FRD). A body is named as `copter`, `jsbsim:c172x`, or `module:Class` for a user's own.
"""

from __future__ import annotations

import importlib
import sys
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Final, Protocol

from mavstack.errors import InvalidArgumentError
from mavstack.simulators.outputs import Outputs

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from mavstack.sim.vehicle_types import Home
    from mavstack.simulators.state import State


class Physics(Protocol):
    """The motion of a vehicle by the outputs of its firmware."""

    def reset(self, home: Home, heading: float) -> State:
        """Put the vehicle at home, at rest.

        Args:
            home: The place of position (0, 0, 0).
            heading: Degrees from north.

        Returns:
            The state there.
        """

    def step(self, actuators: Sequence[float], dt: float) -> State:
        """Move the vehicle.

        Args:
            actuators: The outputs of the firmware: motors from 0 to 1, surfaces and reversible thrusters
                from -1 to 1; see `mavstack.simulators.outputs` for their order.
            dt: Seconds.

        Returns:
            The state afterwards.
        """


@dataclass(frozen=True)
class PhysicsEntry:
    """One kind of physics that a name stands for.

    Attributes:
        make: Makes it from what follows the colon of its name.
        outputs: How outputs of a firmware become its actuators.
        about: What it is, in a line.
        example: A name.
    """

    make: Callable[[str], Physics]
    outputs: Outputs
    about: str
    example: str


def _own(module: str, name: str) -> Callable[[str], Physics]:
    def make(_: str) -> Physics:
        found: Physics = getattr(importlib.import_module(f"mavstack.simulators.{module}"), name)()
        return found

    return make


def _adapter(module: str, name: str) -> Callable[[str], Physics]:
    def make(model: str) -> Physics:
        if not model:
            raise InvalidArgumentError(f"the physics {module!r} needs a model: {module}:MODEL")
        found: Physics = getattr(importlib.import_module(f"mavstack.simulators.adapters.{module}"), name)(
            model
        )
        return found

    return make


#: The vehicle type for each kind of outputs.
_VEHICLES: Final = MappingProxyType(
    {
        Outputs.MOTORS: "copter",
        Outputs.SURFACES: "plane",
        Outputs.VTOL: "vtol",
        Outputs.STEERING: "rover",
        Outputs.THRUSTERS: "sub",
    }
)
#: The built-in physics by name; a name with a colon, `module:Class`, selects another class.
PHYSICS: Final[Mapping[str, PhysicsEntry]] = MappingProxyType(
    {
        "copter": PhysicsEntry(
            _own("bodies.copter", "Copter"), Outputs.MOTORS, "a quadrotor of 1.5 kg", "copter"
        ),
        "plane": PhysicsEntry(
            _own("bodies.plane", "Plane"), Outputs.SURFACES, "a trainer of 1.8 kg on wheels", "plane"
        ),
        "vtol": PhysicsEntry(
            _own("bodies.quadplane", "QuadPlane"),
            Outputs.VTOL,
            "a plane of 2.4 kg with four lifting motors",
            "vtol",
        ),
        "rover": PhysicsEntry(
            _own("bodies.surface", "rover"), Outputs.STEERING, "a rover with steered wheels", "rover"
        ),
        "boat": PhysicsEntry(
            _own("bodies.surface", "boat"), Outputs.STEERING, "a boat with a steered propeller", "boat"
        ),
        "sub": PhysicsEntry(
            _own("bodies.submarine", "Submarine"), Outputs.THRUSTERS, "a submarine with six thrusters", "sub"
        ),
        "jsbsim": PhysicsEntry(
            _adapter("jsbsim", "JsbsimPhysics"), Outputs.SURFACES, "an aircraft of JSBSim", "jsbsim:c172x"
        ),
        "mujoco": PhysicsEntry(
            _adapter("mujoco", "MujocoPhysics"), Outputs.MOTORS, "a model of MuJoCo, MJCF", "mujoco:quad.xml"
        ),
        "log": PhysicsEntry(
            _adapter("log", "LogPhysics"),
            Outputs.MOTORS,
            "the sensors of a recorded flight",
            "log:flight.ulg",
        ),
        "rotorpy": PhysicsEntry(
            _adapter("rotorpy", "RotorpyPhysics"),
            Outputs.MOTORS,
            "a quadrotor of rotorpy",
            "rotorpy:hummingbird",
        ),
    }
)


def load_physics(name: str) -> tuple[Physics, Outputs]:
    """Make the physics of a name.

    Args:
        name: A key of `PHYSICS`, with `:MODEL` where it needs one; or `module:Class` of a class without
            arguments, which may have an attribute `outputs` of type `Outputs`. Modules of the working folder
            are found too.

    Returns:
        The physics, and how outputs of a firmware become its actuators.

    Raises:
        InvalidArgumentError: There is no such physics, or it cannot be made; the text says why.
    """
    kind, _, model = name.partition(":")
    entry = PHYSICS.get(kind)
    if entry is not None:
        return entry.make(model), entry.outputs
    if not model:
        raise InvalidArgumentError(
            f"there is no physics {name!r}: {', '.join(PHYSICS)}, or module:Class of your own"
        )
    return _load_class(kind, model)


def vehicle_of(physics: str | None) -> str:
    """Return the kind of vehicle that a physics moves; a copter where its name does not say it."""
    kind = (physics or "copter").partition(":")[0]
    entry = PHYSICS.get(kind)
    if entry is None:
        return "copter"
    return kind if kind == "boat" else _VEHICLES[entry.outputs]  # a boat has the same outputs as a rover


def _load_class(module: str, name: str) -> tuple[Physics, Outputs]:
    if str(Path.cwd()) not in sys.path:
        sys.path.insert(0, str(Path.cwd()))
    try:
        made: Physics = getattr(importlib.import_module(module), name)()
    except Exception as error:
        raise InvalidArgumentError(f"the physics {module}:{name} cannot be made: {error}") from error
    missing = [call for call in ("reset", "step") if not callable(getattr(made, call, None))]
    if missing:
        raise InvalidArgumentError(f"the physics {module}:{name} has no {' and no '.join(missing)}")
    return made, getattr(made, "outputs", Outputs.MOTORS)
