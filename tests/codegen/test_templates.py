from __future__ import annotations

import sys

import pytest

from mavstack.codegen import GeneratedFile
from mavstack.codegen.templates import Templates, camel_case, one_line, string_literal
from mavstack.errors import MissingExtraError


@pytest.fixture
def package(tmp_path, monkeypatch):
    """A package with templates."""
    folder = tmp_path / "own_language" / "templates"
    folder.mkdir(parents=True)
    (folder.parent / "__init__.py").write_text("")
    (folder / "list.j2").write_text(
        "{% for name in names %}\n{{ name | pascal }} {{ name | camel }} {{ name | shout }}\n"
        "{% endfor %}\n{{ end }}\n"
    )
    (folder / "wrong.j2").write_text("{{ nothing }}\n")
    (folder / "wrong_attribute.j2").write_text("{{ text.nothing }}\n")
    (folder / "wrong_block.j2").write_text("{% if nothing %}{% endif %}\n")
    (folder / "flat.j2").write_text("{{ count }} {{ file.path }} {{ file.text }}\n{{ end }}\n")
    monkeypatch.syspath_prepend(str(tmp_path))
    yield "own_language"
    sys.modules.pop("own_language", None)


def test_a_template_becomes_a_file_without_lines_of_tags(package):
    templates = Templates(package, filters={"shout": str.upper}, end="end")
    file = templates.file("a/b.txt", "list.j2", names=["gps_raw", "<a&b>"])
    assert file.path == "a/b.txt"
    assert file.text == "GpsRaw gpsRaw GPS_RAW\n<a&b> <a&b> <A&B>\nend\n"


def test_a_variable_that_does_not_exist_is_an_error(package):
    from jinja2 import UndefinedError

    templates = Templates(package)
    with pytest.raises(KeyError, match="nothing"):
        templates.file("a.txt", "wrong.j2")
    with pytest.raises(AttributeError, match="nothing"):
        templates.file("a.txt", "wrong_attribute.j2", text="text")
    with pytest.raises(UndefinedError, match="nothing"):
        templates.file("a.txt", "wrong_block.j2")


def test_variables_alone_need_no_jinja(package, monkeypatch):
    monkeypatch.setitem(sys.modules, "jinja2", None)
    text = Templates(package, end="end").text("flat.j2", file=GeneratedFile("a.txt", "{{ end }}"), count=2)
    assert text == "2 a.txt {{ end }}\nend\n"


def test_without_jinja_the_extra_is_named(package, monkeypatch):
    monkeypatch.setitem(sys.modules, "jinja2", None)
    with pytest.raises(MissingExtraError, match=r"mav gen needs an extra: pip install 'mavstack\[gen\]'"):
        Templates(package).text("list.j2", names=[])


@pytest.mark.parametrize(
    ("name", "camel"),
    [("time_boot_ms", "timeBootMs"), ("roll", "roll"), ("_x__y_", "xY"), ("Vcc", "vcc"), ("q1", "q1")],
)
def test_camel_case(name, camel):
    assert camel_case(name) == camel


@pytest.mark.parametrize(
    ("text", "line"),
    [
        (" a\n\tb */ c ]] d ", "a b * / c ]] d"),
        ("/*/ */* **/", "/ * / * / * ** /"),
        ("ends\\", "ends"),
        ("ends \\ ??/ \\", "ends"),
        ("a\\b ??/ c", "a\\b ??/ c"),
        ("turned \u202eround\ufeff\u2028 \x7f", "turned round "),
    ],
)
def test_a_comment_cannot_be_ended_or_continued_by_its_text(text, line):
    assert one_line(text) == line


@pytest.mark.parametrize(
    ("text", "literal"),
    [
        ('a "b" \\ c', '"a \\"b\\" \\\\ c"'),
        ("a\nb\u202e", '"a b"'),
        ("*/ ]] ??/", '"*/ ]] ??/"'),
    ],
)
def test_a_string_cannot_be_ended_by_its_text(text, literal):
    assert string_literal(text) == literal
