"""Configs that nobody would write: each is loaded, or refused in lines with their places, in bounded time."""

import random
import time
from pathlib import Path

from tests.config.lab import LAB
from visitlab_cli.config.loading import load_text
from visitlab_cli.errors import ConfigError

TINY = (Path(__file__).parents[1] / "tiny.yaml").read_text()
SECONDS = 5.0
PIECES = [
    *"{}[]:,-?&*!|>%@`#'\"\n\t\r \\",
    *("\x00", "\x1b[2J", "\u0085", "\u2028", "\u00a0", "\ufeff", "\u202e", "\ud800", "\U0010ffff", "é"),
    *("&a ", "*a", "!!python/name:os.system ", "---\n", "...\n", "? ", ": ", "<<: ", "%YAML 9\n", "|2-\n", '"\\ud800"'),
    *(".nan", "-.inf", "1e400", "0x" + "f" * 50, "9" * 30, "-0", "~", "true", "no", "1_0", "2**63"),
    *(
        "vary: {seed: [1]}\n",
        "like: ",
        "include: [/dev/zero]\n",
        "seeds: 99999\n",
        "models: crossed\n",
        "steps: none\n",
    ),
    *("[" * 40, "{a: " * 40, "- " * 40, "a," * 3000, "x" * 9000, "a: 1\n" * 300, "[1,2],\n" * 500),
]


def fuzz(n: int, seed: int) -> list[str]:
    """What went wrong with `n` damaged configs, a line each; the same for the same seed."""
    chance = random.Random(seed)
    wrong = []
    for index in range(n):
        text = damaged(chance.choice((LAB, TINY)), chance)
        begun = time.perf_counter()
        try:
            load_text(text, "x.yaml")
        except ConfigError as error:
            if not all(line.startswith(("x.yaml:", "... and ", "vary: at ")) for line in str(error).split("\n")):
                wrong.append(f"seed {seed}, input {index}: a line without a place: {error!s:.200}")
            if not all(line.isprintable() for line in str(error).split("\n")):
                wrong.append(f"seed {seed}, input {index}: a line that a terminal would obey: {error!s:.200}")
        except Exception as error:  # whatever it is, it is the fault that is looked for
            wrong.append(f"seed {seed}, input {index}: {type(error).__name__}: {error!s:.200}")
        if (seconds := time.perf_counter() - begun) > SECONDS:
            wrong.append(f"seed {seed}, input {index}: took {seconds:.1f} s")
    return wrong


def damaged(text: str, chance: random.Random) -> str:
    """A text after one to four accidents: something in between, cut out, doubled, moved, or other letters."""
    for _ in range(chance.randint(1, 4)):
        first, last = sorted(chance.randrange(len(text) + 1) for _ in range(2))
        last = min(last, first + chance.choice((1, 5, 50, 500)))
        part = text[first:last]
        text = chance.choice(
            (
                text[:first] + chance.choice(PIECES) * chance.choice((1, 1, 2)) + text[first:],
                text[:first] + chance.choice(PIECES) + text[last:],
                text[:first] + text[last:],
                text[:last] + part * chance.choice((1, 2, 20)) + text[last:],
                text[:first] + part[::-1] + text[last:],
                text.replace(part, chance.choice(PIECES), 3) if part.strip() else text,
                text[:first] + chr(chance.choice((chance.randrange(128), chance.randrange(0x3000)))) + text[last:],
            )
        )
    return text
