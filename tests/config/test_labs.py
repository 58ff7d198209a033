"""Labs as a config says them: maps and rows of rooms, in text and in files, and each mistake with its place."""

import json

import pytest

from tests.config.lab import LAB, edited
from visitlab_cli.config.canonical import canonical, config_hash, dump_yaml
from visitlab_cli.config.experiment import lab_of
from visitlab_cli.config.loading import load, load_text
from visitlab_cli.errors import ConfigError
from visitlab_cli.plan.cells import plan
from visitlab_cli.world.lab import goals_of, room_names, starts_of

LABS = """labs:
  nine: {rooms: 3x3, size: 8 x 8, walls: between}
  closed: {like: nine, closed: [EB]}
  small:
    corridor: Z
    map: |
      AAaAA
      ZZzzZ
      BBBbB
"""
IN_NINE = LAB.replace("navigation, agents: [rmax, mf]", "navigation, lab: nine, agents: [rmax, mf]").replace(
    "task: visit", "task: visit\n    lab: nine"
)


def read(text, name="lab.yaml"):
    return load_text(LABS + text, name)


def test_a_config_with_labs_is_written_as_it_is_read():
    config = read(IN_NINE)
    plain = canonical(config)
    assert plain["labs"]["nine"] == {
        "closed": [], "rooms": "3 x 3", "size": "8 x 8", "walls": "between", "doorway": 2,
    }  # fmt: skip
    assert plain["labs"]["closed"]["closed"] == ["BE"]
    assert plain["labs"]["small"]["map"] == "AAaAA\nZZzzZ\nBBBbB"
    assert plain["experiments"]["visit"]["goal_rooms"] == "all"
    again = load_text(dump_yaml(config), "again.yaml")
    assert again == config
    assert config_hash(again) == config_hash(config)


def test_of_labs_that_nobody_plays_in_nothing_changes_but_the_hash():
    cells = {cell.path for cell in plan(read(LAB))}
    assert cells == {cell.path for cell in plan(load_text(LAB, "lab.yaml"))}
    assert lab_of(read(LAB).experiments["visit"]) is lab_of(load_text(LAB, "lab.yaml").experiments["visit"])


def test_rooms_are_numbered_as_they_first_appear_and_named_by_their_letters():
    config = read(LAB.replace("task: go_to_human", "task: go_to_human, lab: small"))
    lab = lab_of(config.experiments["go_to_human"])
    assert room_names(lab) == ("A", "Z", "B")
    assert (lab.rows, lab.cols, lab.n_rooms) == (3, 5, 3)
    assert goals_of(lab) == (0, 2)
    assert len(starts_of(lab)) == 15


def test_the_paper_lab_has_numbers_and_goal_rooms_may_be_letters_elsewhere():
    in_nine = IN_NINE.replace("humans: [human_2]\n", "humans: [human_2]\n    goal_rooms: [A, 4, I]\n")
    assert read(in_nine).experiments["visit"].goal_rooms == (0, 4, 8)
    assert load_text(LAB, "lab.yaml").experiments["visit"].goal_rooms == tuple(range(9))
    everything = IN_NINE.replace("humans: [human_2]\n", f"humans: [human_2]\n    goal_rooms: {list('ABCDEFGHI')}\n")
    assert config_hash(read(everything)) == config_hash(read(IN_NINE))


def test_a_map_in_a_file_is_as_its_text_wherever_the_file_lies(tmp_path, monkeypatch):
    (tmp_path / "maps").mkdir()
    (tmp_path / "maps" / "small.txt").write_bytes("\ufeffAAaAA\r\nZZzzZ\r\nBBBbB\r\n".encode())
    file = tmp_path / "lab.yaml"
    begin, end = LABS.split("    map: |")[0], LAB
    file.write_text(f"{begin}    map: maps/small.txt\n{end}")
    monkeypatch.chdir("/")
    assert config_hash(load(file)) == config_hash(read(LAB))
    (tmp_path / "maps" / "small.txt").write_text("AAaAA\nZZzz\nBBBbB\n")
    with pytest.raises(ConfigError) as told:
        load(file)
    assert str(told.value) == (
        f"{tmp_path}/maps/small.txt:2:5: labs.small.map: 4 cells; the first row has 5, and all have the same"
    )
    (tmp_path / "maps" / "small.txt").unlink()
    with pytest.raises(ConfigError, match=r"lab\.yaml:6:10: labs\.small\.map: .*maps/small\.txt: no such file"):
        load(file)


def test_of_a_map_that_can_not_be_read_nothing_else_is_said(folder, complaint):
    labs = "labs:\n  house: {map: house.txt, corridor: Z}\n  shut: {like: house, closed: [AZ]}\n"
    phases = "phases: [{trials: 1, human: human_2, lab: shut}, {trials: 1, human: human_2, doors: {BZ: 0.1}}]"
    text = LAB.replace("task: visit", "task: visit\n    lab: house\n    goal_rooms: [A, C]").replace(
        "humans: [human_2]\n", f"{phases}\n"
    )
    missing = "lab.yaml:2:16: labs.house.map: house.txt: no such file or directory"
    assert complaint(labs + text) == [missing]
    wrong = labs.replace("[AZ]", "[A]").replace("corridor: Z", "corridor: ZZ")
    told = complaint(wrong + text.replace("lab: shut", "lab: shtu"))
    assert [line.split(": ")[1] for line in told] == [
        "labs.house.map",
        "labs.house.corridor",
        "labs.shut.closed.0",
        "experiments.visit.phases.0.lab",
    ]


@pytest.mark.parametrize(
    ("written", "line"),
    [
        ("m", "fewer than two rooms; a goal must have another one to follow it; 'm' is read as the map itself; is a"),
        ("house", "'house' is read as the map itself; is a file meant? its name has a dot or a slash"),
        ("ab, corridor: Z", "no room is called Z; there are A, B; 'ab' is read as the map itself; is a file meant?"),
        ("''", "must be a map, or the file in which it is (got '')"),
        ("AAabBB AAabBB", "no such file or directory; for a map as text write | before it"),
        (
            '"AAabBB AAabBB\\n"',
            "column 7 of it: ' '; a cell is a letter, its room's, or #, solid; for a map as text write |",
        ),
    ],
)
def test_what_is_no_map_is_told_what_it_was_read_as(complaint, written, line):
    (told,) = complaint(f"labs:\n  house: {{map: {written}}}\n{LAB}")
    assert line in told


def test_a_map_that_an_override_names_lies_where_the_user_is(folder, loaded, complaint, monkeypatch):
    (folder / "maps").mkdir()
    (folder / "maps" / "two.txt").write_text("ab\n")
    text = f"labs:\n  house: {{map: AAaB}}\n{LAB}"
    assert loaded(text, ["labs.house.map=maps/two.txt"]).labs["house"].map == "ab"
    monkeypatch.chdir(folder / "maps")
    assert load(folder / "lab.yaml", ["labs.house.map=two.txt"]).labs["house"].map == "ab"
    with pytest.raises(ConfigError, match="labs.house.map: maps/two.txt: no such file"):
        load(folder / "lab.yaml", ["labs.house.map=maps/two.txt"])


WRONG_MAPS = {
    "ragged": ("AAB\nAB", "7:9", "2 cells; the first row has 3"),
    "another letter": ("AAB\nA?B", "7:8", "'?'; a cell is a letter, its room's, or #, solid"),
    "one room": ("AAA\nAAA", "6:7", "fewer than two rooms"),
    "no way": ("AAAB\nAAAB", "6:10", "no way leads from A to B"),
    "a doorway to nowhere": ("AAaB\nabBB\nAAAB", "6:9", "a is the cell of a doorway (lower case)"),
}


def wrong(lines):
    body = "".join(f"      {line}\n" for line in lines.split("\n"))
    return LABS.split("      AAaAA")[0].replace("    corridor: Z\n", "") + body + LAB


@pytest.mark.parametrize(("text", "place", "line"), WRONG_MAPS.values(), ids=WRONG_MAPS)
def test_what_is_wrong_with_a_map_is_told_at_its_line_and_column(text, place, line):
    with pytest.raises(ConfigError) as told:
        load_text(wrong(text), "lab.yaml")
    first = str(told.value).splitlines()[0]
    row, column = place.split(":")
    assert first.startswith(f"lab.yaml:{row}:{column}: labs.small.map: {line}"), first


def test_a_doorway_that_two_doors_make_by_accident_is_refused():
    with pytest.raises(ConfigError) as told:
        load_text(wrong("AAAab\nAAAcb\nCCCcB\nCCCCB"), "lab.yaml")
    assert "lie so close that" in str(told.value)
    assert "opens, too; move one of them" in str(told.value)


@pytest.mark.parametrize(
    ("old", "new", "line"),
    [
        ("closed: [EB]", "closed: [AE]", "3:32: labs.closed.closed: no door is called AE; there are AB, AD, BC, BE,"),
        ("closed: [EB]", "closed: [E]", "3:33: labs.closed.closed.0: must be a door: the letters of its two rooms"),
        ("rooms: 3x3", "rooms: 3", "2:17: labs.nine.rooms: must be two whole numbers, as in 3 x 3"),
        ("rooms: 3x3", "rooms: 6 x 6", "2:17: labs.nine.rooms: at most 26 rooms (got 36)"),
        ("size: 8 x 8", "size: 30 x 8", "2:28: labs.nine.size: at most 64 x 64 cells in all (got 90 x 24)"),
        ("walls: between", "walls: between, doorway: 9", "2:60: labs.nine.doorway: wider than a room's side, 8 cells"),
        ("  nine:", "  paper: {rooms: 2 x 2}\n  nine:", "2:3: labs.paper: is the paper's lab, which is always there"),
        ("corridor: Z", "corridor: Q", "5:15: labs.small.corridor: no room is called Q; there are A, Z, B"),
        ("corridor: Z", "corridor: ZA", "5:15: labs.small.corridor: leaves fewer than two rooms that can be goals"),
    ],
)
def test_what_is_wrong_with_a_lab_is_a_line(old, new, line):
    with pytest.raises(ConfigError) as told:
        load_text(LABS.replace(old, new, 1) + LAB, "lab.yaml")
    assert str(told.value).splitlines()[0].startswith(f"lab.yaml:{line}"), str(told.value)


@pytest.mark.parametrize(
    ("old", "new", "line"),
    [
        ("lab: nine, agents", "lab: nien, agents", "no lab is called nien; did you mean nine?"),
        (
            "task: visit\n    lab: nine",
            "task: visit\n    lab: small",
            "was trained in nine, whose cells, rooms or corridor",
        ),
        (
            "humans: [human_2]\n",
            "humans: [human_2]\n    goal_rooms: [A, Q]\n",
            "no room is called Q; there are A, B, C",
        ),
        ("humans: [human_2]\n", "humans: [human_2]\n    goal_rooms: [A, 0]\n", "has A twice, as 0 and as its letter"),
        ("humans: [human_2]\n", "humans: [human_2]\n    goal_rooms: [A, 9]\n", "must be less than 9 (got 9)"),
        ("task: social", "task: social, lab: nine", "experiments.social.lab: unknown"),
    ],
)
def test_what_does_not_fit_a_lab_is_a_line(old, new, line):
    with pytest.raises(ConfigError) as told:
        read(IN_NINE.replace(old, new, 1))
    assert line in str(told.value)


PHASED = IN_NINE.replace("humans: [human_2]\n", "PHASES\n")


@pytest.mark.parametrize(
    ("phases", "line"),
    [
        ("{trials: 2, human: human_2, lab: nien}", "phases.0.lab: no lab is called nien; did you mean nine?"),
        ("{trials: 2, human: human_2, lab: small}", "phases.0.lab: has other cells, rooms or corridor than nine"),
        ("{trials: 2, human: human_2, doors: {AE: 0.1}}", "phases.0.doors.AE: no door is called AE; in nine there are"),
        ("{trials: 2, human: human_2, doors: {BE: 2}}", "phases.0.doors.BE: must be at most 1"),
        ("{trials: 2, human: human_2, doors: {}}", "phases.0.doors: must have at least 1 entry"),
    ],
)
def test_what_does_not_fit_a_phase_is_a_line(phases, line):
    with pytest.raises(ConfigError) as told:
        read(PHASED.replace("PHASES", f"phases: [{phases}]"))
    assert line in str(told.value)


def test_a_phase_may_leave_no_fewer_than_two_goal_rooms():
    shut = ", ".join(f"{door}: 0.5" for door in ("AB", "AD"))
    chosen = "goal_rooms: [A, I]\n    phases: [{trials: 2, human: human_2, doors: {DOORS}}]".replace("DOORS", shut)
    with pytest.raises(ConfigError, match="while its doors are shut fewer than two goal rooms can be reached"):
        read(PHASED.replace("PHASES", chosen))


def test_what_a_phase_changes_is_what_its_cells_depend_on():
    two = "phases: [{trials: 2, human: human_2}, {trials: 2, human: human_2, lab: closed, doors: {EB: 0.1, DE: 0}}]"
    config = read(PHASED.replace("PHASES", two))
    settings = config.experiments["visit"]
    assert canonical(config)["experiments"]["visit"]["phases"][1]["doors"] == {"BE": 0.1, "DE": 0.0}
    first, second = settings.labs
    assert first is lab_of(settings)
    assert second.doors.begin == 0b10
    assert settings.parts == ("phases", "doors")


@pytest.mark.parametrize("text", ["aabb\n", "aabb\r\n", "aabb", "\naabb", "aabb\n\n"])
def test_a_map_of_one_row_is_one_however_its_line_ends(loaded, text):
    assert loaded(f"labs:\n  row: {{map: {json.dumps(text)}}}\n{LAB}").labs["row"].map == "aabb"


@pytest.mark.parametrize(
    ("labs", "lines"),
    [
        ("{}", ["2:3: labs.l: must have map or rooms"]),
        ("{mapp: ab}", ["2:3: labs.l: must have map or rooms", "2:7: labs.l.mapp: unknown; did you mean map?"]),
        ("{corridor: Z}", ["2:3: labs.l: must have map or rooms"]),
        ("{map: ab, rooms: 3 x 3}", ["2:16: labs.l.rooms: unknown; known: closed, corridor, like, map"]),
        ("~", ["2:6: labs.l: must be a mapping (got nothing)"]),
        ("5", ["2:6: labs.l: must be a mapping (got 5)"]),
        (
            "{like: paper}",
            [
                "2:13: labs.l.like: the paper's lab has no entry that another could start from; its cells and rooms "
                "are those of rooms: 3 x 3"
            ],
        ),
    ],
)
def test_a_lab_of_no_form_is_told_which_there_are(complaint, labs, lines):
    assert complaint(f"labs:\n  l: {labs}\n{LAB}") == [f"lab.yaml:{line}" for line in lines]


def test_each_lab_is_known_once(complaint):
    text = edited("agents: [rmax, mf], steps: 100", "agents: [rmax, mf], steps: 100, lab: l")
    told = complaint(f"labs:\n  paper: {{rooms: 3 x 3}}\n{text}")
    assert [line.partition("; ")[2] for line in told] == ["choose another name", "known: paper"]
