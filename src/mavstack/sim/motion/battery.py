"""Battery: an open-circuit voltage that falls with the charge, behind an inner resistance.

Power is what the electronics, the lifting motors (as thrust to the power 3/2, from momentum theory) and the
driving motor take. Its current is the power over the voltage; the voltage is the open-circuit one less the
current times the resistance. Empty, the last percent takes the motors' thrust with it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mavstack.sim.motion.arrays import bounded

if TYPE_CHECKING:
    from mavstack.sim.motion.fleet import Fleet

#: Volts of one lithium-polymer cell by the share of its charge.
CHARGE = np.array([0.0, 0.02, 0.05, 0.1, 0.2, 0.4, 0.6, 0.8, 0.9, 1.0])
CELL_VOLTAGE = np.array([2.8, 3.2, 3.4, 3.55, 3.65, 3.74, 3.85, 4.0, 4.08, 4.2])
NOMINAL_CELL_VOLTAGE = 3.8
GRAVITY = 9.80665
AMBIENT = 25.0
#: Below this share motors lose thrust, down to none.
LAST_CHARGE = 0.01


def drain(fleet: Fleet, step: float) -> None:
    """Take a step's charge out of every battery."""
    lift = np.maximum(fleet.lift_share, 0.0)
    drive = np.abs(fleet.drive_thrust)
    fleet.power[:] = (
        fleet.power_idle * (1.0 + fleet.running)
        + fleet.power_lift * lift * np.sqrt(lift)
        + fleet.power_drive * drive * np.sqrt(drive)
    )
    resting = np.interp(fleet.remaining, CHARGE, CELL_VOLTAGE) * fleet.cells
    current = fleet.power / np.maximum(fleet.voltage, 2.0 * fleet.cells)
    fleet.current[:] = current
    fleet.voltage[:] = np.maximum(resting - current * fleet.resistance - fleet.sag, 0.0)
    fleet.consumed += np.where(fleet.remaining > 0.0, current * (step / 3.6), 0.0)
    fleet.remaining[:] = bounded(1.0 - fleet.consumed / fleet.capacity, 0.0, 1.0)
    fleet.temperature += (AMBIENT + 0.02 * current * current - fleet.temperature) * (step / 120.0)


def strength(fleet: Fleet) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    """Say which share of its thrust a motor has at the battery's present voltage."""
    volts = fleet.voltage / (fleet.cells * NOMINAL_CELL_VOLTAGE)
    return bounded(volts, 0.0, 1.1) * np.minimum(fleet.remaining * (1 / LAST_CHARGE), 1.0)
