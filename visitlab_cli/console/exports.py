"""What `export --foxglove`, `--minari` and `--ros2bag` do: recorded trials of a cell as another program reads them."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from visitlab_cli.terminal import tell, tell_json

if TYPE_CHECKING:
    from visitlab_cli.replay.choice import Log, Logs


def tell_foxglove(logs: "Logs", words: Sequence[str], output: Path | None, as_json: bool) -> None:
    """Write trials for Foxglove and say where they are; the first recorded one where no `words` choose."""
    from visitlab_cli.export.foxglove import write_foxglove

    _tell_trials(logs, words, output, as_json, "foxglove.mcap", write_foxglove)


def tell_ros2bag(logs: "Logs", words: Sequence[str], output: Path | None, as_json: bool, cell_size: float) -> None:
    """The same as a ROS 2 bag."""
    from visitlab_cli.export.ros2bag import write_ros2bag

    def write(path: Path, trials: Any) -> int:
        return write_ros2bag(path, trials, cell_size)

    _tell_trials(logs, words, output, as_json, "ros2bag", write)


def tell_minari(logs: "Logs", words: Sequence[str], output: Path | None, as_json: bool) -> None:
    """Write trials, all recorded ones where no `words` choose, as a Minari data set, and say where it is."""
    from visitlab_cli.export.minari import write_minari

    log, numbers = _chosen(logs, words or ["0"])
    root = output or Path("minari")
    dataset, folder, episodes, steps = write_minari(root, log.path, numbers if words else ())
    told = {"cell": log.cell, "dataset": dataset, "episodes": episodes, "steps": steps, "folder": str(folder)}
    how = f"MINARI_DATASETS_PATH={root} lets minari.load_dataset find it"
    tell_json(told, None) if as_json else tell(f"{folder}: {episodes:,} episodes, {steps:,} steps; {how}")


def _tell_trials(
    logs: "Logs",
    words: Sequence[str],
    output: Path | None,
    as_json: bool,
    ending: str,
    write: Callable[[Path, Any], int],
) -> None:
    from visitlab_cli.scene.trial import load_trial

    log, numbers = _chosen(logs, words or ["0"])
    target = output or Path(f"{_name(log.cell, numbers)}.{ending}")
    rows = write(target, (load_trial(log.path, number) for number in numbers))
    told = {"cell": log.cell, "trials": numbers, "rows": rows, "file": str(target)}
    tell_json(told, None) if as_json else tell(f"{log.cell}, trial {', '.join(map(str, numbers))}: {target}")


def _chosen(logs: "Logs", words: Sequence[str]) -> tuple["Log", list[int]]:
    """The log, and the numbers of its trials, each once, that the words choose: the first one among all logs."""
    from visitlab_cli.replay.choice import Logs, choose_trial

    chosen = choose_trial(logs, words[0])
    if chosen.note:
        tell(chosen.note, err=True)
    log = chosen.log
    return log, list(dict.fromkeys([chosen.trial, *(choose_trial(Logs((log,)), word).trial for word in words[1:])]))


def _name(cell: str, numbers: Sequence[int]) -> str:
    """A file's name that says what is in it; `cell` is one of a run, or a file's path."""
    where = Path(cell).stem if cell.endswith(".mcap") else cell.replace("/", "-")
    return f"{where}-trial-{'-'.join(map(str, numbers))}"
