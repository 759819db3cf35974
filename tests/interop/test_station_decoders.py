"""Decoders of frames in Chromium: datagrams, bytes of scripts, forms, and project files."""

from __future__ import annotations

import json
import socket
import struct
from binascii import crc_hqx
from typing import TYPE_CHECKING, Any

import pytest

from tests.interop.dashboards import dashboard, show
from tests.interop.station import DESKTOP, PATIENT, PHONE, StationPage, station_page, web_server
from tests.links.test_tcp import free_port

if TYPE_CHECKING:
    from pathlib import Path

pytestmark = [pytest.mark.interop, pytest.mark.xdist_group("chromium"), pytest.mark.timeout(240)]

DECODER = {
    "name": "bench",
    "framing": {"kind": "length", "marker": "aa55", "length": {"offset": 2, "type": "uint8"}, "add": 5},
    "checksum": {"kind": "crc16-ccitt", "start": 2},
    "id": {"offset": 3, "type": "uint8"},
    "messages": [
        {
            "name": "IMU",
            "id": 1,
            "fields": [
                {"name": "roll", "type": "int16", "factor": 0.01, "unit": "deg"},
                {"name": "mode", "type": "uint8", "names": {"0": "IDLE", "1": "FLYING"}},
            ],
        }
    ],
}
SCRIPT = "return { volts: new DataView(bytes.buffer, bytes.byteOffset).getUint16(0) / 100 };"


def frame(roll: float, mode: int) -> bytes:
    body = struct.pack("<BBhB", 4, 1, round(roll * 100), mode)
    return b"\xaa\x55" + body + struct.pack("<H", crc_hqx(body, 0xFFFF))


def bench_dashboard(decoded: int, raw: int, **more: Any) -> str:
    """Return a dashboard of two ports: frames of a decoder, and bytes of a script."""
    values = (("roll", "bench:IMU.roll"), ("mode", "bench:IMU.mode"), ("volts", "script:volts:OUT.volts"))
    widgets = [
        {
            "kind": "text" if name == "mode" else "value",
            "title": f"The {name}",
            "x": 4 * index,
            "width": 4,
            "fields": [field],
            "decimals": 2,
            "text": "{1}",
        }
        for index, (name, field) in enumerate(values)
    ]
    return dashboard(
        *widgets,
        sources=[
            f"frames+udp://127.0.0.1:{decoded}?name=bench&decoder=bench",
            f"frames+udp://127.0.0.1:{raw}?name=raw",
        ],
        decoders=[DECODER],
        scripts=[{"name": "volts", "frames": "raw", "code": SCRIPT}],
        **more,
    )


def test_frames_and_bytes_of_scripts_are_shown(browser: Any, tmp_path: Path) -> None:
    decoded, raw = free_port(), free_port()
    with (
        socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender,
        web_server(tmp_path) as server,
        station_page(browser, server.url, DESKTOP) as shown,
    ):
        show(shown, server.url, bench_dashboard(decoded, raw))
        shown.wait_for("This dashboard needs sources")
        assert server.get("sources") == []  # nothing is opened without a click
        shown.button("Add them").click()

        def is_shown(*texts: str) -> bool:
            sender.sendto(b"noise" + frame(-2.5, 1), ("127.0.0.1", decoded))
            sender.sendto(struct.pack(">H", 1234), ("127.0.0.1", raw))
            grid = shown.page.locator(".grid").inner_text()
            return all(each in grid for each in texts)

        shown.wait_until(lambda: is_shown("-2.50", "FLYING", "12.34"))
        (first, _) = server.get("sources")
        assert first["rows"]["messages"]["IMU"][0] == {"name": "roll", "unit": "deg"}
        check_form(shown)
        shown.page.set_viewport_size({"width": PHONE[0], "height": PHONE[1]})
        shown.wait_until(lambda: is_shown("-2.50"))


def check_form(shown: StationPage) -> None:
    """Change the decoder in its form: problems are shown at once, and bytes can be tried."""
    page = shown.page
    shown.button("Edit").click()
    shown.button("Decoders").click()
    text = page.get_by_label("Declaration (JSON)").first
    good = text.input_value()
    text.fill(good.replace("int16", "int17"))
    shown.wait_for("messages[0].fields[0].type must be one of int8")
    assert shown.button("Apply").is_disabled()
    text.fill(good)
    page.get_by_label("Try it with bytes").fill(frame(9, 0).hex(" "))
    shown.wait_for('IMU {"roll":9,"mode":"IDLE"}')
    page.get_by_label("Try it with bytes").fill("aa 55 04 01 00 00 00 00 00")
    shown.wait_for("1 frame refused")
    shown.button("Add a decoder").click()
    shown.wait_until(lambda: page.get_by_label("Declaration (JSON)").count() == 2)
    shown.button("Remove bench2").click()
    shown.button("Apply").click()
    shown.button("Scripts").click()
    assert page.get_by_label("Source whose frames it reads as bytes").input_value() == "raw"
    shown.button("Cancel").click()
    shown.button("Done").click()


@pytest.mark.nightly
def test_projects_are_saved_and_opened_by_choice(browser: Any, tmp_path: Path) -> None:
    with web_server(tmp_path) as server, station_page(browser, server.url, DESKTOP) as shown:
        page = shown.page
        boards = [json.loads(bench_dashboard(9001, 9002, title=name)) for name in ("One", "Two", "Three")]
        project = {"type": "mavstack-project", "version": 1, "dashboards": boards}
        show(shown, server.url, json.dumps(project))
        shown.wait_for("3 widgets, 2 sources, 1 decoder, 1 script")
        page.get_by_role("checkbox", name="Two").uncheck()
        shown.button("Keep 2 dashboards").click()
        titles = page.get_by_label("Dashboards", exact=True).locator("optgroup").first.locator("option")
        shown.wait_until(lambda: titles.all_inner_texts() == ["One", "Three"])
        assert server.get("sources") == []
        with page.expect_download(timeout=PATIENT) as download:
            shown.button("Save all of mine to a project file").click()
        saved = json.loads(download.value.path().read_text("utf-8"))
        assert saved["type"] == "mavstack-project"
        assert [each["title"] for each in saved["dashboards"]] == ["One", "Three"]
        assert saved["dashboards"][0]["decoders"] == [DECODER]
        assert saved["dashboards"][0]["scripts"][0]["frames"] == "raw"
        show(shown, server.url, json.dumps({**project, "dashboards": [{"type": "x"}]}))
        shown.wait_for("dashboard 1: not a dashboard")
