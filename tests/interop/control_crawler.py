"""Uses each control of a page: buttons, fields, lists and links, those that appear meanwhile too.

The functions in the page choose the controls and watch their effects. A control fails that a pointer does not
reach, that was enabled and never used, or that has no effect: it changes no element, sends nothing, stores
nothing and starts nothing.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final

#: Milliseconds after which a guarded button has acted, in the worst case.
HOLD_TIMEOUT: Final = 6000
#: Milliseconds after which a vehicle has finished what disables other controls, such as a calibration.
ROUND_PAUSE: Final = 1500
#: Number of actions after which something goes round in circles.
MAX_ACTIONS: Final = 500
#: Number of attempts to close a dialog.
MAX_ESCAPES: Final = 3
#: The functions of the page, and the wait until a page has its answers and has drawn what changed.
_SCRIPT: Final = Path(__file__).with_suffix(".js").read_text("utf-8")
_DRAWN: Final = "crawler.settle()"
_IS_HELD: Final = "document.querySelector('.guarded.held') !== null"


@dataclass
class Report:
    """The controls of a view, by their keys.

    Attributes:
        seen: All of them.
        used: The used ones.
        nameless: Those without an accessible name.
        problems: Those that were covered or dead, with the reason.
        unused: Those that were enabled and not used.
        idle: Those that were never enabled.
        actions: The actions in their order.
    """

    seen: list[str] = field(default_factory=list)
    used: list[str] = field(default_factory=list)
    nameless: list[str] = field(default_factory=list)
    problems: list[str] = field(default_factory=list)
    unused: list[str] = field(default_factory=list)
    idle: list[str] = field(default_factory=list)
    actions: list[str] = field(default_factory=list)

    @property
    def faults(self) -> list[str]:
        """The controls that fail, with the reason."""
        nameless = [f"nameless: {each}" for each in self.nameless]
        return sorted([*self.problems, *nameless, *(f"not used: {each}" for each in self.unused)])


def crawl(
    page: Any,
    url: str,
    root: str = "main",
    *,
    ready: str = "body",
    excluded: str = "",
    actions: int = MAX_ACTIONS,
) -> Report:
    """Use the controls of a view.

    Args:
        page: A page that showed nothing yet.
        url: The address of the view.
        root: The selector of the element with the controls.
        ready: The selector of an element that is there before the first action.
        excluded: The pattern of keys of controls that are not used here.
        actions: The number of actions after which the rest is not used.

    Returns:
        The controls and their faults; those that would have been used after the last action are no faults.
    """
    page.add_init_script(_SCRIPT)
    page.on("dialog", lambda dialog: dialog.accept())
    page.on("popup", lambda popup: popup.close())
    page.on("filechooser", lambda _: None)
    page.goto(url)
    page.locator(root).first.wait_for()
    page.locator(ready).first.wait_for()
    page.evaluate("([view, pattern]) => crawler.begin(view, pattern)", [root, excluded])
    done: list[str] = []
    is_complete = _use_controls(page, url, actions, done)
    report = Report(**page.evaluate("crawler.report()"), actions=done)
    if not is_complete:
        report.unused.clear()
    return report


def _use_controls(page: Any, url: str, actions: int, done: list[str]) -> bool:
    """Use one control after the other, and note each action; False: some are left."""
    escapes = 0
    for _ in range(actions):
        control = page.evaluate("crawler.next()")
        if control is None:
            return True
        escapes = escapes + 1 if control["action"] == "escape" else 0
        assert escapes <= MAX_ESCAPES, f"a dialog does not close: {page.url}"
        done.append(f"{control['action']} {control['key']}")
        _act(page, control)
        page.evaluate(_DRAWN)
        if not page.url.startswith(url):
            page.evaluate("address => { location.href = address }", url)
            page.evaluate(_DRAWN)
    return False


def _act(page: Any, control: dict[str, Any]) -> None:
    action = control["action"]
    if action == "escape":
        page.keyboard.press("Escape")
    elif action == "click":
        page.mouse.click(control["x"], control["y"])
    elif action == "wait":
        page.wait_for_timeout(ROUND_PAUSE)
    elif action == "hold":
        _hold(page, control)
    elif action == "map":
        for place in control["places"]:
            page.mouse.click(place["x"], place["y"])
            page.evaluate(_DRAWN)


def _hold(page: Any, control: dict[str, Any]) -> None:
    """Hold a guarded button until it acts; the vehicle may disable the button at this moment."""
    page.mouse.move(control["x"], control["y"])
    page.mouse.down()
    try:
        if page.evaluate(_IS_HELD):
            page.locator(".guarded.held").wait_for(state="detached", timeout=HOLD_TIMEOUT)
            page.evaluate("crawler.held()")
    finally:
        page.mouse.up()
