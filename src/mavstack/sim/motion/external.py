"""Bodies whose motion another program computes.

The control laws of the world run as for any body; after each step the true motion is replaced by the one of
the program, and `demand` is what the laws ask of its actuators.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from mavstack.sim.motion import attitude

if TYPE_CHECKING:
    from mavstack.sim.motion.body import Body
    from mavstack.sim.motion.readings import Motion
    from mavstack.sim.motion.world import World

#: A body that does not rise and is less than this many metres above the ground rests on it.
TOUCH: float = 0.1


class ActuatorDemand(NamedTuple):
    """The demand of the control laws: rad, rad/s, and shares of the thrust.

    `lift` is 1 for twice the weight of a copter; `drive` is the share of the propeller or the wheels.
    """

    roll: float
    pitch: float
    yaw_rate: float
    lift: float
    drive: float


class ExternalMotion:
    """The motion of one body, by another program.

    Args:
        world: The world of the body; it follows from now on.
        body: The body.
    """

    def __init__(self, world: World, body: Body) -> None:
        self._world, self._body = world, body
        self._motion: Motion | None = None
        self._thrusts = (0.0, 0.0)
        world.external.append(self)

    def set(self, motion: Motion) -> None:
        """Set the true motion, which holds until the next call."""
        self._motion = motion

    @property
    def demand(self) -> ActuatorDemand:
        """The demand of the last step."""
        state, column = self._world.state, self._body.column
        lift, drive = self._thrusts
        return ActuatorDemand(
            float(state.roll_setpoint[column]),
            float(state.pitch_setpoint[column]),
            float(state.yaw_rate_setpoint[column]),
            lift / max(float(state.lift[column]), 1e-9),
            drive,
        )

    def apply(self) -> None:
        """Replace the motion of the body after a step."""
        state, column = self._world.state, self._body.column
        lift = _undelayed(self._thrusts[0], state.lift_thrust[column], state.lift_response[column])
        drive = _undelayed(self._thrusts[1], state.drive_thrust[column], state.drive_response[column])
        self._thrusts = (lift, drive)
        state.lift_thrust[column], state.drive_thrust[column] = lift, drive
        motion = self._motion
        if motion is None:
            return
        state.data[: len(motion), column] = motion
        state.on_ground[column] = float(motion.down > -TOUCH and motion.velocity_down > -TOUCH)
        attitude.update_axes(state.select(slice(column, column + 1)))


def _undelayed(before: float, after: float, response: float) -> float:
    """Return the command behind a first-order lag."""
    return before + (float(after) - before) / max(float(response), 1e-9)
