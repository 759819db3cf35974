"""Uses each control of a page: buttons, fields, lists and links, those that appear meanwhile too.

The page itself records which controls were used, by the events that the browser gives it. Controls that
differ in a number, or in the name of a parameter or a message, count as one.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final

#: Milliseconds for one action, and for the page to follow it.
ACTION_TIMEOUT, PAUSE = 3000, 60
#: Milliseconds after which a guarded button has acted, in the worst case.
HOLD_TIMEOUT: Final = 6000
#: Number of actions after which something goes round in circles.
MAX_ACTIONS: Final = 900
MAX_FAILURES: Final = 2
#: Controls that are used last, since they take others away.
_LAST: Final = re.compile(
    r"\b(close|dismiss|cancel|remove|delete|clear|erase|disconnect|disarm|land|return|terminate|reboot|end|leave|restart|stop)\b",
    re.IGNORECASE,
)
#: The functions of the page.
_SCRIPT: Final = Path(__file__).with_suffix(".js").read_text("utf-8")


@dataclass
class Crawler:
    """Uses the controls inside of an element of a page.

    Args:
        page: The page, before it has an address.
        excluded: Controls that are not used here, by their keys.
    """

    page: Any
    excluded: re.Pattern[str] = field(default_factory=lambda: re.compile("(?!)"))
    #: The controls that were seen, and the ones that were used, by their keys.
    seen: set[str] = field(default_factory=set)
    used: set[str] = field(default_factory=set)
    #: Controls without an accessible name.
    nameless: set[str] = field(default_factory=set)
    failures: dict[str, int] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.page.expose_function("recordControl", self._record)
        self.page.add_init_script(_SCRIPT)
        self.page.on("dialog", lambda dialog: dialog.accept())
        self.page.on("popup", lambda popup: popup.close())
        self.page.on("filechooser", lambda _: None)

    def _record(self, key: str) -> None:
        self.used.add(key)

    @property
    def unused(self) -> list[str]:
        """The controls that were seen and never used."""
        return sorted(key for key in self.seen - self.used if not self.excluded.search(key))

    def crawl(self, url: str, root: str) -> None:
        """Use the controls of a view.

        Args:
            url: The address of the view.
            root: The selector of the element with the controls.
        """
        self.page.goto(url)
        self.page.locator(root).first.wait_for(timeout=30_000)
        self.page.wait_for_timeout(1500)
        for _ in range(MAX_ACTIONS):
            control = self._next(root)
            if control is None and not self._reopen(root):
                return
            if control is not None:
                self._use(control)
            if not self.page.url.startswith(url):
                self.page.goto(url)
                self.page.wait_for_timeout(500)
        raise AssertionError(f"{MAX_ACTIONS} actions were not enough; not used: {self.unused}")

    def _controls(self, root: str) -> list[dict[str, Any]]:
        controls: list[dict[str, Any]] = self.page.evaluate("root => controlsOf(root)", root)
        self.seen |= {each["key"] for each in controls}
        self.nameless |= {each["key"] for each in controls if not each["name"]}
        return controls

    def _next(self, root: str) -> dict[str, Any] | None:
        controls = [each for each in self._controls(root) if self._is_wanted(each)]
        return min(controls, key=lambda each: (_rank(each), each["index"]), default=None)

    def _is_wanted(self, control: dict[str, Any]) -> bool:
        key = control["key"]
        is_new = key not in self.used and self.failures.get(key, 0) < MAX_FAILURES
        return bool(is_new and control["isEnabled"] and not self.excluded.search(key))

    def _reopen(self, root: str) -> bool:
        """Close a dialog, or show what is behind tabs that were used before; False: everything is used."""
        controls = self._controls(root)
        if any(each["isDialog"] for each in controls):
            self.page.keyboard.press("Escape")
            self.page.wait_for_timeout(PAUSE)
            left = self._controls(root)
            if not any(each["isDialog"] for each in left):
                return True
            closers = [each for each in left if each["isEnabled"] and _LAST.search(each["name"])]
            if closers:
                self._use(closers[-1])
                return True
        for key in dict.fromkeys(each["key"] for each in controls if each["isOpener"]):
            # Places change with each look at the page.
            found = [each for each in self._controls(root) if each["key"] == key and each["isEnabled"]]
            if not found or self.excluded.search(key):
                continue
            self._use(found[0])
            if self._next(root) is not None:
                return True
        return False

    def _use(self, control: dict[str, Any]) -> None:
        key = control["key"]
        place = self.page.locator(f'[data-crawled="{control["index"]}"]').first
        try:
            self._act(place, control)
        except Exception as error:  # noqa: BLE001 (Playwright's errors; the control counts as not used)
            self.failures[key] = self.failures.get(key, 0) + 1
            self.last_error = f"{key}: {str(error).splitlines()[0]}"
        else:
            if key not in self.used:
                self.failures[key] = self.failures.get(key, 0) + 1
        self.page.wait_for_timeout(PAUSE)

    def _act(self, place: Any, control: dict[str, Any]) -> None:
        kind = control["kind"]
        if control["isGuarded"]:
            self._hold(place, control["key"])
        elif kind == "select":
            count = place.locator("option").count()
            chosen = place.evaluate("each => each.selectedIndex")
            place.select_option(index=(chosen + 1) % max(count, 1), timeout=ACTION_TIMEOUT)
        elif kind in ("range", "slider"):
            place.press("ArrowRight", timeout=ACTION_TIMEOUT)
        elif kind in ("text", "search", "number", "textarea", "password", "url", "date", "time"):
            value = place.input_value(timeout=ACTION_TIMEOUT)
            place.fill(value or "1", timeout=ACTION_TIMEOUT)
            place.press("Tab", timeout=ACTION_TIMEOUT)
        elif kind == "color":
            place.fill("#336699", timeout=ACTION_TIMEOUT)
        elif kind == "file":
            file = {"name": "a.txt", "mimeType": "text/plain", "buffer": b"1"}
            place.set_input_files(file, timeout=ACTION_TIMEOUT)
        elif self.failures.get(control["key"]):
            place.press("Enter" if kind != "checkbox" else "Space", timeout=ACTION_TIMEOUT)
        else:
            place.click(timeout=ACTION_TIMEOUT)

    def _hold(self, place: Any, key: str) -> None:
        """Hold a guarded button until it acts."""
        place.hover(timeout=ACTION_TIMEOUT)
        self.page.mouse.down()
        try:
            held = self.page.locator(".guarded.held")
            held.first.wait_for(timeout=ACTION_TIMEOUT)
            held.first.wait_for(state="detached", timeout=HOLD_TIMEOUT)
            self.used.add(key)
        finally:
            self.page.mouse.up()


def _rank(control: dict[str, Any]) -> int:
    """Return when a control is used: fields first, what leads to others later, what takes them away last."""
    if _LAST.search(control["name"]):
        return 3
    if control["isOpener"]:
        return 2
    return 1 if control["kind"] in ("button", "a") else 0
