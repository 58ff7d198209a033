"""`visitlab steps`: a recorded trial as a table, one step a line, in words."""

from functools import partial
from typing import TYPE_CHECKING, Any

from visitlab_cli.console.help import Help
from visitlab_cli.console.options import (
    RUNS,
    Agent,
    At,
    Experiment,
    Human,
    Json,
    Out,
    Phase,
    RunOrFile,
    Seed,
    TrialWord,
)
from visitlab_cli.console.unread import tell_unread
from visitlab_cli.console.words import aligned
from visitlab_cli.terminal import plain as in_line
from visitlab_cli.terminal import tell, tell_json, tell_text

if TYPE_CHECKING:
    from visitlab_cli.scene.words import Steps
    from visitlab_cli.world.lab import Lab


HELP = Help(
    "Look",
    place=2,
    examples=(
        "visitlab steps quickstart --trial worst",
        "visitlab steps quickstart --experiment social --trial 9000 --json",
    ),
)


def command(
    run: RunOrFile,
    experiment: Experiment = "",
    human: Human = "",
    agent: Agent = "",
    seed: Seed = None,
    at: At = None,
    trial: TrialWord = "0",
    phase: Phase = None,
    out: Out = RUNS,
    as_json: Json = False,
) -> None:
    """Print a recorded trial as a table, one step a line, in the words of the replay."""
    from visitlab_cli.log.reader import check_values, read_metadata, read_trial
    from visitlab_cli.plan.selection import Selection
    from visitlab_cli.replay.choice import choose_trial, find_logs
    from visitlab_cli.scene.trial import lab_of_steps, phase_of_log
    from visitlab_cli.scene.words import shut_in
    from visitlab_cli.world.sight import Walls

    logs = find_logs(run, out, Selection(experiment, human, agent, seed, tuple(at or ())))
    tell_unread(logs.run, logs.cells)
    chosen = choose_trial(logs, trial, phase)
    log, number = chosen.log, chosen.trial
    if chosen.note:
        tell(chosen.note, err=True)
    steps = read_trial(log.path, number)
    lab = lab_of_steps(log.path, steps)
    check_values(log.path, steps, read_metadata(log.path)["task"], lab)
    in_phase = phase_of_log(log.path, steps)
    if as_json:
        told: dict[str, Any] = {"cell": log.cell, "trial": number, **({"phase": in_phase} if in_phase else {})}
        if isinstance(lab.walls, Walls):
            told["doors_shut"] = shut_in(steps, lab)
        tell_json({**told, "steps": plain(steps, lab)})
    else:
        tell(", ".join(filter(None, (log.cell, f"trial {number}", in_phase))), "")
        tell_text(table(steps, lab))


def plain(steps: "Steps", lab: "Lab") -> list[dict[str, Any]]:
    """Each step as the log's values, enums by their names, and its caption."""
    from visitlab_cli.log.tables import names_of
    from visitlab_cli.scene.words import captions

    columns = {}
    for column, values in steps.items():
        names = names_of(column)
        columns[column] = [names[value] for value in values] if names else values.tolist()
    rows = zip(*columns.values(), captions(steps, lab), strict=True)
    return [dict(zip((*columns, "caption"), row, strict=True)) for row in rows]


def table(steps: "Steps", lab: "Lab") -> str:
    """A line for each step: what the task has of goal, desired direction, level; reward; what happens in words."""
    from visitlab_cli.scene.words import LEVEL_NAMES, believed, captions, direction_name, room_name

    columns: dict[str, list[str]] = {"step": [str(step) for step in steps["step"]]}
    for head, column, in_words in (
        ("goal", "goal_room", partial(room_name, lab)),
        ("desired", "desired_direction", direction_name),
        ("level", "interaction_level", LEVEL_NAMES.__getitem__),
    ):
        if column in steps:
            columns[head] = [in_words(int(value)) for value in steps[column]]
    if "belief_none" in steps:
        columns["believed"] = [believed(steps, step) for step in range(len(steps["step"]))]
    columns["reward"] = [f"{value:g}" for value in steps["reward"]]
    columns["what happens"] = captions(steps, lab)
    rows = [list(map(in_line, row)) for row in (columns, *zip(*columns.values(), strict=True))]
    return aligned(rows, words=len(columns))
