"""The parameters of a remote component: `component.params`."""

from __future__ import annotations

from contextlib import contextmanager
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.errors import (
    ParameterDenied,
    ParameterTimeout,
    RemoteCancelled,
    RemoteDenied,
    RemoteError,
    RemoteTimeout,
)
from mavstack.node.firmware import has_packed_params, param_encoding
from mavstack.node.read_only import ReadOnly
from mavstack.node.subscription import DEFAULT_QUEUE
from mavstack.node.time_budget import TimeBudget
from mavstack.services.arguments import check_number, check_text
from mavstack.services.parameters import PACKED_NAME, Encoding, ParameterChanged, renaming_of
from mavstack.services.version import RequestAutopilotVersion

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping

    from mavstack.node.clients import ComponentClients
    from mavstack.node.host import NodeHost
    from mavstack.node.subscription import Subscription
    from mavstack.services.parameters import Parameter, ParameterClient, Snapshot, Value

#: Seconds to wait for a component's capabilities before its parameter encoding follows from its heartbeat.
CAPABILITIES_TIMEOUT = 3.0
_ARDUPILOT: Final = common.MavAutopilot.ARDUPILOTMEGA
_NO_SUCH_PARAMETER: Final = common.MavParamError.DOES_NOT_EXIST


class Params(ReadOnly):
    """The parameters of a remote component, by the parameter protocol or ArduPilot's packed file."""

    def __init__(self, clients: ComponentClients) -> None:
        self._clients = clients
        self._capabilities: int | None = None

    @property
    def cached(self) -> Mapping[str, Parameter]:
        """Every parameter received so far, by name, with changes made by any component."""
        return self._clients.params.parameters

    def __getitem__(self, name: str) -> Parameter:
        """Return a parameter that was received before, such as by `download`; nothing is sent.

        Args:
            name: The name of the parameter.

        Returns:
            The parameter with its value and type.

        Raises:
            KeyError: The parameter was not received yet; `get` requests it.
        """
        try:
            return self.cached[name]
        except KeyError:
            text = f"{name!r} was not received; call get({name!r}), or download() for all parameters"
            raise KeyError(text) from None

    def __contains__(self, name: object) -> bool:
        return name in self.cached

    def __iter__(self) -> Iterator[str]:
        """Return an iterator of the names of all parameters that were received."""
        return iter(tuple(self.cached))

    @property
    def encoding(self) -> Encoding:
        """The encoding of values on the wire, as far as it is known."""
        return self._clients.params.encoding

    async def get(self, name: str, *, timeout: float | None = None) -> Parameter:
        """Get one parameter (PARAM_REQUEST_READ).

        Args:
            name: The name of the parameter.
            timeout: Seconds for the whole call; None: until retries are exhausted.

        Returns:
            The parameter with its value and type.

        Raises:
            InvalidTypeError: The name is not a str.
            ParameterDenied: The component has no such parameter (PARAM_ERROR).
            ParameterTimeout: The component does not answer, as most do for an unknown name.
            RemoteCancelled: The node was closed.
        """
        check_text("name", name)
        host, client, budget = self._start(timeout)
        await self._find_encoding(budget)
        with self._naming(name):
            return await host.finish(client, client.get(name, host.now(), timeout=budget.remaining()))

    async def set(self, name: str, value: Value, *, timeout: float | None = None) -> Parameter:
        """Set one parameter (PARAM_SET), and wait until the component reports its value.

        Args:
            name: The name of the parameter.
            value: The new value, in the parameter's own unit.
            timeout: Seconds for the whole call; None: until retries are exhausted.

        Returns:
            The parameter with the value that the component holds now.

        Raises:
            InvalidTypeError: The name is not a str, or the value is not a number.
            InvalidArgumentError: The parameter's type, or its encoding on the wire, cannot hold the value.
            ParameterDenied: The component refused the value.
            ParameterTimeout: The component does not answer, as most do for an unknown name.
            RemoteCancelled: The node was closed.
        """
        check_text("name", name)
        check_number(f"the value of {name}", value, finite=False)
        host, client, budget = self._start(timeout)
        await self._find_encoding(budget)
        operation = client.set(name, value, host.now(), timeout=budget.remaining())
        with self._naming(name):
            return await host.finish(client, operation)

    async def download(
        self,
        *,
        known: Snapshot | None = None,
        packed: bool = True,
        timeout: float | None = None,
        progress: Callable[[int, int], None] | None = None,
    ) -> Mapping[str, Parameter]:
        """Download all parameters: by the packed file, the list (PARAM_REQUEST_LIST) or a cached snapshot.

        Args:
            known: A snapshot of an earlier download; if the component's hash of its parameters still matches,
                nothing is downloaded.
            packed: Download ArduPilot's packed parameter file if the component has one, which is much faster.
            timeout: Seconds for the whole call; None: until retries are exhausted or progress stalls.
            progress: Called with the parameters (or bytes of the packed file) received and those in total.

        Returns:
            All parameters, by name.

        Raises:
            ParameterTimeout: The component does not answer.
            RemoteCancelled: The node was closed.
        """
        host, client, budget = self._start(timeout)
        await self._find_encoding(budget)
        if not (packed and await self._download_packed(budget, progress)):
            operation = client.download(host.now(), known=known, timeout=budget.remaining())
            await host.finish(client, operation, progress)
        return self.cached

    def changes(self) -> Subscription[ParameterChanged]:
        """Subscribe to changes of parameters, made by any component."""
        return self._clients.host.events(ParameterChanged, of=self._clients.params, queue=DEFAULT_QUEUE)

    def clear_cache(self) -> None:
        """Discard the capabilities that were cached before a reboot."""
        self._capabilities = None

    @contextmanager
    def _naming(self, name: str) -> Iterator[None]:
        """Add to the error for an unknown name that ArduPilot 4.7 renamed the parameter."""
        try:
            yield
        except (ParameterDenied, ParameterTimeout) as error:
            info, renamed = self._clients.info, renaming_of(name)
            unknown = not isinstance(error, ParameterDenied) or error.code == _NO_SUCH_PARAMETER
            if renamed is not None and unknown and info is not None and info.autopilot == _ARDUPILOT:
                error.status_texts = (*error.status_texts, renamed.hint)
            raise

    def _start(self, timeout: float | None) -> tuple[NodeHost, ParameterClient, TimeBudget]:
        host = self._clients.host
        return host, self._clients.params, TimeBudget(timeout, host.now)

    async def _download_packed(self, budget: TimeBudget, progress: Callable[[int, int], None] | None) -> bool:
        """Download the packed file; return whether all parameters are known from it."""
        if not has_packed_params(self._clients.info, self._capabilities or 0):
            return False
        host, ftp = self._clients.host, self._clients.ftp
        started_at = host.now()
        try:
            operation = ftp.download(PACKED_NAME, started_at, timeout=budget.remaining())
            data = await host.finish(ftp, operation, progress)
        except (RemoteTimeout, RemoteDenied):
            return False
        return self._clients.params.load_packed(data, host.now(), started_at=started_at)

    async def _find_encoding(self, budget: TimeBudget) -> None:
        if self._capabilities is None:
            self._capabilities = await self._get_capabilities(budget.remaining(CAPABILITIES_TIMEOUT))
            self._clients.params.encoding = param_encoding(self._clients.info, self._capabilities)

    async def _get_capabilities(self, timeout: float | None) -> int:
        operation = RequestAutopilotVersion(timeout=timeout)
        try:
            return (await self._clients.host.run_operation(self._clients.command, operation)).capabilities
        except RemoteCancelled:
            raise  # the node was closed
        except RemoteError:
            return 0
