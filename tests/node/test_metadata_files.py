"""Metadata of a remote component's parameters: requested, downloaded, cached, and every way to fail."""

from __future__ import annotations

import json
import lzma
from contextlib import suppress

import pytest

from mavstack.dialects import common
from mavstack.errors import FileDenied, InvalidArgumentError, RemoteDenied, RemoteProtocolError, RemoteTimeout
from mavstack.files.parameter_metadata import MetadataCache
from mavstack.links import MemoryNetwork
from mavstack.node import Node
from mavstack.services import Address
from mavstack.services.component_metadata import PARAMETER_RULES, ServedMetadata
from mavstack.services.ftp import FtpServer, MemoryStore, file_crc32
from mavstack.sim.virtual import run_virtually
from tests.node.vehicle import Vehicle, VehiclePair
from tests.sim.running import impaired_link

PARAMETER = common.CompMetadataType.PARAMETER
PARAMETERS = [{"name": "P_07", "min": 0, "max": 50, "units": "m"}]
CONTENT = json.dumps({"version": 1, "parameters": PARAMETERS}).encode()
WEB = "https://example.org/parameters.json"


def serve(
    pair: VehiclePair, files: dict[str, bytes], uri: str, crc: int, *, older: bool = False
) -> list[str]:
    """Serve metadata from the vehicle; return the paths that are opened."""
    opened: list[str] = []
    open_file = pair.vehicle.files.open_file

    def counted(path: str, **options):
        opened.append(path)
        return open_file(path, **options)

    pair.vehicle.files.open_file = counted
    for path, data in files.items():
        pair.vehicle.files[path] = data
    messages = pair.vehicle.message_server
    if older:
        message = common.ComponentInformation(general_metadata_uri=uri, general_metadata_file_crc=crc)
        messages.provide(common.ComponentInformation, lambda now: message)
    else:
        messages.provide(
            common.ComponentMetadata, lambda now: common.ComponentMetadata(file_crc=crc, uri=uri)
        )
    return opened


def serve_parameters(pair: VehiclePair, content: bytes = CONTENT, *, older: bool = False) -> list[str]:
    served = ServedMetadata("etc/extras", {PARAMETER: ("parameters.json", content)})
    return serve(pair, served.files, served.uri, served.crc, older=older)


def serve_file(pair: VehiclePair, entry: dict) -> None:
    """Serve a general file with one entry."""
    general = json.dumps({"version": 1, "metadataTypes": [{"type": PARAMETER, **entry}]}).encode()
    serve(pair, {"general.json": general, "p.json": CONTENT}, "mftp:///general.json", file_crc32(general))


def with_pair(work, **options) -> None:
    async def run() -> None:
        async with VehiclePair(**options) as pair:
            await work(pair, pair.remote.params)

    run_virtually(run())


@pytest.mark.parametrize("older", [False, True])
def test_download_and_checks(tmp_path, older):
    async def work(pair: VehiclePair, params) -> None:
        serve_parameters(pair, older=older)
        assert not params.metadata
        steps: list = []
        found = await params.download_metadata(
            cache=MetadataCache(tmp_path), progress=lambda *step: steps.append(step)
        )
        assert found is params.metadata
        assert (found["P_07"].unit, found.source) == ("m", "mftp://etc/extras/parameters.json.xz")
        assert steps
        with pytest.raises(
            InvalidArgumentError, match="P_07 cannot be set to 70: 70 is outside of its range 0 to 50 m"
        ):
            await params.set("P_07", 70, check=True)
        assert (await params.set("P_07", 60)).value == 60
        assert (await params.set("P_07", 40, check=True)).value == 40
        assert (await params.set("P_08", 1000, check=True)).value == 1000

    with_pair(work)


def test_cached_files_are_not_downloaded(tmp_path):
    cache = MetadataCache(tmp_path)

    async def first(pair: VehiclePair, params) -> None:
        serve_parameters(pair)
        with pytest.raises(RemoteDenied, match="it is not in the cache"):
            await params.download_metadata(cache=cache, cached_only=True)
        await params.download_metadata(cache=cache)

    async def second(pair: VehiclePair, params) -> None:
        opened = serve_parameters(pair)
        assert "P_07" in await params.download_metadata(cache=cache, cached_only=True)
        assert opened == []
        await params.download_metadata(cache=None)
        assert set(opened) == {"etc/extras/parameters.json.xz"}  # the general file is known

    async def changed(pair: VehiclePair, params) -> None:
        serve_parameters(pair, CONTENT.replace(b"P_07", b"P_08"))
        assert "P_07" not in await params.download_metadata(cache=cache)

    for work in (first, second, changed):
        with_pair(work)


class LossyPair(VehiclePair):
    """A ground station and a vehicle whose link loses, delays and reorders packets."""

    def __init__(self, seed: int) -> None:
        network = MemoryNetwork()
        self.ground = Node(impaired_link(network, loss=0.1, latency=0.1, jitter=0.1, seed=seed))
        self.vehicle = Vehicle(network.link())


def test_download_over_lossy_links(seeds):
    async def download(seed: int) -> None:
        async with LossyPair(seed) as pair:
            noise = [{"name": f"X_{number}", "longDesc": hex(number**99)} for number in range(60)]
            content = json.dumps({"parameters": [*PARAMETERS, *noise]}).encode()
            serve_parameters(pair, content)
            with suppress(RemoteTimeout):  # complete, or a typed error
                assert len(await pair.remote.params.download_metadata(cache=None)) == 61

    seeds.check(lambda seed: run_virtually(download(seed)))


def test_a_component_without_metadata():
    async def work(pair: VehiclePair, params) -> None:
        with pytest.raises(
            RemoteDenied,
            match=r"^downloading metadata from 1/1 failed: it has none \(COMPONENT_METADATA: UNSUPPORTED\)$",
        ):
            await params.download_metadata(cache=None)

    with_pair(work)


@pytest.mark.parametrize(
    ("entry", "error", "text"),
    [
        (
            {"uri": "mftp://p.json", "fileCrc": 5},
            RemoteProtocolError,
            "p.json: its CRC is not the announced one",
        ),
        ({"uri": "mftp:///none.json"}, FileDenied, "none.json"),
        ({"uri": "mftp:///general.json"}, RemoteProtocolError, "describes no parameter"),
        ({"uri": "file:///etc/passwd"}, RemoteProtocolError, "not a URI of a file"),
        ({"uri": WEB}, RemoteDenied, f"it is on a web server, {WEB}, for which a fetch function is needed"),
        ({"type": 5, "uri": "mftp://p.json"}, RemoteDenied, "it has no such file"),
    ],
)
def test_unusable_files(entry, error, text):
    async def work(pair: VehiclePair, params) -> None:
        serve_file(pair, entry)
        with pytest.raises(error, match=text):
            await params.download_metadata(cache=None)
        assert not params.metadata

    with_pair(work)


def test_the_fallback_is_used():
    async def work(pair: VehiclePair, params) -> None:
        serve_file(pair, {"uri": WEB, "fileCrc": 5, "uriFallback": "mftp:///p.json"})
        assert "P_07" in await params.download_metadata(cache=None)

    with_pair(work)


def test_a_component_of_the_system_serves_the_file():
    async def work(pair: VehiclePair, params) -> None:
        other = Address(1, 100)
        pair.vehicle.serve(FtpServer(other, MemoryStore({"far.json": CONTENT})))
        serve_file(pair, {"uri": "mftp://[;comp=1]p.json"})
        assert "P_07" in await params.download_metadata(cache=None)

    with_pair(work)


def test_files_from_the_web_are_fetched_by_the_program():
    async def work(pair: VehiclePair, params) -> None:
        serve_file(pair, {"uri": WEB, "fileCrc": file_crc32(lzma.compress(CONTENT))})
        urls: list[str] = []

        def fetch(url: str) -> bytes:
            urls.append(url)
            return lzma.compress(CONTENT)

        def fail(url: str) -> bytes:
            raise ConnectionRefusedError("refused")

        assert "P_07" in await params.download_metadata(cache=None, fetch=fetch)
        assert urls == [WEB]
        with pytest.raises(RemoteDenied, match="could not be fetched: refused"):
            await params.download_metadata(cache=None, fetch=fail)

    with_pair(work)


def test_a_file_is_remembered_for_the_firmware(tmp_path):
    cache, file = MetadataCache(tmp_path / "cache"), tmp_path / "parameters.json"
    file.write_bytes(CONTENT)

    async def load(pair: VehiclePair, params) -> None:
        assert (await params.load_metadata(file, cache=cache))["P_07"].maximum == 50
        with pytest.raises(RemoteDenied):
            await params.download_metadata(cache=cache)
        await params.load_metadata(file, remember=True, cache=cache)

    async def later(pair: VehiclePair, params) -> None:
        assert "P_07" in await params.download_metadata(cache=cache)

    async def other_firmware(pair: VehiclePair, params) -> None:
        with pytest.raises(RemoteDenied):
            await params.download_metadata(cache=cache)

    with_pair(load)
    with_pair(later)
    with_pair(other_firmware, autopilot=common.MavAutopilot.ARDUPILOTMEGA)


@pytest.mark.parametrize("problem", ["", "no locale", "no summary", "no TS file"])
def test_a_translation(caplog, problem):
    texts = {"/parameters/P_07/shortDesc": "Höhe"}
    content = json.dumps(
        {"parameters": [{"name": "P_07", "shortDesc": "Height"}], "translation": PARAMETER_RULES}
    )
    served = ServedMetadata("etc", {PARAMETER: ("p.json", content.encode())}, {PARAMETER: {"de_DE": texts}})
    for name, path in (("no summary", "etc/p_summary.json.xz"), ("no TS file", "etc/p_de_DE.ts.xz")):
        if name == problem:
            del served.files[path]

    async def work(pair: VehiclePair, params) -> None:
        serve(pair, served.files, served.uri, served.crc)
        locale = "fr_FR" if problem == "no locale" else "de_DE"
        found = await params.download_metadata(cache=None, locale=locale)
        assert found["P_07"].short_description == ("Height" if problem else "Höhe")
        assert ("is not translated" in caplog.text) == bool(problem)
        assert (await params.download_metadata(cache=None))["P_07"].short_description == "Height"

    with_pair(work)
