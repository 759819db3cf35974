"""Every Python block of the documentation is type-checked; programs also run."""

from __future__ import annotations

import asyncio
import os
import re
import socket
import subprocess
import sys
from contextlib import contextmanager
from pathlib import Path
from textwrap import indent

import pytest

from mavstack.links import BytesReceived, ChannelClosed, ChannelOpened, LinkURL, parse_url
from mavstack.links.options import Options
from tests.docs.blocks import BLOCKS, ROOT, comparison_rows

PYTHON = [
    block
    for block in BLOCKS
    if block.language == "python" and not block.skipped and block.directive != "cell"
]
PROGRAMS = [block for block in PYTHON if block.is_program]
TEST_MODULES = [block for block in PYTHON if block.directive == "test: pytest"]
MAX_SKIPPED = 5  # programs of ROS 2 and mosquitto, and a check that ends with 1

PREAMBLE = """\
import asyncio
import mavstack
import mavstack.files.parameters
import mavstack.files.plans
import mavstack.vehicle
from mavstack.dialects import Message, common
from mavstack.node import Node, RemoteComponent
from mavstack.vehicle import Connection, Group, Vehicle
from mavstack.vehicle.guided_session import GuidedSession
from mavstack.logs.ulog import ULog
from mavstack.wire import Packet

async def fragment(
    connection: Connection, vehicle: Vehicle, component: RemoteComponent, node: Node, group: Group,
    guided: GuidedSession, packet: Packet, message: Message, data: bytes, ulog: ULog,
) -> None:
"""
#: The options of the project, so that its cache of mypy serves the blocks too.
MYPY_SETTINGS = f"""\
[mypy]
strict = True
mypy_path = {ROOT / "src"}
explicit_package_bases = True
[mypy-mypackage.*,pymavlink.*,mavlink_common.*,maturin,atheris,pandas,polars,pyarrow]
ignore_missing_imports = True
"""
MYPY_COMMENTS = "".join(
    f"# mypy: {option}=False\n"
    for option in ("disallow-untyped-defs", "disallow-incomplete-defs", "disallow-untyped-calls")
)
BLOCKING_PREAMBLE = """\
import mavstack.sync
from mavstack.dialects import common
from mavstack.sync import Connection, Vehicle

def fragment(connection: Connection, vehicle: Vehicle) -> None:
"""


def modules() -> dict[str, str]:
    """The text of every module that is type-checked, by its name."""
    made = {}
    for block in PYTHON:
        wrapped = block.is_fragment and block.directive != "fragment: module"
        made[block.name] = PREAMBLE + indent(block.text, "    ") if wrapped else block.text
    for page in ("pymavlink.md", "mavsdk.md"):
        made["table_" + page.removesuffix(".md")] = PREAMBLE + table_calls(page)
    made["table_dronekit"] = BLOCKING_PREAMBLE + table_calls("dronekit.md")
    return made


def table_calls(page: str) -> str:
    """The calls in the right column of a comparison table, one per line."""
    return "".join(f"    {call}\n" for row in comparison_rows(page) for call in row.ours)


def test_all_python_is_well_typed(tmp_path):
    for name, text in modules().items():
        (tmp_path / f"{name}.py").write_text(f"{text}\n{MYPY_COMMENTS}", "utf-8")
    config = tmp_path / "mypy.ini"
    config.write_text(MYPY_SETTINGS, "utf-8")
    command = [sys.executable, "-m", "mypy", "--config-file", str(config)]
    done = subprocess.run(
        [*command, str(tmp_path)], cwd=ROOT, capture_output=True, text=True, timeout=300, check=False
    )
    assert done.returncode == 0, explained(done.stdout)


def explained(output: str) -> str:
    """The output of mypy with the lines that it is about."""
    texts = modules()
    lines = []
    for line in output.splitlines():
        found = re.match(r".*?(\w+)\.py:(\d+):", line)
        source = (
            texts[found[1]].splitlines()[int(found[2]) - 1].strip() if found and found[1] in texts else ""
        )
        lines.append(f"{line}\n        {source}" if source else line)
    return "\n".join(lines)


def test_few_blocks_are_skipped():
    assert len([block for block in BLOCKS if block.skipped]) <= MAX_SKIPPED


NEEDED_FILES = [
    block
    for block in BLOCKS
    if block.directive.startswith("file: ")
    and any(
        block.directive.removeprefix("file: ") in each.text for each in PROGRAMS if each.page == block.page
    )
]


@pytest.mark.parametrize("block", NEEDED_FILES, ids=lambda block: block.name)
def test_the_page_names_the_files_that_its_programs_need(block):
    """The comment with the name of the file is not on the page that readers see."""
    name = block.directive.removeprefix("file: ")
    text = re.sub(r"<!--.*?-->", "", (ROOT / "docs" / block.page).read_text("utf-8"), flags=re.DOTALL)
    assert name in re.sub(r"^```.*?^```$", "", text, flags=re.MULTILINE | re.DOTALL)


def free_port() -> int:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


def on_free_ports(text: str) -> tuple[str, int]:
    """The program with every port replaced by a free one, and the port on which it listens for vehicles."""
    ports = {old: free_port() for old in dict.fromkeys(re.findall(r":(14\d{3})\b", text))}
    for old, new in ports.items():
        text = text.replace(f":{old}", f":{new}")
    return text, ports.get("14550", 0)


@contextmanager
def simulated(port: int):
    """A simulated vehicle that sends to the port, if there is one."""
    if not port:
        yield
        return
    command = [sys.executable, "-m", "mavstack", "sim", "--speed", "5", "--out", f"udpout://127.0.0.1:{port}"]
    with subprocess.Popen(command, cwd=ROOT, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL) as vehicle:
        try:
            yield
        finally:
            vehicle.terminate()


@pytest.fixture
def folder(tmp_path):
    """A folder with the project's recordings, in which programs run."""
    (tmp_path / "tests").symlink_to(ROOT / "tests")
    return tmp_path


def write_files(block, folder) -> None:
    """Write the files that the page of a block shows."""
    for other in BLOCKS:
        if other.page == block.page and other.directive.startswith("file: "):
            (folder / other.directive.removeprefix("file: ")).write_text(other.text, "utf-8")


def check_program(block, folder) -> None:
    write_files(block, folder)
    text, port = on_free_ports(block.text)
    with simulated(port if block.needs_vehicle else 0):
        if block.directive == "test: endless":
            first = first_line(text, folder)
            assert first
            return
        command = [sys.executable, "-W", "error", "-c", text]
        done = subprocess.run(
            command, cwd=folder, capture_output=True, text=True, timeout=100, check=False, input=""
        )
    assert done.returncode == 0, done.stderr
    assert done.stdout + done.stderr


def first_line(text: str, folder) -> str:
    """The first line that an endless program prints."""
    command = [sys.executable, "-u", "-c", text]
    with subprocess.Popen(command, cwd=folder, stdout=subprocess.PIPE, text=True) as program:
        try:
            assert program.stdout is not None
            return program.stdout.readline()
        finally:
            program.terminate()


@pytest.mark.parametrize(
    "block", [block for block in PROGRAMS if not block.needs_vehicle], ids=lambda block: block.name
)
def test_programs_without_a_vehicle_run(block, folder):
    check_program(block, folder)


@pytest.mark.interop
@pytest.mark.parametrize(
    "block", [block for block in PROGRAMS if block.needs_vehicle], ids=lambda block: block.name
)
def test_programs_with_a_vehicle_run(block, folder):
    check_program(block, folder)


@pytest.mark.interop
@pytest.mark.parametrize("block", TEST_MODULES, ids=lambda block: block.name)
def test_test_modules_pass(block, tmp_path):
    (tmp_path / "test_example.py").write_text(block.text, "utf-8")
    command = [
        sys.executable,
        "-m",
        "pytest",
        "-q",
        "-p",
        "no:cacheprovider",
        "--rootdir",
        str(tmp_path),
        str(tmp_path),
    ]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=100, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.skipif(sys.platform == "win32", reason="named pipes of POSIX")
async def test_the_link_plug_in_carries_bytes(tmp_path):
    namespace: dict = {}
    for block in (block for block in PYTHON if block.page == "guides/link-plugin.md"):
        exec(compile(block.text, block.page, "exec"), namespace)
    example = namespace["PIPE"].example
    assert str(parse_url(example, {"pipe": namespace["PIPE"]})) == example
    path = tmp_path / "vehicle"
    for end in ("in", "out"):
        os.mkfifo(f"{path}.{end}")
    url = LinkURL("pipe", path=str(path), options={"chunk": "100"})
    async with asyncio.timeout(10), namespace["PipeLink"](url, Options(url)) as link:
        opened = await anext(link)
        assert isinstance(opened, ChannelOpened)
        await asyncio.to_thread(Path(f"{path}.in").write_bytes, b"hello")
        received = await anext(link)
        assert isinstance(received, BytesReceived)
        assert received.data == b"hello"
        assert opened.channel.write(b"answer")
        opened.channel.close()
        assert isinstance(await anext(link), ChannelClosed)
