"""The form of `mav gen --ui` on the terminal; its logic is `mavstack.codegen.form`."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

from rich.text import Text
from textual import work
from textual.app import App
from textual.containers import Horizontal, Vertical, VerticalScroll
from textual.suggester import SuggestFromList
from textual.widgets import Button, Checkbox, Footer, Header, Input, Label, RichLog, SelectionList, Static

from mavstack.codegen.language import language, language_names
from mavstack.dialects.tables import official_names

if TYPE_CHECKING:
    from collections.abc import Callable

    from textual.app import ComposeResult
    from textual.binding import BindingType

    from mavstack.codegen.form import GenerationForm, Outcome

#: Text entries of the form: label, and the hint that an empty entry shows.
_LINES = {
    "dialect": ("Dialect or definition file", "common, or the path of an XML file"),
    "folder": ("Folder", "where the library is written"),
    "only": ("Only these messages", "all; or HEARTBEAT,GPS*"),
    "exclude": ("Without these messages", "none"),
    "package": ("Package or namespace", "default of the language"),
}


class GenerationWindow(App[int]):
    """A form with the entries, the problem of each, and the results.

    Args:
        form: The initial entries.
    """

    TITLE = "mav gen"
    CSS = """
    #form { height: 1fr; }
    #entries { width: 3fr; padding: 0 1; }
    #languages { width: 2fr; height: 100%; border: round $primary; }
    #entries Label { margin-top: 1; }
    #entries Checkbox { margin-top: 1; }
    .problem { color: $text-error; height: auto; padding: 0 1; }
    #buttons { height: 3; margin: 1 1 0 1; }
    Button { margin-right: 2; }
    #commands { height: auto; max-height: 5; padding: 0 1; color: $text-muted; }
    #results { height: 20%; min-height: 4; border: round $primary; }
    """
    BINDINGS: ClassVar[list[BindingType]] = [
        ("ctrl+g", "generate", "Generate"),
        ("ctrl+k", "check", "Check"),
        ("ctrl+q", "quit", "Quit"),
    ]

    def __init__(self, form: GenerationForm) -> None:
        super().__init__()
        self.form = form

    def compose(self) -> ComposeResult:
        """Yield the parts of the window."""
        yield Header()
        with Horizontal(id="form"):
            with VerticalScroll(id="entries"):
                for name, (label, placeholder) in _LINES.items():
                    yield Label(label)
                    suggester = SuggestFromList(official_names()) if name == "dialect" else None
                    yield Input(
                        getattr(self.form, name),
                        placeholder=placeholder,
                        id=name,
                        suggester=suggester,
                        compact=True,
                    )
                    yield Static("", classes="problem", id=f"{name}-problem")
                yield Checkbox(
                    "Overwrite files that were not generated",
                    self.form.overwrite,
                    id="overwrite",
                    compact=True,
                )
            with Vertical(id="languages"):
                yield SelectionList[str](
                    *((language(name).title, name, name in self.form.languages) for name in language_names()),
                    id="choice",
                    compact=True,
                )
                yield Static("", classes="problem", id="languages-problem")
        with Horizontal(id="buttons"):
            yield Button("Generate", variant="primary", id="generate")
            yield Button("Check", id="check")
        yield Static("", id="commands")
        yield RichLog(id="results", wrap=True)
        yield Footer()

    def on_mount(self) -> None:
        """Show the state of the initial entries."""
        self.query_one("#languages").border_title = "Languages"
        self.query_one("#results").border_title = "Results"
        self._show()

    def on_input_changed(self, event: Input.Changed) -> None:
        """Take a line of text."""
        if event.input.id in _LINES:
            self._take(event.input.id, event.value)

    def on_checkbox_changed(self, event: Checkbox.Changed) -> None:
        """Take the option to overwrite."""
        self._take("overwrite", event.value)

    def on_selection_list_selected_changed(self, event: SelectionList.SelectedChanged[str]) -> None:
        """Take the languages, in the order of the list."""
        chosen = set(event.selection_list.selected)
        self._take("languages", tuple(name for name in language_names() if name in chosen))

    def on_button_pressed(self, event: Button.Pressed) -> None:
        """Do the work of a button."""
        if event.button.id == "generate":
            self.action_generate()
        else:
            self.action_check()

    def action_generate(self) -> None:
        """Write the libraries, and show the results."""
        if not self._show():
            self._work(self.form.run)

    def action_check(self) -> None:
        """Compare the libraries with their folders, and show the results."""
        if not self._show():
            self._work(self.form.check)

    def _take(self, name: str, value: str | bool | tuple[str, ...]) -> None:
        self.form = self.form.with_entry(name, value)
        self._show()

    def _show(self) -> dict[str, str]:
        """Show the problems and the command lines; return the problems."""
        problems = self.form.problems
        for name in (*_LINES, "languages"):
            line = self.query_one(f"#{name}-problem", Static)
            line.update(Text(problems.get(name, "")))
            line.display = name in problems
        for button in self.query(Button):
            button.disabled = bool(problems)
        self.query_one("#commands", Static).update(Text("" if problems else "\n".join(self.form.commands)))
        return problems

    @work(thread=True, exclusive=True)
    def _work(self, work: Callable[[], list[Outcome]]) -> None:
        """Do the work beside the window, which stays usable."""
        outcomes = work()
        self.call_from_thread(self._report, outcomes)

    def _report(self, outcomes: list[Outcome]) -> None:
        results = self.query_one("#results", RichLog)
        for outcome in outcomes:
            style = "bold red" if outcome.failed else "green"
            results.write(Text(f"{outcome.language}: {outcome.folder}: {outcome.text}", style))
