"""A page as a parser sees it: its elements with their attributes, its text, its data."""

import json
from html.parser import HTMLParser

WITHOUT_END = {"meta"}


class Parsed(HTMLParser):
    """`elements` are (name, attributes) in their order; `scripts` the text of each script by its type.

    Words that a `wbr` lets break are one word.
    """

    def __init__(self, page):
        super().__init__()
        self.elements, self.words, self.scripts, self._open, self._goes_on = [], [], {}, [], False
        self.feed(page)
        assert not self._open, self._open

    def handle_starttag(self, tag, attrs):
        self._goes_on = tag == "wbr"
        if self._goes_on:
            return
        self.elements.append((tag, dict(attrs)))
        if tag not in WITHOUT_END:
            self._open.append((tag, dict(attrs)))

    def handle_endtag(self, tag):
        self._goes_on = False
        assert self._open.pop()[0] == tag

    def handle_data(self, data):
        if self._open and self._open[-1][0] == "script":
            kind = self._open[-1][1].get("type", "")
            assert kind not in self.scripts
            self.scripts[kind] = data
        elif self._goes_on:
            self.words[-1] += data
        else:
            self.words.append(data)

    @property
    def text(self):
        return " ".join(" ".join(self.words).split())

    @property
    def data(self):
        return json.loads(self.scripts["application/json"])

    def attributes(self, wanted):
        return [attributes for name, attributes in self.elements if name == wanted]
