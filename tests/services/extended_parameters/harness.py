"""A client and a server of extended parameters."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.services import Address
from mavstack.services.extended_parameters import ExtendedParameterClient, ExtendedParameterServer
from tests.services.network import GROUND, Network

if TYPE_CHECKING:
    from mavstack.links import Impairment
    from mavstack.services.extended_parameters import ExtendedValue

CAMERA = Address(1, 100)


class ExtendedParameterHarness:
    """A client on the ground and a server on a camera, joined by one link."""

    def __init__(
        self,
        rows: dict[str, tuple[ExtendedValue, int | None]] | None = None,
        *,
        seed: int = 0,
        impairment: Impairment | None = None,
    ) -> None:
        self.network = Network(seed, keep_packets=True)
        self.rows = rows or {}
        self.camera = self.network.node(CAMERA, self._setup)
        self.ground = self.network.node(GROUND)
        self.client = self.ground.engine.add(ExtendedParameterClient(GROUND, CAMERA))
        self.pipes = self.network.connect(self.ground, self.camera, impairment)

    def _setup(self, engine) -> None:
        self.server = engine.add(ExtendedParameterServer(CAMERA))
        for name, (value, kind) in self.rows.items():
            self.server.add(name, value, kind)

    def touch(self) -> None:
        self.camera.engine.touch(self.server)
        self.ground.engine.touch(self.client)

    def run(self, *operations, timeout: float = 200.0) -> float:
        begin = self.network.now
        self.touch()
        assert self.network.run(lambda: all(operation.done for operation in operations), timeout=timeout)
        return self.network.now - begin
