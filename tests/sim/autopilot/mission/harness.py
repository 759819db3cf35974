"""A stub flight with the vehicle's real side of the mission protocol, and plans put the way uploads come.

    flight = MissionFlight(VehicleType.COPTER, Firmware.ARDUPILOT)
    flight.load(takeoff(20), waypoint(100, 0), item(CMD.NAV_LAND))
    flight.start()
    flight.run_until(lambda: flight.mission.state == COMPLETE, timeout=120)

Places are metres north and east of where the vehicle begins, altitudes metres above it.
"""

from __future__ import annotations

import types
from math import hypot
from typing import TYPE_CHECKING, Any

from mavstack.dialects import ardupilotmega, common
from mavstack.services import Address
from mavstack.services.mission import (
    CurrentItemSet,
    MissionItem,
    MissionServer,
    MissionServerOptions,
    Plan,
    PlanReplaced,
    PlanType,
)
from mavstack.sim.autopilot.behaviours import Mission
from mavstack.sim.autopilot.fence import FenceWatch
from mavstack.sim.autopilot.mission import MissionRunner
from mavstack.sim.autopilot.rally import RallyPoints
from mavstack.sim.motion import LocalFrame
from mavstack.sim.vehicle_types import DEFAULT_HOME, Firmware, Home, VehicleType
from tests.sim.autopilot.harness import MISSION, AutopilotHarness

if TYPE_CHECKING:
    from mavstack.sim.autopilot.maneuvers import Point

CMD = ardupilotmega.MavCmd
RESULT = common.MavMissionResult
STATE = common.MissionState
FRAME = common.MavFrame
GROUND = Address(255, 190)
_LOCAL = LocalFrame(DEFAULT_HOME.latitude, DEFAULT_HOME.longitude, DEFAULT_HOME.altitude)


class MissionHarness(AutopilotHarness):
    """A vehicle of a type and a firmware."""

    def __init__(
        self,
        kind: VehicleType = VehicleType.COPTER,
        firmware: Firmware = Firmware.ARDUPILOT,
        *,
        home: Home = DEFAULT_HOME,
        **flight_parameters: Any,
    ) -> None:
        self.firmware = firmware
        super().__init__(kind, home=home, modes={MISSION: Mission}, **flight_parameters)
        vehicle = self.vehicle
        vehicle.firmware = firmware
        for event in (PlanReplaced, CurrentItemSet):
            vehicle.reactions.pop(event)
        self.autopilot.watches = [
            watch for watch in self.autopilot.watches if not isinstance(watch, (MissionRunner, FenceWatch))
        ]
        vehicle.services = types.SimpleNamespace(send=self._sent)
        vehicle.uptime_ms = 0
        self.sent: list[Any] = []
        self.server = vehicle.mission = MissionServer(
            vehicle.address,
            vehicle.plans,
            MissionServerOptions(home_first=firmware is Firmware.ARDUPILOT),
            validate=lambda *plan: self.mission.validate(*plan),  # noqa: PLW0108 (made later)
            check=lambda *item: self.mission.check(*item),  # noqa: PLW0108 (made later)
        )
        autopilot: Any = self.autopilot
        autopilot.mission, autopilot.fence = MissionRunner(autopilot), FenceWatch(autopilot)
        autopilot.rally = RallyPoints(autopilot)
        vehicle.touch = self._touched
        self.first = 1 if firmware is Firmware.ARDUPILOT else 0

    @property
    def mission(self) -> MissionRunner:
        return self.autopilot.mission

    @property
    def status_texts(self) -> list[str]:
        texts: list[str] = self.vehicle.status_texts
        return texts

    def _sent(self, message: Any, *_: Any) -> None:
        self.sent.append(message)

    def _touched(self, service: Any) -> None:
        self.sent += [outgoing.message for outgoing in self.server.messages_to_send(self.now)]

    @property
    def reached(self) -> list[int]:
        """The numbers of MISSION_ITEM_REACHED in order; of PX4's repetitions, the first."""
        reported = [message.seq for message in self.sent if isinstance(message, common.MissionItemReached)]
        again = self.vehicle.firmware is Firmware.PX4
        return [seq for at, seq in enumerate(reported) if not again or at == 0 or reported[at - 1] != seq]

    @property
    def currents(self) -> list[int]:
        """The current items in MISSION_CURRENT, each change once."""
        reported = [message.seq for message in self.sent if isinstance(message, common.MissionCurrent)]
        return [seq for at, seq in enumerate(reported) if at == 0 or reported[at - 1] != seq]

    # Plans

    def upload(self, *items: MissionItem, kind: int = PlanType.MISSION) -> int:
        """Store a plan as an upload does, with the checks of each item and of the whole plan."""
        result = self.server.accept(Plan.of(items, kind), GROUND)
        self._settle()
        return result

    def load(self, *items: MissionItem) -> None:
        """Store a mission, for ArduPilot with the home position as its first item."""
        home = [item(CMD.NAV_WAYPOINT, frame=FRAME.GLOBAL)] if self.first else []
        assert self.upload(*home, *items) == RESULT.ACCEPTED

    def clear(self, kind: int = PlanType.MISSION) -> int:
        return self.upload(kind=kind)

    def set_current(self, seq: int, *, reset: bool = False) -> None:
        """As MISSION_SET_CURRENT does."""
        assert self.server._set_current(seq, GROUND, restart=reset)
        self._settle()

    def _settle(self) -> None:
        for event in self.server.events():
            self.vehicle.handle_event(event)
        self._touched(self.server)

    # Flying

    def start(self) -> None:
        """Arm if it is not yet, and fly the mission."""
        if not self.autopilot.armed:
            self.arm()
        assert self.mission.start() is None, self.mission.refusal()

    def ended(self, timeout: float = 300.0) -> None:
        """Until the mission is complete."""
        self.run_until(lambda: self.mission.state == STATE.COMPLETE, timeout=timeout)

    def reach(self, seq: int, timeout: float = 120.0) -> None:
        """Until an item is the current one."""
        self.run_until(lambda: self.mission.sequence == seq, timeout=timeout)

    @property
    def place(self) -> tuple[float, float]:
        return self.body.truth.north, self.body.truth.east


def item(
    command: int, *params: float, at: Point | None = None, frame: int | None = None, **more: Any
) -> MissionItem:
    """An item with its first params, and a place in metres north, east and up."""
    values = {f"param{index}": value for index, value in enumerate(params, 1)}
    if at is not None:
        latitude, longitude, _ = _LOCAL.to_global(at[0], at[1], 0.0)
        values |= {"param5": latitude, "param6": longitude, "param7": at[2]}
    if frame is None:
        placed = at is not None or command in {
            CMD.NAV_TAKEOFF,
            CMD.NAV_LAND,
            CMD.NAV_VTOL_LAND,
            CMD.NAV_VTOL_TAKEOFF,
        }
        frame = FRAME.GLOBAL_RELATIVE_ALT if placed else FRAME.MISSION
    return MissionItem(command, **values, frame=frame, **more)


def waypoint(north: float, east: float, up: float = 20.0, **params: float) -> MissionItem:
    return item(CMD.NAV_WAYPOINT, *(params.get(f"param{n}", 0.0) for n in range(1, 5)), at=(north, east, up))


def takeoff(up: float = 20.0, command: int = CMD.NAV_TAKEOFF) -> MissionItem:
    return item(command, at=(0.0, 0.0, up))


def land(north: float | None = None, east: float = 0.0) -> MissionItem:
    return item(CMD.NAV_LAND, at=None if north is None else (north, east, 0.0))


def cross_track(
    track: list[tuple[float, ...]], begin: tuple[float, float], end: tuple[float, float], corner: float
) -> float:
    """The farthest that a track is from a line, `corner` metres at its ends left aside."""
    along = end[0] - begin[0], end[1] - begin[1]
    length = hypot(*along)
    worst = 0.0
    for north, east, *_ in track:
        here = north - begin[0], east - begin[1]
        progress = (here[0] * along[0] + here[1] * along[1]) / length
        if corner <= progress <= length - corner:
            worst = max(worst, abs(here[0] * along[1] - here[1] * along[0]) / length)
    return worst


def fly_items(
    *items: MissionItem,
    firmware: Firmware = Firmware.ARDUPILOT,
    kind: VehicleType = VehicleType.COPTER,
    **flight_parameters: float,
) -> MissionHarness:
    """Fly a mission of a takeoff to 10 m and these items, up to the first item."""
    flight = MissionHarness(kind, firmware, **flight_parameters)
    flight.load(takeoff(10), *items)
    flight.start()
    flight.run_until(lambda: flight.first in flight.reached, timeout=60)
    return flight


def fly_short_mission(*items: MissionItem, firmware: Firmware = Firmware.ARDUPILOT) -> MissionHarness:
    """Fly a takeoff to 2 m, these items and a waypoint, to the end."""
    flight = MissionHarness(VehicleType.COPTER, firmware)
    flight.load(takeoff(2), *items, waypoint(8, 0, 2))
    flight.start()
    flight.ended()
    return flight
