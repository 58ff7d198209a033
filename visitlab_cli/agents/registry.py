"""Every kind of agent: the one list that the config, the loops and the documentation ask."""

from typing import Annotated

from pydantic import Field

from visitlab_cli.agents.model_based import ModelBasedParameters
from visitlab_cli.agents.observer import ObserverParameters
from visitlab_cli.agents.q_learning import QLearningParameters
from visitlab_cli.agents.rmax import RMaxParameters
from visitlab_cli.agents.scripted import ScriptedParameters
from visitlab_cli.agents.uniform_random import RandomParameters

AnyAgent = Annotated[
    QLearningParameters
    | ModelBasedParameters
    | RMaxParameters
    | ObserverParameters
    | RandomParameters
    | ScriptedParameters,
    Field(discriminator="kind"),
]
