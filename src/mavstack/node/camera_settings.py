"""The settings of a camera: `camera.settings`.

    await camera.settings.load()
    await camera.settings.set("CAM_WBMODE", "Sunset")

A camera describes its settings in a definition file, which `load` downloads over MAVLink FTP. The values are
extended parameters.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.errors import InvalidArgumentError, RemoteDenied
from mavstack.node.api_object import ReadOnly
from mavstack.node.ftp import Ftp
from mavstack.services.camera import read_definition
from mavstack.services.extended_parameters import ExtendedParameterClient
from mavstack.services.ftp import parse_ftp_uri

if TYPE_CHECKING:
    from collections.abc import Callable, Coroutine, Mapping
    from typing import Any

    from mavstack.node.clients import ComponentClients
    from mavstack.services.camera import CameraDefinition, CameraInformation, SettingValue


class CameraSettings(ReadOnly):
    """The settings of one camera, by the names of its definition file."""

    def __init__(
        self,
        clients: ComponentClients,
        get_information: Callable[[], Coroutine[Any, Any, CameraInformation]],
    ) -> None:
        self._clients = clients
        self._get_information = get_information
        self._definition: CameraDefinition | None = None

    @property
    def _client(self) -> ExtendedParameterClient:
        return self._clients.get(ExtendedParameterClient)

    @property
    def definition(self) -> CameraDefinition | None:
        """The definition; None until `load`."""
        return self._definition

    @property
    def values(self) -> Mapping[str, SettingValue]:
        """The values received so far, by name."""
        known = self._client.parameters
        return {name: each.value for name, each in known.items() if not isinstance(each.value, bytes)}

    @property
    def available(self) -> tuple[str, ...]:
        """The names of the settings that have an effect with the present values."""
        if self._definition is None:
            return tuple(self.values)
        excluded = self._definition.excluded(self.values)
        return tuple(name for name in self._definition.settings if name not in excluded)

    def options(self, name: str) -> Mapping[str, SettingValue]:
        """Return the options of a setting that remain with the present values.

        Args:
            name: The name of the setting.

        Returns:
            The values by the names of the options; empty if the setting has no options.

        Raises:
            InvalidArgumentError: The definition was not loaded, or has no such setting.
        """
        if self._definition is None:
            raise InvalidArgumentError("the definition of the camera was not loaded: await settings.load()")
        return self._definition.options_of(name, self.values)

    async def load(
        self, definition: CameraDefinition | bytes | None = None, *, timeout: float | None = None
    ) -> CameraDefinition:
        """Download the definition file and all values.

        Args:
            definition: A definition, or the content of its file, if it is known already; None: download it.
            timeout: Seconds for each of the downloads; None: until retries are exhausted or progress stalls.

        Returns:
            The definition.

        Raises:
            RemoteDenied: The camera has no definition file, or one that MAVLink FTP does not reach.
            CommandDenied: The component has no camera.
            MessageTimeout: The camera does not answer.
            FileDenied: The file cannot be read.
            FileTimeout: The download of the file stalled.
            DialectError: The file is damaged, or no camera definition.
            ParameterTimeout: The camera does not send its values.
        """
        if definition is None:
            definition = await self._download(timeout)
        elif isinstance(definition, bytes):
            definition = read_definition(definition)
        self._definition = definition
        host, client = self._clients.host, self._client
        await host.finish(client, client.download(host.now(), timeout=timeout))
        return definition

    async def get(self, name: str, *, timeout: float | None = None) -> SettingValue | bytes:
        """Get the value of a setting (PARAM_EXT_REQUEST_READ).

        Args:
            name: The name of the setting.
            timeout: Seconds for the whole call; None: until retries are exhausted.

        Returns:
            The value.

        Raises:
            ParameterTimeout: The camera does not answer, or has no such setting.
        """
        host, client = self._clients.host, self._client
        return (await host.finish(client, client.get(name, host.now(), timeout=timeout))).value

    async def set(
        self, name: str, value: SettingValue, *, timeout: float | None = None
    ) -> SettingValue | bytes:
        """Set a setting (PARAM_EXT_SET), then read those that change with it.

        Args:
            name: The name of the setting.
            value: The name of an option, or the value.
            timeout: Seconds for each request; None: until retries are exhausted.

        Returns:
            The value that the camera holds now.

        Raises:
            InvalidArgumentError: The definition does not allow the value at present.
            ParameterDenied: The camera refused the value.
            ParameterTimeout: The camera does not answer, or has no such setting.
            SystemIdConflictError: Several vehicles use its system id, and none was chosen.
        """
        definition, kind = self._definition, None
        updates: tuple[str, ...] = ()
        if definition is not None and name in definition.settings:
            setting = definition.settings[name]
            value, kind, updates = setting.parse(value), setting.type, setting.updates
        if definition is not None:
            definition.check(name, value, self.values)
        host, client = self._clients.host, self._client
        if error := host.refusal_of(self._clients.address, f"setting {name} of"):
            raise error  # check before the client's first request, which reads the type of the setting
        request = client.set(name, value, host.now(), kind=kind, timeout=timeout)
        changed = await host.finish(client, request)
        for other in updates:
            await self.get(other, timeout=timeout)
        return changed.value

    async def _download(self, timeout: float | None) -> CameraDefinition:
        uri = (await self._get_information()).definition_uri
        location = parse_ftp_uri(uri)
        if location is None:
            answer = f"the definition is at {uri}; download it, and pass its content to load()" if uri else ""
            raise RemoteDenied(
                "downloading the definition of",
                str(self._clients.address),
                answer=answer or "the camera has no definition file",
            )
        address = self._clients.address
        clients = self._clients
        if location.component is not None and location.component != address.component:
            clients = self._clients.sibling(location.component)
        return read_definition(await Ftp(clients).download(location.path, timeout=timeout), uri)
