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
from tests.codegen.languages.libraries import check_ground_station, guide_programs

COMMON = Dialect.load("common")


def build_runner(compiler, dialect, folder, *flags):
    defined = (f'-DDIALECT_HEADER="{dialect}/parser.hpp"', f"-DDIALECT={dialect}")
    return build(compiler, RUNNERS / "cpp11" / "runner.cpp", folder / "runner", *WARNINGS, *defined, *flags)


def texts(library):
    return {file.path: file.text for file in generate(library, "cpp11")}


@pytest.fixture(scope="module")
def common(tmp_path_factory):
    return write_library("cpp11", "common", tmp_path_factory.mktemp("common"))


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


def test_c_and_cpp_share_the_runtime():
    library = make_library(COMMON, only=["HEARTBEAT"])
    c = {file.path: file.text for file in generate(library, "c")}
    shared = {path: text for path, text in texts(library).items() if path in c}
    assert {"README.md", "CMakeLists.txt", "protocol.h"} < set(shared)
    assert all(c[path] == text for path, text in shared.items())


@pytest.mark.interop
@pytest.mark.smoke
def test_a_program_for_the_official_library_runs(common):
    source = RUNNERS / "cpp11" / "program.cpp"
    assert run(build(needs("g++"), source, common / "program", "-std=c++11", *WARNINGS)) == "done\n"


@pytest.mark.interop
def test_common_passes_the_corpus(common):
    runner = build_runner(needs("g++"), "common", common, "-std=c++11", "-O0")
    for chunk in ("1", "64"):
        check_runner([runner, chunk], "common")


@pytest.mark.interop
def test_the_programs_of_the_guide_run(common):
    for path in guide_programs("generate-cpp.md", common):
        standard = "-std=c++17" if path.stem == "variants" else "-std=c++11"
        build(needs("g++"), path, path.with_suffix(""), standard, *WARNINGS)
    check_ground_station([str(common / "ground")])
    assert run(common / "variants") == "GPS_RAW_INT 473977420\n"


@pytest.mark.interop
def test_variants_from_cpp17_on(common):
    source = RUNNERS / "cpp11" / "program.cpp"
    assert run(build(needs("g++"), source, common / "program20", "-std=c++20", *WARNINGS)) == "done\n"


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
    (tmp_path / "main.cpp").write_text(
        f'#include "{dialect.lower()}/parser.hpp"\nint main() {{ return 0; }}\n'
    )
    for standard in ("c++11", "c++20"):
        build(needs("g++"), tmp_path / "main.cpp", tmp_path / "main", f"-std={standard}", *WARNINGS)
