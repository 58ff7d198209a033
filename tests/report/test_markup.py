"""Text in a page is text: no markup, nothing that nobody sees or that turns a line round."""

import pytest

from visitlab_cli.report.markup import Html, element


@pytest.mark.parametrize(
    ("text", "stands"),
    [
        ("<b>&\"'", "&lt;b&gt;&amp;&quot;&#x27;"),
        ("a\u202e\u200b\x00\x1bb", "a\\u202e\\u200b\\x00\\x1bb"),
        ("two\nlines, naïve 日本", "two\nlines, naïve 日本"),
    ],
)
def test_text_and_attributes_are_written_so(text, stands):
    assert element("p", text, title=text) == f'<p title="{stands}">{stands}</p>'
    assert element("p", Html("<i></i>")) == "<p><i></i></p>"
