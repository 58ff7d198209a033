"""The tasks as Gymnasium environments: importing this registers them, `gymnasium.make("visitlab/Social-v0")` makes one.

`Navigation-v0`, `GoToHuman-v0`, `Social-v0` and `Visit-v0`, alone or, by `gymnasium.make_vec`, as compiled lanes. What
they take and give is told in docs/environments. Their code is imported when one is made.
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

ENVIRONMENTS = {f"visitlab/{name}-v0": name for name in ("Navigation", "GoToHuman", "Social", "Visit")}
"""The classes' common name of each environment, in the order of the paper."""

for _id, _name in ENVIRONMENTS.items():
    gymnasium.register(
        _id,
        entry_point=f"visitlab_cli.gym.tasks:{_name}Env",
        vector_entry_point=f"visitlab_cli.gym.vector:{_name}Lanes",
        order_enforce=False,  # they see to it themselves, as to the time limit, and are checked by our tests: each
        disable_env_checker=True,  # wrapper would cost as much as a step
    )
