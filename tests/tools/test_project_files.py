"""The project's own files agree with each other: workflows, classifiers, Makefile, README."""

from __future__ import annotations

import re
import shutil
import subprocess
import tomllib
from pathlib import Path

import pytest
import yaml

ROOT = Path(__file__).parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))
WORKFLOWS = sorted((ROOT / ".github" / "workflows").glob("*.yml"))
TARGETS = set(re.findall(r"^([a-z]+):", (ROOT / "Makefile").read_text("utf-8"), re.MULTILINE))


def python_versions() -> list[str]:
    found = (re.fullmatch(r".*:: Python :: (3\.\d+)", line) for line in PROJECT["project"]["classifiers"])
    return [match[1] for match in found if match]


@pytest.mark.parametrize("path", WORKFLOWS, ids=lambda path: path.name)
def test_workflows_have_jobs_with_a_time_limit(path: Path) -> None:
    workflow = yaml.safe_load(path.read_text("utf-8"))
    assert workflow["jobs"]
    assert all("timeout-minutes" in job for job in workflow["jobs"].values())


def test_continuous_integration_covers_the_platforms_and_versions_of_the_classifiers() -> None:
    workflow = yaml.safe_load((ROOT / ".github" / "workflows" / "ci.yml").read_text("utf-8"))
    matrix = workflow["jobs"]["platforms"]["strategy"]["matrix"]
    assert matrix["python"] == python_versions()
    assert {system.split("-")[0] for system in matrix["os"]} == {"ubuntu", "macos", "windows"}


def test_the_root_of_the_repository_has_no_files_that_programs_wrote() -> None:
    git = shutil.which("git")
    if git is None or not (ROOT / ".git").exists():
        pytest.skip("not a checkout of git")
    listed = subprocess.run([git, "ls-files"], cwd=ROOT, capture_output=True, text=True, check=True).stdout
    endings = {Path(name).suffix for name in listed.splitlines() if "/" not in name}
    assert endings <= {"", ".md", ".toml", ".lock", ".yml", ".yaml"}


def test_make_targets_that_documents_name_exist() -> None:
    for name in ("README.md", "CONTRIBUTING.md", ".ci/run", ".github/workflows/nightly.yml"):
        named = set(re.findall(r"(?:`|^|run: )make ([a-z]+)", (ROOT / name).read_text("utf-8"), re.MULTILINE))
        assert named, name
        assert named <= TARGETS, name


def test_continuous_integration_runs_all_tiers_but_the_nightly_one() -> None:
    lines = re.findall(r"^make (.*)", (ROOT / ".ci" / "run").read_text("utf-8"), re.MULTILINE)
    commands = [word for line in lines for word in line.split() if word.isalpha()]
    assert commands == ["test", "flights", "interop", "docs"]


def test_every_test_has_a_time_limit() -> None:
    assert PROJECT["tool"]["pytest"]["ini_options"]["timeout"] == 120
    assert any(line.startswith("pytest-timeout") for line in PROJECT["dependency-groups"]["test"])


@pytest.mark.xdist_group("shared fixture")
def test_a_group_of_tests_runs_in_one_worker(request: pytest.FixtureRequest) -> None:
    """pytest-xdist adds the group to the test id; without it, each worker sets up the shared fixture."""
    if not request.config.getoption("loadgroup", default=False):
        pytest.skip("the tests run in one process, or without --dist loadgroup")
    assert request.node.nodeid.endswith("@shared fixture")
