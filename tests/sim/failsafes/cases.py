"""Failsafe cases, run side by side in one simulation with a vehicle each.

CASES = [Case("radio-RTL", "copter", parameters={"FS_THR_ENABLE": 1}, faults=("radio off",))]
results = run_cases(CASES, "ardupilot")
results["radio-RTL"].mode
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from tests.sim.harness import SimulationHarness, VehicleHarness

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

#: Seconds from boot until vehicles can be armed, and from the placement in the air to the faults.
READY, SETTLED = 3.0, 2.5


@dataclass
class Case:
    """The event that triggers a failsafe in one vehicle, and the expected reaction."""

    name: str
    kind: str = "copter"
    parameters: dict[str, float] = field(default_factory=dict)
    faults: tuple[str, ...] = ()
    #: The mode in the air; None: the mode that holds.
    begin: str | None = None
    #: True if the vehicle stays on the ground, armed or not.
    grounded: bool = False
    arms: bool = True
    sends_heartbeats: bool = False
    #: Called before the vehicle is in the air, and when the faults begin.
    before: Callable[[VehicleHarness], object] | None = None
    event: Callable[[VehicleHarness], object] | None = None
    #: The expected state and texts.
    mode: str = ""
    armed: bool = True
    texts: tuple[str, ...] = ()

    def prepare(self, one: VehicleHarness) -> None:
        if self.before is not None:
            self.before(one)
        if not self.arms:
            return
        if not self.grounded:
            one.place_in_air(self.begin)
            return
        assert not one.autopilot.arm(force=True)
        if self.begin is not None:
            one.enter(self.begin)

    def happen(self, one: VehicleHarness) -> None:
        one.texts.clear_texts()
        one.modes.clear()
        one.inject(*self.faults)
        if self.event is not None:
            self.event(one)


def run_cases(cases: Iterable[Case], firmware: str, seconds: float = 4.0) -> dict[str, VehicleHarness]:
    """Run all cases side by side."""
    simulation_harness = SimulationHarness()
    results: dict[str, VehicleHarness] = {}
    known = list(cases)
    for case in known:
        assert case.name not in results
        results[case.name] = simulation_harness.add(
            case.kind, firmware, **case.parameters
        ).without_telemetry()
        results[case.name].sends_heartbeats = case.sends_heartbeats
    simulation_harness.run(READY)
    for case in known:
        case.prepare(results[case.name])
    simulation_harness.run(SETTLED)
    for case in known:
        case.happen(results[case.name])
    simulation_harness.run(seconds)
    return results


def stop_heartbeats(one: VehicleHarness) -> None:
    """Stop the heartbeats of the ground station."""
    one.sends_heartbeats = False
