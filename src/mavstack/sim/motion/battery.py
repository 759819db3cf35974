"""Battery: an open-circuit voltage that falls with the charge, in series with an internal resistance.

Power is drawn by the electronics, the lifting motors (thrust to the power 3/2, from momentum theory) and the
driving motor. The current is the power divided by the voltage; the voltage is the open-circuit voltage minus
current times resistance. In the last percent of charge the motors lose their thrust.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mavstack.sim.motion.arrays import clip

if TYPE_CHECKING:
    from mavstack.sim.motion.state import StateArray

#: Open-circuit volts of one lithium-polymer cell by its state of charge.
CHARGE = np.array([0.0, 0.02, 0.05, 0.1, 0.2, 0.4, 0.6, 0.8, 0.9, 1.0])
CELL_VOLTAGE = np.array([2.8, 3.2, 3.4, 3.55, 3.65, 3.74, 3.85, 4.0, 4.08, 4.2])
NOMINAL_CELL_VOLTAGE = 3.8
GRAVITY = 9.80665
AMBIENT = 25.0
#: State of charge below which the motors lose thrust; at zero they have none.
LAST_CHARGE = 0.01


def discharge(state: StateArray, step: float) -> None:
    """Draw the charge of one step from every battery."""
    lift = np.maximum(state.lift_share, 0.0)
    drive = np.abs(state.drive_thrust)
    state.power[:] = (
        state.power_idle * (1.0 + state.running)
        + state.power_lift * lift * np.sqrt(lift)
        + state.power_drive * drive * np.sqrt(drive)
    )
    resting = np.interp(state.remaining, CHARGE, CELL_VOLTAGE) * state.cells
    current = state.power / np.maximum(state.voltage, 2.0 * state.cells)
    state.current[:] = current
    state.voltage[:] = np.maximum(resting - current * state.resistance - state.sag, 0.0)
    state.consumed += np.where(state.remaining > 0.0, current * (step / 3.6), 0.0)
    state.remaining[:] = clip(1.0 - state.consumed / state.capacity, 0.0, 1.0)
    state.temperature += (AMBIENT + 0.02 * current * current - state.temperature) * (step / 120.0)


def thrust_factor(state: StateArray) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    """Return the share of its thrust that a motor reaches at the present battery voltage."""
    volts = state.voltage / (state.cells * NOMINAL_CELL_VOLTAGE)
    return clip(volts, 0.0, 1.1) * np.minimum(state.remaining * (1 / LAST_CHARGE), 1.0)
