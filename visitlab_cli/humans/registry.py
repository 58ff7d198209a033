"""Every kind of human, found by listing this folder: what the config and the documentation ask."""

from typing import TYPE_CHECKING

from visitlab_cli import humans
from visitlab_cli.humans.base import HumanParameters
from visitlab_cli.kinds import any_of, built_in

KINDS = built_in(humans, HumanParameters)
"""The parameters' class of each kind, by its name in a config; the paper's has none."""

if TYPE_CHECKING:
    AnyHuman = HumanParameters
else:
    AnyHuman = any_of(KINDS)
