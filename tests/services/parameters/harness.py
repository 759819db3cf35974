"""Tables of parameters that several tests use."""

from __future__ import annotations

from random import Random
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.services.parameters import Encoding, ParameterClient, ParameterServer
from tests.services.network import GROUND, VEHICLE, Network

if TYPE_CHECKING:
    from mavstack.links import Impairment
    from mavstack.services.parameters import Parameter, Value
    from tests.services.network import HalfDuplexRadio, Node, Pipe

KIND = common.MavParamType
SMALL_KINDS = (KIND.INT8, KIND.UINT8, KIND.INT16, KIND.UINT16, KIND.INT32, KIND.UINT32, KIND.REAL32)


def any_value(random: Random, kind: int, encoding: Encoding) -> Value:
    if kind == KIND.REAL32:
        return random.choice([0.0, 0.5, -3.25, 1e10, random.randrange(1 << 20) / 64])
    bits = {KIND.INT8: 7, KIND.UINT8: 8, KIND.INT16: 15, KIND.UINT16: 16, KIND.INT32: 31, KIND.UINT32: 32}[
        kind  # type: ignore[index]
    ]
    signed = kind in (KIND.INT8, KIND.INT16, KIND.INT32)
    if encoding is Encoding.C_CAST:
        bits = min(bits, 24)
    return random.randrange(-(1 << bits) + 1 if signed else 0, 1 << bits)


def any_table(random: Random, size: int, encoding: Encoding) -> list[tuple[str, Value, int]]:
    table = []
    for number in range(size):
        kind = random.choice(SMALL_KINDS)
        name = f"P{number:03d}_{'ABCDEFGHIJKL'[: random.randrange(12)]}"[:16]
        table.append((name, any_value(random, kind, encoding), kind))
    return table


def values_of(parameters: dict[str, Parameter]) -> dict[str, Value]:
    return {name: parameter.value for name, parameter in parameters.items()}


def table_of(server: ParameterServer) -> dict[str, Value]:
    return {definition.name: definition.value for definition in server.table}


class ParameterHarness:
    """A client on the ground and a server on a vehicle, joined by one link."""

    def __init__(
        self,
        size: int = 20,
        *,
        seed: int = 0,
        encoding: Encoding = Encoding.BYTEWISE,
        impairment: Impairment | None = None,
        radio: HalfDuplexRadio | None = None,
        bandwidth: float | None = None,
        hash_check: bool | None = None,
    ) -> None:
        self.network = Network(seed, keep_packets=True)
        self.rows = any_table(Random(seed), size, encoding)
        self.encoding = encoding
        self.hash_check = hash_check
        self.vehicle: Node = self.network.node(VEHICLE, self._setup)
        self.ground: Node = self.network.node(GROUND)
        self.client = self.ground.engine.add(ParameterClient(GROUND, VEHICLE, encoding))
        self.pipes: tuple[Pipe, Pipe] = self.network.connect(
            self.ground, self.vehicle, impairment, radio=radio, bandwidth=bandwidth
        )

    def _setup(self, engine) -> None:
        self.server = engine.add(ParameterServer(VEHICLE, self.encoding, hash_check=self.hash_check))
        for name, value, kind in self.rows:
            self.server.add(name, value, kind)

    def run(self, *operations, timeout: float = 120.0) -> float:
        """Until the operations have ended; gives the seconds it took."""
        begin = self.network.now
        self.ground.engine.touch(self.client)
        assert self.network.run(lambda: all(operation.done for operation in operations), timeout=timeout)
        return self.network.now - begin

    def touch(self) -> None:
        self.vehicle.engine.touch(self.server)
        self.ground.engine.touch(self.client)
