"""What the tests of scenes share with those of the replay."""

from tests.replay.conftest import trial_of

__all__ = ["trial_of"]
