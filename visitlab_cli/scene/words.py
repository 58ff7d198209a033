"""A trial in words: names, and what happens in a step; shared by all that tells of a trial."""

from collections.abc import Mapping
from typing import Any

import numpy.typing as npt

from visitlab_cli.world.enums import DISTANCE_NAMES, N_DIRECTIONS, N_MOVES, Action, Direction, InteractionLevel
from visitlab_cli.world.lab import ALL_OPEN, Lab, names_of_shut, room_names, sees

Steps = Mapping[str, npt.NDArray[Any]]
"""The columns of one trial, from its step 0 on: for each name of the log an array of shape (steps + 1,)."""
LEVEL_NAMES = (
    "Not seen",
    "Seen",
    "Human faces",
    "Robot faces",
    "Both face",
    "Greeted",
    "Called",
    "Follows",
)
MOVES, STAYS, LOOKS, SAYS_HELLO, CALLS, POINTS, GOES = ACTION_KINDS = (
    "Moves",
    "Stays",
    "Looks",
    "Hello",
    "Come",
    "Point",
    "Goes to view",
)
_KINDS = {
    Action.STAY: STAYS,
    Action.LOOK: LOOKS,
    Action.HELLO: SAYS_HELLO,
    Action.COME: CALLS,
    Action.POINT: POINTS,
    Action.GO_TO_HUMAN_VISION: GOES,
}
GESTURES = {Action.HELLO: "HELLO!", Action.COME: "COME!", Action.POINT: "THERE!"}
"""What a speech bubble says."""

_ROBOT_DOES = {
    Action.STAY: "stays",
    Action.LOOK: "looks at the human",
    Action.HELLO: "says hello",
    Action.COME: "says come",
}
_HUMAN_DOES = (
    "does not see it",
    "sees it",
    "faces it",
    "sees it turned to the human",
    "is face to face with it",
    "follows it with its gaze",
    "waits to be shown the way",
    "follows it",
)
_HUMAN_PART = (0, 1, 2, 1, 2, 3, 4, 5)
"""What of an interaction level is the human's: it does not change where the robot alone turned."""
ENGAGED = InteractionLevel.GREETED


def room_name(lab: Lab, room: int) -> str:
    """The name of a room of a lab."""
    return f"Room {room_names(lab)[room]}"


def direction_name(direction: int) -> str:
    """A direction in words, such as north-east."""
    return Direction(direction).name.lower().replace("_", "-")


def action_kind(action: int) -> str:
    """Which of `ACTION_KINDS` an action is."""
    return MOVES if action < N_MOVES else _KINDS.get(Action(action), STAYS)


def option_name(action: int) -> str:
    """An action that might be taken, in words: 'move 2 north-east', 'hello'."""
    if action < N_MOVES:
        return f"move {action // N_DIRECTIONS + 1} {direction_name(action % N_DIRECTIONS)}"
    return action_kind(action).lower()


def executed(steps: Steps) -> npt.NDArray[Any]:
    """What the robot did at each step, shape (steps + 1,)."""
    return steps["executed_action"] if "executed_action" in steps else steps["action"]


def action_name(steps: Steps, step: int) -> str:
    """What the robot does in a step, in words: 'moves 3 cells north-east', 'says hello'."""
    chosen, action = int(steps["action"][step]), int(executed(steps)[step])
    if chosen == Action.GO_TO_HUMAN_VISION:
        how = "" if action == chosen else f": {_physical(steps, step, action)}"
        return f"goes to the human's view{how}"
    return _physical(steps, step, action)


def captions(steps: Steps, lab: Lab) -> list[str]:
    """A sentence for each step: what the robot does, and what the human makes of it; the first says how it begins."""
    return [caption(steps, step, lab) for step in range(len(steps["step"]))]


def caption(steps: Steps, step: int, lab: Lab) -> str:
    """What happens in a step in `lab`: 'says hello; the human faces it and now follows it with its gaze'."""
    parts = [_begins(steps, lab) if step == 0 else action_name(steps, step)]
    if "human_row" in steps:
        parts.append(_human(steps, step, lab))
    if step > 0 and steps["reward"][step] > 0:
        parts.append(_rewarded(steps, step, lab))
    if step in model_changes(steps):
        parts.append(f"the robot changes to {model_name(steps, step)}")
    return "; ".join(parts)


def model_changes(steps: Steps) -> list[int]:
    """Of an agent of several models, the steps from which on it acts by another one than before."""
    if "active_model" not in steps:
        return []
    active = steps["active_model"]
    return [int(step) for step in (active[1:] != active[:-1]).nonzero()[0] + 1]


def model_name(steps: Steps, step: int) -> str:
    """Of an agent of several models, by which of them it acts from a step on: 'model 2'."""
    return f"model {steps['active_model'][step]}"


def _begins(steps: Steps, lab: Lab) -> str:
    phase = [f"in phase {steps['phase'][0]}"] if "phase" in steps else []
    shut = [f"doors shut: {', '.join(names)}"] if (names := shut_in(steps, lab)) else []
    model = [f"with {model_name(steps, 0)}"] if "active_model" in steps else []
    return ", ".join(["the trial begins", *phase, *model, *shut])


def _physical(steps: Steps, step: int, action: int) -> str:
    if action == Action.POINT:
        return f"points {direction_name(steps['desired_direction'][step - 1])}"
    if action >= N_MOVES:
        return _ROBOT_DOES.get(Action(action), "does nothing")
    return _way(steps, step, action, "robot", "moves")


def _way(steps: Steps, step: int, move: int, who: str, verb: str) -> str:
    """How far and where a move went: 'moves 2 cells west', 'moves 1 cell west, then is blocked'."""
    speed, direction = move // N_DIRECTIONS + 1, direction_name(move % N_DIRECTIONS)
    rows, cols = steps[f"{who}_row"].astype(int), steps[f"{who}_col"].astype(int)
    gone = max(abs(rows[step] - rows[step - 1]), abs(cols[step] - cols[step - 1]))
    if gone == 0:
        return f"is blocked going {direction}"
    words = f"{verb} {gone} cell{'' if gone == 1 else 's'} {direction}"
    return words if gone == speed else f"{words}, then is blocked"


def _human(steps: Steps, step: int, lab: Lab) -> str:
    levels = steps["interaction_level"]
    after = int(levels[step])
    before = int(levels[step - 1]) if step else after
    action = int(executed(steps)[step])
    move = int(steps["human_action"][step]) if "human_action" in steps else int(Action.STAY)
    if before >= ENGAGED > after:
        asides = [*_why(steps, step, lab), *([_way(steps, step, move, "human", "wanders")] if move < N_MOVES else [])]
        lost = f"loses attention, {', '.join(asides)}," if asides else "loses attention"
        sees = "and no longer sees it" if after == InteractionLevel.NOT_SEEN else f"but still {_HUMAN_DOES[after]}"
        return f"the human {lost} {sees}"
    if action == Action.HELLO and after == ENGAGED and before != after:
        sees = ("sees it", "faces it", "was distracted")[_HUMAN_PART[min(before, ENGAGED)] - 1]
        return f"the human {sees} and now {_HUMAN_DOES[after]}"
    if after == InteractionLevel.FOLLOWS and move < N_MOVES:
        return f"the human {_way(steps, step, move, 'human', 'follows')}"
    if after == before == InteractionLevel.FOLLOWS:
        return "the human waits"
    wanders = after < ENGAGED and move < N_MOVES
    first = f"{_way(steps, step, move, 'human', 'wanders')} and " if wanders else ""
    ignores = "does not react: it " if action == Action.HELLO and after < ENGAGED else ""
    return f"the human {ignores}{first}{_sight(before, after)}"


BELIEVED = {
    "belief_none": "not engaged",
    "belief_greeted": "greeted",
    "belief_called": "called",
    "belief_following": "following",
}
"""What is believed of the human's engagement, by the log's columns."""


def believed(steps: Steps, step: int) -> str:
    """The likeliest engagement and how likely it is: 'following 0.97'."""
    likeliest = max(BELIEVED, key=lambda name: float(steps[name][step]))
    return f"{BELIEVED[likeliest]} {steps[likeliest][step]:.2f}"


def open_doors_in(steps: Steps) -> int:
    """The doors that are open in a trial."""
    return int(steps["open_doors"][0]) if "open_doors" in steps else ALL_OPEN


def shut_in(steps: Steps, lab: Lab) -> list[str]:
    """The names of the doors of `lab` that are shut in a trial."""
    return names_of_shut(lab, open_doors_in(steps))


def in_sight(steps: Steps, step: int, lab: Lab) -> bool:
    """Whether no wall was between robot and human after a step in `lab`; in the open arena none ever is."""
    row, col, human_row, human_col = (
        int(steps[f"{who}_{axis}"][step]) for who in ("robot", "human") for axis in ("row", "col")
    )
    inside = max(row, human_row) < lab.rows and max(col, human_col) < lab.cols
    return not inside or bool(sees(lab, row, col, human_row, human_col, open_doors_in(steps)))


def _why(steps: Steps, step: int, lab: Lab) -> list[str]:
    """Why attention was lost, where the distance or a wall was the reason."""
    if not in_sight(steps, step - 1, lab):
        return ["out of sight"]
    category = int(steps["distance"][step - 1])
    return [DISTANCE_NAMES[category]] if category in (0, len(DISTANCE_NAMES) - 1) else []


def _sight(before: int, after: int) -> str:
    if _HUMAN_PART[before] == _HUMAN_PART[after]:
        return _HUMAN_DOES[after]
    return "no longer sees it" if after == InteractionLevel.NOT_SEEN else f"now {_HUMAN_DOES[after]}"


def there_already(steps: Steps, step: int, lab: Lab) -> bool:
    """Whether a goal of a step was no achievement: who should come to the room began the trial there."""
    if step != 1 or "goal_room" not in steps:
        return False
    who = "human" if "human_row" in steps else "robot"
    row, col = int(steps[f"{who}_row"][0]), int(steps[f"{who}_col"][0])
    return int(lab.rooms[row, col]) == int(steps["goal_room"][0])


def _rewarded(steps: Steps, step: int, lab: Lab) -> str:
    if "executed_action" in steps:
        reached, following = (room_name(lab, steps["goal_room"][at]) for at in (step - 1, step))
        how = f"the human began in goal {reached}" if there_already(steps, step, lab) else f"goal reached in {reached}"
        return f"{how}, the next is {following}"
    if "desired_direction" in steps:
        return f"rewarded: the human went {direction_name(steps['desired_direction'][step - 1])}"
    if "goal_room" not in steps:
        return "rewarded: in view"
    began = ", where it began" if there_already(steps, step, lab) else ""
    return f"rewarded: in {room_name(lab, steps['goal_room'][step])}{began}"
