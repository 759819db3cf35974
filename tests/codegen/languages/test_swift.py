from __future__ import annotations

import re
import subprocess
from pathlib import Path

import pytest
from jinja2 import Environment, FileSystemLoader, StrictUndefined

from mavstack.codegen import generate, language, make_library, write_files
from mavstack.codegen.languages.swift.types import WIRE_TYPES, message_types, properties
from mavstack.dialects.dialect import Dialect
from mavstack.dialects.tables import official_names
from mavstack.errors import InvalidArgumentError
from tests.codegen.compilers import needs
from tests.codegen.conformance import check_runner
from tests.docs.blocks import BLOCKS, ROOT

COMMON = Dialect.load("common")
RUNNERS = Path(__file__).parents[1] / "runners" / "swift"
PROGRAMS = [block.text for block in BLOCKS if block.language == "swift"]
ODD = b"""<mavlink><enums>
<enum name="WIDE" bitmask="true"><entry name="WIDE_TOP" value="9223372036854775808"/>
<entry name="WIDE_NONE" value="0"/></enum>
<enum name="PARSER"><entry name="PARSER_DEFAULT" value="-1"/><entry name="PARSER_2D" value="2"/>
<entry name="PARSER_ALSO_2D" value="3"/></enum>
</enums><messages>
<message id="70000" name="PARSER"><field type="int8_t[3]" name="protocol" enum="PARSER">a</field>
<field type="uint64_t" name="is" enum="WIDE">b</field><field type="uint8_t" name="a_b">c</field>
<field type="uint8_t" name="aB">d</field><field type="char[5]" name="text" units="&quot;">e</field></message>
</messages></mavlink>"""


def files(library):
    return {file.path: file.text for file in generate(library, "swift")}


def swift_files(library):
    return {path: text for path, text in files(library).items() if path.endswith(".swift")}


def syntax_errors(texts: dict[str, str]) -> list[str]:
    """Return the places of syntax errors, by the grammar of tree-sitter."""
    tree_sitter = pytest.importorskip("tree_sitter")
    grammar = pytest.importorskip("tree_sitter_swift")
    parser = tree_sitter.Parser(tree_sitter.Language(grammar.language()))
    return [path for path, text in texts.items() if parser.parse(text.encode()).root_node.has_error]


def write_program(folder: Path, library, source: str) -> None:
    """Write a program into the package of a library."""
    module = "Mavlink" + library.name.title()
    write_files(generate(library, "swift"), folder)
    package = folder / "Package.swift"
    targets = f'[.target(name: "{module}"), .executableTarget(name: "runner", dependencies: ["{module}"])]'
    package.write_text(package.read_text().replace(f'[.target(name: "{module}")]', targets))
    (folder / "Sources" / "runner").mkdir()
    (folder / "Sources" / "runner" / "main.swift").write_text(source)


def build(folder: Path) -> Path:
    """Compile the package with warnings as errors, and return its program."""
    swift = Path(needs("swift")).with_name("swift")
    subprocess.run([swift, "build", "-Xswiftc", "-warnings-as-errors"], cwd=folder, check=True)
    return folder / ".build" / "debug" / "runner"


def runner_source(library) -> str:
    environment = Environment(
        loader=FileSystemLoader(RUNNERS), undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True
    )
    types = message_types(library)
    messages = [{"type": types[item.name], "fields": fields(item)} for item in library.messages]
    module = "Mavlink" + library.name.title()
    return environment.get_template("main.swift.j2").render(module=module, messages=messages)


def fields(message) -> list[dict[str, str]]:
    names = properties(message)
    return [{"official": item.name, "value": value(item, f"m.{names[item.name]}")} for item in message.fields]


def value(item, name: str) -> str:
    """Return the expression of a field's hexadecimal text."""
    wire = WIRE_TYPES[item.type]
    if item.type == "char" and item.array_length:
        return f"hex({name}, {item.array_length})"
    if item.array_length:
        element = f"{wire}(truncatingIfNeeded: $0.rawValue)" if item.enum else "$0"
        return f"{name}.map {{ hex({element}) }}.joined()"
    return f"hex({wire}(truncatingIfNeeded: {name}.rawValue))" if item.enum else f"hex({name})"


def test_each_file_has_stamp_and_licence():
    library = make_library(COMMON, only=["HEARTBEAT"])
    for path, text in files(library).items():
        if not path.startswith("."):
            assert library.stamp in "".join(text.splitlines()[:2]), path
            assert "SPDX-License-Identifier: MIT" in text, path


def test_equal_definitions_give_equal_files():
    library = make_library(COMMON, only=["HEARTBEAT", "GPS*"])
    assert files(library) == files(library)


def test_a_selection_has_only_its_messages_and_enums():
    found = files(make_library(COMMON, only=["GPS_RAW_INT"]))
    content = [path for path in found if "/Messages/" in path or "/Enums/" in path]
    sources = "Sources/MavlinkCommon"
    assert content == [
        f"{sources}/Enums/GpsFixTypeValues.swift",
        f"{sources}/Messages/GpsRawIntMessage.swift",
    ]
    text = found[content[1]]
    assert "    /// `int32_t`, in degE7.\n    public var lat: Int32\n" in text
    assert 'FieldDefinition("lat", "int32_t", 0, at: 8, units: "degE7"),' in text


def test_the_chosen_package_is_the_name_of_the_module():
    found = files(make_library(COMMON, only=["HEARTBEAT"], package="MyLink"))
    assert 'name: "MyLink"' in found["Package.swift"]
    assert "Sources/MyLink/Parser.swift" in found
    with pytest.raises(InvalidArgumentError, match="package must be a name such as MavlinkCommon"):
        files(make_library(COMMON, only=["HEARTBEAT"], package="My-Link"))


def test_names_that_swift_or_the_runtime_has_are_changed():
    found = files(make_library(Dialect.from_xml(ODD)))
    message = next(text for path, text in found.items() if "/Messages/" in path)
    assert re.findall(r"public var (\w+):", message) == ["protocol_", "is_", "aB", "aB_", "text"]
    assert "public struct Parser_: Message" in message
    enum = next(text for path, text in found.items() if path.endswith("Parser_EnumValues.swift"))
    assert re.findall(r"static let (\w+)", enum) == ["default_", "_2d", "also2d"]
    assert {"protocol", "is"} <= language("swift").reserved_words


def test_the_syntax_of_odd_names_is_right():
    assert syntax_errors(swift_files(make_library(Dialect.from_xml(ODD)))) == []


@pytest.mark.flight
def test_the_syntax_of_all_messages_is_right():
    assert syntax_errors(swift_files(make_library(Dialect.load("all")))) == []


def test_the_syntax_of_guide_and_runner_is_right():
    library = make_library(COMMON, only=["HEARTBEAT", "BATTERY_STATUS", "STATUSTEXT"])
    programs = {str(number): text for number, text in enumerate(PROGRAMS)}
    assert len(programs) == 2
    assert syntax_errors({**programs, "runner": runner_source(library)}) == []


@pytest.mark.interop
def test_common_compiles_and_passes_the_corpus(tmp_path):
    needs("swift")
    library = make_library(COMMON)
    write_program(tmp_path, library, runner_source(library))
    check_runner([build(tmp_path)], "common")


@pytest.mark.interop
@pytest.mark.parametrize("number", range(len(PROGRAMS)))
def test_the_programs_of_the_guide_run(number, tmp_path):
    needs("swift")
    page = (ROOT / "docs/guides/generate-swift.md").read_text("utf-8")
    outputs = re.findall(r"^```text\n(.*?)^```", page, re.DOTALL | re.MULTILINE)
    write_program(tmp_path, make_library(COMMON), PROGRAMS[number])
    assert subprocess.check_output([build(tmp_path)], text=True) == outputs[number]


@pytest.mark.nightly
@pytest.mark.parametrize("name", official_names())
def test_official_dialects_compile(name, tmp_path):
    needs("swift")
    library = make_library(Dialect.load(name), package="Mavlink" + name.title())
    write_program(tmp_path, library, f"import Mavlink{name.title()}\n")
    build(tmp_path)
