from __future__ import annotations

import re
import subprocess
from typing import TYPE_CHECKING

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from mavstack.codegen import generate, language, make_library, write_files
from mavstack.dialects.dialect import Dialect
from mavstack.dialects.tables import official_names
from mavstack.errors import InvalidArgumentError
from tests.codegen.compilers import needs
from tests.codegen.conformance import check_runner, corpus, expected_lines, input_line
from tests.codegen.random_streams import check_random_streams
from tests.docs.blocks import BLOCKS, ROOT

if TYPE_CHECKING:
    from pathlib import Path

COMMON = Dialect.load("common")
RUNNER = ROOT / "tests/codegen/runners/lua/runner.lua"
INTERPRETERS = ("lua5.4", "lua5.3", "luajit")
PROGRAMS = [block.text for block in BLOCKS if block.language == "lua"]
ODD = b"""<mavlink><enums>
<enum name="WIDE" bitmask="true"><entry name="WIDE_TOP" value="9223372036854775808"/>
<entry name="WIDE_ONE" value="1"/></enum>
<enum name="END"><entry name="END_AND" value="1"/><entry name="END_2D" value="2"/></enum>
</enums><messages>
<message id="70000" name="REPEAT"><description>Ends ]] here.</description>
<field type="int8_t[200]" name="end" units="&quot;a\\b&quot;">a</field>
<field type="uint64_t" name="not" enum="WIDE">b</field>
<field type="uint8_t[2]" name="Nil" enum="END">c</field><field type="char" name="c">d</field></message>
</messages></mavlink>"""


def files(library):
    return {file.path: file.text for file in generate(library, "lua")}


def run_lua(interpreter: str, folder: Path, source: str, *words: str) -> str:
    """Run a program in a folder, and return its output."""
    finished = subprocess.run(
        [needs(interpreter), "-", *words],
        cwd=folder,
        input=source,
        capture_output=True,
        text=True,
        check=False,
    )
    assert finished.returncode == 0, finished.stderr
    return finished.stdout


@pytest.fixture(scope="module")
def common(tmp_path_factory):
    folder = tmp_path_factory.mktemp("lua")
    write_files(generate(make_library(COMMON), "lua"), folder)
    return folder


@pytest.fixture(scope="module")
def odd(tmp_path_factory):
    folder = tmp_path_factory.mktemp("odd")
    write_files(generate(make_library(Dialect.from_xml(ODD)), "lua"), folder)
    return folder


def test_each_file_has_stamp_and_licence():
    library = make_library(COMMON, only=["HEARTBEAT"])
    for path, text in files(library).items():
        if not path.startswith("."):
            assert library.stamp in text.splitlines()[0], path
            assert "SPDX-License-Identifier: MIT" in text, path


def test_equal_definitions_give_equal_files():
    library = make_library(COMMON, only=["HEARTBEAT", "GPS*"])
    assert files(library) == files(library)


def test_a_selection_has_only_its_messages_and_enums():
    found = files(make_library(COMMON, only=["GPS_RAW_INT"]))
    assert [path for path in found if "/messages/" in path] == ["mavlink/messages/gps_raw_int.lua"]
    assert re.findall(r'"(\w+)"\] = function', found["mavlink/enum_tables.lua"]) == ["GPS_FIX_TYPE"]
    assert 'offset = 8, array_length = 0, units = "degE7" }' in found["mavlink/messages/gps_raw_int.lua"]
    rock = found["mavlink-common-scm-1.rockspec"]
    assert '["mavlink.messages.gps_raw_int"] = "mavlink/messages/gps_raw_int.lua",' in rock


def test_the_chosen_package_is_the_name_of_the_module():
    found = files(make_library(COMMON, only=["HEARTBEAT"], package="mylink"))
    assert 'require("mylink.parser")' in found["mylink.lua"]
    assert not [path for path in found if path.startswith("mavlink")]
    with pytest.raises(InvalidArgumentError, match="package must be a name such as mavlink"):
        files(make_library(COMMON, only=["HEARTBEAT"], package="a.b"))


def test_numbers_beyond_63_bits_are_hexadecimal():
    text = files(make_library(Dialect.from_xml(ODD)))["mavlink/enum_tables.lua"]
    assert '{ "TOP", 0x8000000000000000 }, -- WIDE_TOP' in text


def test_reserved_words_end_with_an_underscore():
    text = files(make_library(Dialect.from_xml(ODD)))["mavlink/messages/repeat.lua"]
    assert re.findall(r'key = "(\w+)"', text) == ["end_", "not_", "Nil", "c"]
    assert {"end", "not"} <= language("lua").reserved_words


@pytest.mark.interop
@pytest.mark.smoke
def test_common_passes_the_corpus(common):
    check_runner([needs("lua5.4"), RUNNER, common, "13"], "common")


@pytest.mark.interop
@pytest.mark.parametrize("interpreter", INTERPRETERS[1:])
def test_other_interpreters_pass_the_corpus(interpreter, common):
    check_runner([needs(interpreter), RUNNER, common, "1"], "common")


@pytest.mark.interop
@pytest.mark.parametrize("interpreter", INTERPRETERS)
def test_all_passes_the_corpus(interpreter, tmp_path):
    write_files(generate(make_library(Dialect.load("all")), "lua"), tmp_path)
    check_runner([needs(interpreter), RUNNER, tmp_path, "1000"], "all")
    source = """
    local numbers = require("mavlink").enums
    for name in pairs(require("mavlink.enum_tables")) do assert(next(numbers[name])) end
    print(numbers.MAV_CMD.NAV_TAKEOFF, numbers.NO_ENUM)
    """
    assert run_lua(interpreter, tmp_path, source) == "22\tnil\n"


@pytest.mark.interop
@pytest.mark.parametrize("interpreter", INTERPRETERS)
def test_the_programs_of_the_guide_run(interpreter, common):
    page = (ROOT / "docs/guides/generate-lua.md").read_text("utf-8")
    outputs = re.findall(r"^```text\n(.*?)^```", page, re.DOTALL | re.MULTILINE)
    assert len(PROGRAMS) == len(outputs) == 2
    assert [run_lua(interpreter, common, program) for program in PROGRAMS] == outputs


@pytest.mark.interop
@pytest.mark.parametrize("interpreter", INTERPRETERS)
def test_wrong_values_name_message_and_field(interpreter, common):
    source = """
    local encoder = require("mavlink").Encoder.new({ system = 1, component = 1 })
    for _, fields in ipairs({ { type = 256 }, { type = 1.5 }, { kind = 1 }, { type = "x" } }) do
        print(select(2, pcall(encoder.encode, encoder, "HEARTBEAT", fields)))
    end
    print(select(2, pcall(encoder.encode, encoder, "STATUSTEXT", { text = ("x"):rep(51) })))
    print(select(2, pcall(encoder.encode, encoder, "BATTERY_STATUS", { voltages = 1 })))
    print(select(2, pcall(encoder.encode, encoder, "HEARTBEATS", {})))
    """
    lines = run_lua(interpreter, common, source).splitlines()
    starts = ("HEARTBEAT.type: ", "HEARTBEAT.type: ", "HEARTBEAT has no field kind", "HEARTBEAT.type: ")
    ends = ("STATUSTEXT.text: needs a string of at most 50 bytes", "BATTERY_STATUS.voltages: needs a table")
    assert len(lines) == 7
    for line, start in zip(lines, [*starts, *ends, "no message is named HEARTBEATS"], strict=True):
        assert start in line


@pytest.mark.interop
@pytest.mark.parametrize("interpreter", INTERPRETERS)
def test_odd_names_and_64_bit_flags_work(interpreter, odd):
    source = """
    local mavlink = require("mavlink")
    local encoder = mavlink.Encoder.new({ system = 1, component = 1 })
    local wide = mavlink.enums.WIDE
    local bytes = encoder:encode("REPEAT", { end_ = { -1, 2 }, not_ = wide.TOP, Nil = { 1, 2 }, c = 65 })
    local message = mavlink.Parser.new():push(bytes)[1]:decode()
    print(#message.end_, message.end_[1], message.end_[200], message.Nil[2], message.c)
    print(mavlink.enum_name("WIDE", message.not_), mavlink.enum_name("END", 2), mavlink.enum_name("END", 7))
    """
    assert run_lua(interpreter, odd, source) == "200\t-1\t0\t2\t65\nTOP\t_2D\t7\n"


@pytest.mark.interop
@pytest.mark.properties
@pytest.mark.parametrize("interpreter", INTERPRETERS)
@settings(max_examples=5, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(data=st.data())
def test_chunks_of_any_length_give_equal_results(interpreter, common, data):
    cases = data.draw(st.lists(st.sampled_from(corpus("common")), min_size=20, max_size=60))
    length = data.draw(st.integers(1, 600))
    finished = subprocess.run(
        [needs(interpreter), str(RUNNER), str(common), str(length)],
        input="".join(map(input_line, cases)), capture_output=True, text=True, check=True,
    )  # fmt: skip
    assert finished.stdout.splitlines() == [line for case in cases for line in expected_lines(case)]


@pytest.mark.nightly
@pytest.mark.parametrize("interpreter", INTERPRETERS)
@pytest.mark.parametrize("seed", range(10))
def test_damaged_streams_give_the_packets_of_the_core(interpreter, seed, common):
    check_random_streams([needs(interpreter), RUNNER, common, str(1 + 7 * seed)], "common", seed)


@pytest.mark.nightly
@pytest.mark.parametrize("name", official_names())
def test_every_official_dialect_loads(name, tmp_path):
    loaded = Dialect.load(name)
    write_files(generate(make_library(loaded), "lua"), tmp_path)
    own = {"lua53.lua", "luajit.lua"}  # those of one interpreter
    paths = [str(path) for path in tmp_path.rglob("*.lua") if path.name not in own]
    source = """
    for _, path in ipairs(arg) do assert(loadfile(path)) end
    local count = 0
    for id, row in pairs(require("mavlink.index")) do
        assert(require("mavlink.messages." .. row[4]).id == id)
        count = count + 1
    end
    print(#arg, count)
    """
    for interpreter in INTERPRETERS:
        assert run_lua(interpreter, tmp_path, source, *paths) == f"{len(paths)}\t{len(loaded)}\n"


@pytest.mark.nightly
def test_luacheck_finds_nothing(common):
    subprocess.run([needs("luacheck"), "--quiet", "--no-max-line-length", "."], cwd=common, check=True)
