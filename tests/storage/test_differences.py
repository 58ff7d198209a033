"""What differs between configs, and which run is nearest."""

import os

import pytest

from visitlab_cli.config.loading import load
from visitlab_cli.errors import RunError
from visitlab_cli.storage.differences import differences, in_words
from visitlab_cli.storage.nearest import nearest_run, news_of
from visitlab_cli.storage.run_folder import open_run, read_versions

LAB = """
name: {name}
seeds: {seeds}
agents: {{mf: {{kind: q_learning, alpha: {alpha}, epsilon: {epsilon}}}}}
experiments: {{navigation: {{task: navigation, agents: [mf], steps: 40}}}}
"""


@pytest.fixture
def lab(tmp_path):
    """A function: the config with these values."""

    def config(name="lab", seeds=1, alpha=0.5, epsilon=0.05):
        file = tmp_path / "lab.yaml"
        file.write_text(LAB.format(name=name, seeds=seeds, alpha=alpha, epsilon=epsilon))
        return load(file)

    return config


@pytest.mark.parametrize(
    ("first", "second", "expected"),
    [
        ({"a": {"b": 1, "c": 2}}, {"a": {"b": 1, "c": 3}}, ["a.c is 3, not 2"]),
        ({"a": [1, 2]}, {"a": [1, 3]}, ["a is [1, 3], not [1, 2]"]),
        ({"a": None}, {}, ["a is missing, not null"]),
        ({}, {"a": {"b": "é"}}, ['a.b is "é", not missing']),
        ({"a": {"b": 1}}, {"a": 1}, ["a is 1, not missing", "a.b is missing, not 1"]),
        ({"a": {}}, {}, []),
    ],
)
def test_every_path_that_differs(first, second, expected):
    assert [str(each) for each in differences(first, second)] == expected
    assert len(differences(second, first)) == len(expected)


def test_missing_is_no_value_in_json():
    found = differences({"a": None, "c": 1}, {"b": 2, "c": 1.5})
    assert [each.as_json("old", "new") for each in found] == [
        {"path": "a", "old": None},
        {"path": "b", "new": 2},
        {"path": "c", "old": 1, "new": 1.5},
    ]


def test_only_a_few_are_told():
    found = differences({}, {f"k{number}": number for number in range(8)})
    assert in_words(found).endswith("k4 is 4, not missing and 3 more")
    assert "more" not in in_words(found[:5])


def test_the_nearest_run_of_the_name(lab, tmp_path):
    out = tmp_path / "runs"
    assert news_of(out, lab()) is None
    far, _ = open_run(out, lab(alpha=0.1, epsilon=0.5), {})
    near, _ = open_run(out, lab(alpha=0.1), {})
    open_run(out, lab(name="other", alpha=0.4), {})
    broken, _ = open_run(out, lab(alpha=0.2), {})
    (broken / "config.yaml").write_text("[")
    found, differing = nearest_run(out, lab(alpha=0.2))
    assert (found, [str(each) for each in differing]) == (near, ["agents.mf.alpha is 0.2, not 0.1"])
    assert nearest_run(out, lab(alpha=0.2, epsilon=0.5))[0] == far
    new = lab(alpha=0.3, seeds=9)
    line = news_of(out, new)
    assert line.startswith(f"{out}/lab-")
    assert line.endswith(f": a new run: unlike {near}, agents.mf.alpha is 0.3, not 0.1")
    open_run(out, new, {})
    assert news_of(out, lab(alpha=0.3, seeds=20)) is None


def test_of_equally_near_runs_the_latest(lab, tmp_path):
    runs = [open_run(tmp_path, lab(alpha=alpha), {})[0] for alpha in (0.1, 0.2, 0.3)]
    for run, time in zip(runs, (5, 9, 7), strict=True):
        os.utime(run, (time, time))
    assert nearest_run(tmp_path, lab(alpha=0.4))[0] == runs[1]


def test_more_seeds_are_no_edit(lab, tmp_path):
    run, _ = open_run(tmp_path, lab(seeds=2), {})
    (run / "config.yaml").write_text((run / "config.yaml").read_text().replace("alpha: 0.5", "alpha: 0.7"))
    with pytest.raises(RunError, match=r"was edited: agents.mf.alpha is 0.7, not 0.5; delete it and do the same again"):
        open_run(tmp_path, lab(seeds=3), {})


def test_versions_are_read_with_care_and_written_anew(lab, tmp_path):
    run, _ = open_run(tmp_path, lab(), {"visitlab": "1"})
    assert read_versions(run) == {"visitlab": "1"}
    for text in ("", "[1]", '{"visitlab": 1}'):
        (run / "versions.json").write_text(text)
        with pytest.raises(RunError, match="versions.json: damaged"):
            read_versions(run)
    (run / "versions.json").unlink()
    open_run(tmp_path, lab(), {"visitlab": "2"})
    assert read_versions(run) == {"visitlab": "2"}
