"""A lab with walls, doors that are shut, a solid column and rooms of a few cells, as everything shows it."""

import json
import string
from itertools import combinations

import numpy as np
import pyarrow
import pytest
from rerun.chunk import RrdReader

from tests.program import visitlab
from tests.scene.test_scene import by_role
from tests.scene.test_words import BEGIN, visit
from visitlab_cli.export.foxglove_scene import lab_entities, scene_entities
from visitlab_cli.log.writer import StepRecorder
from visitlab_cli.replay.drawing import LETTERS, SOLID_CELL, _name
from visitlab_cli.replay.lettering import strokes, width_of
from visitlab_cli.replay.recording import record
from visitlab_cli.report.best_trial import plain_place, plain_scene
from visitlab_cli.scene.colours import OPEN, SHUT, WALL, shares
from visitlab_cli.scene.scene import Scene
from visitlab_cli.scene.shapes import Role
from visitlab_cli.scene.sight import FACES, SEES
from visitlab_cli.scene.trial import Trial
from visitlab_cli.scene.words import caption
from visitlab_cli.world.columns import DOORS, PHASES, StepColumns, empty_columns
from visitlab_cli.world.enums import Direction, InteractionLevel
from visitlab_cli.world.geometry import DISTANCES
from visitlab_cli.world.lab import ALL_OPEN, names_of_shut, sees, walls_of
from visitlab_cli.world.layout import Layout
from visitlab_cli.world.tasks import VISIT

MAP = """
AAAAAAABBBBB#
AAAAAAABBBBB#
AAAAAAabBBBB#
AAAaAAABBbBB#
CCCcCCCDDddeE
CCCCCCCDDDdeE
CCCCCCCDDDDEE
""".strip("\n")
LAYOUT = Layout(MAP)
SHUT_DOOR = {"closed": ["AC"], "toggling": {"BD": 0.5}}
HERE = {"human_row": 2, "human_col": 3, "robot_row": 2, "robot_col": 5}


def shown(tmp_path, *rows, doors=ALL_OPEN, **more):
    """A visit in the lab with one door shut for good; of others `doors` are open."""
    steps = visit(BEGIN | HERE | {"goal_room": 1}, *(HERE | {"goal_room": 1} | row for row in rows))
    headings = {f"{who}_heading": np.full(len(steps["step"]), Direction.SOUTH) for who in ("robot", "human")}
    steps = {**steps, **headings, "open_doors": np.full(len(steps["step"]), doors), **more}
    return Trial(tmp_path, "visit", VISIT, 0, steps, LAYOUT.lab(**SHUT_DOOR), DISTANCES)


def test_a_door_that_is_shut_for_good_is_told_from_walls(tmp_path):
    lab, opened = LAYOUT.lab(**SHUT_DOOR), LAYOUT.lab(toggling={"BD": 0.5})
    assert walls_of(lab) == walls_of(opened)
    assert (names_of_shut(lab, 0), names_of_shut(lab, 1)) == (["AC", "BD"], ["AC"])
    for doors, names in ((0, ["AC", "BD"]), (1, ["AC"])):
        trial = shown(tmp_path, doors=doors)
        shut = by_role(Scene(trial).place())[Role.SHUT]
        assert {shape.style.colour for shape in shut} == {SHUT}
        assert len(shut) == len(names)
        place = plain_place(trial)
        assert place["shut"] == [shape.points.tolist() for shape in shut]
        assert place["closed"] == names
        assert caption(trial.steps, 0, trial.lab).startswith(f"the trial begins, doors shut: {', '.join(names)}; ")
        (floor,) = lab_entities(Scene(trial))
        brown = [cube for cube in floor["cubes"] if tuple(cube["color"][part] for part in "rgb") == shares(SHUT)]
        assert len(brown) == len(names)


def test_where_rooms_pass_into_each_other_is_no_border(tmp_path):
    place = by_role(Scene(shown(tmp_path, doors=1)).place())
    assert not any(room.style.width for room in place[Role.ROOM])
    assert {shape.style.colour for shape in place[Role.OPEN]} == {OPEN}
    ends = [shape.points.tolist() for shape in place[Role.OPEN]]
    assert [[7, 2], [7, 3]] in ends
    assert not any(shape.points.tolist() in ends for shape in (*place[Role.SHUT], *place[Role.WALL]))


def test_sight_ends_at_walls_wherever_it_is_drawn(tmp_path):
    trial = shown(tmp_path)
    scene = Scene(trial)
    (sight,) = by_role(scene.moment(0))[Role.SIGHT]
    drawn = {
        kind: {(x + cell, y) for x, y, n in sight.rows_of_cells(kind) for cell in range(n)} for kind in (SEES, FACES)
    }
    assert drawn[FACES]
    for x, y in drawn[SEES] | drawn[FACES]:
        assert sees(trial.lab, 2, 3, y, x, ALL_OPEN), "behind a wall"
        assert np.hypot(x - 3, y - 2) <= sight.radius
    assert {y for _, y in drawn[FACES]} == {3}, "the door in the south is shut"
    told = plain_scene(trial)
    assert [told["seen"][place] for place in told["cells"]] == [
        [list(map(list, sight.rows_of_cells(kind))) for kind in (SEES, FACES)]
    ]
    entities = {entity["id"]: entity for entity in scene_entities(scene, 0)}
    assert len(entities["what the human sees"]["cubes"]) == sum(map(len, told["seen"][0]))
    assert "lines" not in entities["human"] or not entities["human"]["lines"], "no sector through walls"


def test_every_letter_and_digit_is_drawn_and_none_like_another():
    drawn = {letter: strokes(letter, (1, 2), 4) for letter in string.ascii_uppercase + string.digits}
    assert all(drawn.values())
    texts = {letter: str([stroke.tolist() for stroke in lines]) for letter, lines in drawn.items()}
    alike = {pair for pair in combinations(texts, 2) if texts[pair[0]] == texts[pair[1]]}
    assert alike == {("O", "0")}
    for lines in drawn.values():
        assert all(((stroke >= 0) & (stroke <= (2, 4))).all() for stroke in lines)


def test_a_name_stays_in_its_room(tmp_path):
    rooms = by_role(Scene(shown(tmp_path)).place())[Role.ROOM]
    for room in rooms:
        points = np.concatenate(_name(room))
        assert (points >= room.corner).all()
        assert (points <= room.corner + room.size).all()
    assert [room.name(lambda words: width_of(words, LETTERS), 0.4) for room in rooms] == [
        "Room A",
        "Room B",
        "Room C",
        "Room D",
        "E",
    ]
    assert rooms[-1].name(lambda words: 5.0) == ""


def test_solid_cells_are_filled_in_the_viewer(tmp_path):
    file = tmp_path / "trial.rrd"
    file.write_bytes(record(shown(tmp_path, {})))
    found = {}
    for chunk in RrdReader(file).stream().to_chunks():
        batch = chunk.to_record_batch()
        for name in batch.schema.names:
            if not pyarrow.types.is_temporal(batch.schema.field(name).type):
                found[str(chunk.entity_path), name] = batch.column(name).to_pylist()
    cells = np.frombuffer(bytes(found["/lab/solid", "SegmentationImage:buffer"][0][0]), np.uint8).reshape(7, 13)
    assert ((cells == SOLID_CELL) == [[letter == "#" for letter in line] for line in MAP.splitlines()]).all()
    classes = str(found["/", "AnnotationContext:context"])
    red, green, blue = WALL
    assert str((red << 24) + (green << 16) + (blue << 8) + 255) in classes


def test_the_strip_keeps_words_off_bodies_and_names_within_rooms(tmp_path):
    pytest.importorskip("matplotlib")
    from visitlab_cli.replay.strip import draw_strip

    corner = {"robot_row": 6, "robot_col": 11, "interaction_level": InteractionLevel.GREETED}
    figure = draw_strip(shown(tmp_path, {"interaction_level": 1}, {}, corner), [1, 3])
    figure.canvas.draw()
    first, second = (axes for axes in figure.axes if axes.axison)
    sides = [[text.get_ha() for text in axes.texts if text.get_weight() == "bold"] for axes in (first, second)]
    assert sides == [["right"], ["left"]]
    rooms = {text.get_text(): text for text in first.texts if text.get_color() == "0.6" and text.get_text()}
    assert set(rooms) == {"Room A", "Room B", "Room C", "Room D", "E"}
    for text, area in zip(rooms.values(), by_role(Scene(shown(tmp_path)).place())[Role.ROOM], strict=True):
        right = first.transData.transform(area.corner + area.size)[0]
        assert text.get_window_extent().x1 < right


def test_the_key_lists_what_is_on_the_strip_and_names_shut_doors(tmp_path):
    pytest.importorskip("matplotlib")
    from visitlab_cli.replay.strip import draw_strip

    wanted = {f"wanted_{who}_{axis}": np.full(2, 1) for who in ("robot", "human") for axis in ("row", "col")}
    plans = {**wanted, "plan_leads": np.zeros(2, np.bool_)}
    (key,) = draw_strip(shown(tmp_path, {}, doors=0, **plans), [0, 1]).legends
    labels = [text.get_text() for text in key.get_texts()]
    assert "shut door: AC, BD" in labels
    assert not [label for label in labels if "plan" in label or "reached" in label]
    leads = shown(tmp_path, {"reward": 1}, **{**plans, "plan_leads": np.ones(2, np.bool_)})
    (key,) = draw_strip(leads, [0, 1]).legends
    labels = [text.get_text() for text in key.get_texts()]
    assert {"where the plan wants the robot", "where the plan wants the human", "just reached"} <= set(labels)


CONFIG = f"""
labs:
  house: {{map: {json.dumps(MAP)}}}
  shut: {{like: house, map: {json.dumps(MAP)}, closed: [AC]}}
experiments:
  navigation:
    task: navigation
    lab: house
    phases: [{{trials: 1}}, {{trials: 1, lab: shut}}, {{trials: 1, lab: shut, doors: {{AC: 0.5, BD: 0.5}}}}]
""".replace("like: house, ", "")


@pytest.fixture(scope="module")
def log(tmp_path_factory):
    """Three trials of navigation, in a lab, with a door shut for good, and with doors that toggle, the second open."""
    steps: StepColumns = empty_columns(6)
    steps.trial[:] = steps.phase[:] = [0, 0, 1, 1, 2, 2]
    steps.step[:] = [0, 1] * 3
    steps.open_doors[:] = [ALL_OPEN] * 4 + [0b10] * 2
    path = tmp_path_factory.mktemp("log") / "steps.mcap"
    about = {"version": "0.1.0", "cell": "navigation/rmax/seed-0000", "seed": "0"}
    with StepRecorder(
        path, "navigation", attributes=about, config_yaml=CONFIG.encode(), parts=(PHASES, DOORS)
    ) as recorder:
        recorder.write(steps, 6)
    return path


@pytest.mark.parametrize(
    ("trial", "phase", "shut"),
    [
        (0, "phase 0", []),
        (1, "phase 1 (lab shut)", ["AC"]),
        (2, "phase 2 (doors AC 0.5, BD 0.5)", ["AC"]),
    ],
)
def test_steps_says_which_doors_are_shut(log, trial, phase, shut):
    told = visitlab("steps", log, "--trial", str(trial))
    head, _, _, first, _ = told.stdout.splitlines()
    assert head.endswith(f"trial {trial}, {phase}")
    assert ("doors shut" in first) == bool(shut)
    assert first.endswith(
        ", ".join(["the trial begins", f"in phase {trial}", *(f"doors shut: {door}" for door in shut)])
    )
    plain = json.loads(visitlab("steps", log, "--trial", str(trial), "--json").stdout)
    assert (plain["phase"], plain["doors_shut"]) == (phase, shut)
