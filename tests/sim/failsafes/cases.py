"""Many small scenes at once: each has a vehicle of its own in one simulation, to which something happens.

SCENES = [Scene("radio-RTL", "copter", parameters={"FS_THR_ENABLE": 1}, faults="radio off")]
played = play(SCENES)
played["radio-RTL"].mode
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from tests.sim.harness import SimulationHarness, VehicleHarness

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

#: From boot to readiness, and from being in the air to what happens.
READY, SETTLED = 3.0, 2.5


@dataclass
class Case:
    """What happens to one vehicle, and what is to come of it."""

    name: str
    kind: str = "copter"
    parameters: dict[str, float] = field(default_factory=dict)
    faults: tuple[str, ...] = ()
    #: In which mode it is in the air; None: where it holds.
    begin: str | None = None
    #: Whether it stays on the ground, armed or not.
    grounded: bool = False
    arms: bool = True
    sends_heartbeats: bool = False
    #: Done before it is in the air, and when the faults begin.
    before: Callable[[VehicleHarness], object] | None = None
    event: Callable[[VehicleHarness], object] | None = None
    #: What is to be afterwards.
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
    """Let all of them happen side by side."""
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
    """The ground station is heard no more."""
    one.sends_heartbeats = False
