"""The Wireshark dissector: its text, and what tshark finds in captures."""

from __future__ import annotations

import shlex
import struct
import sys
from math import isinf
from typing import TYPE_CHECKING

import pytest

from mavstack.codegen import generate, make_library
from mavstack.dialects import Dialect, common
from mavstack.dialects.tables import official_names
from mavstack.logs.recorder.formats import PCAP
from mavstack.wire import Parser, Signing, encode
from tests.codegen.conformance import corpus
from tests.codegen.wireshark import (
    RIGHT,
    UNKNOWN,
    USER0,
    WRONG,
    Dissected,
    capture,
    dissect,
    generate_dissector,
    tcp,
    tshark,
    udp,
)
from tests.docs.blocks import BLOCKS

if TYPE_CHECKING:
    from pathlib import Path

    from mavstack import Packet
    from mavstack.dialects.model import FieldDefinition

MAX_DOUBLE = sys.float_info.max
GUIDE_COMMANDS = [
    line
    for block in BLOCKS
    if block.page == "guides/generate-wireshark.md"
    for line in block.text.splitlines()
    if line.startswith("tshark ")
]
ARM = "MAV_CMD_COMPONENT_ARM_DISARM"
FORMATS = {"float": "<f", "double": "<d"}
TRICKY = """<mavlink><messages>
<message id="200" name="CRC"><description>Quotes " and \\ and ]] in a text.</description>
<field type="uint8_t" name="end" units="a&quot;b">x</field><field type="uint8_t" name="nil">y</field>
</message></messages></mavlink>"""


def packed(message: object, system: int = 1, sequence: int = 0, **options) -> bytes:
    return encode(message, system=system, component=1, sequence=sequence, **options)


def test_equal_definitions_give_equal_files():
    library = make_library(Dialect.load("common"))
    assert generate(library, "wireshark") == generate(library, "wireshark")


def test_there_is_one_lua_file_with_the_stamp_and_the_licence():
    library = make_library(Dialect.load("common"))
    files = {file.path: file.text for file in generate(library, "wireshark")}
    assert sorted(files) == [".mavgen-wireshark.txt", "README.md", "mavlink_common.lua"]
    for path in ("README.md", "mavlink_common.lua"):
        assert library.stamp in files[path][:300]
        assert "SPDX-License-Identifier: MIT" in files[path][:400]


def test_filters_of_messages_are_apart_from_those_of_the_dissector():
    text = "".join(file.text for file in generate(make_library(Dialect.from_xml(TRICKY)), "wireshark"))
    assert '"CRC", "mavlink.crc_"' in text


def test_only_the_selected_messages_are_there():
    library = make_library(Dialect.load("common"), only=["ATTITUDE"], package="small")
    files = {file.path: file.text for file in generate(library, "wireshark")}
    text = files["small.lua"]
    assert 'message(30, "ATTITUDE", "mavlink.attitude", 39, 28, 28' in text
    assert 'message(0, "HEARTBEAT"' not in text


@pytest.fixture(scope="module")
def dissector(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return generate_dissector(tmp_path_factory.mktemp("dissector"))


@pytest.fixture(scope="module")
def dissector_all(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return generate_dissector(tmp_path_factory.mktemp("dissector"), "all")


def expected(packet: Packet, dialect: Dialect) -> dict[str, object]:
    """Return what tshark should show of a packet that the core parsed."""
    known = packet.message is not None
    definition = dialect.message_definition(packet.message_id) if known else None
    length = definition.length if definition else 0
    data = packet.payload[:length].ljust(length, b"\0")
    fields = definition.fields if definition else ()
    return {
        "msgid": str(packet.message_id),
        "message": definition.name if definition else "unknown",
        "version": str(packet.version),
        "seq": str(packet.sequence),
        "sysid": str(packet.system),
        "compid": str(packet.component),
        "crc.status": RIGHT if known else UNKNOWN,
        "signed": packet.signed,
        "fields": {
            item.name: data[item.offset : item.offset + item.size].hex()
            for item in fields
            if packet.version == 2 or not item.extension
        },
    }


def shown(packet: Dissected, dialect: Dialect) -> dict[str, object]:
    """Return the same of a packet that tshark showed."""
    names = ("msgid", "message", "version", "seq", "sysid", "compid", "crc.status")
    name = packet.message
    fields = dialect.message_definition(int(packet.one("msgid"))).fields if name != "unknown" else ()
    prefix = f"mavlink.{name.lower()}"
    return {
        **{item: packet.one(item) for item in names},
        "signed": "mavlink.signature" in packet.values,
        "fields": {
            item.name: _shown_hex(packet, f"{prefix}.{item.name}", item)
            for item in fields
            if f"{prefix}.{item.name}" in packet.values
        },
    }


def _shown_hex(packet: Dissected, name: str, item: FieldDefinition) -> str:
    """Return the bytes of a field, after a comparison with its shown values."""
    raw = b"".join(packet.raw[name]).ljust(item.size, b"\0")
    values = packet.values[name]
    if item.type == "char":
        assert values == [raw.partition(b"\0")[0].decode()], name
    elif len(values) == max(item.array_length, 1):
        size = item.size // len(values)
        for index, value in enumerate(values):
            _assert_value(value, raw[index * size : (index + 1) * size], item.type, name)
    return raw.hex()


def _assert_value(value: str, raw: bytes, kind: str, name: str) -> None:
    if kind in FORMATS:
        (number,) = struct.unpack(FORMATS[kind], raw)
        # The shown text of the largest double, rounded, is larger than any double.
        rounded = isinf(float(value)) and abs(number) > MAX_DOUBLE * 0.99
        assert rounded or float(value) == pytest.approx(number, rel=1e-5, nan_ok=True), name
    elif ":" not in value:
        assert int(value, 0) == int.from_bytes(raw, "little", signed=kind.startswith("i")), name


def check_corpus(dialect: Dialect, script: Path, folder: Path, category: str = "") -> None:
    """Compare what tshark shows of each input with what the core finds in it."""
    cases = [case for case in corpus(dialect.name) if case["name"].startswith(category)]
    frames = [udp(bytes.fromhex(case["input"]), 20000 + number) for number, case in enumerate(cases)]
    found: dict[int, list[Dissected]] = {}
    for packet in dissect(script, capture(folder / "corpus.pcap", frames)):
        if packet.one("crc.status") != WRONG:
            found.setdefault(packet.frame, []).append(packet)
    for number, case in enumerate(cases, 1):
        parser = Parser(dialect)
        data = bytes.fromhex(case["input"])
        wanted = [expected(packet, dialect) for packet in (*parser.feed(data), *parser.flush())]
        assert [shown(packet, dialect) for packet in found.get(number, [])] == wanted, case["name"]


@pytest.mark.interop
@pytest.mark.smoke
@pytest.mark.xdist_group("tshark")
def test_fields_and_checksums_of_the_corpus(dissector, tmp_path):
    check_corpus(Dialect.load("common"), dissector, tmp_path)


@pytest.mark.interop
@pytest.mark.xdist_group("tshark")
def test_fields_and_checksums_of_the_corpus_of_all(dissector_all, tmp_path):
    check_corpus(Dialect.load("all"), dissector_all, tmp_path)


def lines(dissector: Path, path: Path, *words: str) -> list[str]:
    """Return the lines of tshark without empty ones."""
    return [line for line in tshark(dissector, path, *words).splitlines() if line]


def column_info(dissector: Path, path: Path) -> list[str]:
    return lines(dissector, path, "-T", "fields", "-e", "_ws.col.Info")


@pytest.mark.interop
@pytest.mark.xdist_group("tshark")
def test_a_recording_of_mav_record_and_its_filters(dissector, tmp_path):
    attitudes = [common.Attitude(roll=roll) for roll in (0.4, 0.6, -0.6)]
    messages = [*attitudes, common.Heartbeat(base_mode=0x81), common.Statustext(severity=6, text="Höhe 10 m")]
    records = [PCAP.record(packed(item), 1_700_000_000_000_000 + n) for n, item in enumerate(messages)]
    path = tmp_path / "live.pcap"
    path.write_bytes(PCAP.header + b"".join(records))

    def frames(display_filter: str) -> list[str]:
        return lines(dissector, path, "-Y", display_filter, "-T", "fields", "-e", "frame.number")

    assert frames("mavlink.attitude.roll > 0.5") == ["2"]
    assert frames("mavlink.attitude") == ["1", "2", "3"]
    assert frames("mavlink.heartbeat.base_mode.safety_armed == 1") == ["4"]
    assert frames('mavlink.statustext.text contains "10 m"') == ["5"]
    assert column_info(dissector, path)[3:] == ["1/1 HEARTBEAT", "1/1 STATUSTEXT MAV_SEVERITY_INFO Höhe 10 m"]


@pytest.mark.interop
@pytest.mark.xdist_group("tshark")
def test_requests_are_linked_to_their_answers(dissector, tmp_path):
    messages = [
        (common.CommandLong(target_system=1, target_component=1, command=400, param1=1), 255),
        (common.CommandLong(target_system=2, target_component=1, command=400, param1=1), 255),
        (common.CommandAck(command=400, result=5, target_system=255), 1),
        (common.CommandAck(command=400, result=0, target_system=254), 1),  # an answer to another station
        (common.CommandAck(command=400, result=0), 1),
        (common.ParamRequestRead(target_system=2, param_id="A", param_index=-1), 255),
        (common.ParamValue(param_id="B"), 2),
        (common.ParamValue(param_id="A", param_value=1), 2),
        (common.MissionRequestInt(target_system=255, seq=3), 1),
        (common.MissionItemInt(target_system=1, seq=3), 255),
    ]
    path = capture(tmp_path / "links.pcap", [udp(packed(item, system)) for item, system in messages])
    packets = dissect(dissector, path)

    def links(name: str) -> dict[int, list[str]]:
        found = {packet.frame: packet.values.get(f"mavlink.{name}", []) for packet in packets}
        return {frame: values for frame, values in found.items() if values}

    assert links("response_in") == {1: ["5"], 6: ["8"], 9: ["10"]}
    assert links("response_to") == {3: ["1"], 5: ["1"], 8: ["6"], 10: ["9"]}
    assert links("response_time")[5] == ["0.004000000"]
    assert column_info(dissector, path)[4] == f"1/1 COMMAND_ACK {ARM} MAV_RESULT_ACCEPTED"


def ftp(sequence: int, opcode: int, requested: int = 0, target: int = 1) -> common.FileTransferProtocol:
    payload = struct.pack("<HBBBB", sequence, 0, opcode, 0, requested)
    return common.FileTransferProtocol(target_system=target, target_component=1, payload=payload)


@pytest.mark.interop
@pytest.mark.xdist_group("tshark")
def test_pings_and_files_are_linked_to_their_answers(dissector, tmp_path):
    messages = [
        (common.Ping(seq=7), 255),
        (common.Ping(seq=8, target_system=255, target_component=190), 1),  # an echo of another one
        (common.Ping(seq=7, target_system=254, target_component=190), 1),  # to another station
        (common.Ping(seq=7, target_system=255, target_component=190), 1),
        (ftp(65535, 4), 255),
        (ftp(1, 5), 255),
        (ftp(0, 128, 5, target=255), 1),  # of another operation
        (ftp(0, 128, 4, target=255), 1),
        (ftp(2, 129, 5, target=255), 1),
    ]
    path = capture(tmp_path / "links.pcap", [udp(packed(item, system)) for item, system in messages])
    packets = dissect(dissector, path)
    links = {packet.frame: packet.values["mavlink.response_to"] for packet in packets if
             "mavlink.response_to" in packet.values}  # fmt: skip
    assert links == {4: ["1"], 8: ["5"], 9: ["6"]}
    assert packets[0].one("response_in") == "4"
    assert packets[4].one("response_in") == "8"


@pytest.mark.interop
@pytest.mark.xdist_group("tshark")
def test_states_of_checksums_signatures_and_bytes_outside_of_packets(dissector, tmp_path):
    good = packed(common.Attitude(roll=1.0, yawspeed=1.0))
    wrong = good[:12] + b"\x55" + good[13:]
    unknown = packed(Dialect.load("ardupilotmega")["AHRS"](error_yaw=1.0))
    signing = Signing(bytes(32), 7, timestamp=34_719_840_000_000)
    signed = packed(common.Heartbeat(), signing=signing)
    streams = (wrong + good, unknown, signed, b"\x01\x02" + good, b"\xfd\x09\x02" + good)
    frames = [*map(udp, streams), udp(good, 33000, 33001)]  # the last one on no port of MAVLink
    path = capture(tmp_path / "states.pcap", frames)
    packets = dissect(dissector, path)
    assert [(packet.frame, packet.one("crc.status")) for packet in packets] == [
        (1, WRONG), (1, RIGHT), (2, UNKNOWN), (3, RIGHT), (4, RIGHT), (5, RIGHT), (6, RIGHT),
    ]  # fmt: skip
    assert packets[2].one("payload") == packets[2].raw["mavlink.payload"][0].hex(":")
    assert packets[3].one("signature.link_id") == "7"
    assert packets[3].one("signature.time").startswith("Jan  1, 2026 12:00:00.00001")
    words = ("-Y", "mavlink.junk", "-T", "fields", "-e", "mavlink.junk")
    assert lines(dissector, path, *words) == ["0102", "fd0902"]


def pieces(data: bytes, size: int) -> list[bytes]:
    return [data[start : start + size] for start in range(0, len(data), size)]


@pytest.mark.interop
@pytest.mark.xdist_group("tshark")
@pytest.mark.parametrize("transport", ["tcp", "udp", "serial"])
def test_packets_continue_in_the_next_frame(dissector, tmp_path, transport):
    data = b"".join(packed(common.Attitude(roll=n, yawspeed=1.0), sequence=n) for n in range(1, 6))
    parts = pieces(data, 17)
    path = tmp_path / "pieces.pcap"
    if transport == "serial":
        capture(path, parts, USER0)
    elif transport == "udp":
        capture(path, [udp(part) for part in parts])
    else:
        capture(path, [tcp(part, 1 + 17 * number) for number, part in enumerate(parts)])
    packets = dissect(dissector, path)
    assert [packet.one("attitude.roll") for packet in packets] == ["1", "2", "3", "4", "5"]
    assert {packet.one("crc.status") for packet in packets} == {RIGHT}


@pytest.mark.interop
@pytest.mark.xdist_group("tshark")
def test_commands_of_the_guide(dissector, tmp_path):
    messages = [common.Attitude(roll=0.75), common.CommandLong(command=400), common.CommandAck(command=400)]
    path = capture(tmp_path / "flight.pcap", [udp(packed(item)) for item in messages])
    printed = {
        command[command.index("-Y") + 1]: lines(dissector, path, *command[5:])
        for command in map(shlex.split, GUIDE_COMMANDS)
    }
    assert [len(items) for items in printed.values()] == [3, 1, 0, 0, 1, 1]
    assert printed["mavlink.attitude"][0].split()[1] == "0.75"
    assert printed["mavlink.command_long"] == ["400\t3"]


@pytest.mark.interop
@pytest.mark.xdist_group("tshark")
def test_difficult_names_load(tmp_path):
    dialect = Dialect.from_xml(TRICKY)
    script = generate_dissector(tmp_path, dialect)
    path = capture(tmp_path / "one.pcap", [udp(packed(dialect["CRC"](end=5, nil=6)))])
    (packet,) = dissect(script, path)
    assert packet.one("crc_.end") == "5"


@pytest.mark.nightly
@pytest.mark.parametrize("name", official_names())
def test_tshark_loads_each_official_dialect(name, tmp_path):
    dialect = Dialect.load(name)
    messages = [message() for message in dialect]
    path = capture(tmp_path / "zeros.pcap", [udp(packed(item)) for item in messages])
    found = dissect(generate_dissector(tmp_path, name), path)
    assert [packet.message for packet in found] == [item.definition.name for item in messages]
