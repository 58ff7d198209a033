"""`visitlab labs`: what a config's labs are, in words, in characters, as a picture."""

import json

import pytest

from tests.program import visitlab
from visitlab_cli.origin import is_ours
from visitlab_cli.scene.lab_in_text import lab_in_text
from visitlab_cli.world.layout import Layout

DRAWN = """ _______
|  A    |
|__= __=|
|  B ___|
|___|#_#|"""
CONFIG = """
name: labs
labs:
  nine: {rooms: 3 x 3, walls: between}
  map: {corridor: Z, map: "AAa\\nZzz\\nbBB", closed: [AZ]}
agents: {mf: {kind: q_learning}}
experiments: {navigation: {task: navigation, agents: [mf], lab: nine, steps: 20}}
""".replace("AAa\\nZzz\\nbBB", "AAa\\nzZz\\nbBB")


def test_a_lab_in_characters():
    layout = Layout("AAAA\nAaAa\nBbBb\nBB##")
    assert lab_in_text(layout.lab(closed=["AB"], toggling={"AB": 0})) == DRAWN
    assert lab_in_text(layout.lab()) == DRAWN.replace("=", ".")


@pytest.fixture
def config(tmp_path):
    file = tmp_path / "labs.yaml"
    file.write_text(CONFIG.replace("closed: [AZ]", "closed: []"))
    return file


def test_the_labs_of_a_config_are_told_and_drawn(config, tmp_path):
    picture = tmp_path / "labs.png"
    done = visitlab("labs", config, "--picture", picture)
    assert done.returncode == 0, done.stderr
    assert "paper: 24 x 24 cells, 9 rooms (0, 1, 2, 3, 4, 5, 6, 7, 8); doors: none, nor walls" in done.stdout
    assert "map: 3 x 3 cells, 3 rooms (A, Z, B), never goals: Z; doors: AZ, BZ" in done.stdout
    assert is_ours(picture)
    told = json.loads(visitlab("labs", config, "labs.nine.closed=[BE]", "--lab", "nine", "--json").stdout)
    (nine,) = told["labs"]
    assert (nine["name"], nine["rows"], nine["cols"], nine["goals"]) == ("nine", 24, 24, list("ABCDEFGHI"))
    assert nine["doors"]["BE"] == {"cells": 2, "shut": True}
    assert nine["map"].splitlines()[7] == "AAAaaAAABBBbbBBBCCCccCCC"


def test_what_validate_shows_is_still_yaml_and_has_the_lab_in_it(config):
    done = visitlab("validate", config, "--show")
    assert "# lab nine:" in done.stdout
    config.write_text(done.stdout)
    assert visitlab("validate", config).returncode == 0


@pytest.mark.parametrize(
    ("words", "code", "line"),
    [
        (["--lab", "nien"], 5, "--lab nien: no lab is called so; did you mean nine?"),
        (["--picture", "x.bmp"], 2, "--picture x.bmp: must end in .svg, .png, .pdf"),
    ],
)
def test_what_can_not_be_done_is_a_line(config, words, code, line):
    done = visitlab("labs", config, *words)
    assert (done.returncode, done.stdout, done.stderr.count("\n")) == (code, "", 1)
    assert line in done.stderr
