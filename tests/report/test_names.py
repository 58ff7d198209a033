"""How conditions are named: short, and told apart."""

import pytest

from visitlab_cli.report.names import breakable


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("slow_and_distractible", "slow_<wbr>and_<wbr>distractible"),
        ("p_A=0.1234567", "p_A=0.1234567"),
        ("humans.shyer.p_S=[0.333, 0.667]", "humans.<wbr>shyer.<wbr>p_S=[0.333, 0.667]"),
        ("a<long_name", "a&lt;long_<wbr>name"),
    ],
)
def test_a_name_breaks_behind_words_and_never_in_a_number(text, shown):
    assert breakable(text) == shown
