"""An enum of a file that the file of the field does not include: all languages take it, as mavgen does."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from mavstack.codegen import generate, language_names, make_library, write_files
from mavstack.dialects import Dialect
from tests.codegen.compilers import needs
from tests.codegen.languages.compiling import C99, build, run
from tests.codegen.languages.test_csharp import compile_library
from tests.codegen.languages.test_go import compile_go
from tests.codegen.rust_crates import cargo, write_crate

if TYPE_CHECKING:
    from pathlib import Path

FIELD = '<message id="{0}" name="{1}"><field type="{2}" name="mode" enum="SHARED">x</field></message>'
BASE = f"<mavlink><messages>{FIELD.format(20001, 'BASE_MODE', 'int8_t')}</messages></mavlink>"
SIBLING = f"""<mavlink><include>minimal.xml</include><enums><enum name="SHARED">
<entry name="SHARED_A" value="1"/></enum></enums><messages>{FIELD.format(20002, "SIBLING_MODE", "uint8_t")}
</messages></mavlink>"""
TOP = f"""<mavlink><include>base.xml</include><include>sibling.xml</include><enums><enum name="SHARED">
<entry name="SHARED_B" value="7"/></enum></enums><messages>{FIELD.format(20003, "TOP_MODE", "uint16_t")}
</messages></mavlink>"""
C_PROGRAM = """#include "top/mavlink.h"
#include <stdio.h>
int main(void)
{
    printf("%d %d\\n", (int)SHARED_A, (int)SHARED_B);
    return 0;
}
"""


@pytest.fixture
def dialect(tmp_path: Path) -> Dialect:
    for name, text in (("base", BASE), ("sibling", SIBLING), ("top", TOP)):
        (tmp_path / f"{name}.xml").write_text(text, "utf-8")
    return Dialect.from_xml(tmp_path / "top.xml")


@pytest.mark.parametrize("name", language_names())
def test_the_fields_of_all_files_have_all_entries(name: str, dialect: Dialect) -> None:
    text = "\n".join(file.text.upper() for file in generate(make_library(dialect), name)).replace("_", "")
    for expected in ("BASEMODE", "SIBLINGMODE", "TOPMODE", "SHARED"):
        assert expected in text


@pytest.mark.interop
@pytest.mark.parametrize(("compiler", "flags"), [("gcc", C99), ("g++", ("-x", "c++", "-std=c++17"))])
def test_the_library_in_c_compiles(
    compiler: str, flags: tuple[str, ...], dialect: Dialect, tmp_path: Path
) -> None:
    write_files(generate(make_library(dialect), "c"), tmp_path)
    (tmp_path / "program.c").write_text(C_PROGRAM)
    assert run(build(needs(compiler), tmp_path / "program.c", tmp_path / "program", *flags)) == "1 7\n"


@pytest.mark.interop
def test_other_libraries_compile(dialect: Dialect, tmp_path: Path) -> None:
    library = make_library(dialect)
    for name, compile_folder in (("go", compile_go), ("csharp", compile_library)):
        write_files(generate(library, name), tmp_path / name)
        compile_folder(tmp_path / name)
    cargo(write_crate(library, tmp_path / "rust"), "check")
