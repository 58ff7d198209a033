"""The exceptions of visitlab: each is one clear line for the user and carries the exit code of the command."""


class VisitlabError(Exception):
    """Something the user can mend; shown as one line, never as a traceback."""

    exit_code = 4


class UsageError(VisitlabError):
    """The command line is wrong: exit code 2."""

    exit_code = 2


class ConfigError(VisitlabError):
    """The config is invalid: exit code 3. The message has one line for each problem."""

    exit_code = 3


class RunError(VisitlabError):
    """A run failed, is incomplete, cannot be written or misses an expected value: exit code 4."""

    exit_code = 4


class NotFoundError(VisitlabError):
    """A file, run or trial does not exist: exit code 5."""

    exit_code = 5


class Interrupted(VisitlabError):  # noqa: N818  (not an error: the user asked for it)
    """Stopped by Ctrl-C, SIGTERM or a closed terminal; what was finished is kept: exit code 130."""

    exit_code = 130
