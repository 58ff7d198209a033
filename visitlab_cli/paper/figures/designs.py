"""What the paper's learning curves compare: Fig. 6 and Fig. 8 as data, by the names of `configs/paper/`."""

from collections.abc import Sequence
from typing import NamedTuple

from visitlab_cli.colours import FIXED
from visitlab_cli.paper.figures.panel import CHANCE, SCRIPT
from visitlab_cli.pictures.style import ORANGE, PLUM, PURPLE, SKY


class Condition(NamedTuple):
    """A curve of a panel: the rest of its group's name after the experiment, its look, what it was published as."""

    group: str
    name: str
    colour: str
    marker: str
    published: str


class Design(NamedTuple):
    """A panel as the paper has it; `references` are groups, by kind, whose mean is a line.

    `{}` in a reference stands for each condition's group in turn, where each has a line of its own.
    """

    title: str
    experiment: str
    conditions: Sequence[Condition]
    published: str
    references: Sequence[tuple[str, str]] = ()

    def named(self) -> list[tuple[Condition, str]]:
        """Its conditions, each with the group that is its data."""
        return [(condition, f"{self.experiment}/{condition.group}") for condition in self.conditions]

    def groups(self) -> list[str]:
        """The groups whose curves it shows."""
        return [group for _, group in self.named()]


def _agent(group: str, name: str, published: str) -> Condition:
    paint = FIXED[group]
    return Condition(group, name, paint.light, paint.marker, published)


RMAX = _agent("rmax", "R-max", "rmax")
MODEL_BASED = _agent("mb", "model-based", "epsilon_greedy_mb")
MODEL_FREE = _agent("mf", "model-free", "epsilon_greedy_mf")
BOOTSTRAPPED = _agent("mf_after_mb", "bootstrapped", "mf_bootstrapped")
AGENTS = (RMAX, MODEL_BASED, MODEL_FREE)


def _with(condition: Condition, human: str) -> Condition:
    return condition._replace(group=f"{condition.group}/{human}")


_SOCIAL_REFERENCES = [(SCRIPT, "social_reference/script/human_1"), (CHANCE, "social_reference/chance/human_1")]
FIG_6 = (
    Design("Navigation", "navigation", AGENTS, "fig6_navigation"),
    Design("Go to human", "go_to_human", AGENTS, "fig6_go_to_human"),
    Design("Social, Human 1", "social", [_with(a, "human_1") for a in AGENTS], "fig6_social", _SOCIAL_REFERENCES),
    Design(
        "Social, Human 1, after watching",
        "social",
        [_with(each, "human_1") for each in (BOOTSTRAPPED, MODEL_BASED, MODEL_FREE)],
        "fig6_mb_mf",
        _SOCIAL_REFERENCES,
    ),
)

# Humans have colours that no agent has: a colour means one thing in all figures.
HUMAN_1 = Condition("human_1", "Human 1", ORANGE, "s", "human_1")
HUMAN_2 = Condition("human_2", "Human 2", SKY, "o", "human_2")
HUMAN_3 = Condition("human_3", "Human 3", PURPLE, "^", "human_3")
POINTING = Condition("human_2_pointing", "Human 2 with pointing", PLUM, "D", "human_2_pointing")
FIG_8 = (
    Design(
        "Social, three humans",
        "social_humans",
        [each._replace(group=f"mb/{each.group}") for each in (HUMAN_1, HUMAN_2, HUMAN_3)],
        "fig8_humans",
        [(SCRIPT, "social_humans_reference/script/{}"), (CHANCE, "social_humans_reference/chance/human_1")],
    ),
    Design(
        "Visit the lab, trained with Human 2",
        "visit",
        (HUMAN_1, HUMAN_2, POINTING),
        "fig8_adaptation",
        [(SCRIPT, "visit_script/{}"), (CHANCE, "visit_chance/human_2")],
    ),
)
