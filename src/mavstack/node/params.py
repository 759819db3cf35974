"""The parameters of a remote component: `component.params`."""

from __future__ import annotations

from contextlib import contextmanager
from os import fspath
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.errors import (
    InvalidArgumentError,
    MetadataError,
    ParameterDenied,
    ParameterTimeout,
    RemoteCancelled,
    RemoteDenied,
    RemoteError,
    RemoteProtocolError,
    RemoteTimeout,
)
from mavstack.files.parameter_metadata import MetadataCache, parse_parameter_metadata, read_metadata_file
from mavstack.node.api_object import ReadOnly
from mavstack.node.firmware import (
    firmware_key,
    has_packed_params,
    is_ardupilot,
    is_px4,
    param_encoding,
    saves_at_once,
    saves_by_itself,
)
from mavstack.node.metadata_files import MetadataAccess, MetadataFiles
from mavstack.node.subscription import DEFAULT_QUEUE
from mavstack.node.time_budget import TimeBudget
from mavstack.services.arguments import check_number, check_text
from mavstack.services.command import Command, CommandOperation
from mavstack.services.ftp import FtpClient
from mavstack.services.parameters import (
    PACKED_NAME,
    Encoding,
    MetadataTable,
    ParameterChanged,
    ParameterClient,
    renaming_of,
)
from mavstack.services.parameters.metadata import NO_METADATA, number_text
from mavstack.services.version import RequestAutopilotVersion

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping
    from os import PathLike

    from mavstack.node.clients import ComponentClients
    from mavstack.node.host import NodeHost
    from mavstack.node.subscription import Subscription
    from mavstack.services.parameters import Parameter, Snapshot, Value
    from mavstack.services.version import AutopilotVersion

#: Seconds to wait for a component's capabilities; then its heartbeat determines its parameter encoding.
CAPABILITIES_TIMEOUT = 3.0
_NO_SUCH_PARAMETER: Final = common.MavParamError.DOES_NOT_EXIST
#: Value of param 1 of MAV_CMD_PREFLIGHT_STORAGE.
_SAVE_PARAMETERS: Final = 1
#: The cached metadata files in the user's cache directory.
USER_CACHE = MetadataCache()


class Params(ReadOnly):
    """The parameters of a remote component, by the parameter protocol or ArduPilot's packed file."""

    def __init__(self, clients: ComponentClients) -> None:
        self._clients = clients
        #: The component's version; None: not requested yet, or the component did not answer the request.
        self._version: AutopilotVersion | None = None
        self._version_requested = False
        self._metadata = NO_METADATA
        self._unsaved: dict[str, None] = {}
        self._is_complete = False
        self._metadata_files = MetadataFiles(clients)

    @property
    def _client(self) -> ParameterClient:
        return self._clients.get(ParameterClient)

    @property
    def cached(self) -> Mapping[str, Parameter]:
        """Every parameter received so far, by name, with changes made by any component."""
        return self._client.parameters

    @property
    def is_complete(self) -> bool:
        """True if `cached` has all parameters: they were downloaded, and no reboot came since."""
        return self._is_complete

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
        return self._client.encoding

    @property
    def metadata(self) -> MetadataTable:
        """The metadata (description, unit, range, values) by name; empty until downloaded or loaded."""
        return self._metadata

    @property
    def unsaved(self) -> tuple[str, ...]:
        """The names that `set` changed and a restart reverts, until `commit`; empty if the firmware saves."""
        return tuple(self._unsaved)

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
        with self._explain_renamed(name):
            return await host.finish(client, client.get(name, host.now(), timeout=budget.remaining()))

    async def set(
        self, name: str, value: Value, *, check: bool = False, timeout: float | None = None
    ) -> Parameter:
        """Set one parameter (PARAM_SET), and wait until the component reports its value.

        Args:
            name: The name of the parameter.
            value: The new value, in the parameter's own unit.
            check: Refuse a value that `metadata` does not allow; a parameter without metadata is not checked.
            timeout: Seconds for the whole call; None: until retries are exhausted.

        Returns:
            The parameter with the value that the component holds now.

        Raises:
            InvalidTypeError: The name is not a str, or the value is not a number.
            InvalidArgumentError: The parameter's type, or its encoding on the wire, cannot hold the value; or
                with `check` the metadata does not allow it.
            ParameterDenied: The component refused the value.
            ParameterTimeout: The component does not answer, as most do for an unknown name.
            RemoteCancelled: The node was closed.
        """
        check_text("name", name)
        check_number(f"the value of {name}", value, finite=False)
        problem = self.metadata.problem(name, value) if check else None
        if problem is not None:
            raise InvalidArgumentError(f"{name} cannot be set to {number_text(value)}: {problem}")
        host, client, budget = self._start(timeout)
        await self._find_encoding(budget)
        operation = client.set(name, value, host.now(), timeout=budget.remaining())
        with self._explain_renamed(name):
            held = await host.finish(client, operation)
        if not saves_by_itself(self._clients.info):
            self._unsaved[name] = None
        return held

    async def commit(self, *, timeout: float | None = None) -> None:
        """Save all parameters, so that they outlast a restart (MAV_CMD_PREFLIGHT_STORAGE).

        Betaflight and iNav keep what was set only if it is saved. PX4 saves by itself after some seconds,
        and by this call at once. ArduPilot saves each parameter when it is set, and is sent nothing.

        Args:
            timeout: Seconds for the whole call; None: until retries are exhausted.

        Raises:
            CommandDenied: The component does not save now, as while it is armed.
            CommandTimeout: The component does not answer.
            RemoteCancelled: The node was closed.
        """
        saved = self.unsaved
        if not saves_at_once(self._clients.info):
            host = self._clients.host
            command = Command.of(host.named_command(common.MavCmd.PREFLIGHT_STORAGE), (_SAVE_PARAMETERS,))
            await host.run_operation(self._clients.command, CommandOperation(command, timeout=timeout))
        for name in saved:
            self._unsaved.pop(name, None)

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
        self._is_complete = True
        return self.cached

    async def download_metadata(
        self,
        *,
        fetch: Callable[[str], bytes] | None = None,
        cache: MetadataCache | None = USER_CACHE,
        cached_only: bool = False,
        locale: str | None = None,
        timeout: float | None = None,
        progress: Callable[[int, int], None] | None = None,
    ) -> MetadataTable:
        """Download the metadata of the parameters (COMPONENT_METADATA, MAVLink FTP), unless it is cached.

        For a component without metadata, such as ArduPilot's, the file is used that `load_metadata` stored
        with `remember` for its firmware.

        Args:
            fetch: Returns the content of a URL, for components whose metadata is on a web server; called in a
                thread. The URL comes from the component. None: such a file is refused.
            cache: Where files are kept by their CRC; None: nowhere.
            cached_only: Do not download a file: take one from the cache, or fail.
            locale: The locale of the texts, such as "de_DE", if they are translated; None: as they are.
            timeout: Seconds for the whole call; None: until retries are exhausted or progress stalls.
            progress: Called with the bytes received and the bytes in total.

        Returns:
            The metadata by name, also in `metadata` from now on.

        Raises:
            RemoteDenied: The component has no metadata, or does not give it.
            RemoteTimeout: The component does not answer.
            RemoteProtocolError: The file is damaged, or is not metadata.
            RemoteCancelled: The node was closed.
        """
        budget = TimeBudget(timeout, self._clients.host.now)
        access = MetadataAccess(budget, cache, fetch, progress, cached_only, locale)
        try:
            found = await self._metadata_files.get(
                common.CompMetadataType.PARAMETER, access, parse_parameter_metadata
            )
        except (RemoteDenied, RemoteProtocolError):
            remembered = await self._remembered_metadata(cache, budget)
            if remembered is None:
                raise
            found = remembered
        self._metadata = found
        return found

    async def load_metadata(
        self,
        path: str | PathLike[str],
        *,
        remember: bool = False,
        cache: MetadataCache | None = USER_CACHE,
        timeout: float | None = None,
    ) -> MetadataTable:
        """Load the metadata of the parameters from a file of a firmware project.

        Args:
            path: ArduPilot's apm.pdef.xml or apm.pdef.json, PX4's parameters.json or .xml; compressed
                or not.
            remember: Keep a copy in the cache for `download_metadata` of components with this firmware.
            cache: Where the copy is kept.
            timeout: Seconds to wait for the version of the firmware, with `remember`.

        Returns:
            The metadata by name, also in `metadata` from now on.

        Raises:
            MetadataError: The content is not metadata of parameters.
            OSError: The file cannot be read.
        """
        data = read_metadata_file(path)
        self._metadata = found = parse_parameter_metadata(data, fspath(path))
        if remember and cache is not None:
            cache.store(await self._firmware_key(TimeBudget(timeout, self._clients.host.now)), data)
        return found

    def changes(self) -> Subscription[ParameterChanged]:
        """Subscribe to changes of parameters, made by any component."""
        return self._clients.host.events(ParameterChanged, of=self._client, queue=DEFAULT_QUEUE)

    def clear_cache(self) -> None:
        """Discard version and unsaved names from before a reboot; metadata stays until the next download."""
        self._version, self._version_requested, self._is_complete = None, False, False
        self._unsaved.clear()
        self._metadata_files.clear_cache()

    @contextmanager
    def _explain_renamed(self, name: str) -> Iterator[None]:
        """Add to the error for an unknown name that ArduPilot 4.7 renamed the parameter."""
        try:
            yield
        except (ParameterDenied, ParameterTimeout) as error:
            info, renamed = self._clients.info, renaming_of(name)
            unknown = not isinstance(error, ParameterDenied) or error.code == _NO_SUCH_PARAMETER
            if renamed is not None and unknown and is_ardupilot(info):
                error.status_texts = (*error.status_texts, renamed.hint)
            raise

    def _start(self, timeout: float | None) -> tuple[NodeHost, ParameterClient, TimeBudget]:
        host = self._clients.host
        return host, self._client, TimeBudget(timeout, host.now)

    async def _download_packed(self, budget: TimeBudget, progress: Callable[[int, int], None] | None) -> bool:
        """Download the packed file; return whether all parameters are known from it."""
        if not has_packed_params(self._clients.info, self._capabilities):
            return False
        host, ftp = self._clients.host, self._clients.get(FtpClient)
        started_at = host.now()
        try:
            operation = ftp.download(PACKED_NAME, started_at, timeout=budget.remaining())
            data = await host.finish(ftp, operation, progress)
        except (RemoteTimeout, RemoteDenied):
            return False
        return self._client.load_packed(data, host.now(), started_at=started_at)

    async def _find_encoding(self, budget: TimeBudget) -> None:
        if not is_px4(self._clients.info):  # no version of PX4 has a packed file either
            await self._find_version(budget)
        self._client.encoding = param_encoding(self._clients.info, self._capabilities)

    @property
    def _capabilities(self) -> int:
        return 0 if self._version is None else self._version.capabilities

    async def _find_version(self, budget: TimeBudget) -> None:
        if self._version_requested:
            return
        operation = RequestAutopilotVersion(timeout=budget.remaining(CAPABILITIES_TIMEOUT))
        try:
            self._version = await self._clients.host.run_operation(self._clients.command, operation)
        except RemoteCancelled:
            raise  # the node was closed
        except RemoteError:
            self._version = None
        self._version_requested = True

    async def _firmware_key(self, budget: TimeBudget) -> str:
        await self._find_version(budget)
        return firmware_key(self._clients.info, self._version)

    async def _remembered_metadata(
        self, cache: MetadataCache | None, budget: TimeBudget
    ) -> MetadataTable | None:
        """Return the metadata that was remembered for the component's firmware; None if there is none."""
        key = None if cache is None else await self._firmware_key(budget)
        data = None if cache is None or key is None else cache.find(key)
        if data is None:
            return None
        try:
            return parse_parameter_metadata(data, f"the file that was loaded for {key}")
        except MetadataError:
            return None
