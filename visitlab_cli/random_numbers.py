"""Random numbers in kernels: SFC64 on an array of four words, numpy's own numbers bit for bit.

Source: C. Doty-Humphrey's sfc64 as `numpy.random.SFC64` has it. An array is a checkpoint by itself, and costs a
kernel nothing to receive, unlike a `numpy.random.Generator`.
"""

import hashlib

import numpy as np
import numpy.typing as npt

from visitlab_cli.compiled import JIT_DISABLED, kernel

RandomState = npt.NDArray[np.uint64]
"""Shape (4,): the state of one stream, changed in place by each draw."""

UNIT = 1.0 / 9007199254740992.0  # 2 ** -53


def _next_word(state: RandomState) -> np.uint64:
    result = state[0] + state[1] + state[3]
    state[3] += np.uint64(1)
    state[0] = state[1] ^ (state[1] >> np.uint64(11))
    state[1] = state[2] + (state[2] << np.uint64(3))
    state[2] = ((state[2] << np.uint64(24)) | (state[2] >> np.uint64(40))) + result
    return result  # type: ignore[no-any-return]


# uncompiled, numpy would warn of the overflow that the generator is made of
next_word = np.errstate(over="ignore")(_next_word) if JIT_DISABLED else kernel(_next_word)


@kernel
def random_unit(state: RandomState) -> float:
    """Uniform in [0, 1), 53 bits, as `Generator.random`."""
    return float(next_word(state) >> np.uint64(11)) * UNIT


@kernel
def random_below(state: RandomState, n: int) -> int:
    """Uniform integer in 0..n-1."""
    return int(random_unit(state) * n)


@kernel
def happens(state: RandomState, probability: float) -> bool:
    """True with `probability`."""
    return random_unit(state) < probability


def random_state(seed: int, *names: str) -> RandomState:
    """The stream of `names` (a cell's path, a purpose) under the root `seed`, independent of every other."""
    words = np.frombuffer(hashlib.sha256("\0".join(names).encode()).digest(), "<u4")
    generator = np.random.SFC64(np.random.SeedSequence(seed, spawn_key=[int(word) for word in words]))
    return np.array(generator.state["state"]["state"], dtype=np.uint64)
