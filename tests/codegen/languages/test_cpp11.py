"""The library in C++11 and later: its files, its warnings with several standards, and the corpus."""

from __future__ import annotations

import re

import pytest

from mavstack.codegen import generate, make_library
from mavstack.dialects import Dialect
from mavstack.dialects.tables import official_names
from tests.codegen.compilers import needs
from tests.codegen.conformance import check_runner
from tests.codegen.languages.compiling import RUNNERS, WARNINGS, build, run, write_library
from tests.codegen.languages.libraries import SMALL, check_ground_station, guide_programs

COMMON = Dialect.load("common")
#: Messages of the programs here and in the guide.
FEW = (*SMALL, "VFR_HUD", "GPS_RAW_INT", "GLOBAL_POSITION_INT", "SYSTEM_TIME", "RADIO_STATUS")


def build_runner(compiler, dialect, folder, *flags):
    defined = (f'-DDIALECT_HEADER="{dialect}/parser.hpp"', f"-DDIALECT={dialect}")
    return build(compiler, RUNNERS / "cpp11" / "runner.cpp", folder / "runner", *WARNINGS, *defined, *flags)


def texts(library):
    return {file.path: file.text for file in generate(library, "cpp11")}


@pytest.fixture(scope="module")
def small(tmp_path_factory):
    return write_library("cpp11", "common", tmp_path_factory.mktemp("small"), FEW)


def test_names_are_those_of_the_official_library():
    files = texts(make_library(COMMON, only=["HEARTBEAT", "ATTITUDE"]))
    enum = files["minimal/minimal.hpp"]
    assert "enum class MAV_TYPE : uint8_t {\n    GENERIC = 0," in enum
    assert re.search(r"constexpr auto MAV_TYPE_ENUM_END = \d+;", enum)
    assert "using minimal::msg::HEARTBEAT;" in files["common/common.hpp"]
    assert "using minimal::MAV_TYPE;" in files["common/common.hpp"]
    assert "float roll{};  ///< [rad]" in files["common/mavlink_msg_attitude.hpp"]


def test_entries_keep_names_that_begin_with_a_letter_and_are_no_macros(tmp_path):
    definition = """<mavlink><enums><enum name="LIMIT_KIND"><entry value="0" name="LIMIT_KIND_MAX"/>
    <entry value="1" name="LIMIT_KIND_3D"/><entry value="5000000000" name="LIMIT_OTHER"/></enum></enums>
    <messages>
    <message id="50000" name="WORDS"><field type="uint8_t" name="class" enum="LIMIT_KIND">c</field></message>
    </messages></mavlink>"""
    (tmp_path / "words.xml").write_text(definition)
    files = texts(make_library(Dialect.from_xml(tmp_path / "words.xml")))
    enum = files["words/words.hpp"]
    assert "enum class LIMIT_KIND : uint64_t {" in enum
    for name in ("MAX_ = 0", "KIND_3D = 1", "OTHER = 5000000000"):
        assert f"    {name}," in enum
    assert "uint8_t class_{};" in files["words/mavlink_msg_words.hpp"]


def test_an_enum_has_the_largest_type_of_its_fields_or_one_that_holds_its_values():
    entries = '<entry name="{0}_A" value="{1}"/><entry name="{0}_B" value="1"/>'
    enums = "".join(
        f'<enum name="{name}">{entries.format(name, value)}</enum>'
        for name, value in (("SAME", 2), ("NEGATIVE", -129), ("WIDE", 2**63))
    )
    fields = "".join(
        f'<field type="{kind}" name="{name.lower()}_{kind}" enum="{name}"/>'
        for name in ("SAME", "NEGATIVE", "WIDE")
        for kind in ("int8_t", "uint8_t")
    )
    message = f'<message id="1" name="M">{fields}</message>'
    text = f"<mavlink><enums>{enums}</enums><messages>{message}</messages></mavlink>"
    header = texts(make_library(Dialect.from_xml(text)))["text/text.hpp"]
    assert "enum class SAME : uint8_t {" in header
    assert "enum class NEGATIVE : int16_t {" in header
    assert "enum class WIDE : uint64_t {" in header
    assert "    A = 9223372036854775808ULL,\n" in header
    assert "WIDE_ENUM_END = 9223372036854775809ULL;" in header


def test_c_and_cpp_share_the_runtime():
    library = make_library(COMMON, only=["HEARTBEAT"])
    c = {file.path: file.text for file in generate(library, "c")}
    shared = {path: text for path, text in texts(library).items() if path in c}
    assert {"README.md", "CMakeLists.txt", "protocol.h"} < set(shared)
    assert all(c[path] == text for path, text in shared.items())


@pytest.mark.interop
@pytest.mark.smoke
def test_a_program_for_the_official_library_runs(small):
    source = RUNNERS / "cpp11" / "program.cpp"
    lean = ("-fno-exceptions", "-fno-rtti")
    assert run(build(needs("g++"), source, small / "program", "-std=c++11", *lean, *WARNINGS)) == "done\n"


@pytest.mark.interop
def test_common_passes_the_corpus(tmp_path):
    write_library("cpp11", "common", tmp_path)
    runner = build_runner(needs("g++"), "common", tmp_path, "-std=c++11", "-O0")
    for chunk in ("1", "64"):
        check_runner([runner, chunk], "common")


@pytest.mark.interop
def test_the_programs_of_the_guide_run(small):
    for path in guide_programs("generate-cpp.md", small):
        standard = "-std=c++17" if path.stem == "variants" else "-std=c++11"
        build(needs("g++"), path, path.with_suffix(""), standard, *WARNINGS)
    check_ground_station([str(small / "ground")])
    assert run(small / "variants") == "GPS_RAW_INT 473977420\n"


@pytest.mark.interop
def test_variants_from_cpp17_on(small):
    source = RUNNERS / "cpp11" / "program.cpp"
    assert run(build(needs("g++"), source, small / "program20", "-std=c++20", *WARNINGS)) == "done\n"


@pytest.mark.nightly
@pytest.mark.parametrize("standard", ["c++11", "c++14", "c++17", "c++20"])
@pytest.mark.parametrize("compiler", ["g++", "clang"])
def test_everything_passes_the_corpus(standard, compiler, tmp_path):
    write_library("cpp11", "all", tmp_path)
    libraries = ["-x", "c++", "-lstdc++"] if compiler == "clang" else []
    runner = build_runner(needs(compiler), "all", tmp_path, f"-std={standard}", *libraries)
    check_runner([runner, "7"], "all")


@pytest.mark.nightly
@pytest.mark.parametrize("dialect", official_names())
def test_every_official_dialect_compiles(dialect, tmp_path):
    write_library("cpp11", dialect, tmp_path)
    (tmp_path / "main.cpp").write_text(f'#include "{dialect}/parser.hpp"\nint main() {{ return 0; }}\n')
    for standard in ("c++11", "c++20"):
        build(needs("g++"), tmp_path / "main.cpp", tmp_path / "main", f"-std={standard}", *WARNINGS)
