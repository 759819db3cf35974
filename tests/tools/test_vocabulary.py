"""The check of names and prose finds banned words, and only those."""

from __future__ import annotations

import pytest

from tools.vocabulary import Vocabulary, files_below, main, parts_of

VOCABULARY = Vocabulary(
    identifiers={"patience": "timeout", "set_up_signing": "setup_signing"},
    prose={r"^(?-i:What)\b(?!.*\?$)": "name the noun first", r"\bsoup\b": "random input"},
    allowed={"patience": ["src/games/*"]},
)


def words(path: str, text: str) -> list[tuple[int, str]]:
    return [(finding.line, finding.word) for finding in VOCABULARY.check(path, text)]


@pytest.mark.parametrize(
    ("name", "parts"),
    [
        ("wait_for_vehicle", ["wait", "for", "vehicle"]),
        ("MAX_RETRIES", ["max", "retries"]),
        ("HTTPServer2", ["http", "server", "2"]),
        ("_private", ["private"]),
    ],
)
def test_identifiers_are_split_into_words(name: str, parts: list[str]) -> None:
    assert parts_of(name) == parts


def test_defined_names_are_checked_by_whole_words() -> None:
    text = "PATIENCE = 1\ndef impatience(link_patience): pass\nclass PatienceError: pass\n"
    assert words("a.py", text) == [(1, "PATIENCE"), (2, "link_patience"), (3, "PatienceError")]


def test_names_with_several_words_are_checked_in_sequence() -> None:
    assert words("a.py", "def set_up_signing(): pass\ndef setup_signing(): pass\n") == [(1, "set_up_signing")]


def test_names_of_a_library_do_not_count() -> None:
    assert words("a.py", "import game\ngame.patience()\n") == []


def test_docstrings_and_comments_are_checked() -> None:
    text = '"""Module head.\n\nWhat it does.\n"""\n\n#: What it is.\nx = 1  # soup\n'
    assert words("a.py", text) == [(3, "What"), (6, "What"), (7, "soup")]


def test_texts_contain_no_comments_and_comments_no_texts() -> None:
    text = 'x = \'# soup\'\ny = """\n# soup \\""" # soup\n"""\nz = 1  # it\'s soup\nw = \'a\\\'\'  # \'soup\n'
    assert words("a.py", text) == [(5, "soup"), (6, "soup")]


def test_questions_may_begin_with_what() -> None:
    assert words("a.md", "## What is a link?\n") == []


def test_letter_case_counts_only_for_patterns_with_a_mark() -> None:
    assert words("a.md", "Soup of the day,\nwhat it costs\n") == [(1, "Soup")]


def test_error_texts_are_checked() -> None:
    text = 'def f():\n    name = "soup"\n    raise ValueError(f"a {name} of soup")\n'
    assert words("a.py", text) == [(3, "soup")]


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("Makefile", "soup: ## Cook soup\n\tcook soup\n"),
        ("a.toml", "# cold soup\nsoup = 1\n"),
        ("a.yml", "name: Cook soup\nrun: cook\n"),
    ],
)
def test_files_of_the_project_are_checked(name: str, text: str) -> None:
    assert words(name, text) == [(1, "soup")]


def test_rust_is_checked() -> None:
    text = "/// What runs.\nfn patience() {} // soup\nlet x = 1;\n"
    assert words("a.rs", text) == [(1, "What"), (2, "patience"), (2, "soup")]


@pytest.mark.parametrize("name", ["a.ts", "a.svelte"])
def test_scripts_of_the_station_are_checked(name) -> None:
    text = (
        "/** What runs. */\nconst patience = 1; // soup\nlibrary.patience();\nt('a bowl of soup', 'soup');\n"
    )
    assert words(name, text) == [(1, "What"), (2, "patience"), (2, "soup"), (4, "soup")]


def test_code_blocks_of_markdown_are_left_out() -> None:
    assert words("a.md", "soup\n```py\nsoup\n```\n") == [(1, "soup")]


def test_a_word_is_allowed_in_a_named_place() -> None:
    assert words("src/games/cards.py", "patience = 1\n") == []


def test_the_command_prints_findings_and_fails(tmp_path, capsys) -> None:
    file = tmp_path / "module.py"
    file.write_text("hangar = 1\n", "utf-8")
    assert main([str(tmp_path)]) == 1
    out, err = capsys.readouterr()
    assert out.startswith(f"{file}:1: 'hangar': ")
    assert "1 places" in err


def test_the_command_is_silent_where_nothing_is_found(tmp_path, capsys) -> None:
    (tmp_path / "module.py").write_text("harness = 1\n", "utf-8")
    assert main([str(tmp_path)]) == 0
    assert capsys.readouterr() == ("", "")


def test_generated_definitions_are_left_out(tmp_path) -> None:
    folder = tmp_path / "dialects" / "definitions"
    folder.mkdir(parents=True)
    (folder / "notes.md").write_text("soup", "utf-8")
    assert list(files_below([tmp_path])) == []
