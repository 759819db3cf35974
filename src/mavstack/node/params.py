"""The parameters of a component: read, set, fetched as a whole, watched."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.errors import RemoteCancelled, RemoteDenied, RemoteError, RemoteTimeout
from mavstack.services.parameters import (
    PACKED_NAME,
    Encoding,
    ParameterChanged,
    ParameterClient,
    encoding_of,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from mavstack.node.component import RemoteComponent
    from mavstack.node.subscription import Subscription
    from mavstack.services.parameters import Parameter, Snapshot, Value

_Capability = common.MavProtocolCapability
#: How long to ask a component for its capabilities before going by its heartbeat.
CAPABILITIES_PATIENCE = 3.0


class Params:
    """The parameters of one component; raises `ParameterDenied` or `ParameterTimeout`."""

    def __init__(self, remote: RemoteComponent) -> None:
        self._remote = remote
        self._capabilities: int | None = None

    @cached_property
    def client(self) -> ParameterClient:
        """The state machine behind it."""
        return self._remote.node.serve(ParameterClient(self._remote.node.address, self._remote.address))

    @property
    def cached(self) -> Mapping[str, Parameter]:
        """Every parameter that was heard of, by name; it follows what others set."""
        return self.client.parameters

    async def get(self, name: str, *, timeout: float | None = None) -> Parameter:
        """Ask for one parameter."""
        await self._know_encoding()
        node = self._remote.node
        return await node.driver.finish(self.client, self.client.read(name, node.now(), timeout=timeout))

    async def set(self, name: str, value: Value, *, timeout: float | None = None) -> Parameter:
        """Set a parameter and see it read back; the result is what the component holds now."""
        await self._know_encoding()
        node = self._remote.node
        return await node.driver.finish(self.client, self.client.set(name, value, node.now(), timeout=timeout))

    async def download(
        self,
        *,
        known: Snapshot | None = None,
        packed: bool = True,
        timeout: float | None = None,
        progress: Callable[[int, int], None] | None = None,
    ) -> Mapping[str, Parameter]:
        """Fetch them all: by the packed file, or the list, or not at all if `known` still holds."""
        await self._know_encoding()
        if not (packed and await self._fetched_packed(timeout, progress)):
            node = self._remote.node
            operation = self.client.fetch_all(node.now(), known=known, timeout=timeout)
            await node.driver.finish(self.client, operation, progress)
        return self.cached

    def changes(self) -> Subscription[ParameterChanged]:
        """Each parameter that changes from now on, whoever changes it."""
        return self._remote.node.events(ParameterChanged, of=self.client)

    def clear_cache(self) -> None:
        """The component started anew: its parameters, and how it tells them, are to be asked for again."""
        self._capabilities = None
        if "client" in self.__dict__:
            self.client.forget(self._remote.node.now())
            self._remote.node.wake(self.client)

    async def _fetched_packed(
        self, timeout: float | None, progress: Callable[[int, int], None] | None
    ) -> bool:
        """ArduPilot packs all parameters into a file, which is smaller and comes at a file's speed."""
        if not (self._is_ardupilot and self._can(_Capability.FTP)):
            return False
        begun = self._remote.node.now()
        try:
            data = await self._remote.ftp.download(PACKED_NAME, timeout=timeout, progress=progress)
        except (RemoteTimeout, RemoteDenied):
            return False
        return self.client.take_packed(data, self._remote.node.now(), begun=begun)

    async def _know_encoding(self) -> None:
        if self._capabilities is None:
            self._capabilities = await self._ask_capabilities()
            info = self._remote.info
            autopilot = info.autopilot if info else common.MavAutopilot.GENERIC
            self.client.encoding = encoding_of(self._capabilities, autopilot)

    async def _ask_capabilities(self) -> int:
        try:
            return (await self._remote.get_version(timeout=CAPABILITIES_PATIENCE)).capabilities
        except RemoteCancelled:
            raise  # the node was closed
        except RemoteError:
            return 0

    def _can(self, capability: int) -> bool:
        return bool((self._capabilities or 0) & capability)

    @property
    def _is_ardupilot(self) -> bool:
        info = self._remote.info
        return info is not None and info.autopilot == common.MavAutopilot.ARDUPILOTMEGA

    @property
    def encoding(self) -> Encoding:
        """How the component encodes values, as far as is known."""
        return self.client.encoding
