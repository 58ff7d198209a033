"""The figure of a config: the question that its run answers, and how the answer is drawn. It changes no result."""

from collections.abc import Collection
from typing import Annotated, Literal, Self

from pydantic import AfterValidator, Field

from visitlab_cli.config.names import Name
from visitlab_cli.settings import Settings
from visitlab_cli.yaml.problems import Path

LONGEST_WORDS, LONGEST_QUESTION = 60, 200


def _line(text: str, longest: int) -> str:
    if not text.strip() or not text.isprintable() or len(text) > longest:
        raise ValueError(f"must be a line of 1 to {longest} characters (got {len(text)})")
    return text


def _question(text: str) -> str:
    return _line(text, LONGEST_QUESTION)


def _words(text: str) -> str:
    return _line(text, LONGEST_WORDS)


Words = Annotated[str, AfterValidator(_words)]


class FigureSettings(Settings):
    """The one figure that answers the config's question."""

    question: Annotated[str, AfterValidator(_question)] = Field(description="what the run is to answer: its title")
    draws: Literal["curves", "doors", "grid", "meetings", "phases", "visits"] = Field(
        description="which figure answers it: curves of visits without phases over trials, and of trainings over steps "
        "where of these there are more; how navigation recovers when doors close; a grid's levels; first meetings and "
        "returns in phases; curves of phases; or bars of visits without phases"
    )
    names: dict[Name, Words] = Field(
        default={}, description="what experiments, agents and humans are called in it, by their names"
    )
    dashed: dict[Name, Name] = Field(
        default={}, description="whose curves are dashed, each in the colour of another agent or experiment"
    )
    costs: bool = Field(default=False, description="in curves of agents, also what a step of each costs")

    def unknown(self, known: Collection[str]) -> list[tuple[Path, str]]:
        """The names in it that are none of the `known`, each with its place in it."""
        said = [((part, name), name) for part in ("names", "dashed") for name in getattr(self, part)]
        said += [(("dashed", name), other) for name, other in self.dashed.items()]
        return [(place, name) for place, name in said if name not in known]

    def without(self, names: Collection[str]) -> Self:
        """The same without what it says of these names."""
        kept = {name: words for name, words in self.names.items() if name not in names}
        dashed = {name: other for name, other in self.dashed.items() if not {name, other} & {*names}}
        return self.model_copy(update={"names": kept, "dashed": dashed})

    def words(self, name: str) -> str:
        """What a name is called."""
        return self.names.get(name, name)


NO_FIGURE = FigureSettings(question="-", draws="curves")
"""Of a config that declares none: all is called by its name."""
