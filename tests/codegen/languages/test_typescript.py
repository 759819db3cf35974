"""TypeScript libraries: their text, the TypeScript compiler, the corpus, and the programs of the guide."""

from __future__ import annotations

import json
import shutil
import socket
import subprocess
from contextlib import suppress
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from threading import Thread
from typing import TYPE_CHECKING

import pytest

from mavstack.codegen import generate, language, make_library, write_files
from mavstack.dialects import Dialect, common
from mavstack.dialects.tables import official_names
from mavstack.wire import encode
from tests.codegen.compilers import needs
from tests.codegen.conformance import check_runner
from tests.codegen.languages.libraries import SMALL
from tests.docs.blocks import BLOCKS
from tools.compilers import TOOLS

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

RUNNERS = Path(__file__).parents[1] / "runners" / "typescript"
PROGRAMS = {
    block.directive.removeprefix("file: "): block.text
    for block in BLOCKS
    if block.page == "guides/generate-typescript.md" and block.directive.startswith("file: ")
}
PARSE_IN_BROWSER = """async bytes => {
  const { Parser, messages } = await import("/index.js")
  return [...new Parser(messages).push(new Uint8Array(bytes))].map(
    message => [message.name, message.system, message.fields.roll])
}"""
#: Messages of the programs here and in the guide.
FEW = (*SMALL, "SYSTEM_TIME")
#: Flags beyond those of the tsconfig.json of the library.
STRICT = ("--erasableSyntaxOnly", "--noPropertyAccessFromIndexSignature", "--noImplicitAny")
TRICKY = """<mavlink><enums>
<enum name="PARSER">
<entry name="PARSER_CLASS" value="1"><description>*/ alert(1) /*</description></entry></enum>
<enum name="WIDE"><entry name="WIDE_TOP" value="9223372036854775808"/></enum>
</enums><messages>
<message id="200" name="DATA_VIEW"><description>A */ in a text.</description>
<field type="uint8_t" name="class">Text with `${x}` and \\ in it.</field>
<field type="uint8_t" name="constructor" enum="PARSER">c</field>
<field type="uint8_t" name="to_object">o</field>
<field type="uint8_t" name="a_b">b</field><field type="uint8_t" name="aB">b</field>
<field type="uint64_t" name="flags" enum="WIDE">w</field><field type="char" name="c">c</field>
<field type="int64_t[2]" name="wide">w</field><field type="double[2]" name="d">d</field>
<extensions/><field type="char[3]" name="text">t</field><field type="uint8_t[3]" name="more">m</field>
</message><message id="70000" name="PACKET"><field type="int8_t[3]" name="_view">v</field></message>
</messages></mavlink>"""


def texts(dialect: str | Dialect, **options) -> dict[str, str]:
    loaded = Dialect.load(dialect) if isinstance(dialect, str) else dialect
    files = generate(make_library(loaded, **options), "typescript")
    return {file.path: file.text for file in files}


def test_equal_definitions_give_equal_files():
    assert texts("common") == texts("common")


def test_each_file_begins_with_the_stamp_and_the_licence():
    stamp = make_library(Dialect.load("minimal")).stamp
    for path, text in texts("minimal").items():
        if not path.startswith("."):
            head = text[:500]
            assert stamp in head, path
            assert "SPDX-License-Identifier: MIT" in head, path


def test_only_the_selected_messages_are_there():
    files = texts("common", only=["HEARTBEAT"])
    assert [path for path in files if "messages/" in path] == ["src/messages/minimal.ts"]
    assert "MavCmd" not in "".join(files.values())


def test_the_package_has_the_chosen_name():
    files = texts("minimal", package="@example/mavlink")
    assert json.loads(files["package.json"])["name"] == "@example/mavlink"
    assert 'from "@example/mavlink"' in files["README.md"]


def test_a_bitmask_is_a_number_and_an_enum_one_of_its_values():
    enums = "".join(text for path, text in texts("minimal").items() if "/enums/" in path)
    assert "export type MavModeFlag = number;" in enums
    assert "export type MavState = (typeof MavState)[keyof typeof MavState];" in enums


def test_enums_of_64_bit_fields_are_bigints():
    files = texts("common")
    assert "  MISSION_FLOAT: 1n," in "".join(text for path, text in files.items() if "enums/" in path)
    assert "readonly capabilities: MavProtocolCapability;" in "".join(
        text for path, text in files.items() if "messages/" in path
    )


def test_names_that_the_library_uses_get_an_underscore():
    files = texts(Dialect.from_xml(TRICKY))
    (module,) = (text for path, text in files.items() if "messages/" in path)
    assert "export class DataView_ extends MessageFields" in module
    assert "export class Packet_ extends" in module
    for name in ("class", "constructor_", "toObject_", "aB", "aB_"):
        assert f"\n  get {name}(): " in module


def test_a_field_may_be_named_as_a_keyword():
    assert "constructor" in language("typescript").reserved_words
    assert not {"type", "class", "of"} & language("typescript").reserved_words


def build(folder: Path, dialect: str | Dialect, *programs: str, only: Iterable[str] = ()) -> Path:
    """Generate a library with further modules, compile it, and return the folder of its modules."""
    compiler = needs("typescript")
    loaded = Dialect.load(dialect) if isinstance(dialect, str) else dialect
    write_files(generate(make_library(loaded, only=only), "typescript"), folder)
    for name in programs:
        source = folder / "src" / name
        if name in PROGRAMS:
            source.write_text(PROGRAMS[name], "utf-8")
        else:
            shutil.copy(RUNNERS / name, source)
    types = str(TOOLS / "node_modules" / "@types")
    node = ["--types", "node", "--typeRoots", types, "--skipLibCheck"] if programs else []
    done = subprocess.run(
        [compiler, "-p", str(folder), "--sourceMap", "false", "--declarationMap", "false", *STRICT, *node],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout[-2000:]
    return folder / "dist"


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A small library with the runner, the test of types and the programs of the guide."""
    folder = tmp_path_factory.mktemp("small")
    return build(folder, "common", "runner.ts", "types.ts", *PROGRAMS, only=FEW)


def node(program: Path, *words: str) -> str:
    done = subprocess.run(
        [needs("node"), str(program), *words], capture_output=True, text=True, check=True, timeout=60
    )
    return done.stdout


@pytest.mark.interop
@pytest.mark.smoke
@pytest.mark.xdist_group("typescript")
def test_a_small_library_passes_the_corpus_in_any_chunks(built):
    for chunk in ((), ("1",)):
        check_runner([needs("node"), built / "runner.js", *chunk], "common", messages=FEW)


@pytest.mark.interop
@pytest.mark.smoke
@pytest.mark.xdist_group("typescript")
def test_programs_of_the_guide(built):
    assert node(built / "enums.js") == "QUADROTOR [ 'SAFETY_ARMED', 'CUSTOM_MODE_ENABLED' ]\n"
    assert node(built / "signing.js") == "HEARTBEAT true true\n1\n"
    assert "0 HEARTBEAT 50 9 9\n  type uint8_t \n" in node(built / "tables.js")


@pytest.fixture
def ground(built: Path) -> Iterator[tuple[subprocess.Popen[str], socket.socket, tuple[str, int]]]:
    """The guide's ground station, and a socket that sends to it."""
    with socket.socket(type=socket.SOCK_DGRAM) as probe:
        probe.bind(("127.0.0.1", 0))
        address = probe.getsockname()
    with socket.socket(type=socket.SOCK_DGRAM) as vehicle:
        vehicle.settimeout(0.2)
        command = [needs("node"), str(built / "ground.js"), str(address[1])]
        process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
        try:
            yield process, vehicle, address
        finally:
            process.kill()
            process.communicate()


@pytest.mark.interop
@pytest.mark.smoke
@pytest.mark.xdist_group("typescript")
def test_the_ground_station_of_the_guide_receives_and_answers(ground):
    process, vehicle, address = ground
    messages = [
        common.Heartbeat(type=2, autopilot=3, base_mode=0x81, system_status=4),
        common.Attitude(roll=0.1, pitch=-0.2, yaw=3),
    ]
    datagram = b"".join(encode(item, system=7, component=1, sequence=0) for item in messages)
    for _ in range(100):  # until the program listens
        vehicle.sendto(datagram, address)
        with suppress(TimeoutError):
            answer = vehicle.recv(300)
            break
    assert answer[0] == 0xFD
    assert answer[5:10] == bytes([255, 190, 0, 0, 0])
    assert process.stdout.readline() == "vehicle 7: armed\n"
    assert process.stdout.readline() == "vehicle 7: roll 0.100 pitch -0.200 yaw 3.000\n"


@pytest.fixture
def website(built: Path) -> Iterator[str]:
    """The address of a server of the modules."""
    handler = partial(SimpleHTTPRequestHandler, directory=str(built))
    with ThreadingHTTPServer(("127.0.0.1", 0), handler) as server:
        thread = Thread(target=server.serve_forever)
        thread.start()
        yield f"http://127.0.0.1:{server.server_port}/"
        server.shutdown()
        thread.join()


@pytest.mark.interop
@pytest.mark.xdist_group("typescript")
def test_a_browser_loads_the_modules_and_parses(website):
    playwright = pytest.importorskip("playwright.sync_api")
    packet = encode(common.Attitude(roll=0.5), system=7, component=1, sequence=0)
    with playwright.sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=needs("chromium"), args=["--no-sandbox"])
        page = browser.new_page()
        page.goto(website)
        found = page.evaluate(PARSE_IN_BROWSER, list(packet))
        browser.close()
    assert found == [["ATTITUDE", 7, 0.5]]


@pytest.mark.interop
def test_difficult_names_compile(tmp_path):
    build(tmp_path, Dialect.from_xml(TRICKY))


@pytest.mark.interop
@pytest.mark.xdist_group("typescript_all")
def test_all_passes_the_corpus(tmp_path):
    runner = build(tmp_path, "all", "runner.ts") / "runner.js"
    for chunk in ((), ("1",)):
        check_runner([needs("node"), runner, *chunk], "all")


@pytest.mark.nightly
@pytest.mark.parametrize("name", official_names())
def test_each_official_dialect_compiles(name, tmp_path):
    build(tmp_path, name)
