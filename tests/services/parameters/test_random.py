"""Parameters over random networks: equal sets on both ends, or a typed error in time."""

from __future__ import annotations

from random import Random
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.errors import ParameterDenied, ParameterTimeout, RemoteError
from mavstack.services import Address
from mavstack.services.parameters import Encoding, ParameterClient, ParameterServer
from tests.services.network import GROUND, VEHICLE, Network, random_impairment, with_cuts
from tests.services.parameters.harness import any_table, any_value, table_of, values_of

if TYPE_CHECKING:
    from mavstack.services.parameters import Value
    from tests.seeds import Seeds

DEADLINE = 200.0
SECOND_GROUND = Address(254, 190)


class Vehicle:
    """Keeps its values over restarts, as a vehicle with storage does."""

    def __init__(self, network: Network, random: Random, encoding: Encoding) -> None:
        self.encoding = encoding
        self.rows = {name: (value, kind) for name, value, kind in any_table(random, 40, encoding)}
        for spare in random.sample(sorted(self.rows), random.randrange(39)):
            del self.rows[spare]
        self.hash_check = random.choice([None, False])
        self.node = network.node(VEHICLE, self.setup)

    def setup(self, engine) -> None:
        self.server = engine.add(ParameterServer(VEHICLE, self.encoding, hash_check=self.hash_check))
        for name, (value, kind) in self.rows.items():
            self.server.add(name, value, kind)
        self.server.add("READ_ONLY", 7, read_only=True)
        self.server.add("SMALL", 3, minimum=0, maximum=10)

    def restart(self) -> None:
        for name, value in table_of(self.server).items():
            if name in self.rows:
                self.rows[name] = (value, self.rows[name][1])
        self.node.restart()

    def grow(self) -> None:
        self.server.add("GROWN", 1.5)


def scenario(seed: int) -> None:
    network, random = Network(seed), Random(seed)
    encoding = random.choice(list(Encoding))
    vehicle = Vehicle(network, random, encoding)
    original = table_of(vehicle.server)
    grounds = [network.node(GROUND), network.node(SECOND_GROUND)]
    clients = [ground.engine.add(ParameterClient(ground.address, VEHICLE, encoding)) for ground in grounds]
    for ground in grounds:
        with_cuts(network, network.connect(ground, vehicle.node, random_impairment(random)))
    if random.random() < 0.2:
        network.at(random.uniform(0, 3), vehicle.restart)
    grows = random.random() < 0.1
    if grows:
        network.at(random.uniform(0, 0.5), vehicle.grow)
    first, second = clients
    lists = [first.download(network.now), second.download(network.now)]
    wanted = choose_sets(random, vehicle, encoding)
    sets = [(name, value, first.set(name, value, network.now)) for name, value in wanted]
    denied = [first.set("READ_ONLY", 8, network.now), second.set("SMALL", 11, network.now)]
    unknown = second.get("UNKNOWN", network.now)
    ends = (*lists, *(operation for _, _, operation in sets), *denied, unknown)
    for ground, client in zip(grounds, clients, strict=True):
        ground.engine.touch(client)
    assert network.run(lambda: all(operation.done for operation in ends), timeout=DEADLINE)
    check_sets(vehicle, original, sets)
    check_denied(vehicle, [*denied, unknown])
    changed = {name for name, _ in wanted} | ({"GROWN"} if grows else set())
    for listing in lists:
        if listing.error is None:
            found = {
                name: value for name, value in values_of(listing.result()).items() if name not in changed
            }
            assert found == {name: value for name, value in original.items() if name not in changed}
            assert set(listing.result()) - {"GROWN"} == set(original)
        else:
            assert isinstance(listing.error, ParameterTimeout)


def choose_sets(random: Random, vehicle: Vehicle, encoding: Encoding) -> list[tuple[str, Value]]:
    names = random.choices(sorted(vehicle.rows), k=random.randrange(6))
    return [(name, any_value(random, vehicle.rows[name][1], encoding)) for name in names]


def check_sets(vehicle: Vehicle, original: dict[str, Value], sets) -> None:
    """The vehicle has the last confirmed value; an unconfirmed one may or may not have arrived."""
    possible: dict[str, list[Value]] = {}
    for name, value, operation in sets:
        if operation.error is None:
            assert operation.result().value == value
            possible[name] = [value]
        else:
            assert isinstance(operation.error, RemoteError)
            possible[name] = [*possible.get(name, [original[name]]), value]
    for name, values in possible.items():
        assert vehicle.server[name] in values


def check_denied(vehicle: Vehicle, operations) -> None:
    assert (vehicle.server["READ_ONLY"], vehicle.server["SMALL"]) == (7, 3)
    codes = (
        common.MavParamError.READ_ONLY,
        common.MavParamError.VALUE_OUT_OF_RANGE,
        common.MavParamError.DOES_NOT_EXIST,
    )
    for operation, code in zip(operations, codes, strict=True):
        assert isinstance(operation.error, ParameterDenied | ParameterTimeout)
        if isinstance(operation.error, ParameterDenied):
            assert operation.error.code in (code, 0)


def test_parameters_over_bad_links(seeds: Seeds) -> None:
    seeds.check(scenario)


def restart_scenario(seed: int) -> None:
    """The ground station restarts during a download and a set; after the restart its download succeeds."""
    network, random = Network(seed), Random(seed)
    vehicle = Vehicle(network, random, Encoding.BYTEWISE)
    clients: list[ParameterClient] = []
    ground = network.node(GROUND, lambda engine: clients.append(engine.add(ParameterClient(GROUND, VEHICLE))))
    network.connect(ground, vehicle.node, random_impairment(random))
    name = random.choice(sorted(vehicle.rows)) if vehicle.rows else "SMALL"
    clients[0].download(network.now)
    clients[0].set(name, 4, network.now)
    ground.engine.touch(clients[0])
    network.run(timeout=random.uniform(0, 2))
    ground.restart()
    network.run(timeout=1.0)  # what the old one sent last and was overtaken has arrived, too
    listing = clients[1].download(network.now)
    setting = clients[1].set(name, 5, network.now)
    ground.engine.touch(clients[1])
    assert network.run(lambda: listing.done and setting.done, timeout=DEADLINE)
    if setting.error is None:
        assert vehicle.server[name] == 5
    if listing.error is None:
        found = {key: value for key, value in values_of(listing.result()).items() if key != name}
        assert found == {key: value for key, value in table_of(vehicle.server).items() if key != name}
    else:
        assert isinstance(listing.error, ParameterTimeout)


def test_the_ground_restarts(seeds: Seeds) -> None:
    seeds.check(restart_scenario)
