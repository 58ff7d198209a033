"""The random stream of an environment's rules: four words for kernels, drawn once from Gymnasium's generator."""

import numpy as np

from visitlab_cli.random_numbers import RandomState

WORDS = 4
ENTROPY_WORDS = 8


def derived(generator: np.random.Generator) -> RandomState:
    """The stream, shape (4,), that a generator begins, of which eight numbers are drawn: so a seed is an episode."""
    entropy = generator.integers(2**32, size=ENTROPY_WORDS, dtype=np.uint32)
    return np.array(np.random.SFC64(entropy.tolist()).state["state"]["state"], np.uint64)
