from __future__ import annotations

import pytest

from mavstack.codegen.checks import reserved_names
from mavstack.dialects.includes import collect


@pytest.mark.usefixtures("plugins")
def test_reserved_words_name_their_languages_and_lines(tmp_path):
    path = tmp_path / "own.xml"
    path.write_text(
        '<mavlink><messages>\n<message id="53000" name="OWN">\n<field type="uint8_t" name="value"/>\n'
        '<field type="uint8_t" name="roll"/>\n</message></messages></mavlink>'
    )
    assert list(reserved_names(collect(str(path)).definition)) == [
        (4, "OWN.roll is a reserved word in text, whose libraries name it roll_")
    ]
