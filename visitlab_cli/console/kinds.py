"""What `visitlab agents` and `visitlab humans` tell of each kind."""

from typing import Any

from visitlab_cli.console.words import aligned
from visitlab_cli.terminal import plain, tell_json, tell_text

HEAD = ["kind", "of", "compiled", "tasks", "parameters"]
NO_WORD = "-"
"""Stands for the word of the paper's human, which has none."""


def tell_kinds(section: str, *, as_json: bool) -> None:
    """Print every kind of `agents` or `humans`; what can't be used is told with the reason, and is no failure."""
    found = _kinds(section)
    if as_json:
        tell_json({section: found})
        return
    rows = [HEAD]
    for each in found:
        if each["error"]:
            rows.append([each["kind"] or NO_WORD, each["package"], "-", "-", f"can't be used: {each['error']}"])
            continue
        parameters = ", ".join(_parameter(name, value) for name, value in each["parameters"].items())
        tasks = ", ".join(each["tasks"]) or "-"
        whose = " ".join(filter(None, (each["package"], each["version"])))
        rows.append([each["kind"] or NO_WORD, whose, "yes" if each["compiled"] else "no", tasks, parameters])
    tell_text(aligned([list(map(plain, row)) for row in rows], words=len(HEAD)))


def _parameter(name: str, value: Any) -> str:
    return name if value == {"required": True} else f"{name}={value['default']}"


def _kinds(section: str) -> list[dict[str, Any]]:
    from visitlab_cli import __version__
    from visitlab_cli.config.building import KINDS
    from visitlab_cli.plugins import OURS, PluginError, all_words, faults_of_files, find

    built_in, base = KINDS[section]
    found = [_told(word, OURS, __version__, kind) for word, kind in sorted(built_in.items())]
    for source in all_words(section, base):
        try:
            if source.word in built_in:
                raise PluginError(f"{source.word} is a kind of {OURS}'s own; it needs another name")
            found.append(_told(source.word, source.package, source.version, find(section, source.word, base)))
        except PluginError as error:
            found.append(
                {"kind": source.word, "package": source.package, "version": source.version, "error": str(error)}
            )
    told = {each["package"] for each in found}
    for file, fault in faults_of_files(KINDS).items():
        if str(file) not in told:
            found.append({"kind": NO_WORD, "package": str(file), "version": "", "error": fault})
    return found


def _told(word: str, package: str, version: str, kind: Any) -> dict[str, Any]:
    from visitlab_cli.kinds import KIND
    from visitlab_cli.settings import defaults_of

    parameters = {
        name: {"default": default} if has else {"required": True}
        for name, (has, default) in defaults_of(kind).items()
        if name != KIND
    }
    return {
        "kind": word,
        "package": package,
        "version": version,
        "compiled": kind.compiled(),
        "tasks": list(getattr(kind, "tasks", ())),
        "parameters": parameters,
        "error": None,
    }
