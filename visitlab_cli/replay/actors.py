"""Robot and human: bodies with headings, paths, what the human sees, speech bubbles, the desired direction."""

import numpy as np
import numpy.typing as npt
import rerun as rr

from visitlab_cli.replay.lab import FACES, NOTHING, SEES
from visitlab_cli.replay.lettering import strokes, width_of
from visitlab_cli.replay.stage import Line, Stage
from visitlab_cli.replay.trial import Trial, Vectors
from visitlab_cli.story import DESIRED, GESTURES, HUMAN, INK, ROBOT, Colour, action_name, executed
from visitlab_cli.world.enums import N_DIRECTIONS, Action
from visitlab_cli.world.geometry import (
    BEHIND,
    CIRCLE,
    CLOSEST_APPROPRIATE,
    FACING_FIELD,
    FARTHEST_APPROPRIATE,
    HUNDREDTHS,
    VISUAL_FIELD,
    make_geometry,
)

PALE = {"robot": (244, 190, 150), "human": (150, 196, 226)}
COLOURS = {"robot": ROBOT, "human": HUMAN}
WHITE: Colour = (255, 255, 255)
ORDER_FIELD, ORDER_PATH, ORDER_HUMAN, ORDER_ROBOT, ORDER_SAYS = -22.0, 1.0, 10.0, 20.0, 30.0
TRAIL_STEPS = 8
REACH = 8
"""How far the human's fields are drawn, in cells."""
NEAR_OPACITY, ELSEWHERE_OPACITY = 0.42, 0.14


def draw_robot(stage: Stage) -> None:
    """The robot, a square with an arrow, and where it has been."""
    trial = stage.trial
    places, ahead = trial.places("robot"), trial.headings("robot_heading")
    _draw_path(stage, "robot", places)
    outline = [_square(place, way, 0.52, INK) for place, way in zip(places, ahead, strict=True)]
    body = [_square(place, way, 0.44, ROBOT) for place, way in zip(places, ahead, strict=True)]
    stage.lines("robot/outline", outline, ORDER_ROBOT)
    stage.lines("robot/body", body, ORDER_ROBOT + 1)
    _draw_arrow(stage, "robot/heading", places + 0.45 * ahead, 1.25 * ahead, ROBOT, ORDER_ROBOT)
    words = [action_name(trial.steps, step) if step else "" for step in range(trial.length)]
    stage.columns("robot/place", rr.Points2D.columns(positions=places, labels=words))
    stage.fixed(
        "robot/place", rr.Points2D.from_fields(radii=0.15, colors=WHITE, show_labels=False, draw_order=ORDER_SAYS)
    )


def draw_human(stage: Stage) -> None:
    """The human from above, shoulders and head, and where it has been."""
    trial = stage.trial
    places, ahead = trial.places("human"), trial.headings("human_heading")
    aside = np.stack([-ahead[:, 1], ahead[:, 0]], axis=1)
    _draw_path(stage, "human", places)

    def shoulders(radius: float, colour: Colour) -> list[list[Line]]:
        ends = np.stack([places - 0.5 * aside, places + 0.5 * aside], axis=1)
        return [[Line(line, radius, colour)] for line in ends]

    stage.lines("human/outline", shoulders(0.38, INK), ORDER_HUMAN)
    stage.lines("human/body", shoulders(0.30, HUMAN), ORDER_HUMAN + 1)
    _draw_arrow(stage, "human/heading", places + 0.4 * ahead, 1.05 * ahead, HUMAN, ORDER_HUMAN)
    stage.columns("human/place", rr.Points2D.columns(positions=places))
    stage.fixed("human/place", rr.Points2D.from_fields(radii=0.3, colors=WHITE, draw_order=ORDER_HUMAN + 2))


def draw_fields(stage: Stage) -> None:
    """The human's visual field, 90 degrees to each side, and facing field, 45 (paper, Fig. 3), around the human."""
    trial = stage.trial
    fields, near = fields_around(trial.distances)
    rows, cols = trial.steps["human_row"].astype(int), trial.steps["human_col"].astype(int)
    around = np.arange(-REACH, REACH + 1)
    inside_rows = (rows[:, None] + around >= 0) & (rows[:, None] + around < trial.size)
    inside_cols = (cols[:, None] + around >= 0) & (cols[:, None] + around < trial.size)
    seen = fields[trial.steps["human_heading"].astype(int)] * (inside_rows[:, :, None] & inside_cols[:, None, :])
    stage.cells("human/field/near", seen * near, ORDER_FIELD, NEAR_OPACITY)
    stage.cells("human/field/elsewhere", seen * ~near, ORDER_FIELD, ELSEWHERE_OPACITY)
    corner = np.stack([cols - REACH, rows - REACH, np.zeros_like(rows)], axis=1).astype(np.float32)
    stage.columns("human/field", rr.Transform3D.columns(translation=corner))


def draw_desired_direction(stage: Stage) -> None:
    """An arrow beside the human: where it should go."""
    places, ways = stage.trial.places("human"), stage.trial.headings("desired_direction")
    _draw_arrow(stage, "human/desired", places + 1.2 * ways, 2.2 * ways, DESIRED, ORDER_HUMAN - 1, 0.2)


def draw_gestures(stage: Stage) -> None:
    """A bubble for each gesture; pointing also draws the way that is pointed."""
    trial = stage.trial
    places = trial.places("robot")
    actions = executed(trial.steps)
    bubbles = [
        _bubble(trial, place, GESTURES[Action(action)]) if action in set(GESTURES) else []
        for place, action in zip(places, actions, strict=True)
    ]
    stage.lines("robot/says", bubbles, ORDER_SAYS)
    if trial.has_engagement:
        pointed = np.concatenate([trial.headings("desired_direction")[:1], trial.headings("desired_direction")[:-1]])
        points = [
            [Line(np.stack([place + 0.8 * way, place + 2.6 * way]), 0.1, INK)] if action == Action.POINT else []
            for place, way, action in zip(places, pointed, actions, strict=True)
        ]
        stage.lines("robot/points", points, ORDER_SAYS)


def fields_around(distances: tuple[int, ...]) -> tuple[npt.NDArray[np.uint8], npt.NDArray[np.bool_]]:
    """The cells around a human: their class by its heading, and which are at a distance to interact.

    Shapes (8, 2 REACH + 1, 2 REACH + 1), by heading, row and col, and without the heading.
    """
    geometry = make_geometry(REACH + 1, REACH + 1, distances)
    from_human = np.arange(-REACH, REACH + 1)
    north, east = np.meshgrid(from_human, -from_human, indexing="ij")  # from a robot in that cell to the human
    to_robot = geometry.bearing[north + geometry.reach, east + geometry.reach] + BEHIND
    category = geometry.distance[north + geometry.reach, east + geometry.reach]
    turn = (np.arange(N_DIRECTIONS)[:, None, None] * HUNDREDTHS - to_robot) % CIRCLE
    turn = np.minimum(turn, CIRCLE - turn)
    fields = np.where(turn <= FACING_FIELD, FACES, np.where(turn <= VISUAL_FIELD, SEES, NOTHING))
    fields[:, REACH, REACH] = NOTHING
    near = (category >= CLOSEST_APPROPRIATE) & (category <= FARTHEST_APPROPRIATE)
    return fields.astype(np.uint8), near


def _draw_path(stage: Stage, who: str, places: Vectors) -> None:
    """The whole way so far, pale, and the last steps of it in full colour."""
    steps = range(len(places))
    path = [[Line(places[: step + 1], 0.06, PALE[who])] if step else [] for step in steps]
    trail = [
        [Line(places[max(0, step - TRAIL_STEPS) : step + 1], 0.075, COLOURS[who])] if step else [] for step in steps
    ]
    stage.lines(f"{who}/path", path, ORDER_PATH)
    stage.lines(f"{who}/trail", trail, ORDER_PATH + 1)


def _draw_arrow(
    stage: Stage, entity: str, origins: Vectors, vectors: Vectors, colour: Colour, order: float, radius: float = 0.12
) -> None:
    stage.columns(entity, rr.Arrows2D.columns(origins=origins, vectors=vectors))
    stage.fixed(entity, rr.Arrows2D.from_fields(colors=colour, radii=radius, draw_order=order))


def _square(place: Vectors, way: Vectors, radius: float, colour: Colour) -> list[Line]:
    """A rounded square that looks along `way`."""
    aside = np.array([-way[1], way[0]], np.float32)
    corners = [place + 0.5 * radius * (a * way + b * aside) for a, b in ((-1, -1), (-1, 1), (1, 1), (1, -1), (-1, -1))]
    return [Line(np.stack(corners), radius / 2, colour)]


def _bubble(trial: Trial, place: Vectors, text: str) -> list[Line]:
    """A speech bubble above the robot, or below it at the northern border."""
    height, padding = 0.75, 0.62
    half = width_of(text, height) / 2
    up = -1.0 if place[1] > 3 else 1.0
    middle = np.array([np.clip(place[0], half + padding, trial.size - half - padding), place[1] + 2.2 * up])
    aside, towards = np.array([half, 0]), np.array([0, 0.8 * up])
    base = np.stack([middle - aside, middle + aside])
    tail = np.stack([place + towards, middle])
    drawn = [Line(base, padding + 0.09, INK), Line(tail, 0.16, INK), Line(base, padding, WHITE)]
    return drawn + [Line(stroke, 0.085, INK) for stroke in strokes(text, (middle[0], middle[1]), height)]
