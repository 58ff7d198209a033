"""Small runs of the paper's own configs, made by the real program; not to be changed."""

from pathlib import Path

import pytest

from tests.program import the_run, visitlab
from tests.shared import made_once

CONFIGS = Path(__file__).parents[1] / "configs"
SEEDS = 2
SMALL = [
    f"seeds={SEEDS}",
    "experiments.navigation.steps=2000",
    "experiments.go_to_human.steps=2000",
    "experiments.social_humans.steps=2000",
    "experiments.visit.trials=12",
]
UNTIL = 600
SMALL_PAPER = [
    *SMALL,
    "experiments.social.steps=2000",
    "experiments.navigation_observed.steps=2000",
    "experiments.social_reference.steps=2000",
    "experiments.social_humans_reference.steps=2000",
    "experiments.visit_script.trials=2",
    "experiments.visit_chance.trials=2",
    f"agents.mf_after_mb.until={UNTIL}",
    "agents.mf_watching_mb.until=2000",
    "agents.mf_watching_rmax.until=2000",
]


def made(factory, name, config, overrides):
    def make(out):
        done = visitlab("run", CONFIGS / config, *overrides, "--out", out, "--workers", 2, "--quiet")
        assert done.returncode == 0, done.stderr

    return the_run(made_once(factory, name, make))


@pytest.fixture(scope="session")
def paper_run(tmp_path_factory):
    """`configs/paper.yaml`, two seeds, every experiment cut short."""
    return made(tmp_path_factory, "paper", "paper.yaml", SMALL_PAPER)


@pytest.fixture(scope="session")
def crossed_run(tmp_path_factory):
    """Two models, two visits of each; no log."""
    return made(tmp_path_factory, "crossed", "paper/variants/fig8_crossed.yaml", SMALL)
