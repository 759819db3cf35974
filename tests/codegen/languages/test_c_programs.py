"""Public programs for the official C headers compile against ours, and our code is no larger than mavgen's.

The programs are cloned into a temporary folder; without a network their tests skip.
"""

from __future__ import annotations

import contextlib
import io
import subprocess
from pathlib import Path
from xml.etree import ElementTree

import pytest

import mavstack
from mavstack.dialects import Dialect
from tests.codegen.compilers import needs
from tests.codegen.languages.compiling import C99, RUNNERS, run, write_library

pytestmark = [pytest.mark.interop, pytest.mark.nightly]

DEFINITIONS = Path(mavstack.__file__).parent / "dialects" / "definitions"
GITHUB = "https://github.com"
CORTEX = ("-std=c99", "-Os", "-mthumb", "-DMAVLINK_COMM_NUM_BUFFERS=1", "-w", "-c")


@pytest.fixture(scope="module")
def headers(tmp_path_factory):
    return write_library("c", "all", tmp_path_factory.mktemp("headers") / "mavlink")


def clone(repository, folder):
    """Fetch the newest commit of a public repository, or skip the test."""
    command = ["git", "clone", "-q", "--depth", "1", f"{GITHUB}/{repository}", str(folder)]
    try:
        fetched = subprocess.run(command, capture_output=True, timeout=100, check=False)
    except subprocess.TimeoutExpired:
        pytest.skip(f"cannot fetch {repository}: timeout")
    if fetched.returncode:
        pytest.skip(f"cannot fetch {repository}: {fetched.stderr.decode()[-200:]}")
    return folder


def compiles(compiler, source, headers, *flags):
    includes = (f"-I{headers}", f"-I{headers.parent}")
    run(compiler, "-fsyntax-only", "-Wall", "-Werror", *flags, *includes, source)


def test_the_uart_example(headers, tmp_path):
    folder = clone("mavlink/c_uart_interface_example", tmp_path / "program")
    sources = sorted(folder.glob("*.cpp"))
    assert len(sources) >= 4
    for source in sources:
        compiles(needs("g++"), source, headers, "-std=c++11")


def test_the_udp_example(headers, tmp_path):
    folder = clone("mavlink/mavlink", tmp_path / "program")
    compiles(needs("gcc"), folder / "examples" / "c" / "udp_example.c", headers, "-D_GNU_SOURCE")


def test_the_udp_example_in_cpp(tmp_path):
    headers = write_library("cpp11", "common", tmp_path / "mavlink")
    source = clone("mavlink/mavlink", tmp_path / "program") / "examples" / "cpp" / "udp_example.cpp"
    compiles(needs("g++"), source, headers, "-std=c++11")


def test_the_router(headers, tmp_path):
    folder = clone("mavlink-router/mavlink-router", tmp_path / "program")
    (folder / "src" / "git_version.h").write_text("#define GIT_VERSION 0\n")
    for name in ("endpoint", "mainloop", "logendpoint", "autolog", "binlog", "tlog", "ulog", "dedup"):
        flags = ("-std=c++14", f"-I{folder / 'src'}", f"-I{headers / 'ardupilotmega'}", "-Wno-unused-result")
        compiles(needs("g++"), folder / "src" / f"{name}.cpp", headers, *flags, "-D_GNU_SOURCE")


def test_the_test_suite_of_pymavlink(headers, tmp_path):
    folder = clone("ArduPilot/pymavlink", tmp_path / "program")
    source = folder / "generator" / "C" / "test" / "posix" / "testmav.c"
    for dialect in ("common", "ardupilotmega"):
        program = tmp_path / dialect
        includes = (f"-I{headers}", f"-I{headers / dialect}")
        run(needs("gcc"), "-Wall", "-Werror", "-Wno-unused-function", *includes, source, "-o", program)
        assert "No errors detected" in run(program)


def mavgen_headers(folder, definition=DEFINITIONS / "common.xml"):
    mavgen = pytest.importorskip("pymavlink.generator.mavgen")
    options = mavgen.Opts(str(folder), wire_protocol="2.0", language="C", validate=False)
    with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
        assert mavgen.mavgen(options, [str(definition)])
    return folder


def three_messages(path):
    """Write a definition with the messages of the firmware alone, and their enums."""
    trees = [ElementTree.parse(DEFINITIONS / f"{name}.xml") for name in ("minimal", "standard", "common")]
    wanted = ("HEARTBEAT", "ATTITUDE", "SYSTEM_TIME")
    messages = [item for tree in trees for item in tree.iter("message") if item.get("name") in wanted]
    used = {field.get("enum") for message in messages for field in message.iter("field")}
    enums = [item for tree in trees for item in tree.iter("enum") if item.get("name") in used]
    root = ElementTree.Element("mavlink")
    for tag, items in (("enums", enums), ("messages", messages)):
        ElementTree.SubElement(root, tag).extend(items)
    ElementTree.ElementTree(root).write(path)
    return path


def sizes(source, headers, target, processor="m4"):
    """Return the bytes of code and constants, and those of variables."""
    run(
        needs("arm-none-eabi-gcc"), *CORTEX, f"-mcpu=cortex-{processor}", f"-I{headers}", source, "-o", target
    )
    compiler = needs("arm-none-eabi-gcc")
    text, data, bss = run(compiler.removesuffix("gcc") + "size", target).splitlines()[1].split()[:3]
    return int(text) + int(data), int(bss)


def all_messages():
    names = [name.lower() for name in Dialect.load("common").names]
    union = "".join(f"mavlink_{name}_t {name};" for name in names)
    cases = "".join(
        f"case MAVLINK_MSG_ID_{name.upper()}: mavlink_msg_{name}_decode(msg, &u.{name});"
        f"mavlink_msg_{name}_encode(1, 1, msg, &u.{name}); break;\n"
        for name in names
    )
    return f"""#include "common/mavlink.h"
union {{ {union} }} u;
uint8_t use(mavlink_message_t *msg, uint8_t byte) {{
mavlink_status_t status;
if (mavlink_parse_char(0, byte, msg, &status)) switch (msg->msgid) {{
{cases}}}
return msg->len; }}
"""


def test_bare_metal_needs_only_functions_of_memory(tmp_path):
    headers, target = write_library("c", "common", tmp_path / "headers"), tmp_path / "firmware.o"
    compiler = needs("arm-none-eabi-gcc")
    flags = (*C99, "-Os", "-ffreestanding", "-mthumb", "-mcpu=cortex-m0", f"-I{headers}", "-c")
    run(compiler, *flags, RUNNERS / "c" / "firmware.c", "-o", target)
    undefined = run(compiler.removesuffix("gcc") + "nm", "-u", target).replace("U", "").split()
    functions = {name for name in undefined if not name.startswith("__aeabi_")}
    assert functions <= {
        "memcpy",
        "memmove",
        "memset",
        "memcmp",
        "roll",
        "boot_time",
        "uart_read",
        "uart_write",
    }


@pytest.mark.parametrize("processor", ["m0", "m4"])
@pytest.mark.parametrize("messages", ["three", "all"])
def test_code_for_a_small_processor_is_no_larger_than_that_of_mavgen(messages, processor, tmp_path):
    source = RUNNERS / "c" / "firmware.c"
    if messages == "all":
        source = tmp_path / "all.c"
        source.write_text(all_messages())
    ours = sizes(source, write_library("c", "common", tmp_path / "ours"), tmp_path / "ours.o", processor)
    theirs = sizes(source, mavgen_headers(tmp_path / "theirs"), tmp_path / "theirs.o", processor)
    assert ours[0] <= theirs[0]
    assert ours[1] <= theirs[1]


def test_a_dialect_of_three_messages_is_no_larger_than_that_of_mavgen(tmp_path):
    definition = three_messages(tmp_path / "common.xml")
    source = RUNNERS / "c" / "firmware.c"
    ours = sizes(source, write_library("c", definition, tmp_path / "ours"), tmp_path / "ours.o")
    theirs = sizes(source, mavgen_headers(tmp_path / "theirs", definition), tmp_path / "theirs.o")
    assert ours[0] <= theirs[0]
    assert ours[1] <= theirs[1]
