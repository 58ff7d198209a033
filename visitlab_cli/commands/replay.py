"""`visitlab replay`: a trial in the Rerun viewer."""


def command() -> None:
    """To come."""
