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

    def prepare(self, harness: VehicleHarness) -> None:
        if self.before is not None:
            self.before(harness)
        if not self.arms:
            return
        if not self.grounded:
            harness.place_in_air(self.begin)
            return
        assert not harness.autopilot.arm(force=True)
        if self.begin is not None:
            harness.enter(self.begin)

    def trigger(self, harness: VehicleHarness) -> None:
        harness.texts.clear_texts()
        harness.modes.clear()
        harness.inject(*self.faults)
        if self.event is not None:
            self.event(harness)


def run_cases(cases: Iterable[Case], firmware: str, seconds: float = 4.0) -> dict[str, VehicleHarness]:
    """Run all cases side by side."""
    simulation_harness = SimulationHarness()
    results: dict[str, VehicleHarness] = {}
    all_cases = list(cases)
    for case in all_cases:
        assert case.name not in results
        results[case.name] = simulation_harness.add(
            case.kind, firmware, **case.parameters
        ).without_telemetry()
        results[case.name].sends_heartbeats = case.sends_heartbeats
    simulation_harness.run(READY)
    for case in all_cases:
        case.prepare(results[case.name])
    simulation_harness.run(SETTLED)
    for case in all_cases:
        case.trigger(results[case.name])
    simulation_harness.run(seconds)
    return results


def stop_heartbeats(harness: VehicleHarness) -> None:
    """Stop the heartbeats of the ground station."""
    harness.sends_heartbeats = False
