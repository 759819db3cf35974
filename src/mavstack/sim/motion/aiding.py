"""Sources of a body's estimate besides its own sensors: methods of `Body`."""

# ruff: noqa: SLF001 (methods of `Body`)

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.sim.motion.demands import MAX_DISTANCE, angle, finite

if TYPE_CHECKING:
    from mavstack.sim.motion.body import Body
    from mavstack.sim.motion.readings import Aid


def use_gps(body: Body, used: bool) -> None:
    """Let the estimate use GPS for its position, or not; the receiver works in either case."""
    body._fault("gps_unused", float(not used))


def aid(body: Body, aid: Aid, *, reset: bool = False) -> None:
    """Let the estimate follow an estimate from outside; the parts that are None follow their sensors.

    With `reset` its position is taken at once, as after a jump; the first one always is.
    """
    truth, state = body.truth, body._world.state
    begins = reset or not float(state.aid_position[body.column])
    north, east = (0.0, 0.0) if aid.horizontal is None else body._offset_from_truth(*aid.horizontal)
    down = 0.0 if aid.down is None else finite(aid.down - truth.down, 0.0, -MAX_DISTANCE, MAX_DISTANCE)
    body._fault("aid_offset", north, east, down)
    body._fault("aid_turn", 0.0 if aid.yaw is None else angle(aid.yaw - truth.yaw, 0.0))
    for name, value in zip(("position", "height", "heading"), aid, strict=True):
        body._fault(f"aid_{name}", float(value is not None))
    if begins and aid.horizontal is not None:
        state.position_error[:2, body.column] = north, east
