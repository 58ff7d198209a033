"""What YAML can do to a reader: oddities, attacks, and the core schema of YAML 1.2."""

import math
import time

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.config.lab import LAB, Complain, Load, edited
from visitlab_cli.config.building import build
from visitlab_cli.errors import ConfigError
from visitlab_cli.yaml.reader import read_yaml
from visitlab_cli.yaml.scalars import meaning

REFUSED = [
    (b"", "1:1: empty; `visitlab init` writes a config to start from"),
    (b"# nothing\n", "1:1: empty; `visitlab init` writes a config to start from"),
    ("[1, 2]", "1:1: must be a mapping (got a list)"),
    ("3", "1:1: must be a mapping (got one value)"),
    ("name: a\n---\nname: b", "2:1: a second document; a config is one"),
    ("name:\n\t- 1", "2:1: a tab; YAML is indented with spaces"),
    ("name: lab\n\tx: 1", "2:1: a tab; YAML is indented with spaces"),
    ("a: &x [1]\nb: *x", "2:4: an alias (*x); use `like` or `include`"),
    (
        "a: !!python/object/apply:os.system [x]",
        "1:4: a tag ('tag:yaml.org,2002:python/object/apply:os.system'); a config has none",
    ),
    ("a: !x {}", "1:4: a tag ('!x'); a config has none"),
    ("[" * 5000, "1:34: nested more than 32 deep"),
    ("a: " + "{a: " * 5000, "1:129: nested more than 32 deep"),
    ("- " * 5000 + "a", "1:67: nested more than 32 deep"),
    (b"\xff\xfea", "1:1: not UTF-8"),
    ("é: 1\nñ: ".encode() + b"\x80", "2:5: not UTF-8"),
    ("é: 1\nñ: \x07", "2:4: a character that YAML does not allow: '\\x07'"),
    (
        "a: [1",
        "2:1: not YAML: while parsing a flow sequence that begins at line 1, column 4: "
        "did not find expected ',' or ']'",
    ),
    ("a: b: c", "1:5: not YAML: mapping values are not allowed in this context"),
    ("é: @x", "1:4: text that starts with @ must be in quotes"),
    ("a: %x", "1:4: text that starts with % must be in quotes"),
]


@pytest.mark.parametrize(("text", "line"), REFUSED)
def test_refused_with_one_line(complaint: Complain, text: str | bytes, line: str) -> None:
    assert complaint(text) == [f"lab.yaml:{line}"]


def test_100_mb_are_refused_unread(complaint: Complain) -> None:
    start = time.perf_counter()
    assert complaint(b"- x\n" * (25 << 20)) == ["lab.yaml: larger than 1 MiB; no config is"]
    assert time.perf_counter() - start < 10


def test_an_alias_bomb_ends_at_its_first_alias(complaint: Complain) -> None:
    bomb = "a0: &a0 [x]\n" + "".join(f"a{n}: &a{n} [{f'*a{n - 1}, ' * 9}]\n" for n in range(1, 20))
    assert complaint(bomb) == ["lab.yaml:2:10: an alias (*a0); use `like` or `include`"]


def test_a_byte_order_mark_moves_nothing(complaint: Complain, loaded: Load) -> None:
    assert loaded("\ufeff" + LAB) == loaded(LAB)
    assert complaint("\ufeffname: [") == complaint("name: [")


@pytest.mark.parametrize(
    ("keys", "line"),
    [
        ("seed: 1\nseed: 2", "3:1: 'seed' a second time; first at lab.yaml:2:1"),
        ("5: 1", "2:1: a key must be text (got 5; put it in quotes)"),
        ("true: 1", "2:1: a key must be text (got true; put it in quotes)"),
        ("~: 1", "2:1: a key must be text (got nothing; put it in quotes)"),
        ("? [a]\n: 1", "2:3: a key must be text (got a list)"),
    ],
)
def test_doubled_and_other_keys(complaint: Complain, keys: str, line: str) -> None:
    assert complaint(edited("name: lab\n", f"name: lab\n{keys}\n")) == [f"lab.yaml:{line}"]


@pytest.mark.parametrize(
    ("word", "value"),
    [
        *((word, word) for word in ("no", "yes", "on", "off", "1_0", "1:30", "0b1", "e3", "-", "1e", "inf")),
        *((word, None) for word in ("", "~", "null")),
        ("true", True),
        ("FALSE", False),
        ("010", 10),
        ("-7", -7),
        ("0o10", 8),
        ("0x1F", 31),
        ("1e-3", 0.001),
        ("1e3", 1000.0),
        (".5", 0.5),
        ("5.", 5.0),
        ("1e400", math.inf),
        ("-.inf", -math.inf),
        ("1" * 40, int("1" * 40)),
    ],
)
def test_words_mean_what_yaml_1_2_says(word: str, value: object) -> None:
    assert meaning(word) == value
    assert type(meaning(word)) is type(value)


def test_there_is_no_negative_zero() -> None:
    assert math.copysign(1, meaning("-0.0")) == 1


def test_a_quoted_word_is_text() -> None:
    document, problems = read_yaml("['1', \"true\", |-\n 5\n]".replace("|-\n 5\n", "'5'"), "x")
    assert document is not None
    assert (document.plain(), problems) == (["1", "true", "5"], [])


def refusal(text: str) -> list[str]:
    """The lines with which reading and building refuse a text; none if they do not."""
    try:
        document, problems = read_yaml(text, "x.yaml")
        if document is not None and isinstance(document.value, dict):
            build(document, problems)
    except ConfigError as error:
        return str(error).split("\n")
    return []


@given(st.text(alphabet=st.sampled_from("ab:-[]{}\"'#&*!|>%@` \n\t\r,?01.eé\x07\u2028\ud800"), max_size=40))
def test_any_text_is_read_or_refused_with_a_place(text: str) -> None:
    assert all(line.startswith("x.yaml:") for line in refusal(text))


@given(st.integers(0, len(LAB)), st.text(alphabet="ab:-[]{}\"'&*!|>\n 01.eé~", min_size=1, max_size=4))
def test_a_typo_anywhere_ends_in_a_config_or_in_lines_with_places(position: int, typo: str) -> None:
    lines = refusal(LAB[:position] + typo + LAB[position:])
    assert all(line.startswith(("x.yaml:", "... and ")) for line in lines)
