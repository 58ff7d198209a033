"""Hidden engagement as a config says it: what is written, what depends on it, and each mistake with its line."""

import pytest

from tests.config.lab import LAB
from visitlab_cli.config.canonical import canonical, config_hash, dump_yaml
from visitlab_cli.config.loading import load_text
from visitlab_cli.errors import ConfigError
from visitlab_cli.plan.cells import plan

SOCIAL, VISIT = "humans: [human_1, human_2], steps: 100", "humans: [human_2]\n"
HIDDEN = LAB.replace(SOCIAL, f"{SOCIAL}, observe: geometry, belief: {{parameters: em}}").replace(
    VISIT, f"{VISIT}    observe: geometry\n"
)


def test_it_is_written_as_it_is_read_and_left_out_where_nothing_is_hidden() -> None:
    config = load_text(HIDDEN, "lab.yaml")
    plain = canonical(config)["experiments"]
    assert plain["social"]["observe"] == "geometry"
    assert plain["social"]["belief"] == {"parameters": "em"}
    assert plain["visit"]["observe"] == "geometry"
    assert "belief" not in plain["visit"]
    again = load_text(dump_yaml(config), "again.yaml")
    assert again == config
    assert config_hash(again) == config_hash(config) != config_hash(load_text(LAB, "lab.yaml"))
    assert {cell.parts for cell in plan(config) if cell.experiment == "social"} == {("belief",)}


@pytest.mark.parametrize(
    ("old", "new", "line"),
    [
        (VISIT, f"{VISIT}    belief: {{parameters: em}}\n", "experiments.visit.belief: means nothing here"),
        (VISIT, f"{VISIT}    observe: engagement\n", "experiments.visit.observe: must be levels or geometry"),
        (
            VISIT,
            f"{VISIT}    observe: geometry\n    belief: {{parameters: x}}\n",
            "belief.parameters: must be em or given",
        ),
        ("go_to_human, agents", "go_to_human, observe: geometry, agents", "experiments.go_to_human.observe: unknown"),
    ],
)
def test_each_mistake_has_its_line(old: str, new: str, line: str) -> None:
    with pytest.raises(ConfigError) as told:
        load_text(LAB.replace(old, new, 1), "lab.yaml")
    assert line in str(told.value)
    assert "\n" not in str(told.value)
