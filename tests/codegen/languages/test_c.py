"""The library in C99: its files, its warnings with several compilers, and the conformance corpus."""

from __future__ import annotations

import json
import re
import subprocess
from hashlib import sha256
from pathlib import Path

import pytest

from mavstack import dialects
from mavstack.codegen import generate, make_library
from mavstack.dialects import Dialect
from mavstack.dialects.tables import official_names
from tests.codegen.compilers import needs
from tests.codegen.conformance import CORPUS, check_runner
from tests.codegen.languages.compiling import C99, RUNNERS, build, build_runner, run, write_library
from tests.codegen.languages.libraries import check_ground_station, check_signing, guide_programs

DEFINITION = """<mavlink><enums><enum name="BIG" bitmask="true">
<entry value="1" name="BIG_LOW"/><entry value="2147483648" name="BIG_HIGH"/></enum></enums><messages>
<message id="50000" name="WORDS"><field type="uint8_t" name="default" enum="BIG">a */ b</field>
<field type="char[4]" name="class">c</field></message></messages></mavlink>
"""
#: Sends and receives each message of a dialect.
ALL_MESSAGES = """
#define MAVLINK_USE_CONVENIENCE_FUNCTIONS
#define MAVLINK_USE_MESSAGE_INFO
#include <assert.h>
#define MAVLINK_ASSERT(condition) assert(condition)
#include "mavlink_types.h"
static mavlink_system_t mavlink_system = {{1, 1}};
static void comm_send_ch(mavlink_channel_t chan, uint8_t byte);
#include "{name}/mavlink.h"
static mavlink_message_t received;
static void comm_send_ch(mavlink_channel_t chan, uint8_t byte)
{{
    mavlink_status_t status;
    mavlink_parse_char((uint8_t)(chan + 2), byte, &received, &status);
}}
#include "{name}/testsuite.h"
int main(void)
{{
    mavlink_test_all(1, 1, &received);
    return 0;
}}
"""


def texts(library):
    return {file.path: file.text for file in generate(library, "c")}


def program(compiler, folder, dialect, *flags):
    """Compile the program that sends and receives all messages of a dialect."""
    headers = [
        f'-D{name}_HEADER="{dialect}/{file}.h"'
        for name, file in (("DIALECT", "mavlink"), ("TESTSUITE", "testsuite"))
    ]
    return build(compiler, RUNNERS / "c" / "program.c", folder / "program", *headers, *flags)


@pytest.fixture(scope="module")
def common(tmp_path_factory):
    return write_library("c", "common", tmp_path_factory.mktemp("common"))


@pytest.fixture(scope="module")
def everything(tmp_path_factory):
    return write_library("c", "all", tmp_path_factory.mktemp("all"))


def test_each_definition_file_has_a_folder():
    files = texts(make_library(Dialect.load("common"), only=["HEARTBEAT", "ATTITUDE"]))
    assert {path.partition("/")[0] for path in files if "/" in path} == {"common", "minimal", "standard"}
    assert {"common/mavlink_msg_attitude.h", "minimal/mavlink_msg_heartbeat.h", "protocol.h"} < set(files)
    entries = re.findall(r"\{(\d+), \d+, \d+, \d+, \d, \d, \d\}", files["common/common.h"])
    assert entries == ["0", "30"]


@pytest.mark.parametrize("dialect", ["ASLUAV", "AVSSUAS", "csAirLink", "icarous", "uAvionix"])
def test_folders_have_the_names_of_the_files_as_those_of_mavgen(dialect):
    mavparse = pytest.importorskip("pymavlink.generator.mavparse")
    path = Path(dialects.__file__).with_name("definitions") / f"{dialect}.xml"
    folder = mavparse.MAVXML(str(path), "2.0").basename
    assert folder == dialect
    for language, ending in (("c", "h"), ("cpp11", "hpp")):
        library = make_library(Dialect.load(dialect))
        files = {file.path: file.text for file in generate(library, language)}
        assert f"{folder}/{folder}.{ending}" in files
        for name in re.findall(r'#include "(.*?)"', files[f"{folder}/{folder}.{ending}"]):
            assert name.startswith("../") or f"{folder}/{name}" in files, name
            assert not name.startswith("../") or name[3:] in files, name


def test_words_of_c_and_big_values(tmp_path):
    (tmp_path / "words.xml").write_text(DEFINITION)
    files = texts(make_library(Dialect.from_xml(tmp_path / "words.xml")))
    message = files["words/mavlink_msg_words.h"]
    assert "uint8_t default_;" in message
    assert "char class_[4];" in message
    assert '"default"' in message
    assert "#define BIG_HIGH 2147483648U\n" in files["words/words.h"]
    assert "BIG_LOW = 1\n" in files["words/words.h"]


def test_entries_are_in_the_order_of_their_values_and_unfinished_messages_are_marked():
    entries = '<entry name="E_B" value="2"/><entry name="E_A" value="1"/>'
    field = '<field type="uint8_t" name="f" enum="E"/>'
    text = (
        f'<mavlink><enums><enum name="E">{entries}</enum></enums>'
        f'<messages><message id="1" name="M"><wip/>{field}</message></messages></mavlink>'
    )
    files = texts(make_library(Dialect.from_xml(text)))
    assert "    E_A = 1,\n    E_B = 2,\n    E_ENUM_END = 3\n" in files["text/text.h"]
    assert "MAVLINK_WIP static inline uint16_t mavlink_msg_m_pack(" in files["text/mavlink_msg_m.h"]


def test_a_struct_is_packed_only_if_a_field_is_not_aligned():
    files = texts(make_library(Dialect.load("common"), only=["BATTERY_STATUS", "COMMAND_LONG"]))
    assert "\nMAVPACKED(typedef struct" in files["common/mavlink_msg_battery_status.h"]
    assert "\ntypedef struct" in files["common/mavlink_msg_command_long.h"]


def test_programs_do_not_pass_the_protocol_version():
    file = texts(make_library(Dialect.load("minimal"), only=["HEARTBEAT"]))["minimal/mavlink_msg_heartbeat.h"]
    (parameters,) = set(
        re.findall(r"mavlink_msg_heartbeat_pack\(.*?, mavlink_message_t \*msg, (.*?)\)", file)
    )
    assert "uint8_t system_status" in parameters
    assert "mavlink_version" not in parameters
    assert "    _mav_put_uint8_t(_buf, 8, 3);" in file


def test_the_table_has_the_target_of_each_message():
    files = texts(make_library(Dialect.load("common"), only=["HEARTBEAT", "SET_MODE", "COMMAND_LONG"]))
    entries = re.findall(r"\{(\d+), \d+, \d+, \d+, (\d), (\d+), (\d+)\}", files["common/common.h"])
    # 1: a target system, 2: a target component, and their offsets.
    assert sorted(set(entries)) == [("0", "0", "0", "0"), ("11", "1", "4", "0"), ("76", "3", "30", "31")]


def test_an_enum_is_not_repeated_by_a_file_that_adds_no_entries():
    files = texts(make_library(Dialect.load("common"), only=["HEARTBEAT", "COMMAND_LONG"]))
    assert "typedef enum MAV_TYPE {" in files["minimal/minimal.h"]
    assert "typedef enum MAV_TYPE {" not in files["common/common.h"]


def test_an_enum_of_several_files_is_complete_in_the_file_that_joins_them():
    files = texts(make_library(Dialect.load("all")))
    everything, common = (
        re.findall(r"^    (MAV_CMD_\w+) =", files[f"{name}/{name}.h"], re.MULTILINE)
        for name in ("all", "common")
    )
    assert set(common) < set(everything)
    assert len(everything) == len(set(everything))


@pytest.mark.interop
@pytest.mark.smoke
def test_common_passes_the_corpus_with_gcc(common):
    runner = build_runner(needs("gcc"), "common", common, "-O0")
    check_runner([runner, "0"], "common")
    check_runner([runner, "64"], "common")


@pytest.mark.interop
@pytest.mark.smoke
def test_a_program_for_the_official_library_runs(common):
    assert run(program(needs("gcc"), common, "common", *C99)) == "752 packets\n"


@pytest.mark.interop
@pytest.mark.smoke
def test_hashes_of_all_lengths(common):
    output = run(build(needs("gcc"), RUNNERS / "c" / "hashes.c", common / "hashes", *C99))
    data = bytes(index % 256 for index in range(300))
    assert output.split() == [sha256(data[:length]).hexdigest()[:12] for length in range(301)]


@pytest.mark.interop
def test_the_work_for_a_byte_of_a_valid_stream_is_one_piece_of_a_checksum(common):
    work = build(needs("gcc"), RUNNERS / "c" / "work.c", common / "work", *C99, "-DMAVLINK_CRC_TABLES=0")
    cases = [json.loads(line) for line in (CORPUS / "common.jsonl").read_text().splitlines()]
    valid = [bytes.fromhex(case["input"]) for case in cases if case["name"].startswith("message/")]
    done = subprocess.run([work], input=b"".join(valid), capture_output=True, check=True)
    packets, maximum = map(int, done.stdout.split())
    assert packets > 1000
    assert maximum <= 17  # 16 bytes and CRC_EXTRA


@pytest.mark.interop
def test_the_programs_of_the_guide_run(common):
    flags = ("-std=gnu99", *C99[1:])
    for path in guide_programs("generate-c.md", common):
        build(needs("gcc"), path, path.with_suffix(""), *flags)
    check_ground_station([str(common / "ground")])
    check_signing([str(common / "signed")])


@pytest.mark.interop
def test_clang_and_cpp_accept_the_headers(common):
    run(program(needs("clang"), common, "common", *C99))
    for standard in ("c++11", "c++20"):
        flags = ("-x", "c++", *C99[1:], f"-std={standard}")
        run(program(needs("g++"), common, "common", *flags))


@pytest.mark.interop
def test_everything_passes_the_corpus(everything):
    runner = build_runner(needs("gcc"), "all", everything, "-DMAVLINK_CRC_BITWISE")
    check_runner([runner, "7"], "all")


@pytest.mark.nightly
@pytest.mark.parametrize("name", ["gcc", "clang", "gcc-multilib", "powerpc-gcc", "s390x-gcc"])
def test_everything_passes_the_corpus_on_other_processors(everything, name):
    flags = {"gcc-multilib": ["-m32"], "powerpc-gcc": ["-static"], "s390x-gcc": ["-static"]}.get(name, [])
    emulator = {"powerpc-gcc": "qemu-ppc", "s390x-gcc": "qemu-s390x"}.get(name)
    command = [needs(emulator)] if emulator else []
    runner = build_runner(needs(name), "all", everything, *flags, "-O2")
    for chunk in ("0", "1", "100000"):
        check_runner([*command, runner, chunk], "all")
    run(*command, program(needs(name), everything, "all", *C99, *flags))


@pytest.mark.nightly
@pytest.mark.parametrize("dialect", official_names())
def test_every_official_dialect_compiles(dialect, tmp_path):
    write_library("c", dialect, tmp_path)
    (tmp_path / "main.c").write_text(ALL_MESSAGES.format(name=dialect))
    for compiler in ("gcc", "clang"):
        run(build(needs(compiler), tmp_path / "main.c", tmp_path / "main", *C99))
