from __future__ import annotations

import pytest

from mavstack.codegen.form import GenerationForm

pytestmark = pytest.mark.usefixtures("plugins")


def test_an_empty_form_has_problems():
    assert GenerationForm().problems == {"languages": "choose a language", "folder": "name a folder"}


@pytest.mark.parametrize(
    ("entries", "entry", "problem"),
    [
        ({"dialect": "comon"}, "dialect", "comon"),
        ({"dialect": "missing.xml"}, "dialect", "missing.xml"),
        ({"languages": ("fortran",)}, "languages", "there is no language fortran"),
        ({"only": "NO_SUCH"}, "only", "no message matches 'NO_SUCH'"),
        ({"exclude": "*"}, "exclude", "no message is left to generate"),
    ],
)
def test_a_wrong_entry_has_a_problem(entries, entry, problem, tmp_path):
    form = GenerationForm(**{"languages": ("text",), "folder": str(tmp_path), **entries})
    assert list(form.problems) == [entry]
    assert problem in form.problems[entry]


def test_a_language_is_written_to_the_folder(tmp_path):
    form = GenerationForm("minimal", ("text",), str(tmp_path), package="mine")
    assert form.problems == {}
    (outcome,) = form.check()
    assert outcome.failed
    (outcome,) = form.run()
    assert (outcome.folder, outcome.failed) == (tmp_path, False)
    assert (tmp_path / "README.md").read_text() == "# mine\n"
    assert form.check()[0].text == "up to date"


def test_each_of_several_languages_has_a_folder_and_an_outcome(tmp_path):
    form = GenerationForm("minimal", ("text", "escaping"), str(tmp_path))
    text, escaping = form.run()
    assert (tmp_path / "text" / "README.md").is_file()
    assert (text.failed, escaping.failed) == (False, True)
    assert "outside of its folder" in escaping.text


def test_a_file_of_the_user_is_overwritten_on_request(tmp_path):
    (tmp_path / "README.md").write_text("mine")
    form = GenerationForm("minimal", ("text",), str(tmp_path))
    assert "was not generated: choose another folder" in form.run()[0].text
    assert not form.with_entry("overwrite", value=True).run()[0].failed


def test_a_folder_that_cannot_be_written_is_an_outcome(tmp_path):
    (tmp_path / "file").write_text("")
    (outcome,) = GenerationForm("minimal", ("text",), str(tmp_path / "file")).run()
    assert outcome.failed
    assert "cannot write" in outcome.text


def test_commands_do_the_same():
    form = GenerationForm("my dialect.xml", ("c", "java"), "out", only="A,B*", overwrite=True)
    assert form.commands == [
        "mav gen c 'my dialect.xml' -o out/c '--only=A,B*' --force",
        "mav gen java 'my dialect.xml' -o out/java '--only=A,B*' --force",
    ]
