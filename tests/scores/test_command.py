"""`visitlab score`, end to end on tiny rows: scores by hand, the unplayable, resumption, kinds of others, files."""

import json
import math
import shutil
from statistics import fmean, stdev

import pyarrow.parquet as parquet
import pytest

from tests.program import hashes, only_cells, visitlab
from tests.scores.test_rows import ROWS
from visitlab_cli.origin import is_ours

PLUGIN = ROWS.with_name("knows_all.py")
FAILS = ROWS.parents[1] / "agents" / "plain_q.py"
T_OF_TWO_DEGREES = 4.302653  # 97.5% quantile
SEEDS = 3


def score(out, *words, code=0, rows=ROWS, **options):
    done = visitlab(
        "score", *words, "--rows", rows, "--out", out, "--seeds", SEEDS, "--workers", 1, "--json", **options
    )
    assert done.returncode == code, done.stderr
    return json.loads(done.stdout), done


@pytest.fixture(scope="module")
def out(tmp_path_factory):
    return tmp_path_factory.mktemp("scores")


@pytest.fixture(scope="module")
def learned(out):
    told, _ = score(out, "q_learning")
    return told


def lines(told, agent=0):
    return {line["row"]: line for line in told["agents"][agent]["rows"]}


def run_of(out, name):
    (run,) = out.glob(f"score-{name}-*")
    return run


def rewards(run, path):
    return [
        parquet.read_table(run / path / f"seed-000{seed}" / "trials.parquet")["reward"].to_pylist()
        for seed in (0, 1, 2)
    ]


def by_hand(scores):
    return fmean(scores), T_OF_TWO_DEGREES * stdev(scores) / math.sqrt(len(scores))


def test_a_score_is_the_share_of_the_way_from_random_to_best_with_t_over_seeds(out, learned):
    run, chance = run_of(out, "q_learning"), run_of(out, "random")
    line = lines(learned)["speed"]
    zero = fmean(map(fmean, rewards(chance, "navigation/random")))
    best = 18.078704
    mean, half = by_hand([(fmean(each) - zero) / (best - zero) for each in rewards(run, "navigation/q_learning")])
    assert line["score"]["mean"] == pytest.approx(mean, abs=1e-6)
    assert line["score"]["interval"] == pytest.approx([mean - half, mean + half], abs=1e-5)
    assert (line["n"], line["random"], line["best"]) == (SEEDS, pytest.approx(zero), pytest.approx(best, abs=1e-5))
    assert line["best_is"] == "exact optimum"


def test_a_row_of_several_groups_is_the_mean_of_their_scores_each_with_its_own_best(out, learned):
    run, chance = run_of(out, "q_learning"), run_of(out, "random")
    parts = []
    for path, best, tenth in (("social/{}/fast", 9.83, 10), ("adapting/{}/slow", 8, 2)):
        zero = fmean(fmean(each[-tenth:]) for each in rewards(chance, path.format("random")))
        found = rewards(run, path.format("q_learning"))
        parts.append([(fmean(each[-tenth:]) - zero) / (best - zero) for each in found])
    mean, half = by_hand([fmean(each) for each in zip(*parts, strict=True)])
    line = lines(learned)["both"]
    assert line["score"]["mean"] == pytest.approx(mean)
    assert line["best"] == pytest.approx((9.83 + 8) / 2)
    if half:
        assert line["score"]["interval"] == pytest.approx([mean - half, mean + half], rel=1e-5)


def test_the_json_has_its_rows_its_set_and_what_each_score_is_measured_by(learned):
    assert set(learned) == {"set", "rows", "seeds", "random", "agents"}
    assert (learned["set"], learned["seeds"]) == (7, SEEDS)
    assert learned["rows"].startswith("set 7 (")
    (card,) = learned["agents"]
    assert set(card) == {"agent", "kind", "parameters", "run", "rows"}
    assert card["parameters"] == {"gamma": 0.9, "epsilon": 0.05, "alpha": 0.5, "symmetric": False}
    fields = {"row", "question", "unit", "n", "score", "value", "random", "best", "best_is", "reason"}
    assert all(set(line) == fields for line in card["rows"])
    assert lines(learned)["visit"]["best_is"] == "best known of a test"
    assert lines(learned)["visit"]["unit"] == "goals a trial"
    assert lines(learned)["updates"]["value"]["mean"] == 1
    assert lines(learned)["updates"]["score"] is None
    assert 0 < lines(learned)["cpu"]["value"]["mean"] < 1000


def test_the_floor_is_zero_and_who_knows_all_is_one(out, learned):
    told, _ = score(out, "random", "--only", "navigation", "--only", "speed")
    assert [line["score"]["mean"] for line in lines(told).values()] == [pytest.approx(0, abs=1e-12)] * 2
    told, _ = score(out, "knows_all", "--plugin", PLUGIN)
    found = lines(told)
    assert found["speed"]["score"]["mean"] == pytest.approx(1, abs=0.05)
    assert found["speed"]["score"]["mean"] > lines(learned)["speed"]["score"]["mean"]
    for row in ("both", "remembers", "cpu"):
        assert (found[row]["score"], found[row]["reason"]) == (None, "can't play social; it plays navigation")
    assert found["visit"]["reason"] == "can't play visit; it plays navigation"


def test_what_is_done_is_kept_and_what_is_missing_comes_again_byte_by_byte(out, learned):
    run = run_of(out, "q_learning")
    before = only_cells(hashes(run))
    shutil.rmtree(run / "social" / "q_learning" / "fast" / "seed-0001")
    (run / "again" / "q_learning" / "fast" / "seed-0002" / "cell.json").unlink()
    again, done = score(out, "q_learning")
    assert "2 of 21 cells to do" in done.stderr
    assert only_cells(hashes(run)) == before
    timeless = [{name: line for name, line in lines(each).items() if name != "cpu"} for each in (again, learned)]
    assert timeless[0] == timeless[1]


def test_a_cell_that_fails_is_a_row_with_the_reason_and_exit_code_4(out):
    told, done = score(out, "plain_q", "wrong_at=30", "--plugin", FAILS, "--only", "speed", code=4)
    assert lines(told)["speed"]["reason"].startswith("failed: its agent (kind plain_q) failed in trial 1, step 10")
    assert "navigation/plain_q/seed-0000: " in done.stderr


def test_agents_of_a_config_stand_beside_one_another_in_all_that_is_written(out, tmp_path, learned):
    config = tmp_path / "two.yaml"
    config.write_text("agents:\n  q_learning: {kind: q_learning}\n  script: {kind: scripted}\n")
    files = {name: tmp_path / "made" / f"scores.{name}" for name in ("svg", "html", "md")}
    options = ["--picture", files["svg"], "--report", files["html"], "--page", files["md"]]
    words = [config, "--only", "navigation", "--only", "visit", "--rows", ROWS, "--out", out, "--seeds", SEEDS]
    done = visitlab("score", *words, *options)
    assert done.returncode == 0, done.stderr
    head, navigation, visit, *_ = [line.split() for line in done.stdout.splitlines()]
    assert head == ["row", "q_learning", "script"]
    assert (navigation[0], navigation[-1]) == ("navigation", "-")
    assert visit[0] == "visit"
    assert "script: can't play navigation; it plays social, visit (navigation)" in done.stdout
    assert all(is_ours(file) for file in files.values())
    page = files["md"].read_text()
    assert "](scores.svg)" in page
    assert "| navigation | Does it go? |" in page
    html = files["html"].read_text()
    assert "can&#x27;t play navigation" in html
    assert "script src" not in html
    assert "&lt;" not in files["svg"].read_text()
    first = files["svg"].read_bytes(), files["html"].read_bytes(), files["md"].read_bytes()
    visitlab("score", *words, *options)
    assert (files["svg"].read_bytes(), files["html"].read_bytes(), files["md"].read_bytes()) == first


@pytest.mark.parametrize(
    ("words", "code", "line"),
    [
        (["nobodys"], 5, "nobodys: no kind of agent, and no config of this name"),
        (["rmax", "--only", "navigatoin"], 5, "--only navigatoin: no such row; did you mean navigation?"),
        (["rmax", "--quick", "--seeds", "2"], 2, "--quick and --seeds: choose one"),
        (["rmax", "--picture", "x.bmp"], 2, "--picture x.bmp: must end in .svg, .png, .pdf"),
        (["rmax", "--page", str(PLUGIN)], 2, "exists and was not written by visitlab"),
        (["rmax", "--rows", "/nowhere"], 5, "no rows of a scorecard there"),
    ],
)
def test_what_can_not_be_done_is_one_line_before_anything_is_played(tmp_path, words, code, line):
    done = visitlab("score", *words, "--out", tmp_path / "runs")
    assert (done.returncode, done.stdout, done.stderr.count("\n")) == (code, "", 1)
    assert line in done.stderr
    assert not (tmp_path / "runs").exists()


def test_without_an_agent_the_questions_are_told():
    done = visitlab("score", "--json")
    told = json.loads(done.stdout)
    assert told["questions"]["human_1"]["of"] == ["social/AGENT/human_1"]
    assert "Does it bear distraction?" in visitlab("score").stdout
