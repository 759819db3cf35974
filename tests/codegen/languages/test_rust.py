from __future__ import annotations

import re
import subprocess

import pytest

from mavstack.codegen import generate, language, make_library
from mavstack.dialects.dialect import Dialect
from mavstack.dialects.tables import official_names
from mavstack.errors import InvalidArgumentError
from tests.codegen.conformance import check_runner
from tests.codegen.random_streams import check_random_streams
from tests.codegen.rust_crates import cargo, write_crate, write_program, write_runner
from tests.docs.blocks import BLOCKS, ROOT

COMMON = Dialect.load("common")
#: Messages with text, arrays, 64-bit values, extensions, enums and bitmasks, and those of the guide.
FEW = (
    "HEARTBEAT", "ATTITUDE", "STATUSTEXT", "GPS_RAW_INT", "SYSTEM_TIME", "PARAM_VALUE",
    "ACTUATOR_CONTROL_TARGET", "BATTERY_STATUS", "AUTOPILOT_VERSION", "GIMBAL_DEVICE_INFORMATION",
    "ENCAPSULATED_DATA", "RADIO_STATUS",
)  # fmt: skip
PROGRAMS = [block.text for block in BLOCKS if block.language == "rust"]
ODD = b"""<mavlink><enums>
<enum name="SIGNED"><entry name="SIGNED_LOW" value="-2"/><entry name="SIGNED_HIGH" value="3"/></enum>
<enum name="WIDE" bitmask="true"><entry name="WIDE_TOP" value="9223372036854775808"/>
<entry name="WIDE_ONE" value="1"/></enum>
<enum name="ENTRIES"><entry name="ENTRIES_ENTRIES" value="1"/><entry name="ENTRIES_2D" value="2"/></enum>
</enums><messages>
<message id="300" name="MOD"><description>Uses [brackets], `ticks` and &lt;tags&gt;.</description>
<field type="int8_t" name="type" enum="SIGNED">a</field><field type="uint64_t" name="fn" enum="WIDE">b</field>
<field type="uint8_t[3]" name="Self" enum="ENTRIES">c</field><field type="char" name="Loop">d</field>
<field type="uint16_t[2]" name="impl" enum="ENTRIES">e</field></message>
<message id="301" name="OPTION"><field type="uint8_t" name="value">Some.</field></message>
<message id="302" name="STRING"><field type="char[5]" name="text">Text.</field></message>
</messages></mavlink>"""


def few():
    return make_library(COMMON, only=FEW)


def files(library):
    return {file.path: file.text for file in generate(library, "rust")}


def test_each_file_has_stamp_and_licence():
    library = few()
    for path, text in files(library).items():
        if not path.startswith("."):
            assert library.stamp in text.splitlines()[0], path
            assert "SPDX-License-Identifier: MIT" in text, path


def test_equal_definitions_give_equal_files():
    assert files(few()) == files(few())


def test_the_chosen_package_is_the_name_of_the_crate():
    found = files(make_library(COMMON, only=FEW, package="my-link"))
    assert 'name = "my-link"' in found["Cargo.toml"]
    assert "use my_link::messages::Heartbeat;" in found["README.md"]
    with pytest.raises(InvalidArgumentError, match="package must be a name such as mavlink-common"):
        files(make_library(COMMON, only=FEW, package="1 x"))


def test_a_selection_has_only_its_messages_and_enums():
    found = files(make_library(COMMON, only=["ATTITUDE"]))
    assert "src/messages/attitude.rs" in found
    assert not [path for path in found if "heartbeat" in path or path.startswith("src/enums/mav")]
    assert "ATTITUDE" in found["src/messages/attitude.rs"]


def test_fields_have_units_and_enums():
    text = files(few())["src/messages/gps_raw_int.rs"]
    assert "/// `int32_t`, in degE7.\n    pub lat: i32," in text
    assert 'field("lat", (FieldType::I32, 0), 8, ("degE7", ""), false)' in text
    assert "pub fix_type: GpsFixType," in text


def test_reserved_words_end_with_an_underscore():
    text = files(make_library(Dialect.from_xml(ODD)))["src/messages/mod_.rs"]
    assert re.findall(r"pub (\w+):", text) == ["type_", "fn_", "Self_", "Loop", "impl_"]
    assert {"type", "fn", "impl"} <= language("rust").reserved_words


@pytest.mark.interop
@pytest.mark.smoke
def test_a_selection_compiles_and_passes_the_corpus(tmp_path):
    library = few()
    crate = write_crate(library, tmp_path)
    cargo(write_runner(library, crate), "build")
    check_runner([tmp_path / "target/debug/runner"], "common", messages=FEW)


@pytest.mark.interop
def test_the_programs_of_the_guide_run(tmp_path):
    page = (ROOT / "docs/guides/generate-rust.md").read_text("utf-8")
    outputs = re.findall(r"^```text\n(.*?)^```", page, re.DOTALL | re.MULTILINE)
    assert len(PROGRAMS) == len(outputs) == 2
    crate = write_crate(few(), tmp_path)
    for program, output in zip(PROGRAMS, outputs, strict=True):
        cargo(write_program(crate, program), "build")
        assert subprocess.check_output([tmp_path / "target/debug/runner"], text=True) == output


@pytest.mark.interop
def test_common_passes_the_corpus(tmp_path):
    library = make_library(COMMON)
    crate = write_crate(library, tmp_path)
    cargo(write_runner(library, crate), "build")
    check_runner([tmp_path / "target/debug/runner"], "common")


@pytest.mark.interop
def test_odd_names_compile_without_the_standard_library(tmp_path):
    crate = write_crate(make_library(Dialect.from_xml(ODD)), tmp_path)
    cargo(crate, "clippy", "--no-default-features")
    cargo(crate, "doc", "--no-default-features")
    cargo(crate, "test")


@pytest.mark.nightly
def test_common_passes_clippy_and_its_own_tests(tmp_path):
    crate = write_crate(make_library(COMMON), tmp_path)
    cargo(crate, "clippy", "--all-targets")
    cargo(crate, "test")


@pytest.mark.nightly
def test_all_passes_the_corpus(tmp_path):
    library = make_library(Dialect.load("all"))
    crate = write_crate(library, tmp_path)
    cargo(write_runner(library, crate), "build")
    check_runner([tmp_path / "target/debug/runner"], "all")


@pytest.mark.nightly
def test_damaged_streams_give_the_packets_of_the_core(tmp_path):
    library = make_library(COMMON)
    crate = write_crate(library, tmp_path)
    cargo(write_runner(library, crate), "build")
    for seed in range(40):
        check_random_streams([tmp_path / "target/debug/runner"], "common", seed)


@pytest.mark.nightly
@pytest.mark.parametrize("name", official_names())
def test_official_dialects_compile(name, tmp_path):
    cargo(write_crate(make_library(Dialect.load(name)), tmp_path), "check")
