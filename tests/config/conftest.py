"""Loading a text, and the lines with which it is refused."""

from collections.abc import Sequence
from pathlib import Path

import pytest

from tests.config.lab import LAB, Complain, Load
from visitlab_cli.config.loading import load
from visitlab_cli.config.model import Config
from visitlab_cli.errors import ConfigError


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def loaded(folder: Path) -> Load:
    """Load a text as lab.yaml."""

    def load_text(text: str | bytes = LAB, overrides: Sequence[str] = ()) -> Config:
        (folder / "lab.yaml").write_bytes(text if isinstance(text, bytes) else text.encode())
        return load("lab.yaml", overrides)

    return load_text


@pytest.fixture
def complaint(loaded: Load) -> Complain:
    """The lines that a text (and overrides) are refused with."""

    def lines(text: str | bytes = LAB, overrides: Sequence[str] = ()) -> list[str]:
        with pytest.raises(ConfigError) as error:
            loaded(text, overrides)
        assert error.value.exit_code == 3
        return str(error.value).split("\n")

    return lines
