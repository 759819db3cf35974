"""Python packages: their text, their behaviour, mypy, the corpus on CPython and MicroPython, the guide."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any

import pytest

from mavstack.codegen import generate, make_library, write_files
from mavstack.codegen.languages.python.classes import RESERVED_WORDS
from mavstack.dialects import Dialect, common
from mavstack.dialects.tables import official_names
from mavstack.errors import InvalidArgumentError
from mavstack.wire import Parser, Signing, encode
from tests.codegen.compilers import needs
from tests.codegen.conformance import check_runner
from tests.docs.blocks import BLOCKS

if TYPE_CHECKING:
    from collections.abc import Iterator

RUNNERS = Path(__file__).parents[1] / "runners" / "python"
TRICKY = """<mavlink><enums>
<enum name="class"><entry name="CLASS_3D" value="1"><description>A "quoted" \\ text
of two lines</description></entry></enum></enums><messages>
<message id="70000" name="FROM"><description>Ends with a quote "</description>
<field type="uint8_t" name="class" enum="class">Text with \\ in it.</field>
<field type="uint8_t" name="self">s</field>
<field type="uint8_t" name="pack">p</field><field type="char" name="letter">c</field>
<field type="int64_t[2]" name="wide">w</field><field type="double[2]" name="d">d</field>
<extensions/><field type="uint8_t[3]" name="more">m</field></message>
<message id="7" name="ONE"><field type="int8_t[1]" name="single">v</field></message>
</messages></mavlink>"""


def texts(dialect: str | Dialect, **options) -> dict[str, str]:
    loaded = Dialect.load(dialect) if isinstance(dialect, str) else dialect
    return {file.path: file.text for file in generate(make_library(loaded, **options), "python")}


def write(folder: Path, dialect: str | Dialect, **options) -> Path:
    loaded = Dialect.load(dialect) if isinstance(dialect, str) else dialect
    write_files(generate(make_library(loaded, **options), "python"), folder)
    return folder


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The package of common."""
    return write(tmp_path_factory.mktemp("python"), "common")


@pytest.fixture(scope="module")
def package(folder: Path) -> Iterator[ModuleType]:
    """The imported package of common."""
    sys.path.insert(0, str(folder))
    try:
        import mavlink_common

        yield mavlink_common
    finally:
        sys.path.remove(str(folder))
        for name in [name for name in sys.modules if name.partition(".")[0] == "mavlink_common"]:
            del sys.modules[name]


def run(folder: Path, *words: str | Path) -> str:
    done = subprocess.run(
        [sys.executable, "-W", "error", *map(str, words)],
        env={**os.environ, "PYTHONPATH": str(folder)},
        capture_output=True,
        text=True,
        timeout=100,
        check=False,
    )
    assert done.returncode == 0, done.stderr[-2000:]
    return done.stdout


def test_equal_definitions_give_equal_files():
    assert texts("common") == texts("common")


def test_only_the_selected_messages_are_there():
    files = texts("common", only=["HEARTBEAT"])
    modules = [path for path in files if "/messages/" in path]
    assert modules == ["mavlink_common/messages/__init__.py", "mavlink_common/messages/minimal.py"]
    assert "class MavCmd" not in files["mavlink_common/enums.py"]


def test_the_package_has_the_chosen_name():
    assert "my_mavlink/__init__.py" in texts("minimal", package="my_mavlink")
    with pytest.raises(InvalidArgumentError, match="must be the name of a Python package, got 'my-mavlink'"):
        texts("minimal", package="my-mavlink")


def test_reserved_names_get_an_underscore(tmp_path):
    write(tmp_path, Dialect.from_xml(TRICKY), package="tricky")
    program = (
        "from tricky import messages, enums, Parser\n"
        "m = messages.From(class_=1, self_=2, pack_=3, letter='x', wide=(1, 2), "
        "d=(0.5, 1.0), more=b'z')\n"
        "print(Parser().feed(m.pack(1, 1))[0].message, enums.Class.CLASS_3D)\n"
        "print(Parser().feed(messages.One((-1,)).pack(1, 1))[0].message)\n"
        "print(Parser().feed(m.pack(1, 1))[0].message == m)\n"
    )
    assert run(tmp_path, "-c", program).splitlines() == [
        "From(class_=1, self_=2, pack_=3, letter='x', wide=(1, 2), d=(0.5, 1.0), more=b'z\\x00\\x00') 1",
        "One(single=(-1,))",
        "True",
    ]


def test_the_reserved_words_are_those_of_python():
    assert {"class", "lambda", "None", "self", "pack"} <= RESERVED_WORDS


def test_packets_equal_those_of_mavstack(package):
    message = package.messages.Attitude(time_boot_ms=7, roll=0.5, yaw=-1.0)
    expected = common.Attitude(time_boot_ms=7, roll=0.5, yaw=-1.0)
    for version in (1, 2):
        packet = message.pack(3, 4, 5, version)
        assert packet == encode(expected, system=3, component=4, sequence=5, version=version)
        (received,) = package.Parser().feed(packet)
        assert (received.version, received.system, received.component, received.sequence) == (
            version,
            3,
            4,
            5,
        )
        assert received.message == message
        assert received.raw == packet


def test_a_message_shows_and_lists_its_fields(package):
    message = package.messages.Heartbeat(type=package.enums.MavType.QUADROTOR)
    assert repr(message).startswith("Heartbeat(type=2, autopilot=0, ")
    assert message.to_dict()["mavlink_version"] == package.VERSION == 3
    assert package.enums.name_of(package.enums.MavType, 2) == "QUADROTOR"
    assert package.enums.name_of(package.enums.MavType, 250) == "250"


@pytest.mark.parametrize(
    ("name", "fields", "problem"),
    [
        ("Heartbeat", {"type": 256}, "cannot pack HEARTBEAT: "),
        ("Heartbeat", {"type": "x"}, "cannot pack HEARTBEAT: "),
        ("Statustext", {"text": "x" * 51}, "text has 51 bytes, more than 50"),
        ("FileTransferProtocol", {"payload": bytes(252)}, "payload has 252 bytes, more than 251"),
        ("ActuatorControlTarget", {"controls": (1.0,)}, "cannot pack ACTUATOR_CONTROL_TARGET: "),
    ],
)
def test_values_that_do_not_fit_are_refused(package, name, fields, problem):
    with pytest.raises(ValueError, match=problem):
        getattr(package.messages, name)(**fields).pack(1, 1)


@pytest.mark.parametrize("version", [1, 2])
@pytest.mark.parametrize("sender", [(256, 1, 0), (1, -1, 0), (1, 1, 300)])
def test_a_sender_that_does_not_fit_is_refused(package, version, sender):
    system, component, sequence = sender
    with pytest.raises(ValueError, match=r"255|range"):
        package.messages.Heartbeat().pack(system, component, sequence, version)


@pytest.mark.parametrize("version", [1, 2])
def test_checksums_by_the_table_of_micropython_are_equal(package, version, monkeypatch):
    checksums = package._checksum
    packet = package.messages.Attitude(roll=0.5).pack(3, 4, 5, version)
    monkeypatch.setitem(sys.modules, "binascii", ModuleType("binascii"))
    slow: dict[str, Any] = {"__name__": "slow"}
    exec(Path(checksums.__file__).read_text(), slow)
    assert slow["checksum"] is slow["_checksum_by_table"]
    data, state = packet[:-2] + package.messages.Attitude.EXTRA, f"BEFORE_MAGIC_{version}"
    assert slow["checksum"](data, slow[state]) == slow["checksum"](data[1:]) == packet[-2:]
    assert checksums.checksum(data, getattr(checksums, state)) == packet[-2:]


def test_mavlink_1_carries_no_large_id_and_no_signature(package):
    with pytest.raises(ValueError, match="MAVLink 1 cannot carry"):
        package.messages.ProtocolVersion().pack(1, 1, version=1)
    with pytest.raises(ValueError, match="MAVLink 1 cannot carry"):
        package.messages.Heartbeat().pack(1, 1, version=1, signing=package.Signing(bytes(32)))
    with pytest.raises(ValueError, match="a signing key has 32 bytes"):
        package.Signing(b"short")


def test_signed_packets_are_accepted_by_mavstack_and_back(package):
    key, now = bytes(range(32)), 36_000_000_000_000
    ours, theirs = Signing(key, timestamp=now), package.Signing(key, link_id=3, timestamp=now)
    packet = package.messages.Heartbeat().pack(1, 1, 0, signing=theirs)
    assert len(Parser(common, signing=ours).feed(packet, now=1_420_070_400 + now / 1e5)) == 1
    parser = package.Parser(package.Signing(key, accept_unsigned=(30,)))
    signed = encode(common.Heartbeat(), system=1, component=1, signing=Signing(key, timestamp=now))
    assert [item.signed for item in parser.feed(signed + signed)] == [True]
    assert parser.bad_signature == 1
    assert (
        len(parser.feed(package.messages.Attitude().pack(1, 1) + package.messages.Heartbeat().pack(1, 1)))
        == 1
    )
    assert "bytes" not in repr(parser.signing)


def test_bytes_outside_of_packets_are_counted(package):
    parser = package.Parser()
    packet = package.messages.Heartbeat().pack(1, 1)
    assert len(parser.feed(b"abc" + packet + b"de" + packet)) == 2
    assert (parser.good, parser.skipped) == (2, 5)


def test_info_has_all_fields(package):
    import mavlink_common.info

    (roll,) = (field for field in mavlink_common.info.FIELDS[30] if field.name == "roll")
    assert (roll.type, roll.array_length, roll.offset, roll.units, roll.enum) == ("float", 0, 4, "rad", "")
    assert set(mavlink_common.info.FIELDS) == set(package.messages.BY_ID)


def test_common_passes_the_corpus(folder, monkeypatch):
    monkeypatch.setenv("PYTHONPATH", str(folder))
    check_runner([sys.executable, RUNNERS / "runner.py", "mavlink_common"], "common")


@pytest.mark.flight
def test_all_passes_the_corpus(tmp_path, monkeypatch):
    monkeypatch.setenv("PYTHONPATH", str(write(tmp_path, "all")))
    check_runner([sys.executable, RUNNERS / "runner.py", "mavlink_all"], "all")


@pytest.mark.flight
@pytest.mark.parametrize("dialect", official_names())
def test_every_official_dialect_is_imported(dialect, tmp_path):
    name = f"mavlink_{dialect.lower()}"
    program = f"import {name}, {name}.info; print(len({name}.messages.BY_ID))"
    assert run(write(tmp_path, dialect), "-c", program) == f"{len(Dialect.load(dialect))}\n"


@pytest.mark.flight
def test_types_are_strict(folder):
    command = [sys.executable, "-m", "mypy", "--strict", "--config-file=", "--cache-dir", os.devnull]
    done = subprocess.run(
        [*command, "-p", "mavlink_common"], cwd=folder, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout[-2000:]


@pytest.mark.nightly
def test_micropython_passes_the_corpus(folder):
    command = [needs("node"), RUNNERS / "micropython.mjs", needs("micropython"), folder]
    check_runner([*command, "mavlink_common", RUNNERS / "runner.py"], "common", timeout=600)


def test_the_example_of_the_readme_runs(folder):
    text = (folder / "README.md").read_text("utf-8")
    program = text.partition("```python\n")[2].partition("```")[0]
    assert "1 packets, 0 damaged" in run(folder, "-c", program)


@pytest.mark.parametrize(
    "block",
    [block for block in BLOCKS if block.page == "guides/generate-python.md" and block.language == "python"],
    ids=lambda block: block.name,
)
def test_programs_of_the_guide_run(folder, block):
    assert run(folder, "-c", block.text)
