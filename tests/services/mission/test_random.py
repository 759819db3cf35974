"""Plans over random networks: complete or not at all, with correct results.

Two ground stations, one vehicle whose storage outlives its restarts. Whatever happens, the storage never
holds anything but a plan that a client sent completely; an upload that succeeded is there; a download that
succeeded is what the vehicle held in that time; everything ends.
"""

from __future__ import annotations

from random import Random
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.errors import MissionDenied, MissionTimeout, RemoteCancelled
from mavstack.services import Address
from mavstack.services.mission import (
    ClearPlan,
    DownloadPlan,
    MissionClient,
    MissionItem,
    MissionServer,
    MissionServerOptions,
    Plan,
    PlanStore,
    PlanType,
    UploadPlan,
)
from mavstack.services.mission.stale_messages import UPLOAD_EXPIRES_AFTER
from tests.services.network import GROUND, VEHICLE, Network, random_impairment, with_cuts

if TYPE_CHECKING:
    from mavstack.services import Operation
    from tests.seeds import Seeds

OTHER_GROUND = Address(254, 190)
TYPES = (PlanType.MISSION, PlanType.FENCE)
TOO_FAR = 9999.0
DEADLINE = 400.0


class Storage(PlanStore):
    """Remembers all that it ever held."""

    def __init__(self) -> None:
        super().__init__()
        self.history = {kind: [Plan(kind)] for kind in TYPES}

    def put(self, plan: Plan) -> None:
        super().put(plan)
        if plan.type in self.history:
            self.history[plan.type].append(plan)  # type: ignore[index]


class ScriptedStation:
    """Does one thing after the other with the vehicle's plans, and checks each end."""

    def __init__(self, scenario: Scenario, address: Address, weight: int) -> None:
        self.scenario, self.random = scenario, Random(scenario.seed * 2 + weight)
        self.network = scenario.network
        self.left = self.random.randint(2, 5)
        self.node = self.network.node(address, self.setup)
        self.operation: Operation | None = None
        self.held_before = 1

    def setup(self, engine) -> None:
        self.client = engine.add(MissionClient(engine.local, VEHICLE))
        self.operation = None

    def restart(self) -> None:
        self.node.restart()
        self.network.at(
            UPLOAD_EXPIRES_AFTER, self.next
        )  # a new program knows nothing of the upload it was in

    def next(self) -> None:
        if self.operation is not None or not self.left:
            return
        self.left -= 1
        kind, choice = self.random.choice(TYPES), self.random.random()
        self.held_before, now = len(self.scenario.storage.history[kind]), self.network.now
        if choice < 0.5:
            self.operation = self.client.upload(self.scenario.new_plan(kind, self.random), now)
        elif choice < 0.9:
            self.operation = self.client.download(now, kind)
        else:
            self.operation = self.client.clear(now, kind)
        self.node.engine.touch(self.client)
        if self.random.random() < 0.1:
            operation = self.operation
            self.network.at(self.random.uniform(0, 2), lambda: self.cancel(operation))

    def cancel(self, operation: Operation) -> None:
        if operation is self.operation and not operation.done:
            self.client.cancel(operation, self.network.now)
            self.node.engine.touch(self.client)

    def look(self) -> None:
        if self.operation is not None and self.operation.done:
            self.check(self.operation)
            self.operation = None
            pause = self.random.choice([0.0, 0.0, 0.1, 1.0])
            self.network.at(pause, self.next)

    def check(self, operation: Operation) -> None:
        if operation.error is not None:
            assert isinstance(operation.error, MissionTimeout | MissionDenied | RemoteCancelled), (
                operation.error
            )
            self.scenario.failed += 1
            return
        held = self.scenario.storage.history[operation.type][self.held_before - 1 :]
        match operation:
            case UploadPlan(plan=plan):
                assert all(item.param2 != TOO_FAR for item in plan.items)
                assert plan in held, "an upload succeeded that the vehicle never held"
                if not self.scenario.crowded:
                    assert self.scenario.storage.get(plan.type) == plan
            case DownloadPlan():
                assert operation.result() in held, "a plan was downloaded that was never there"
            case ClearPlan():
                assert Plan(operation.type) in held
        self.scenario.succeeded += 1


class Scenario:
    def __init__(self, seed: int, *, worst_loss: float = 0.4) -> None:
        self.seed, self.random = seed, Random(seed)
        self.network = Network(seed)
        self.storage = Storage()
        self.sent: list[Plan] = [Plan(kind) for kind in TYPES]
        self.failed = self.succeeded = 0
        self.vehicle = self.network.node(VEHICLE, self.setup)
        self.crowded = self.random.random() < 0.4
        addresses = [GROUND, OTHER_GROUND] if self.crowded else [GROUND]
        self.stations = [ScriptedStation(self, address, index) for index, address in enumerate(addresses)]
        for station in self.stations:
            impairment = random_impairment(self.random, worst_loss=worst_loss)
            with_cuts(self.network, self.network.connect(station.node, self.vehicle, impairment))
            station.next()
        if self.random.random() < 0.2:
            self.network.at(self.random.uniform(0, 3), self.vehicle.restart)
        if self.random.random() < 0.1:
            self.network.at(self.random.uniform(0, 3), self.stations[0].restart)

    def setup(self, engine) -> None:
        self.server = engine.add(
            MissionServer(VEHICLE, self.storage, MissionServerOptions(limits=LIMITS), check=self.check_item)
        )

    @staticmethod
    def check_item(plan_type: int, seq: int, item: MissionItem) -> int:
        result = common.MavMissionResult
        return result.INVALID_PARAM2 if item.param2 == TOO_FAR else result.ACCEPTED

    def new_plan(self, kind: int, random: Random) -> Plan:
        count = random.choice([0, 1, 1, 2, 3, 5, 8, 20])
        number = len(self.sent)
        items = [self.item(number, seq, random) for seq in range(count)]
        plan = Plan.of(items, kind)
        self.sent.append(plan)
        return plan

    @staticmethod
    def item(number: int, seq: int, random: Random) -> MissionItem:
        wrong = TOO_FAR if random.random() < 0.01 else 0.0
        return MissionItem(
            common.MavCmd.NAV_WAYPOINT, float(number), wrong, param5=47.1, param6=8.2, param7=float(seq)
        )

    def run(self) -> None:
        assert self.network.run(self.over, timeout=DEADLINE), "something hangs"
        for plans in self.storage.history.values():
            for plan in plans:
                assert plan in self.sent, "the vehicle held a plan that nobody sent"
        self.network.run(timeout=30)
        assert self.server.next_timeout() is None, "the vehicle still waits for an upload"

    def over(self) -> bool:
        for station in self.stations:
            station.look()
        return all(station.operation is None and not station.left for station in self.stations)


LIMITS = {int(PlanType.MISSION): 100, int(PlanType.FENCE): 100}


def scenario(seed: int) -> None:
    Scenario(seed).run()


def test_plans_over_bad_links(seeds: Seeds) -> None:
    seeds.check(scenario)


def test_the_majority_of_operations_succeeds() -> None:
    """The scenario would prove nothing if everything failed."""
    done = [Scenario(seed, worst_loss=0.1) for seed in range(40)]
    for each in done:
        each.run()
    succeeded, failed = sum(each.succeeded for each in done), sum(each.failed for each in done)
    assert succeeded > 6 * failed > 0
