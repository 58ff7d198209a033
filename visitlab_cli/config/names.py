"""The names that a config gives to humans, agents and experiments, and how one is referred to."""

from collections.abc import Iterable, Mapping
from typing import Annotated, Any, NamedTuple

from pydantic import AfterValidator, BeforeValidator, Field

from visitlab_cli.wording import few, shown

NAME_RULE = "a name has 1 to 64 of A-Z a-z 0-9 . _ - and starts with a letter or digit"
_NAME = r"[A-Za-z0-9][A-Za-z0-9._-]{0,63}"
NAME_PATTERN = f"^{_NAME}$"
MODULE_PATTERN = f"^{_NAME}/{_NAME}(/{_NAME})?$"
MODULE_RULE = "a module is experiment/agent or experiment/agent/human"

Name = Annotated[str, Field(pattern=NAME_PATTERN)]
"""Safe as the name of a folder: no separators, no leading dot or dash, at most 64 characters."""


def _one_module(given: Any) -> Any:
    if isinstance(given, list | tuple | dict):
        raise ValueError(f"must be one module (got {shown(given)}); several as one: a visit's social module only")
    return given


ModuleName = Annotated[str, Field(pattern=MODULE_PATTERN), BeforeValidator(_one_module)]


def distinct(entries: tuple[Any, ...]) -> tuple[Any, ...]:
    """The entries, if none of them is there twice; else a ValueError."""
    seen: set[Any] = set()
    for entry in entries:
        if entry in seen:
            raise ValueError(f"has {entry} twice")
        seen.add(entry)
    return entries


Names = Annotated[
    tuple[Name, ...], Field(min_length=1, json_schema_extra={"uniqueItems": True}), AfterValidator(distinct)
]

RESERVED_EXPERIMENTS = ("config.yaml", "versions.json", "evaluations", "failures", "figures", "report.html")
"""What else lies in a run folder beside the experiments' own folders."""

RESERVED_RUNS = ("latest",)
"""What else a word may mean where the name of a run may stand, in any case of letters."""
LOG_ENDING = ".mcap"
"""How a word ends that means a log there."""


PAPER_LAB = "paper"
"""The name of the paper's lab, which needs no declaration."""
MOST_DOORS = 3
"""So many doors that toggle are named in words."""


def changes_of_place(lab: str, phases: Iterable[tuple[str, Mapping[str, float]]]) -> list[str]:
    """Of each phase what of its lab and its toggling doors is another than in the phase before, in words.

    Args:
        lab: the experiment's own, as which its first phase begins, with no door that toggles.
        phases: the lab of each, and how likely some doors are opened or shut.
    """
    told, before = [], (lab, dict[str, float]())
    for name, doors in phases:
        toggling = few([f"{door} {chance:g}" for door, chance in doors.items()], MOST_DOORS)
        new = [f"lab {name}"] if name != before[0] else []
        new += [f"doors {toggling}" if doors else "no door toggles"] if doors != before[1] else []
        told.append(", ".join(new))
        before = name, dict(doors)
    return told


class Module(NamedTuple):
    """A trained module of a visit: the experiment that trains it, the agent, in the social task the human."""

    experiment: str
    agent: str
    human: str | None = None

    @property
    def text(self) -> str:
        """As a config refers to it."""
        return "/".join(filter(None, self))


def module(text: str) -> Module:
    """The parts of `experiment/agent` or `experiment/agent/human` (already known to be one of the two)."""
    return Module(*text.split("/"))
