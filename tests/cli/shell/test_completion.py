"""Candidates for words, without and with a vehicle."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavstack.cli.shell import completion
from mavstack.cli.shell.completion import complete
from mavstack.cli.shell.runner import run_line
from tests.cli.shell.shell_session import COPTER, PX4_COPTER, alone, in_shell


def completed(text):
    """Return the candidates for a text without a vehicle."""
    found = []

    async def scenario(session):
        session.aliases["up"] = "mode guided"
        found.extend(await complete(session, text))

    alone(scenario)
    return found


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("takeo", ["takeoff"]),
        ("u", ["up"]),
        ("arm thr", ["throttle"]),
        ("arm throttle f", ["force"]),
        ("param sa", ["save"]),
        ("set wa", ["wait"]),
        ("set wait of", ["off"]),
        ("wp cl", ["clear"]),
        ("help takeo", ["takeoff"]),
        ("mode guided; land; rt", ["rtl"]),
        ("long component_arm", ["COMPONENT_ARM_DISARM"]),
        ("command_int GLOBAL_RELATIVE_ALT_I", ["GLOBAL_RELATIVE_ALT_INT"]),
        ("command_int GLOBAL DO_SET_HO", ["DO_SET_HOME"]),
        ("status heartb", ["HEARTBEAT"]),
        ("watch HEARTBEAT SYS_ST", ["SYS_STATUS"]),
        ("alias remove u", ["up"]),
        ("camera vid", ["video"]),
        ("camera video st", ["start", "stop"]),
        ("gimbal roi o", ["off"]),
        ("rc al", ["all"]),
        ("takeoff 1", []),
        ("nothing x", []),
        ("param guess x", []),
        ("arm throttle force x", []),
    ],
)
def test_words(text, found):
    words, length = completed(text)
    assert words == found
    assert length in (0, len(text.split()[-1]))


def test_word_of_unusual_spaces():
    assert completed("\f") == [[], 0]


def test_first_word_completes_commands():
    words, length = completed("")
    assert length == 0
    assert {"arm", "param", "exit", "?", "up"} <= set(words)


def test_local_files(tmp_path, monkeypatch):
    (tmp_path / "way.plan").touch()
    (tmp_path / "ways").mkdir()
    (tmp_path / ".hidden").touch()
    monkeypatch.chdir(tmp_path)
    assert completed("wp load w")[0] == ["way.plan", "ways/"]
    assert completed("wp load .h")[0] == [".hidden"]
    assert completed("script ")[0] == ["way.plan", "ways/"]
    assert completed(f"wp load {tmp_path}/way")[0] == [f"{tmp_path}/way.plan", f"{tmp_path}/ways/"]
    assert completed("wp load none/x")[0] == []


@pytest.mark.fast_cases(1)
@pytest.mark.parametrize(("kind", "mode"), [(COPTER, "alt_hold"), (PX4_COPTER, "offboard")])
def test_vehicle_data_is_completed(kind, mode):
    async def scenario(session, world):
        assert mode in (await complete(session, f"mode {mode[:3]}"))[0]
        assert mode in (await complete(session, mode[:4]))[0]
        assert (await complete(session, "param set SYS"))[0] == []
        await run_line(session, "param fetch")
        name = "SYSID_THISMAV" if kind == COPTER else "SYS_AUTOSTART"
        assert name in (await complete(session, "param set sys"))[0]
        assert (await complete(session, "vehicle "))[0] == ["1"]

    in_shell(kind, scenario)


@pytest.mark.flight
def test_values_of_parameters_are_completed():
    async def scenario(session, _):
        found, length = await complete(session, "param set nav_dll_act ")
        assert (found, length) == (["0", "1", "2", "3", "5", "6"], 0)
        assert [each.note for each in found][:3] == ["None", "Hold", "Return"]
        assert (await complete(session, "param set NAV_DLL_ACT=5"))[0] == ["NAV_DLL_ACT=5"]
        assert (await complete(session, "param set COM_RCL_EXCEPT 1"))[0] == ["1", "16"]
        assert (await complete(session, "param set UNKNOWN "))[0] == []
        names = (await complete(session, "param set NAV_DLL_ACT 2 nav_rcl"))[0]
        assert [(name, name.note) for name in names] == [("NAV_RCL_ACT", "Reaction to lost manual control")]

    in_shell(PX4_COPTER, scenario)


def test_remote_listing_is_cached():
    async def scenario(session, world):
        listed = []
        files = session.vehicle.ftp
        list_directory = files.list

        async def recorded(path):
            listed.append(path)
            return await list_directory(path)

        object.__setattr__(files, "list", recorded)
        assert (await complete(session, "ftp get /AP"))[0] == ["/APM/"]
        assert "/APM/LOGS/" in (await complete(session, "ftp list /APM/"))[0]
        assert (await complete(session, "ftp get /AP"))[0] == ["/APM/"]
        assert listed == ["/", "/APM/"]
        assert (await complete(session, "ftp get /none/x"))[0] == []

    in_shell(COPTER, scenario)


@pytest.mark.nightly
def test_silent_vehicle_does_not_block_completion():
    async def scenario(session, world):
        async def silence(path):
            import asyncio

            await asyncio.sleep(1000)

        object.__setattr__(session.vehicle.ftp, "list", silence)
        began = session.connection.now()
        assert (await complete(session, "ftp get /"))[0] == []
        assert session.connection.now() - began <= completion.LISTING_TIMEOUT + 0.1

    in_shell(COPTER, scenario)


@pytest.mark.flight
@given(st.text(st.one_of(st.sampled_from("\"'; \\/"), st.characters(exclude_categories=["Cs"])), max_size=25))
def test_any_text_can_be_completed(text):
    words, length = completed(text)
    assert 0 <= length <= len(text)
    assert words == sorted(words)
