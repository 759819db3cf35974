"""A simulated ArduPilot and a ground station that speaks to it, in virtual time."""

from __future__ import annotations

from math import nan
from typing import TYPE_CHECKING

from mavstack import Dialect, Parser, encode
from mavstack.dialects import ardupilotmega, common
from mavstack.services.command import Command
from mavstack.services.mission import MissionItem, Plan, PlanType
from mavstack.sim.simulation import Simulation

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.dialects import Message
    from mavstack.sim.autopilot.interfaces import Autopilot
    from mavstack.sim.vehicle_types import VehicleType

CMD = ardupilotmega.MavCmd
RESULT = common.MavResult
RELATIVE = common.MavFrame.GLOBAL_RELATIVE_ALT
GROUND = (255, 190)


class Bench:
    """One vehicle; `messages` and `texts` are what it sent so far."""

    def __init__(self, kind: VehicleType | str = "copter", *, settle: float = 2.3) -> None:
        self.simulation = Simulation()
        self.vehicle = self.simulation.add(kind, "ardupilot")
        self.port = self.vehicle.open_port("ground")
        self.messages: list[Message] = []
        self._parser = Parser(Dialect.load("all"))
        self._sequence = 0
        self.run(settle)

    @property
    def autopilot(self) -> Autopilot:
        return self.vehicle.autopilot

    @property
    def mode(self) -> str:
        return self.autopilot.mode.name

    @property
    def texts(self) -> list[str]:
        return [message.text for message in self.messages if isinstance(message, common.Statustext)]

    def run(self, seconds: float) -> None:
        end = self.simulation.now + seconds
        while self.simulation.now < end:
            self.simulation.step()
            self._take()

    def run_until(self, reached: Callable[[], object], limit: float = 120.0) -> None:
        end = self.simulation.now + limit
        while not reached():
            assert self.simulation.now < end, (
                f"not in {limit} s: {self.mode}, {self.autopilot.maneuvers.place}"
            )
            self.run(0.2)

    def send(self, message: Message, source: tuple[int, int] = GROUND) -> None:
        self._sequence = (self._sequence + 1) % 256
        data = encode(message, system=source[0], component=source[1], sequence=self._sequence)
        self.vehicle.receive(self.port, data)
        self._take()

    def ask(self, command: int, *params: float, frame: int | None = None, wait: float = 0.3) -> int:
        """Send a command; gives the last answer to it."""
        wanted = Command.of(command, params, frame)
        known = len(self.messages)
        address = self.vehicle.address
        self.send(wanted.to_long(address) if frame is None else wanted.to_int(address))
        self.run(wait)
        answers = [
            message.result
            for message in self.messages[known:]
            if isinstance(message, common.CommandAck) and message.command == int(command)
        ]
        assert answers, f"no answer to {wanted.name}"
        return answers[-1]

    def accepted(self, command: int, *params: float, frame: int | None = None, wait: float = 0.3) -> None:
        assert self.ask(command, *params, frame=frame, wait=wait) == RESULT.ACCEPTED, self.texts[-3:]

    def set_mode(self, name: str) -> int:
        number = next(mode.number for mode in self.autopilot.profile.modes if mode.name == name)
        return self.ask(CMD.DO_SET_MODE, 1, number)

    def at(self, north: float, east: float) -> tuple[float, float]:
        return self.vehicle.body.frame.to_global(north, east, 0.0)[:2]

    def reposition(self, north: float, east: float, altitude: float, *, frame: int = RELATIVE) -> int:
        return self.ask(CMD.DO_REPOSITION, -1, 1, 0, nan, *self.at(north, east), altitude, frame=frame)

    def lift(self, height: float = 10.0) -> None:
        """In the air in GUIDED; what does not fly is armed in it."""
        if self.vehicle.type in ("copter", "vtol"):
            self.autopilot.enter(self.autopilot.profile.guided, "test")
            self.autopilot.arm(force=True)
            self.vehicle.body.place(0.0, 0.0, -height, 0.0)
            self.autopilot.guided.go_to((0.0, 0.0, -height))
        else:
            self.vehicle.profile.take_off(self.autopilot, height)
        if self.vehicle.type.flies:
            self.run_until(lambda: self.autopilot.altitude > 0.9 * height and not self.autopilot.landed)
        self.run(0.5)
        assert self.set_mode("GUIDED") == RESULT.ACCEPTED

    def load(self, *items: MissionItem) -> None:
        """Replace the mission; its item 0 is home."""
        home = MissionItem(common.MavCmd.NAV_WAYPOINT, frame=common.MavFrame.GLOBAL)
        self.vehicle.mission.replace(Plan(PlanType.MISSION, (home, *items)))

    def waypoint(self, north: float, east: float, altitude: float) -> MissionItem:
        latitude, longitude = self.at(north, east)
        return MissionItem(
            common.MavCmd.NAV_WAYPOINT, param5=latitude, param6=longitude, param7=altitude, frame=RELATIVE
        )

    def _take(self) -> None:
        for _, data in self.vehicle.data_to_send():
            self.messages.extend(packet.message for packet in self._parser.feed(data))
