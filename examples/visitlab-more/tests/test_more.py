"""That Double Q-learning keeps what agents promise."""

import visitlab_cli


def test_it_keeps_what_agents_promise():
    failed = [answer for answer in visitlab_cli.check_agent("double_q") if not answer.passed]
    assert not failed, failed
