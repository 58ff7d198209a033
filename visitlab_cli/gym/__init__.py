"""The tasks as Gymnasium environments: importing this registers them, `gymnasium.make("visitlab/Social-v0")` makes one.

`Navigation-v0`, `GoToHuman-v0`, `Social-v0` and `Visit-v0`, alone or, by `gymnasium.make_vec`, as compiled lanes. What
they take and give is told in docs/environments.
"""

from visitlab_cli.errors import UsageError


class NoGymnasiumError(UsageError, ImportError):
    """The extra is not installed."""


try:
    import gymnasium
except ModuleNotFoundError as error:
    if error.name != "gymnasium":
        raise
    raise NoGymnasiumError('visitlab_cli.gym needs Gymnasium: pip install "visitlab[gymnasium]"') from None

from visitlab_cli.gym.environment import Environment
from visitlab_cli.gym.tasks import GoToHumanEnv, NavigationEnv, SocialEnv, VisitEnv
from visitlab_cli.gym.vector import Lanes

NAMESPACE = "visitlab"
ENVIRONMENTS = {
    "Navigation-v0": NavigationEnv,
    "GoToHuman-v0": GoToHumanEnv,
    "Social-v0": SocialEnv,
    "Visit-v0": VisitEnv,
}
"""By their names, in the order of the paper."""
__all__ = ["ENVIRONMENTS", "Environment", "GoToHumanEnv", "Lanes", "NavigationEnv", "SocialEnv", "VisitEnv"]

for _name, _environment in ENVIRONMENTS.items():
    gymnasium.register(
        f"{NAMESPACE}/{_name}",
        entry_point=f"visitlab_cli.gym.tasks:{_environment.__name__}",
        vector_entry_point=f"visitlab_cli.gym.vector:{_environment.__name__.removesuffix('Env')}Lanes",
        order_enforce=False,  # they see to it themselves, as to the time limit, and are checked by our tests: each
        disable_env_checker=True,  # wrapper would cost as much as a step
    )
