"""The metadata files of a remote component: found by COMPONENT_METADATA, kept in a cache, else downloaded.

Each file is looked up in the cache, then at its location, then at its fallback. Files on web servers are
fetched only by a function of the program, since a URL from a vehicle can name any host of the network.
"""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, TypeAlias, TypeVar

from mavstack.dialects import common
from mavstack.errors import (
    CommandDenied,
    MetadataError,
    RemoteCancelled,
    RemoteDenied,
    RemoteError,
    RemoteProtocolError,
)
from mavstack.services import Address
from mavstack.services.component_metadata import (
    MAX_FILE,
    MetadataFile,
    find_locale,
    has_crc,
    parse_general,
    parse_translations,
    parse_uri,
    translate_content,
    unpack_content,
)
from mavstack.services.ftp import FtpClient, FtpLocation
from mavstack.services.message_request import RequestMessage

if TYPE_CHECKING:
    from mavstack.files.parameter_metadata import MetadataCache
    from mavstack.node.clients import ComponentClients
    from mavstack.node.time_budget import TimeBudget

#: Returns the content of a URL, or raises OSError.
Fetch: TypeAlias = Callable[[str], bytes]
Progress: TypeAlias = Callable[[int, int], None]
Result = TypeVar("Result")

_LOGGER: Final = logging.getLogger("mavstack.node")
_OPERATION: Final = "downloading metadata from"
_GENERAL: Final = int(common.CompMetadataType.GENERAL)


@dataclass(frozen=True, slots=True)
class MetadataAccess:
    """How files are reached: the cache, the function for URLs, the remaining time, the progress."""

    budget: TimeBudget
    cache: MetadataCache | None = None
    fetch: Fetch | None = None
    progress: Progress | None = None
    #: True if files are read only from the cache, without a download.
    cached_only: bool = False
    #: The locale to translate texts to, such as "de_DE"; None: texts as the component has them.
    locale: str | None = None


class MetadataFiles:
    """The metadata files of one component."""

    def __init__(self, clients: ComponentClients) -> None:
        self._clients = clients
        self._files: dict[int, MetadataFile] | None = None

    def clear_cache(self) -> None:
        """Forget which files the component has, as after its reboot."""
        self._files = None

    async def get(self, kind: int, access: MetadataAccess, parse: Callable[[bytes, str], Result]) -> Result:
        """Return the parsed file of a COMP_METADATA_TYPE.

        Args:
            kind: The type.
            access: How files are reached.
            parse: Parses the bytes of a file from a URI; raises `MetadataError`.

        Returns:
            The result of `parse`.

        Raises:
            RemoteDenied: The component has no such file, or does not give it.
            RemoteTimeout: The component does not answer.
            RemoteProtocolError: The file is not valid.
        """
        if self._files is None:
            self._files = await self._read(await self._find_general(access), access, _parse_general)
        file = self._files.get(kind)
        if file is None:
            raise self._denied("it has no such file")
        texts = await self._translations(file, access)
        if not texts:
            return await self._read(file, access, parse)
        return await self._read(file, access, lambda data, uri: parse(translate_content(data, texts), uri))

    async def _translations(self, file: MetadataFile, access: MetadataAccess) -> Mapping[str, str]:
        """Return the texts of the wanted locale by their places; none if they cannot be had."""
        if access.locale is None:
            return {}
        problem = f"it has no translation to {access.locale}"
        for uri in file.translation_sources:
            try:
                found = find_locale(await self._download(uri, None, access), access.locale)
                if found is not None:
                    return parse_translations(await self._download(found, None, access))
            except RemoteCancelled:
                raise  # the node was closed
            except (RemoteError, MetadataError) as error:
                problem = str(error)
        # texts in another language are better than none, so the file is used as it is
        _LOGGER.warning("metadata of %s is not translated: %s", self._clients.address, problem)
        return {}

    async def _find_general(self, access: MetadataAccess) -> MetadataFile:
        """Ask for the general file, in the older way if the component refuses the current one."""
        message: common.ComponentMetadata | common.ComponentInformation
        try:
            message = await self._request(common.ComponentMetadata, access)
            uri, crc = message.uri, message.file_crc
        except CommandDenied as error:
            try:
                message = await self._request(common.ComponentInformation, access)
            except CommandDenied:
                raise self._denied(f"it has none (COMPONENT_METADATA: {error.answer})", error.code) from None
            uri, crc = message.general_metadata_uri, message.general_metadata_file_crc
        if not uri:
            raise self._denied("it has none (its COMPONENT_METADATA names no file)")
        return MetadataFile(_GENERAL, uri, crc or None)

    async def _request(self, message: type[Result], access: MetadataAccess) -> Result:
        operation = RequestMessage(message, timeout=access.budget.remaining())  # type: ignore[arg-type]
        found: Result = await self._clients.host.run_operation(self._clients.command, operation)
        return found

    async def _read(
        self, file: MetadataFile, access: MetadataAccess, parse: Callable[[bytes, str], Result]
    ) -> Result:
        """Return a parsed file from the first location that has a valid one."""
        for uri, crc in file.sources:
            data = None if crc is None or access.cache is None else access.cache.find_crc(file.type, crc)
            if data is not None:
                return self._parsed(data, uri, parse)
        if access.cached_only:
            raise self._denied("it is not in the cache")
        first: RemoteError | None = None
        for uri, crc in file.sources:
            try:
                data = await self._download(uri, crc, access)
                result = self._parsed(data, uri, parse)
            except RemoteCancelled:
                raise  # the node was closed
            except RemoteError as error:
                _LOGGER.info("metadata of %s: %s", self._clients.address, error)
                first = first or error
                continue
            if crc is not None and access.cache is not None:
                access.cache.store_crc(file.type, crc, data)
            return result
        raise first if first is not None else self._denied("it names no location of the file")

    async def _download(self, uri: str, crc: int | None, access: MetadataAccess) -> bytes:
        """Return the bytes of a file, verified by its CRC if it has one."""
        try:
            location = parse_uri(uri)
            if isinstance(location, FtpLocation):
                data = await self._transfer(location, access)
            else:
                data = await self._fetch(location, access)
            if crc is not None and not has_crc(data, crc):
                raise MetadataError("its CRC is not the announced one", uri)
        except MetadataError as error:
            raise self._invalid(error) from None
        return data

    async def _transfer(self, location: FtpLocation, access: MetadataAccess) -> bytes:
        """Return a file over MAVLink FTP, from the component itself or another one of its system."""
        host, address = self._clients.host, self._clients.address
        other = location.component is not None and location.component != address.component
        if other:
            client = host.serve(FtpClient(host.address, Address(address.system, location.component or 0)))
        else:
            client = self._clients.get(FtpClient)
        try:
            operation = client.download(
                location.path, host.now(), max_size=MAX_FILE, timeout=access.budget.remaining()
            )
            return await host.finish(client, operation, access.progress)
        finally:
            if other:
                host.remove(client)

    async def _fetch(self, url: str, access: MetadataAccess) -> bytes:
        """Return a file from a web server, in a thread of its own."""
        if access.fetch is None:
            raise self._denied(f"it is on a web server, {url}, for which a fetch function is needed")
        try:
            async with asyncio.timeout(access.budget.remaining()):
                return await asyncio.to_thread(access.fetch, url)
        except OSError as error:  # also a TimeoutError
            raise self._denied(f"{url} could not be fetched: {error or 'no answer in time'}") from None

    def _parsed(self, data: bytes, uri: str, parse: Callable[[bytes, str], Result]) -> Result:
        try:
            return parse(data, uri)
        except MetadataError as error:
            raise self._invalid(error) from None

    def _denied(self, answer: str, code: int = 0) -> RemoteDenied:
        return RemoteDenied(_OPERATION, str(self._clients.address), answer=answer, code=code)

    def _invalid(self, error: MetadataError) -> RemoteProtocolError:
        return RemoteProtocolError(_OPERATION, str(self._clients.address), answer=str(error))


def _parse_general(data: bytes, uri: str) -> dict[int, MetadataFile]:
    try:
        return parse_general(unpack_content(data))
    except MetadataError as error:
        raise MetadataError(error.problem, uri, error.line) from None
