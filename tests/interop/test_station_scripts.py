"""Scripts of dashboards in Chromium: they try to break out, hang and grow."""

from __future__ import annotations

import json
import re
import socket
from pathlib import Path
from typing import Any

import pytest

import mavstack
from tests.interop.dashboards import dashboard, region, sending, show, widget
from tests.interop.station import DESKTOP, station_page, web_server

pytestmark = [pytest.mark.interop, pytest.mark.xdist_group("chromium")]

ROOT = Path(__file__).parents[2]
#: Attempts of a script to reach the page, the network or the browser; 1 is a success.
ESCAPES = {
    # Constants that cannot be removed are no way out.
    "globals": """
        const kept = new Set(KEPT), found = [];
        const next = Object.getPrototypeOf;
        for (let owner = globalThis; owner && owner !== Object.prototype; owner = next(owner))
          for (const name of Object.getOwnPropertyNames(owner))
            if (!kept.has(name) && Object(owner[name]) === owner[name]) found.push(name);
        if (found.length) throw new Error('left: ' + found.join(' '));
        return { found: 0 };""",
    "constructors": """
        let made = 0;
        const all = [() => {}, async () => {}, function* () {}, class {}, Object, Promise.prototype.then];
        for (const each of all) {
          try { each.constructor('return 1')(); made = 1; } catch {}
          try { Object.getPrototypeOf(each).constructor('return 1')(); made = 1; } catch {}
        }
        return { found: made };""",
    "prototypes": """
        Object.prototype.polluted = 1; Array.prototype.map = () => [{ found: 1 }];
        return { found: 0, polluted: 5 };""",
    "answers": """
        return { found: 0, toString() { return 'x'; }, get a() { return 'x'; }, "__proto__x": 3 };""",
}
#: Scripts that the station must stop, and what it says.
STOPPED = {
    "endless": ("for (;;) {}", "took longer than"),
    "microtasks": ("(async () => { for (;;) await 0; })(); return {};", "took longer than"),
    "memory": ("state.a ??= []; for (;;) state.a.push(new Array(1e5).fill(1.5));", "memory was stopped"),
    "buffers": (
        "state.a ??= []; for (;;) state.a.push(new Uint8Array(1e9).fill(1));",
        "buffers was stopped",
    ),
    "state": ("(state.a ??= []).push(new Array(1e5).fill(1.5)); return {};", "keeps too much in state"),
    "throws": ("return { get a() { throw 'a reason' } }", "a reason"),
}
#: Attempts in the worker of scripts without the guard around them: the browser alone must refuse them. URLs
#: of blobs are not among them: Chromium ends a page whose worker makes one and has no origin.
REQUESTS = {
    "fetch": "fetch(OTHER, { mode: 'no-cors' })",
    "fetch of the station": "fetch(OWN + 'openapi.json')",
    "fetch by a constructor": "(() => {}).constructor('url', 'return fetch(url)')(OTHER)",
    "XMLHttpRequest": """new Promise((done, fail) => {
        const request = new XMLHttpRequest();
        request.onload = done; request.onerror = fail;
        request.open('GET', OWN); request.send();
    })""",
    "WebSocket": """new Promise((done, fail) => {
        const socket = new WebSocket(OTHER.replace('http', 'ws'));
        socket.onopen = done; socket.onerror = fail;
    })""",
    "EventSource": """new Promise((done, fail) => {
        const source = new EventSource(OTHER);
        source.onopen = done; source.onerror = fail;
    })""",
    "importScripts": "(async () => importScripts(OTHER))()",
    "import": "import(OTHER + 'a.js')",
    "import of the station": "import(OWN + ENTRY)",
    "import of data": "import('data:text/javascript,export default 1')",
    "nested worker of data": "nested('data:text/javascript,postMessage(1)')",
    "nested worker of the station": "nested(location.href)",
    "font": "new FontFace('a', `url(${OTHER})`).load()",
    "IndexedDB": """new Promise((done, fail) => {
        const request = indexedDB.open('a');
        request.onsuccess = done; request.onerror = fail;
    })""",
    "caches": "(async () => caches.open('a'))()",
    "files": "(async () => navigator.storage.getDirectory())()",
    "serial ports": "(async () => navigator.serial.getPorts())()",
    "USB": "(async () => navigator.usb.getDevices())()",
}
UNGUARDED = """
const nested = (url) => new Promise((done, fail) => {
  const worker = new Worker(url);
  worker.onmessage = done; worker.onerror = fail;
});
const late = new Promise((done) => setTimeout(done, 5000));
const refused = (error) => `refused: ${error?.name ?? error?.type}`;
Promise.race([ATTEMPT, late]).then(() => 'done', refused).then(postMessage);
"""
RUN = """([url, program]) => new Promise((done, fail) => {
  const worker = new Worker(url);
  worker.onmessage = ({ data }) => done(data);
  worker.onerror = ({ message }) => fail(message);
  worker.postMessage({ program });
})"""


def test_scripts_cannot_leave_their_sandbox(browser: Any, tmp_path: Path) -> None:
    source = (ROOT / "web/src/lib/scripts/sandbox.ts").read_text("utf-8")
    kept = re.search(r"const KEPT = \[(.*?)\]", source, re.DOTALL)
    assert kept is not None
    scripts = [
        {"name": name, "inputs": {"a": "bench:ROW.alt"}, "code": code.replace("KEPT", f"[{kept[1]}]")}
        for name, code in ESCAPES.items()
    ]
    results = [
        {"kind": "value", "title": f"The {name}", "fields": [f"script:{name}:OUT.found"], "y": 3 * at}
        for at, name in enumerate(ESCAPES)
    ]
    with (
        sending() as sender,
        web_server(tmp_path, sender.url) as server,
        station_page(browser, server.url, DESKTOP) as shown,
    ):
        show(shown, server.url, dashboard(*results, scripts=scripts))
        for name in ESCAPES:

            def is_known(name: str = name) -> bool:
                sender.send(1)
                alerts = shown.page.get_by_role("alert")
                assert alerts.count() == 0, alerts.all_inner_texts()
                return "0.0" in region(shown, name).inner_text()

            shown.wait_until(is_known)
        assert shown.page.evaluate("({}).polluted === undefined && [1].map(each => each)[0] === 1")


def test_the_browser_refuses_what_the_worker_of_a_script_requests(browser: Any, tmp_path: Path) -> None:
    static = Path(mavstack.__file__).parent / "server" / "static"
    with (
        socket.create_server(("127.0.0.1", 0)) as other,
        web_server(tmp_path) as server,
        station_page(browser, server.url, DESKTOP) as shown,
    ):
        (worker,) = (static / "sandbox").glob("*.js")
        page = (static / "index.html").read_text("utf-8")
        entry = static / next(re.finditer(r"assets/index-[\w-]+\.js", page))[0]
        places = {
            "OTHER": f"http://127.0.0.1:{other.getsockname()[1]}/",
            "OWN": server.url,
            "ENTRY": f"assets/{entry.name}",
        }
        constants = "".join(f"const {name} = {json.dumps(value)};" for name, value in places.items())
        for name, attempt in REQUESTS.items():
            program = constants + UNGUARDED.replace("ATTEMPT", attempt)
            answer = shown.page.evaluate(RUN, [f"sandbox/{worker.name}", program])
            assert answer.startswith("refused: "), (name, answer)
        assert shown.page.evaluate(RUN, [f"sandbox/{worker.name}", "postMessage(origin)"]) == "null"
        shown.problems.clear()  # the browser tells each
        other.settimeout(0)
        with pytest.raises(BlockingIOError):
            other.accept()


@pytest.mark.parametrize("name", STOPPED)
@pytest.mark.flight_cases(2)
def test_a_script_that_hangs_or_grows_is_stopped(name: str, browser: Any, tmp_path: Path) -> None:
    code, reason = STOPPED[name]
    with (
        sending() as sender,
        web_server(tmp_path, sender.url) as server,
        station_page(browser, server.url, DESKTOP) as shown,
    ):
        script = {"name": name, "inputs": {"a": "bench:ROW.alt"}, "code": code}
        show(shown, server.url, dashboard(widget("value", "alt"), scripts=[script]))
        alert = shown.page.get_by_role("alert").filter(has_text=reason)

        def is_stopped() -> bool:
            sender.send(7)
            return bool(alert.count())

        shown.wait_until(is_stopped)
        # The page goes on.
        sender.send(8)
        shown.wait_for("8.0")
