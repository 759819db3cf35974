"""Many small scenes at once: each has a vehicle of its own in one simulation, to which something happens.

SCENES = [Scene("radio-RTL", "copter", parameters={"FS_THR_ENABLE": 1}, faults="radio off")]
played = play(SCENES)
played["radio-RTL"].mode
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from tests.sim.flights import Airspace, Flown

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

#: From boot to readiness, and from being in the air to what happens.
READY, SETTLED = 3.0, 2.5


@dataclass
class Scene:
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
    talks: bool = False
    #: Done before it is in the air, and when the faults begin.
    before: Callable[[Flown], object] | None = None
    event: Callable[[Flown], object] | None = None
    #: What is to be afterwards.
    mode: str = ""
    armed: bool = True
    says: tuple[str, ...] = ()

    def prepare(self, one: Flown) -> None:
        if self.before is not None:
            self.before(one)
        if not self.arms:
            return
        if not self.grounded:
            one.put_into_the_air(self.begin)
            return
        assert not one.autopilot.arm(force=True)
        if self.begin is not None:
            one.enter(self.begin)

    def happen(self, one: Flown) -> None:
        one.texts.forget()
        one.modes.clear()
        one.inject(*self.faults)
        if self.event is not None:
            self.event(one)


def play(scenes: Iterable[Scene], firmware: str, seconds: float = 4.0) -> dict[str, Flown]:
    """Let all of them happen side by side."""
    airspace = Airspace()
    played: dict[str, Flown] = {}
    known = list(scenes)
    for scene in known:
        assert scene.name not in played
        played[scene.name] = airspace.add(scene.kind, firmware, **scene.parameters).mute()
        played[scene.name].talks = scene.talks
    airspace.run(READY)
    for scene in known:
        scene.prepare(played[scene.name])
    airspace.run(SETTLED)
    for scene in known:
        scene.happen(played[scene.name])
    airspace.run(seconds)
    return played


def silence(one: Flown) -> None:
    """The ground station is heard no more."""
    one.talks = False
