"""Learned affordances as plain values, and the arrows of the paper's Fig. 4 among them."""

import math
from typing import Any, NamedTuple

from visitlab_cli.affordances.counts import KINDS, Kind
from visitlab_cli.affordances.learned import Affordances, Graph
from visitlab_cli.affordances.policy import UNSEEN, PolicyMap
from visitlab_cli.affordances.truth import NOT_ENGAGED
from visitlab_cli.world.enums import N_DIRECTIONS, N_MOVES, Action, InteractionLevel

OUTCOMES = (*(level.name for level in InteractionLevel), "NOT_ENGAGED")
"""Names of the outcomes: the levels, and 'any of the levels 0 to 4'."""


class Arrow(NamedTuple):
    """An arrow of Fig. 4: a kind of action, the level before, the outcome after."""

    kind: Kind
    level: InteractionLevel
    outcome: int


ARROWS = (
    Arrow(Kind.GO_TO_HUMAN_VISION, InteractionLevel.NOT_SEEN, InteractionLevel.HUMAN_FACES),
    Arrow(Kind.GO_TO_HUMAN_VISION, InteractionLevel.NOT_SEEN, InteractionLevel.BOTH_FACE),
    Arrow(Kind.LOOK, InteractionLevel.SEEN, InteractionLevel.ROBOT_FACES),
    Arrow(Kind.LOOK, InteractionLevel.HUMAN_FACES, InteractionLevel.BOTH_FACE),
    Arrow(Kind.HELLO, InteractionLevel.ROBOT_FACES, InteractionLevel.GREETED),
    Arrow(Kind.HELLO, InteractionLevel.BOTH_FACE, InteractionLevel.GREETED),
    Arrow(Kind.COME, InteractionLevel.GREETED, InteractionLevel.CALLED),
    Arrow(Kind.COME, InteractionLevel.GREETED, InteractionLevel.FOLLOWS),
    Arrow(Kind.POINT, InteractionLevel.CALLED, InteractionLevel.FOLLOWS),
    *(
        Arrow(kind, InteractionLevel.FOLLOWS, NOT_ENGAGED)
        for kind in (Kind.TOWARDS, Kind.SIDEWAYS, Kind.AWAY, Kind.STAY)
    ),
)


class Weight(NamedTuple):
    """What is known of an arrow: visits behind it, the learned and the true probability (nan if undecided)."""

    visits: int
    learned: float
    low: float
    high: float


def weight(graph: Graph, arrow: Arrow) -> Weight:
    """The probabilities at an arrow."""
    place = KINDS.index(arrow.kind), int(arrow.level)
    bounds = (float(table[(*place, arrow.outcome)]) for table in (graph.learned, graph.low, graph.high))
    return Weight(int(graph.visits[place]), *bounds)


def as_json(found: Affordances) -> dict[str, Any]:
    """All of it: `trained` and each of `visits` with `transitions`, `policy`, and for a visit `seen_in_visit`."""
    return {
        "trained": {
            "cell": found.cell.path,
            "human": found.cell.human,
            **({"pool": list(found.pool)} if found.pool else {}),
            "transitions": transitions(found.knows),
            "policy": _policy(found.policy),
        },
        "visits": [
            {
                "cell": each.cell.path,
                "human": each.cell.human,
                "transitions": transitions(each.knows),
                "seen_in_visit": transitions(each.saw),
                "policy": _policy(each.policy),
            }
            for each in found.adaptations
        ],
    }


def transitions(graph: Graph) -> list[dict[str, Any]]:
    """Every kind of action and level, with what followed."""
    lines = []
    for kind in KINDS:
        for level in InteractionLevel:
            weights = [weight(graph, Arrow(kind, level, outcome)) for outcome in range(len(OUTCOMES))]
            visits = weights[0].visits
            learned = {name: each.learned for name, each in zip(OUTCOMES, weights, strict=True)}
            true = {name: [each.low, each.high] for name, each in zip(OUTCOMES, weights, strict=True)}
            lines.append(
                {
                    "action": str(kind),
                    "level": level.name,
                    "visits": visits,
                    "learned": learned if visits else None,
                    "true": {name: pair for name, pair in true.items() if not math.isnan(pair[0])},
                }
            )
    return lines


def _policy(policy: PolicyMap) -> list[dict[str, Any]]:
    """The situations that the module was in; bearings and directions against the desired one, in degrees."""
    lines = []
    degrees = 360 // N_DIRECTIONS
    for level in InteractionLevel:
        for distance, bearing in zip(*(policy.action[level] != UNSEEN).nonzero(), strict=True):
            place = int(level), int(distance), int(bearing)
            action = int(policy.action[place])
            moves = action < N_MOVES
            lines.append(
                {
                    "level": level.name,
                    "distance": int(distance),
                    "robot_bearing": int(bearing) * degrees,
                    "action": "MOVE" if moves else Action(action).name,
                    "speed": action // N_DIRECTIONS + 1 if moves else None,
                    "direction": action % N_DIRECTIONS * degrees if moves else None,
                    "share": float(policy.share[place]),
                    "visits": int(policy.visits[place]),
                    "value": float(policy.value[place]),
                }
            )
    return lines
