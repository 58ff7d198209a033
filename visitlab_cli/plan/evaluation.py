"""Visits with options of their own on a run's models: the options, their folder, and the file that says them."""

import hashlib
import json
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from visitlab_cli.config.model import Config
from visitlab_cli.errors import RunError
from visitlab_cli.storage.cell_folder import one_line, to_json
from visitlab_cli.storage.inside import check_inside, is_real
from visitlab_cli.storage.on_disk import EVALUATIONS, OPTIONS
from visitlab_cli.storage.reading import read_json
from visitlab_cli.whole_file import write_whole


@dataclass(frozen=True)
class Evaluation:
    """What differs from the config: nothing in the visits that a config itself declares.

    `humans` play instead of the visit's own, `trials` instead of its number of them; `frozen`: no learning and no
    exploration; `social` is the module, `experiment/agent/human`, that plays instead of the visit's own.
    """

    humans: tuple[str, ...] = ()
    trials: int | None = None
    frozen: bool = False
    social: str = ""

    @property
    def folder(self) -> str:
        """Where their cells lie in the run folder; empty where nothing differs."""
        if self == AS_DECLARED:
            return ""
        options = [self.humans, self.trials, self.frozen, *([self.social] if self.social else [])]
        return f"{EVALUATIONS}/{hashlib.sha256(json.dumps(options).encode()).hexdigest()[:8]}/"

    @property
    def words(self) -> str:
        """What differs but the humans, such as 'frozen, 500 trials'; 'as declared' where no more does."""
        trials = "" if self.trials is None else f"{self.trials:,} trial{'' if self.trials == 1 else 's'}"
        told = [*(["frozen"] if self.frozen else []), trials, f"with {self.social}" if self.social else ""]
        return ", ".join(filter(None, told)) or "as declared"

    def applied(self, config: Config, experiment: str) -> Config:
        """The config with these options for an `experiment`; the same where there are none that its settings say."""
        if self.trials is None and not self.social and not self.humans:
            return config
        settings = config.experiments[experiment].evaluated(self.trials, self.social, self.humans)
        return config.model_copy(update={"experiments": {**config.experiments, experiment: settings}})

    def as_json(self) -> dict[str, Any]:
        """Plain values."""
        return {**asdict(self), "humans": list(self.humans)}


AS_DECLARED = Evaluation()
MOST_TRIALS = 10**9
"""Of a visit, as `visitlab eval` takes them."""


def record_evaluation(run: Path, evaluation: Evaluation) -> None:
    """Say in an evaluation's folder what its options are; nothing where there are none.

    Raises:
        RunError: it can't be written.
    """
    if not evaluation.folder:
        return
    file = run / evaluation.folder / OPTIONS
    check_inside(run, file)
    if _read(file) != evaluation:
        try:
            file.parent.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise RunError(f"{file.parent}: can't be written: {one_line(error)}") from error
        write_whole(file, to_json(evaluation.as_json()).encode())


def recorded_evaluations(run: Path) -> list[Evaluation]:
    """The evaluations of a run, those of a module together; without those whose file does not fit its folder."""
    files = [folder / OPTIONS for folder in _folders(run)]
    found = [each for file in files if (each := _read(file)) is not None]
    return sorted(found, key=lambda each: (each.social, not each.frozen, each.trials or 0, each.humans))


def unknown_evaluations(run: Path) -> list[str]:
    """The folders of evaluations, below the run, whose options are missing, damaged, or those of another folder."""
    return [folder.relative_to(run).as_posix() for folder in _folders(run) if _read(folder / OPTIONS) is None]


def _folders(run: Path) -> list[Path]:
    """Those of evaluations; no link is followed."""
    if not is_real(run / EVALUATIONS):
        return []
    return [path for path in sorted((run / EVALUATIONS).iterdir()) if is_real(path)]


def _can_be(told: Any) -> bool:
    """Whether a document says options of the right kinds."""
    humans, trials, social = told["humans"], told["trials"], told["social"]
    return (
        isinstance(humans, list)
        and all(isinstance(human, str) for human in humans)
        and (trials is None or (type(trials) is int and 1 <= trials <= MOST_TRIALS))
        and type(told["frozen"]) is bool
        and isinstance(social, str)
        and (not social or social.count("/") in (1, 2))
    )


def _read(file: Path) -> Evaluation | None:
    try:
        told = read_json(file)
        if not _can_be(told):
            return None
        found = Evaluation(tuple(told["humans"]), told["trials"], told["frozen"], told["social"])
        whole = to_json(found.as_json()) == to_json(told) and found.folder == f"{EVALUATIONS}/{file.parent.name}/"
    except (OSError, ValueError, KeyError, TypeError):
        return None
    return found if whole else None
