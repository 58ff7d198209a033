"""One-line mutations of the package that the oracle must notice, and how one is applied to a copy."""

from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class Mutation:
    """One wrong line: `old`, which occurs exactly once in `file`, becomes `new`.

    `file` is relative to the package's folder; `task` is the task whose log must then be refused, played in the paper's
    lab or in `labs`, one phase after the other.
    """

    name: str
    file: str
    old: str
    new: str
    task: str
    labs: tuple[str, ...] = ()


HUMAN, GESTURES = "humans/six_parameters.py", "world/human.py"
GEOMETRY = "world/geometry.py"
LAB, LAYOUT, SIGHT, SCENE = "world/lab.py", "world/layout.py", "world/sight.py", "world/scene.py"
# What is played where it is not the paper's lab: names in tests/world/package_log.py.
SMALL, DOORS, PHASES = ("small",), ("toggling",), ("nine rooms", "closed", "toggling", "closed")

MUTATIONS: list[Mutation] = [
    Mutation("attention is never lost", HUMAN, "happens(random, human.p_A)", "False", "social"),
    Mutation("attention survives any distance", HUMAN, "if not appropriate or (", "if (", "social"),
    Mutation(
        "hello works from afar",
        HUMAN,
        "action == Action.HELLO and appropriate:",
        "action == Action.HELLO:",
        "social",
    ),
    Mutation("hello may fail face to face", HUMAN, "level == InteractionLevel.BOTH_FACE or (", "(", "social"),
    Mutation("hello always succeeds", HUMAN, "and not happens(random, human.p_H)", "", "social"),
    Mutation(
        "hello resets who follows",
        HUMAN,
        "engagement = max(engagement, Engagement.GREETED.value)",
        "engagement = Engagement.GREETED.value",
        "social",
    ),
    Mutation("nobody needs pointing", HUMAN, "happens(random, human.p_P)", "False", "social"),
    Mutation("follows at gestures too", HUMAN, " and not is_gesture(action)", "", "social"),
    Mutation(
        "a look is a gesture",
        GESTURES,
        "return action in GESTURES",
        "return action >= Action.LOOK",
        "social",
    ),
    Mutation(
        "follows away from the robot",
        HUMAN,
        "(scene.angle + N_DIRECTIONS // 2)",
        "(scene.angle + 0)",
        "social",
    ),
    Mutation(
        "moves at random while engaged",
        HUMAN,
        "if engagement == Engagement.NONE:\n        if happens",
        "if True:\n        if happens",
        "visit",
    ),
    Mutation(
        "looks around less often",
        HUMAN,
        "happens(random, human.p_O)",
        "happens(random, human.p_O * 0.5)",
        "social",
    ),
    Mutation(
        "speeds 2 and 3 are swapped",
        HUMAN,
        "human.p_speed_1 + human.p_speed_2 else 3",
        "1.0 - human.p_speed_2 else 3",
        "social",
    ),
    Mutation("the visual field is 45 degrees", GEOMETRY, "VISUAL_FIELD = 2 *", "VISUAL_FIELD = 1 *", "go_to_human"),
    Mutation(
        "bounds of the fields excluded",
        GEOMETRY,
        "CIRCLE - turn) <= field",
        "CIRCLE - turn) < field",
        "go_to_human",
    ),
    Mutation("faced from behind", GEOMETRY, "to_robot = bearing + BEHIND", "to_robot = bearing", "go_to_human"),
    Mutation("thresholds excluded", GEOMETRY, 'side="left"', 'side="right"', "go_to_human"),
    Mutation(
        "ties go up",
        GEOMETRY,
        "nearest = np.rint(bearing / HUNDREDTHS)",
        "nearest = np.floor(bearing / HUNDREDTHS + 0.5)",
        "go_to_human",
    ),
    Mutation(
        "the lab is upside down",
        GEOMETRY,
        "np.arctan2(north, east)",
        "np.arctan2(-north, east)",
        "go_to_human",
    ),
    Mutation(
        "bearings not rounded first",
        GEOMETRY,
        "np.rint(turns * HUNDREDTHS)",
        "np.floor(turns * HUNDREDTHS)",
        "go_to_human",
    ),
    Mutation(
        "moves one cell too far", "world/lab.py", "min(speed, lab.reach", "min(speed + 1, lab.reach", "navigation"
    ),
    Mutation(
        "a move does not turn",
        "world/robot.py",
        "Body(row, col, direction)",
        "Body(row, col, body.heading)",
        "navigation",
    ),
    Mutation(
        "success only faced both ways",
        "world/go_to_human.py",
        "level == InteractionLevel.HUMAN_FACES or",
        "",
        "go_to_human",
    ),
    Mutation(
        "success at any distance",
        "world/go_to_human.py",
        "return is_appropriate(scene.distance) and",
        "return",
        "go_to_human",
    ),
    Mutation(
        "gesture steps are paid",
        GESTURES,
        "        and scene.human_action != Action.STAY\n        and scene.human_action % N_DIRECTIONS == direction",
        "        and True",
        "social",
    ),
    Mutation(
        "the new desired direction is judged",
        "world/social.py",
        "reward = 1.0 if follows_in_direction(after, scene.desired_direction)",
        "reward = 1.0 if follows_in_direction(after, random_direction(random))",
        "social",
    ),
    Mutation(
        "teleports who is engaged",
        "world/social.py",
        " and scene.engagement == Engagement.NONE:",
        ":",
        "social",
    ),
    Mutation("teleports too far", "world/social.py", "VISION_SPEED = 2", "VISION_SPEED = 3", "social"),
    Mutation(
        "the old goal may come again",
        "world/visit.py",
        "        if room != goal_room:\n            others += 1",
        "        if True:\n            others += 1",
        "visit",
    ),
    Mutation(
        "the robot's room is paid",
        "world/visit.py",
        "rooms[after.human_row, after.human_col]",
        "rooms[after.robot_row, after.robot_col]",
        "visit",
    ),
]

MUTATIONS += [
    # Walls
    Mutation(
        "a diagonal step needs one way round only",
        "world/walls.py",
        "{(cell, ahead), (cell, beside), (ahead, there), (beside, there)}",
        "{(cell, ahead), (ahead, there)}",
        "navigation",
        SMALL,
    ),
    Mutation(
        "one cell in lower case makes a doorway",
        LAYOUT,
        "if all(letter.islower() for letter in letters):",
        "if any(letter.islower() for letter in letters):",
        "navigation",
        SMALL,
    ),
    Mutation(
        "trials begin in cells that no way leads to",
        LAB,
        "walls.starts[random_below(random, len(walls.starts))]",
        "random_below(random, rows * cols)",
        "navigation",
        SMALL,
    ),
    Mutation("goals in rooms that no way leads to", LAYOUT, " and room in within]", "]", "navigation", SMALL),
    Mutation("the corridor is a goal", LAYOUT, "letter not in corridor and", "", "navigation", ("corridor",)),
    Mutation(
        "a goal that is out of reach now carries over",
        "world/visit.py",
        "elif not is_goal(world, goal_room):",
        "elif False:",
        "visit",
        PHASES,
    ),
    # Sight
    Mutation("walls are of glass", SCENE, "if not visible:", "if False:", "go_to_human", SMALL),
    Mutation("the level is that of glass", SCENE, "elif visible:", "elif True:", "go_to_human", SMALL),
    Mutation(
        "out of sight the distance is wide, so that nobody is lost",
        SCENE,
        "distance = TOO_FAR",
        "distance = TOO_FAR - 1",
        "visit",
        ("nine rooms",),
    ),
    Mutation(
        "sight passes where one side of a corner is free",
        SIGHT,
        "row_border <= col_border",
        "row_border < col_border",
        "go_to_human",
        SMALL,
    ),
    Mutation(
        "sight goes from the north only",
        SIGHT,
        "found[first + down, second + right, first, second] = along",
        "pass",
        "go_to_human",
        SMALL,
    ),
    Mutation(
        "sight passes doors that are shut",
        SIGHT,
        "if sight < THROUGH_DOORS:",
        "if True:",
        "go_to_human",
        SMALL,
    ),
    # Doors
    Mutation(
        "moves pass doors that are shut",
        LAB,
        "steps = before_shut(lab.doors, row, col, direction, steps, open_doors)",
        "",
        "navigation",
        SMALL,
    ),
    Mutation(
        "the human passes doors that are shut",
        HUMAN,
        "moved(lab, body, human_action, scene.open_doors)",
        "moved(lab, body, human_action, -1)",
        "visit",
        SMALL,
    ),
    Mutation("doors never toggle", SCENE, "toggled(lab, last.open_doors, random))", "last.open_doors)", "visit", DOORS),
    Mutation(
        "doors toggle half as often",
        LAB,
        "happens(random, doors.chances[door])",
        "happens(random, doors.chances[door] * 0.5)",
        "navigation",
        SMALL,
    ),
    Mutation("doors are shut only", LAB, "open_doors ^= 1 << door", "open_doors &= ~(1 << door)", "navigation", SMALL),
    Mutation("doors toggle together", LAB, "open_doors ^= 1 << door", "open_doors ^= 3", "navigation", SMALL),
    Mutation(
        "closed doors are open at first where they toggle",
        LAB,
        " - sum(1 << door for door in shut)",
        "",
        "navigation",
        DOORS,
    ),
    Mutation(
        "trials begin behind doors that may be shut",
        LAYOUT,
        "never = {*closed, *toggling}",
        "never = {*closed}",
        "navigation",
        SMALL,
    ),
]


def apply(mutation: Mutation, package_copy_dir: Path) -> None:
    """Change one line of a copy of the package; `package_copy_dir` is the folder visitlab_cli of the copy."""
    file = package_copy_dir / mutation.file
    text = file.read_text(encoding="utf-8")
    count = text.count(mutation.old)
    assert count == 1, f"{mutation.name}: {mutation.old!r} occurs {count} times in {mutation.file}, not once"
    file.write_text(text.replace(mutation.old, mutation.new), encoding="utf-8")
