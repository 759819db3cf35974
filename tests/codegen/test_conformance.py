"""The conformance corpus is up to date and complete, and the harness finds differences."""

from __future__ import annotations

import sys

import pytest

from mavstack.dialects import Dialect
from tests.codegen.conformance import CORPUS, check_runner, corpus, expected_lines, run, summary
from tools.conformance.__main__ import main
from tools.conformance.bootloader import bootloader_text
from tools.conformance.corpus import DIALECTS, corpus_text
from tools.conformance.msp import msp_text
from tools.conformance.surveys import survey_files

#: A runner that prints the expected lines, with a change in the results of one input.
RUNNER = """
import sys
from tests.codegen.conformance import corpus, expected_lines
cases = {case["name"]: case for case in corpus("common")}
for line in sys.stdin:
    for text in expected_lines(cases[line.split()[0]]):
        if len(sys.argv) > 1 and line.split()[0] == sys.argv[1]:
            text = text.replace(sys.argv[2], sys.argv[3])
        print(text)
"""


@pytest.mark.parametrize("dialect", DIALECTS)
def test_the_files_are_up_to_date(dialect):
    assert (CORPUS / f"{dialect}.jsonl").read_text("ascii") == corpus_text(dialect)


def test_the_plans_of_surveys_are_up_to_date():
    files = {path.name: path.read_text("ascii") for path in (CORPUS / "survey").iterdir()}
    assert files == survey_files()


def test_the_vectors_of_msp_are_up_to_date():
    assert (CORPUS / "msp.jsonl").read_text("ascii") == msp_text()


def test_the_conversations_with_bootloaders_are_up_to_date():
    assert (CORPUS / "bootloader.jsonl").read_text("ascii") == bootloader_text()


@pytest.mark.parametrize("dialect", DIALECTS)
def test_every_message_of_the_dialect_is_there(dialect):
    found = {packet["message"] for case in corpus(dialect) for packet in case["packets"]}
    assert found == set(Dialect.load(dialect).names)


def test_the_files_are_small():
    assert sum(path.stat().st_size for path in CORPUS.iterdir()) < 3_500_000


def test_check_reports_an_old_file(monkeypatch, tmp_path, capsys):
    monkeypatch.setattr("tools.conformance.__main__.FOLDER", tmp_path)
    monkeypatch.setattr("tools.conformance.__main__.corpus_text", lambda name: f"{name}\n")
    monkeypatch.setattr(sys, "argv", ["conformance", "--check"])
    assert main() == 1
    assert "out of date: common.jsonl, all.jsonl" in capsys.readouterr().err
    monkeypatch.setattr(sys, "argv", ["conformance"])
    assert main() == 0
    assert (tmp_path / "all.jsonl").read_text() == "all\n"


def test_a_right_runner_passes():
    command = [sys.executable, "-c", RUNNER]
    check_runner(command, "common")
    assert all(passed == total for passed, total in summary(run(command, "common")).values())


@pytest.mark.parametrize(("old", "new"), [("roll=", "roll=00"), ("good=", "good=1"), ("packed", "wrapped")])
def test_a_wrong_runner_fails(old, new):
    with pytest.raises(AssertionError, match=r"1 of \d+ inputs differ:\nmessage/ATTITUDE"):
        check_runner([sys.executable, "-c", RUNNER, "message/ATTITUDE", old, new], "common")


def test_a_library_with_a_few_messages_is_checked_for_these():
    results = run([sys.executable, "-c", RUNNER], "common", messages=["ATTITUDE", "HEARTBEAT"])
    assert [result.name for result in results] == ["message/HEARTBEAT", "message/ATTITUDE"]


def test_expected_lines_have_the_form_of_the_readme():
    case = next(case for case in corpus("common") if case["name"] == "signed/accepted")
    packet, packed, *_, end = expected_lines(case)
    assert packet.startswith("packet ATTITUDE 30 2 0 1 1 1 time_boot_ms=")
    assert packed.startswith("packed ATTITUDE fd")
    assert end == "end signed/accepted good=3 bad_crc=0 bad_signature=0 unknown=0"
