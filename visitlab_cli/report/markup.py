"""HTML from values: all text is escaped, so that no name from a file becomes markup, or turns the page round."""

import html

from visitlab_cli.terminal import plain_text


class Html(str):
    """Text that is markup already."""

    __slots__ = ()


Child = str | None
"""Markup, or plain text that is escaped; None is nothing."""


def element(name: str, *children: Child, **attributes: str | int | bool | None) -> Html:
    """An element with its children.

    Args:
        name: of the element.
        children: its content.
        attributes: by name, with `_` for `-` and a trailing one dropped (`class_`); True is an attribute without a
            value, None or False none at all.
    """
    written = "".join(_attribute(key, value) for key, value in attributes.items())
    return Html(f"<{name}{written}>{together(*children)}</{name}>")


def escape(text: str) -> str:
    """Text as it stands in a page: no markup, nothing unseen, nothing that HTML does not allow."""
    return html.escape(plain_text(text))


def together(*children: Child) -> Html:
    """Children one after the other."""
    return Html("".join(child if isinstance(child, Html) else escape(child) for child in children if child))


def _attribute(key: str, value: str | int | bool | None) -> str:
    if value is None or value is False:
        return ""
    name = key.rstrip("_").replace("_", "-")
    return f" {name}" if value is True else f' {name}="{escape(str(value))}"'
