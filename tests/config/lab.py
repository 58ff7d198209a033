"""A small whole config, and a way to break it."""

from collections.abc import Callable

from visitlab_cli.config.model import Config

LAB = """\
name: lab
humans:
  human_1: {p_S: [1, 0, 0], p_M: 0.1}
  human_2: {p_S: [0, 0.5, 0.5]}
agents:
  rmax: {kind: rmax}
  mb: {kind: model_based}
  mf: {kind: q_learning}
  watcher: {kind: observer, watches: mb, learner: mf, until: 100, acts_as: mf}
  script: {kind: scripted}
experiments:
  navigation: {task: navigation, agents: [rmax, mf], steps: 100}
  go_to_human: {task: go_to_human, agents: [mb], steps: 100}
  social: {task: social, agents: [mb, mf], humans: [human_1, human_2], steps: 100}
  visit:
    task: visit
    modules: {navigation: navigation/rmax, go_to_human: go_to_human/mb, social: social/mb/human_2}
    humans: [human_2]
"""

Load = Callable[..., Config]
Complain = Callable[..., list[str]]


def edited(old: str, new: str, text: str = LAB) -> str:
    """The text with one place changed; the place must be there, once."""
    assert text.count(old) == 1, old
    return text.replace(old, new)
