"""The way in: `load` a config by its file or its shipped name."""

from collections.abc import Sequence
from pathlib import Path

from visitlab_cli.config.building import Overridden, build
from visitlab_cli.config.files import find, shipped_folder
from visitlab_cli.config.grid import with_checked_grid
from visitlab_cli.config.groups import wrong_expected
from visitlab_cli.config.model import Config
from visitlab_cli.errors import UsageError
from visitlab_cli.wording import shown
from visitlab_cli.yaml.document import Node, Place
from visitlab_cli.yaml.files import read_content
from visitlab_cli.yaml.include import INCLUDE, read_with_includes
from visitlab_cli.yaml.overrides import Sections, apply_overrides, source_of
from visitlab_cli.yaml.problems import Problem, failure, positioned
from visitlab_cli.yaml.reader import read_yaml

OWN_KEYS = ("name", "seed", "seeds", "record", "figure")
"""What a file does not take over from those that it includes."""
EXPECTED = "expected"
HARMLESS = ("seed", "seeds")
"""What may be overridden without making the expected values meaningless."""
SECTIONS = Sections(
    {"humans": "human", "labs": "lab", "agents": "agent", "experiments": "experiment"}, dotted=("vary",)
)


def load(name: str | Path, overrides: Sequence[str] = ()) -> Config:
    """Read, resolve and check a config.

    Args:
        name: a YAML file, or the bare name of a shipped config.
        overrides: `key=value` each, the key dotted, the value YAML. Any but `seed`, `seeds` and those of
            `expected` itself drops `expected`, whose values belong to the config as it is written.

    Returns:
        The config with `include` and `like` resolved.

    Raises:
        NotFoundError: if there is no such file.
        ConfigError: with a line `file:line:column: path: message` for every problem.
        UsageError: for an override that is not `key=value`, or of a setting that varies.
    """
    document, problems = read_with_includes(find(name), OWN_KEYS, shipped_folder())
    keys = [override.partition("=")[0] for override in overrides]
    if any(key not in HARMLESS and key.split(".")[0] != EXPECTED for key in keys):
        document = document.with_entries({key: node for key, node in document.value.items() if key != EXPECTED})
    written = document
    document, more = apply_overrides(document, overrides, SECTIONS)
    sources = [source_of(override) for override in overrides]
    config = _whole(document, problems + more, Overridden(written, sources))
    for key, _, text in (override.partition("=") for override in overrides):
        if key in config.vary:
            instead = f"override vary.{key}=[{text}]"
            raise UsageError(f"override {shown(key)}: has no effect, for the config varies it; {instead} instead")
    return config


def load_content(content: bytes, path: Path) -> Config:
    """The config in the bytes of a file that stands for itself, such as a run's own: it includes no other.

    A kind of others that is not to be had is no error here: what was made with it can be read without it.

    Raises:
        ConfigError: as `load`.
    """
    document, problems = read_content(content, path)
    return with_checked_grid(build(document, problems, kept=True), document)


def load_text(text: str, source: str) -> Config:
    """The config in a text that stands for itself, such as what `dump_yaml` wrote: it includes no file.

    `source` names it in messages.

    Raises:
        ConfigError: as `load`.
    """
    document, problems = read_yaml(text, source)
    document = document or Node({}, Place(source, 1, 1))
    if not isinstance(document.value, dict):
        raise failure([*problems, Problem(document.place, (), "must be a mapping")])
    if INCLUDE in document.value:
        problems = [
            *problems,
            Problem(document.value[INCLUDE].place, (INCLUDE,), "only a file includes files; write out what they have"),
        ]
        document = document.with_entries({key: node for key, node in document.value.items() if key != INCLUDE})
    return _whole(document, problems)


def _whole(document: Node, problems: list[Problem], overridden: Overridden | None = None) -> Config:
    """The config with its grid, all of whose expected values can be checked.

    Raises:
        ConfigError: with a line for each problem, those already known included.
    """
    config = with_checked_grid(build(document, problems, overridden), document)
    wrong = list(wrong_expected(config))
    if wrong:
        raise failure(positioned(document, issue) for issue in wrong)
    return config
