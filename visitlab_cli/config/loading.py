"""The way in: `load` a config by its file or its shipped name."""

from collections.abc import Sequence
from pathlib import Path

from visitlab_cli.config.building import build
from visitlab_cli.config.document import Node, Place
from visitlab_cli.config.files import find, read_content
from visitlab_cli.config.grid import with_checked_grid
from visitlab_cli.config.include import read_with_includes
from visitlab_cli.config.model import Config
from visitlab_cli.config.overrides import apply_overrides
from visitlab_cli.config.problems import Problem, failure, shown
from visitlab_cli.config.yaml_reader import read_yaml
from visitlab_cli.errors import UsageError


def load(name: str | Path, overrides: Sequence[str] = ()) -> Config:
    """Read, resolve and check a config.

    Args:
        name: a YAML file, or the bare name of a shipped config.
        overrides: `key=value` each, the key dotted, the value YAML. Any but `seed` and `seeds` drops
            `expected`, whose values belong to the config as it is written.

    Returns:
        The config with `include` and `like` resolved.

    Raises:
        NotFoundError: if there is no such file.
        ConfigError: with a line `file:line:column: path: message` for every problem.
        UsageError: for an override that is not `key=value`, or of a setting that varies.
    """
    document, problems = read_with_includes(find(name))
    document, more = apply_overrides(document, overrides)
    config = with_checked_grid(build(document, problems + more), document)
    for key, _, text in (override.partition("=") for override in overrides):
        if key in config.vary:
            instead = f"override vary.{key}=[{text}]"
            raise UsageError(f"override {shown(key)}: has no effect, for the config varies it; {instead} instead")
    return config


def load_content(content: bytes, path: Path) -> Config:
    """The config in the bytes of a file that stands for itself, such as a run's own: it includes no other.

    Raises:
        ConfigError: as `load`.
    """
    document, problems = read_content(content, path)
    return with_checked_grid(build(document, problems), document)


def load_text(text: str, source: str) -> Config:
    """The config in a text that stands for itself, such as what `dump_yaml` wrote; `source` names it in messages.

    Raises:
        ConfigError: as `load`.
    """
    document, problems = read_yaml(text, source)
    document = document or Node({}, Place(source, 1, 1))
    if not isinstance(document.value, dict):
        raise failure([*problems, Problem(document.place, (), "must be a mapping")])
    return with_checked_grid(build(document, problems), document)
