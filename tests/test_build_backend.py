"""The build backend: without Rust it gets a toolchain into the project, or ends with one line."""

from __future__ import annotations

import importlib.util
import os
import shutil
import subprocess
import sys
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from threading import Thread

import pytest

pytest.importorskip("maturin")

ROOT = Path(__file__).parent.parent
HOOKS = {
    "build_wheel": ("folder",),
    "build_editable": ("folder",),
    "build_sdist": ("folder",),
    "get_requires_for_build_wheel": (),
    "get_requires_for_build_editable": (),
    "get_requires_for_build_sdist": (),
    "prepare_metadata_for_build_wheel": ("folder",),
    "prepare_metadata_for_build_editable": ("folder",),
}
#: Stands in for rustup-init: makes the programs of a toolchain in the folders that it is given.
INSTALLER = """\
#!/bin/sh
/bin/mkdir -p "$CARGO_HOME/bin" "$RUSTUP_HOME"
for program in cargo rustc; do
    printf '#!/bin/sh\\necho "%s 1.99.0 $*"\\n' $program > "$CARGO_HOME/bin/$program"
    /bin/chmod +x "$CARGO_HOME/bin/$program"
done
printf '#!/bin/sh\\necho "$*" >> "%s/components"\\n' "$CARGO_HOME" > "$CARGO_HOME/bin/rustup"
/bin/chmod +x "$CARGO_HOME/bin/rustup"
"""
LINE = (
    "mavstack needs a Rust toolchain, version 1.88 or later, to build: "
    "cargo was not found; install Rust from https://rustup.rs and try again"
)
ENVIRONMENT = ("PATH", "CARGO_HOME", "RUSTUP_HOME", "RUSTUP_INIT_SKIP_PATH_CHECK", "MAVSTACK_NO_DOWNLOAD")


@pytest.fixture
def project(tmp_path):
    """A folder with the part of the project that says which Rust is required."""
    folder = tmp_path / "project"
    (folder / "backend").mkdir(parents=True)
    shutil.copy(ROOT / "Cargo.toml", folder)
    shutil.copy(ROOT / "backend" / "mavstack_rust.py", folder / "backend")
    return folder


@pytest.fixture
def backend(monkeypatch, project):
    monkeypatch.syspath_prepend(str(ROOT / "backend"))
    spec = importlib.util.spec_from_file_location("mavstack_build", ROOT / "backend" / "mavstack_build.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    monkeypatch.setattr(module, "_ROOT", project)
    return module


@pytest.fixture
def programs(tmp_path, monkeypatch):
    """A folder that is the whole PATH; the returned function adds a program that prints a text."""
    folder = tmp_path / "bin"
    folder.mkdir()
    for variable in ENVIRONMENT:
        monkeypatch.setenv(variable, "")  # the backend sets some of them; the fixture restores them
        monkeypatch.delenv(variable)
    monkeypatch.setenv("PATH", str(folder))
    monkeypatch.setenv("MAVSTACK_NO_DOWNLOAD", "1")
    for variable in ("MATURIN_NO_INSTALL_RUST", "RUSTUP_AUTO_INSTALL"):
        monkeypatch.setenv(variable, "")  # the backend sets it; the fixture restores it

    def add(name: str, output: str = "", code: int = 0) -> None:
        program = folder / name
        program.write_text(f"#!/bin/sh\necho '{output}'\nexit {code}\n")
        program.chmod(0o755)

    return add


@pytest.mark.parametrize(("hook", "arguments"), HOOKS.items())
def test_every_hook_ends_with_one_line_without_rust(backend, programs, hook, arguments):
    with pytest.raises(SystemExit) as ended:
        getattr(backend, hook)(*arguments)
    assert ended.value.code == LINE


@pytest.mark.skipif(sys.platform == "win32", reason="the programs are shell scripts")
@pytest.mark.parametrize(
    ("output", "code", "problem"),
    [
        ("rustc 1.70.0 (90c541806 2023-05-31)", 0, "rustc 1.70.0 is too old; run `rustup update`"),
        ("rustc 1.9.0", 0, "rustc 1.9.0 is too old"),
        ("error: no default toolchain", 1, "rustc --version failed; run `rustup default stable`"),
        (None, 0, "rustc was not found"),
    ],
)
def test_an_unusable_toolchain_ends_the_build(backend, programs, output, code, problem):
    programs("cargo", "cargo 1.70.0")
    if output is not None:
        programs("rustc", output, code)
    with pytest.raises(SystemExit) as ended:
        backend.get_requires_for_build_wheel()
    assert problem in ended.value.code  # type: ignore[operator]


@pytest.mark.skipif(sys.platform == "win32", reason="the programs are shell scripts")
@pytest.mark.parametrize("version", ["1.88.0", "1.95.0-nightly", "2.0.0"])
def test_a_sufficient_toolchain_is_accepted(backend, programs, version, monkeypatch):
    programs("cargo", f"cargo {version}")
    programs("rustc", f"rustc {version}")
    monkeypatch.setattr(backend.mavstack_station, "requirements", lambda: ["node"])
    assert backend.get_requires_for_build_wheel() == ["node"]
    assert backend.get_requires_for_build_editable() == []
    assert os.environ["MATURIN_NO_INSTALL_RUST"] == "1"


@pytest.mark.skipif(sys.platform == "win32", reason="the programs are shell scripts")
def test_rustup_downloads_no_toolchain(backend, programs, tmp_path):
    programs("cargo")
    programs("rustc")
    downloads = '[ "$RUSTUP_AUTO_INSTALL" = 0 ] && exit 1\necho rustc 1.95.0\n'
    (tmp_path / "bin" / "rustc").write_text(f"#!/bin/sh\n{downloads}")
    with pytest.raises(SystemExit, match="rustc --version failed; run `rustup default stable` and try again"):
        backend.get_requires_for_build_wheel()


class Download(BaseHTTPRequestHandler):
    """Serves the stand-in for rustup-init, whatever the system."""

    def do_HEAD(self):
        self.send_response(200)
        self.send_header("Content-Length", str(len(INSTALLER)))
        self.end_headers()

    def do_GET(self):
        self.server.requests.append(self.path)
        self.do_HEAD()
        self.wfile.write(INSTALLER.encode())

    def log_message(self, *_words):
        pass


@pytest.fixture
def downloads(monkeypatch):
    """The paths that were downloaded from the stand-in for rustup's server."""
    pytest.importorskip("puccinialin")
    with ThreadingHTTPServer(("127.0.0.1", 0), Download) as server:
        server.requests = []
        Thread(target=server.serve_forever).start()
        monkeypatch.setenv("RUSTUP_UPDATE_ROOT", f"http://127.0.0.1:{server.server_port}")
        monkeypatch.setenv("NO_PROXY", "127.0.0.1")
        yield server.requests
        server.shutdown()


def files_below(folder):
    return {path for path in folder.rglob("*") if path.is_file()}


@pytest.mark.skipif(sys.platform == "win32", reason="the programs are shell scripts")
@pytest.mark.parametrize("system", [None, "rustc 1.70.0"], ids=["without Rust", "with an old Rust"])
def test_a_toolchain_is_downloaded_into_the_project(
    backend, programs, project, downloads, system, tmp_path, monkeypatch, capfd
):
    if system is not None:
        programs("cargo", "cargo 1.70.0")
        programs("rustc", system)
    monkeypatch.delenv("MAVSTACK_NO_DOWNLOAD")
    monkeypatch.setattr(backend.mavstack_station, "requirements", list)
    built = backend._with_rust(lambda: (shutil.which("cargo"), os.environ["CARGO_HOME"]))
    before = files_below(tmp_path)

    assert backend.get_requires_for_build_wheel() == [backend.mavstack_rust.REQUIREMENT]
    assert downloads == []
    own = project / ".tools" / "rust" / "cargo"
    assert built() == (str(own / "bin" / "cargo"), str(own))
    (line,) = capfd.readouterr().err.splitlines()
    assert line.startswith("mavstack: ")
    assert "about 130 MB" in line
    assert str(project / ".tools" / "rust") in line
    assert "MAVSTACK_NO_DOWNLOAD=1" in line
    assert len(downloads) == 1
    added = files_below(tmp_path) - before
    assert added
    assert all(path.is_relative_to(project / ".tools") for path in added)

    built()
    assert backend.get_requires_for_build_wheel() == []
    assert len(downloads) == 1
    assert capfd.readouterr().err == ""


def test_a_download_that_cannot_be_reached_ends_with_the_line(
    backend, programs, downloads, monkeypatch, project
):
    monkeypatch.delenv("MAVSTACK_NO_DOWNLOAD")
    monkeypatch.setenv("RUSTUP_UPDATE_ROOT", "http://127.0.0.1:1")
    with pytest.raises(SystemExit) as ended:
        backend._with_rust(print)()
    assert ended.value.code.startswith(f"{LINE} (the download failed: ")
    assert "\n" not in ended.value.code  # type: ignore[operator]
    assert not (project / ".tools" / "rust" / "cargo" / "bin").exists()


@pytest.fixture
def make(tmp_path, project, monkeypatch):
    """Run make with the Makefile of the project, in a system that has no Rust."""
    if shutil.which("make") is None or sys.platform == "win32":
        pytest.skip("needs make")
    folder = tmp_path / "make"
    folder.mkdir()
    for program in ("make", "sh", "find", "touch", "mkdir", "env"):
        (folder / program).symlink_to(shutil.which(program))
    shutil.copy(ROOT / "Makefile", project)

    def run(*words):
        environment = {key: value for key, value in os.environ.items() if not key.startswith("MAKE")}
        command = [
            "make",
            "--no-print-directory",
            *words,
            f"PYTHON={sys.executable}",
            f"VENV={tmp_path / 'venv'}",
        ]
        return subprocess.run(
            command,
            capture_output=True,
            text=True,
            check=False,
            cwd=project,
            env={**environment, "PATH": str(folder)},
        )

    return run


@pytest.mark.parametrize("target", ["demo", "check"])
def test_make_downloads_nothing_if_that_is_refused(tmp_path, make, target, monkeypatch):
    monkeypatch.setenv("MAVSTACK_NO_DOWNLOAD", "1")
    result = make(target)
    assert result.returncode != 0
    assert LINE in result.stderr
    assert not (tmp_path / "venv").exists()


def test_make_gets_a_toolchain_and_the_components_of_the_linters(make, project, downloads):
    result = make("lint-rust")
    assert (result.returncode, len(downloads)) == (0, 1), result.stderr
    assert result.stderr.count("downloading a Rust toolchain") == 1
    own = project / ".tools" / "rust" / "cargo"
    assert (own / "components").read_text().split("\n")[:2] == [
        "component add rustfmt",
        "component add clippy",
    ]
    assert "cargo 1.99.0 clippy --quiet" in result.stdout


def test_pip_shows_the_line_and_no_traceback(tmp_path):
    command = [
        sys.executable,
        "-m",
        "pip",
        "wheel",
        "--no-build-isolation",
        "--no-deps",
        "-w",
        tmp_path,
        ROOT,
    ]
    result = subprocess.run(
        command,
        capture_output=True,
        text=True,
        check=False,
        env={**os.environ, "PATH": str(tmp_path), "MAVSTACK_NO_DOWNLOAD": "1"},
    )
    assert result.returncode != 0
    output = result.stdout + result.stderr
    assert "cargo was not found; install Rust from https://rustup.rs" in output
    assert "Traceback" not in output
    assert "puccinialin" not in output
