"""Every kind of agent, found by listing this folder: what the config, the loops and the documentation ask."""

from typing import TYPE_CHECKING

from visitlab_cli import agents
from visitlab_cli.agents.base import AgentParameters
from visitlab_cli.kinds import any_of, built_in

KINDS = built_in(agents, AgentParameters)
"""The parameters' class of each kind, by its name in a config."""

if TYPE_CHECKING:
    AnyAgent = AgentParameters
else:
    AnyAgent = any_of(KINDS)
