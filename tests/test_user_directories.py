"""The folders of the user stay where they have been since the first version."""

from __future__ import annotations

from pathlib import Path

import pytest
from platformdirs.macos import MacOS
from platformdirs.windows import Windows

from mavstack.user_directories import cache_directory, config_directory, state_directory


def test_the_folders_of_linux(tmp_path, monkeypatch):
    monkeypatch.setattr("sys.platform", "linux")
    for name in ("XDG_CACHE_HOME", "XDG_STATE_HOME", "XDG_CONFIG_HOME"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("HOME", str(tmp_path))
    assert cache_directory() == tmp_path / ".cache" / "mavstack"
    assert state_directory() == tmp_path / ".local" / "state" / "mavstack"
    assert config_directory() == tmp_path / ".config" / "mavstack"
    for name in ("XDG_CACHE_HOME", "XDG_STATE_HOME", "XDG_CONFIG_HOME"):
        monkeypatch.setenv(name, str(tmp_path / name))
    assert cache_directory() == tmp_path / "XDG_CACHE_HOME" / "mavstack"
    assert state_directory() == tmp_path / "XDG_STATE_HOME" / "mavstack"
    assert config_directory() == tmp_path / "XDG_CONFIG_HOME" / "mavstack"


def test_the_folders_of_macos(tmp_path, monkeypatch):
    for name in ("XDG_CACHE_HOME", "XDG_STATE_HOME", "XDG_CONFIG_HOME"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.setattr("platformdirs.PlatformDirs", MacOS)
    assert cache_directory() == tmp_path / "Library" / "Caches" / "mavstack"
    assert state_directory() == tmp_path / "Library" / "Application Support" / "mavstack"
    assert config_directory() == tmp_path / "Library" / "Application Support" / "mavstack"


def test_the_folders_of_windows(monkeypatch):
    """Only configuration roams with the user."""
    monkeypatch.setattr("platformdirs.PlatformDirs", Windows)
    folders = {"CSIDL_APPDATA": "/home/Roaming", "CSIDL_LOCAL_APPDATA": "/home/Local"}
    monkeypatch.setattr("platformdirs.windows.get_win_folder", folders.get)
    assert cache_directory().as_posix().lower() == "/home/local/mavstack/cache"
    assert state_directory() == Path("/home/Local/mavstack")
    assert config_directory() == Path("/home/Roaming/mavstack")


@pytest.mark.parametrize("directory", [cache_directory, state_directory, config_directory])
def test_without_a_home_nothing_is_written_into_the_current_folder(directory, monkeypatch):
    for name in ("XDG_CACHE_HOME", "XDG_STATE_HOME", "XDG_CONFIG_HOME"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr("os.path.expanduser", lambda path: path)
    monkeypatch.setattr(Path, "home", _no_home)
    with pytest.raises(RuntimeError, match="home directory"):
        directory()


def _no_home():
    raise RuntimeError("Could not determine home directory.")
