"""`include` and `like`: configs from parts."""

import os
from pathlib import Path

import pytest

from tests.config.lab import LAB, Complain, Load, edited
from visitlab_cli.config.files import shipped_configs
from visitlab_cli.config.loading import load
from visitlab_cli.errors import NotFoundError

HUMANS = "humans:\n  human_3: {p_S: [0.33, 0.33, 0.34]}\n  human_1: {p_S: [1.0, 0, 0], p_M: 0.1}\n"


def including(names: str, text: str = LAB) -> str:
    return f"include: [{names}]\n{text}"


def test_sections_merge_by_key(loaded: Load, folder: Path) -> None:
    (folder / "parts").mkdir()
    (folder / "parts/humans.yaml").write_text("include: [more.yaml]\n" + HUMANS)
    (folder / "parts/more.yaml").write_text("interaction: {distances: [1, 2, 3, 4]}\n")
    config = loaded(including("parts/humans.yaml"))
    assert list(config.humans) == ["human_3", "human_1", "human_2"]
    assert config.interaction.distances == (1, 2, 3, 4)


def test_what_is_a_files_own_is_not_taken_over(loaded: Load, folder: Path) -> None:
    (folder / "other.yaml").write_text("name: other\nseed: 7\nseeds: 8\nrecord: {steps: none}\n")
    assert loaded(including("other.yaml")) == loaded()


def test_a_file_included_twice_is_one(loaded: Load, folder: Path) -> None:
    (folder / "a.yaml").write_text("include: [humans.yaml]\n")
    (folder / "humans.yaml").write_text(HUMANS)
    assert loaded(including("a.yaml, humans.yaml")) == loaded(including("humans.yaml"))


def test_another_value_for_the_same_key_is_an_error(complaint: Complain, folder: Path) -> None:
    (folder / "humans.yaml").write_text(HUMANS.replace("p_M: 0.1", "p_M: 0.2"))
    assert complaint(including("humans.yaml")) == [
        "lab.yaml:4:3: humans.human_1: differs from that at humans.yaml:3:3; give it a name of its own"
    ]


def test_errors_in_included_files_have_their_places(complaint: Complain, folder: Path) -> None:
    (folder / "humans.yaml").write_text(HUMANS.replace("0.34", "0.35") + "human: 3\n")
    assert complaint(including("humans.yaml")) == [
        "humans.yaml:2:18: humans.human_3.p_S: must sum to 1 (sums to 1.01)",
        "humans.yaml:4:1: human: unknown; did you mean humans?",
    ]


def test_bad_includes(complaint: Complain, folder: Path) -> None:
    (folder / "round.yaml").write_text("include: [lab.yaml]\n")
    (folder / "folder").mkdir()
    assert complaint(including('3, nix.yaml, lab.yaml, round.yaml, folder, "a\\0b"')) == [
        "lab.yaml:1:11: include.0: must be the name of a file",
        "lab.yaml:1:14: include: nix.yaml: no such file or directory",
        "lab.yaml:1:24: include: lab.yaml includes this file in turn",
        "lab.yaml:1:46: include: folder: is a directory",
        "lab.yaml:1:54: include: 'a\\x00b': embedded null byte",
        "round.yaml:1:11: include: lab.yaml includes this file in turn",
    ]
    assert complaint("include: x.yaml\n" + LAB) == ["lab.yaml:1:10: include: must be a list of files"]


def test_like_takes_over_what_is_not_said(loaded: Load) -> None:
    config = loaded(
        edited(
            "  human_2: {",
            "  third: {like: second, p_A: 0.3}\n  second: {like: human_1, p_P: 1}\n  human_2: {",
        )
    )
    assert config.humans["third"].model_dump() == {
        "p_S": (1, 0, 0), "p_H": 0, "p_M": 0.1, "p_O": 0, "p_A": 0.3, "p_P": 1
    }  # fmt: skip


def test_like_in_an_included_file_is_resolved_after_merging(loaded: Load, folder: Path) -> None:
    (folder / "humans.yaml").write_text("humans:\n  fourth: {like: human_1, p_A: 1}\n")
    assert loaded(including("humans.yaml")).humans["fourth"].p_M == 0.1


@pytest.mark.parametrize(
    ("entries", "messages"),
    [
        ("a: {like: human_11}", ["4:13: humans.a.like: no human of this name; did you mean human_1?"]),
        ("a: {like: [b]}", ["4:13: humans.a.like: no human of this name; known: human_1, human_2"]),
        ("a: {like: a}", ["4:13: humans.a.like: goes round in a circle: a -> a"]),
        (
            "a: {like: b}\n  b: {like: c}\n  c: {like: b}",
            [
                "5:13: humans.b.like: goes round in a circle: c -> b -> c",
                "6:13: humans.c.like: goes round in a circle: b -> c -> b",
            ],
        ),
        (
            "a: {like: b, p_M: 2}\n  b: {p_S: [1, 0, 0], p_A: 7}",
            [
                "4:21: humans.a.p_M: must be at most 1 (got 2)",
                "5:28: humans.a.p_A: must be at most 1 (got 7)",
            ],
        ),
    ],
)
def test_bad_likes(complaint: Complain, entries: str, messages: list[str]) -> None:
    text = edited("  human_2: {", f"  {entries}\n  human_2: {{")
    assert complaint(text) == [f"lab.yaml:{message}" for message in messages]


def test_an_agent_keeps_the_kind_that_it_is_like(complaint: Complain) -> None:
    assert complaint(edited("  mf: {", "  m2: {like: mb, kind: q_learning}\n  mf: {")) == [
        "lab.yaml:8:24: agents.m2.kind: must be that of mb, which it is like"
    ]


def test_a_long_chain_of_likes_is_refused(complaint: Complain) -> None:
    chain = "".join(f"  h{n}: {{like: h{n + 1}}}\n" for n in range(3000))
    lines = complaint(edited("  human_2: {", chain + "  h3000: {like: human_1}\n  human_2: {"))
    assert "humans.h32.like: a chain of more than 32" in lines[0]


SHIPPED = ", ".join(name for name in shipped_configs() if "/" not in name)


@pytest.mark.parametrize(
    ("name", "message"),
    [
        (
            "nix.yaml",
            f"nix.yaml: no such file, nor a shipped config; shipped: {SHIPPED} and those in beyond/ and paper/",
        ),
        ("quikstart", "quikstart: no such file, nor a shipped config; did you mean quickstart?"),
        ("quickstart\n", "'quickstart\\n': no such file"),
        ("../nix.yaml", "../nix.yaml: no such file"),
        ("some_folder", "some_folder: a folder, not a config"),
        ("a\0b", "'a\\x00b': no such file"),
    ],
)
def test_no_such_config(folder: Path, name: str, message: str) -> None:
    (folder / "some_folder").mkdir()
    with pytest.raises(NotFoundError) as error:
        load(name)
    assert (str(error.value), error.value.exit_code) == (message, 5)


@pytest.mark.skipif(os.geteuid() == 0, reason="root reads everything")
def test_an_unreadable_file(folder: Path) -> None:
    (folder / "lab.yaml").touch(mode=0)
    with pytest.raises(NotFoundError, match=r"^lab.yaml: permission denied$"):
        load("lab.yaml")


def test_a_folder_of_the_same_name_does_not_hide_a_shipped_config(folder: Path) -> None:
    (folder / "paper").mkdir()
    assert load("paper").name == "paper"
