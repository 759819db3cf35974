"""Hostile texts and awkward names: each language keeps them in comments and strings, and compiles."""

from __future__ import annotations

import ast
import re
import subprocess
from pathlib import Path

import pytest

from mavstack import encode
from mavstack.codegen import generate, language_names, make_library, write_files
from mavstack.dialects import Dialect
from tests.codegen.compilers import needs
from tests.codegen.languages.awkward import AWKWARD, HOSTILE
from tests.codegen.languages.compiling import C99, WARNINGS, run
from tests.codegen.languages.compiling import build as build_c
from tests.codegen.languages.test_csharp import compile_library
from tests.codegen.languages.test_go import compile_go
from tests.codegen.languages.test_java import compile_java
from tests.codegen.languages.test_lua import run_lua
from tests.codegen.languages.test_swift import syntax_errors
from tests.codegen.languages.test_typescript import build as build_typescript
from tests.codegen.rust_crates import cargo, write_crate
from tests.codegen.wireshark import capture, dissect, udp

ROOT = Path(__file__).parents[3] / "src" / "mavstack" / "codegen"
#: Comments and strings by the ending of a source file.
C_LIKE = r'//[^\n]*|/\*.*?\*/|"(?:\\.|[^"\\\n])*"'
COMMENTS = {
    **dict.fromkeys((".c", ".h", ".hpp", ".ts", ".java", ".rs", ".go", ".cs", ".swift"), C_LIKE),
    ".lua": r'--[^\n]*|"(?:\\.|[^"\\\n])*"',
    ".py": r'"""(?:\\.|[^\\])*?"""|#[^\n]*|"(?:\\.|[^"\\\n])*"',
}
#: The hostile text as a string holds it, on one line.
UNIT = " ".join(HOSTILE.split()).replace("\u202e", "").replace("\ufeff", "")
#: Texts of definitions that need a filter wherever a template writes them.
TEXTS = re.compile(
    r"\{\{[^|}]*\.(units|description|multiplier|invalid|print_format|since|replaced_by|label)\b"
)
C_PROGRAM = """#include <stdint.h>
#include <stdio.h>
#define MAVLINK_USE_CONVENIENCE_FUNCTIONS
#define MAVLINK_USE_MESSAGE_INFO
#include "mavlink_types.h"
static mavlink_system_t mavlink_system = {1, 1};
static void comm_send_ch(mavlink_channel_t chan, uint8_t byte) { (void)chan; (void)byte; }
#include "text/mavlink.h"
int main(void)
{
    mavlink_message_t msg;
    mavlink_hostile_t hostile = {0};
    mavlink_msg_hostile_send_struct(MAVLINK_COMM_0, &hostile);
    mavlink_msg_hostile_encode(1, 1, &msg, &hostile);
    puts(mavlink_get_message_info(&msg)->fields[0].units);
    return 0;
}
"""
CPP_PROGRAM = """#include "text/parser.hpp"
#include <iostream>
struct Print { template <typename T> void operator()(const mavlink::FieldInfo &info, const T &) const
    { if (info.offset == 0) { std::cout << info.units << std::endl; } } };
int main() { mavlink::text::msg::HOSTILE hostile; hostile.for_each_field(Print()); }
"""


@pytest.fixture(scope="module")
def library():
    return make_library(Dialect.from_xml(AWKWARD))


def write(library, language: str, folder: Path) -> Path:
    write_files(generate(library, language), folder)
    return folder


@pytest.mark.parametrize("language", language_names())
def test_no_text_leaves_its_comment_or_string(library, language):
    sources = 0
    for file in generate(library, language):
        pattern = COMMENTS.get(Path(file.path).suffix)
        if pattern and "leaves" in file.text:
            sources += 1
            assert "leaves" not in re.sub(pattern, "", file.text, flags=re.DOTALL), file.path
            assert not {"\u202e", "\ufeff", "\u2028", "\u0085"} & set(file.text), file.path
    assert sources


@pytest.mark.parametrize("language", ["c", "cpp11"])
def test_no_line_continues_a_comment_and_no_string_has_a_trigraph(library, language):
    for file in generate(library, language):
        if Path(file.path).suffix in (".h", ".hpp") and "leaves" in file.text:
            for part in re.findall(C_LIKE, file.text, flags=re.DOTALL):
                assert not part.endswith(("\\", "??/")), (file.path, part)
                assert "/*" not in part[2:] or part[0] == '"', (file.path, part)
                assert "??" not in part or part[0] != '"', (file.path, part)


def test_names_of_the_runtime_of_c_get_an_underscore(library):
    files = {file.path: file.text for file in generate(library, "c")}
    assert "} mavlink_message__t;" in files["text/mavlink_msg_message.h"]
    assert re.search(r"mavlink_message_t \*msg, .* msg_[,)]", files["text/mavlink_msg_object.h"])


def test_java_comments_hold_no_escapes(library):
    for file in generate(library, "java"):
        assert not re.search(r"(?<!\\)\\u", file.text), file.path


def test_templates_write_texts_of_definitions_only_through_filters():
    found = [path for path in ROOT.rglob("*.j2") if TEXTS.search(path.read_text("utf-8"))]
    assert found == []


def test_python_is_valid(library):
    for file in generate(library, "python"):
        if file.path.endswith(".py"):
            ast.parse(file.text)


def test_the_syntax_of_swift_is_right(library):
    files = generate(library, "swift")
    assert syntax_errors({file.path: file.text for file in files if file.path.endswith(".swift")}) == []


def test_a_file_name_becomes_a_plain_folder(tmp_path):
    path = tmp_path / 'awk"\n*- ward.xml'
    path.write_text(AWKWARD)
    library = make_library(Dialect.from_xml(path))
    assert library.file_name == "awk_-_ward"
    assert '"' not in library.stamp
    assert "\n" not in library.stamp


@pytest.mark.interop
@pytest.mark.parametrize("compiler", ["gcc", "clang"])
def test_c(library, compiler, tmp_path):
    source = write(library, "c", tmp_path) / "program.c"
    source.write_text(C_PROGRAM)
    assert run(build_c(needs(compiler), source, tmp_path / "program", *C99)) == f"{UNIT}\n"


@pytest.mark.interop
def test_cpp(library, tmp_path):
    source = write(library, "cpp11", tmp_path) / "program.cpp"
    source.write_text(CPP_PROGRAM)
    program = build_c(needs("g++"), source, tmp_path / "program", "-std=c++11", *WARNINGS)
    assert run(program) == f"{UNIT}\n"


def test_python_runs(library, tmp_path, monkeypatch):
    write(library, "python", tmp_path)
    monkeypatch.syspath_prepend(str(tmp_path))
    package = __import__("mavlink_text", fromlist=["info", "messages"])
    for message in package.messages.BY_ID.values():
        (packet,) = package.Parser().feed(message().pack(1, 1))
        assert packet.message == message()
    assert package.info.FIELDS[5][0].units == UNIT


@pytest.mark.interop
@pytest.mark.parametrize("interpreter", ["lua5.4", "lua5.3", "luajit"])
def test_lua(library, interpreter, tmp_path):
    program = """
        local mavlink = require("mavlink")
        for _, name in pairs(mavlink.message_names()) do assert(mavlink.definition(name), name) end
        print(mavlink.definition("HOSTILE").fields[1].units)
        print(mavlink.enum_name("WORDS", 2), mavlink.enums.FROM.HERE)
    """
    assert run_lua(interpreter, write(library, "lua", tmp_path), program).split("\n")[:2] == [UNIT, "end\t-1"]


@pytest.mark.interop
@pytest.mark.xdist_group("tshark")
def test_wireshark(tmp_path):
    dialect = Dialect.from_xml(AWKWARD)
    folder = write(make_library(dialect), "wireshark", tmp_path)
    message = dialect["HOSTILE"](x=3, text="abc")
    path = capture(tmp_path / "one.pcap", [udp(encode(message, system=1, component=1))])
    (packet,) = dissect(folder / "mavlink_text.lua", path)
    assert packet.one("hostile.text") == "abc"


@pytest.mark.interop
def test_typescript(tmp_path):
    build_typescript(tmp_path, Dialect.from_xml(AWKWARD))


@pytest.mark.interop
def test_java(library, tmp_path):
    compile_java(write(library, "java", tmp_path))


@pytest.mark.interop
def test_go(library, tmp_path):
    compile_go(write(library, "go", tmp_path))


@pytest.mark.interop
def test_csharp(library, tmp_path):
    compile_library(write(library, "csharp", tmp_path))


@pytest.mark.interop
def test_rust(library, tmp_path):
    cargo(write_crate(library, tmp_path), "check")


@pytest.mark.interop
def test_swift(library, tmp_path):
    swift = Path(needs("swift")).with_name("swift")
    subprocess.run([swift, "build"], cwd=write(library, "swift", tmp_path), check=True)
