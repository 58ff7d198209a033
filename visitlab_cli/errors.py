"""The exceptions of visitlab: each is one clear line for the user and carries the exit code of the command."""

import errno
from collections.abc import Sequence
from types import ModuleType
from typing import Any

resource: ModuleType | None
try:
    import resource  # here: where too many files are open nothing can be imported any more
except ImportError:  # not on this system
    resource = None


class VisitlabError(Exception):
    """Something the user can mend; shown as one line, or as one for each argument, never as a traceback."""

    exit_code = 4

    def __str__(self) -> str:
        return "\n".join(map(str, self.args))


class UsageError(VisitlabError):
    """The command line is wrong: exit code 2."""

    exit_code = 2


class ConfigError(VisitlabError):
    """The config is invalid: exit code 3. The message has one line for each problem.

    `problems` are these as plain values: `file`, `line`, `column` (None in an override), `path`, `message`.
    """

    exit_code = 3

    def __init__(self, message: str, problems: Sequence[dict[str, Any]] = ()) -> None:
        """An error of one line, or of several `problems`."""
        super().__init__(*message.split("\n"))
        alone = {"file": None, "line": None, "column": None, "path": None, "message": message}
        self.problems = list(problems) or [alone]

    def __reduce__(self) -> Any:
        """Another process gets all of it."""
        return type(self), (str(self), self.problems)


class RunError(VisitlabError):
    """A run failed, is incomplete, cannot be written or misses an expected value: exit code 4."""

    exit_code = 4


class AnswerError(ValueError):
    """An agent or a human answered, or an agent would save, what is none: `where`, in words, '' where nobody knows."""

    def __init__(self, answer: str, where: str = "") -> None:
        """With what it was."""
        super().__init__(answer)
        self.where = where


class NotFoundError(VisitlabError):
    """A file, run or trial does not exist: exit code 5."""

    exit_code = 5


class Interrupted(VisitlabError):  # noqa: N818  (not an error: the user asked for it)
    """Stopped by Ctrl-C, SIGTERM or a closed terminal; what was finished is kept: exit code 130."""

    exit_code = 130


def reason(error: OSError | ValueError) -> str:
    """Why the system refused something, in words; of too many open files also the limit and how to raise it."""
    number = getattr(error, "errno", None)
    words = getattr(error, "strerror", None) or str(error) or type(error).__name__
    if number == errno.EMFILE:
        most = resource.getrlimit(resource.RLIMIT_NOFILE)[0] if resource is not None else "so many"
        words += f" (at most {most} at once); `ulimit -n` with a higher number before the command allows more"
    elif number == errno.ENFILE:
        words += " on this machine; end other programs"
    return words
