"""`like`: an entry that starts from another one of the same mapping."""

from visitlab_cli.config.names import PAPER_LAB
from visitlab_cli.kinds import KIND, UNSAID
from visitlab_cli.wording import or_else
from visitlab_cli.yaml.document import Node
from visitlab_cli.yaml.problems import Issue, Path, dotted

LIKE = "like"
SECTIONS = {"humans": "human", "labs": "lab", "agents": "agent"}
NO_ENTRY = "the paper's lab has no entry that another could start from; its cells and rooms are those of rooms: 3 x 3"
LONGEST_CHAIN = 32
MOST_TAKEN_OVER = 20_000


def resolve_like(document: Node) -> tuple[Node, list[Issue], set[Path]]:
    """The document without `like`, what was wrong with it, and the entries that are not whole therefore."""
    issues: list[Issue] = []
    broken: set[Path] = set()
    sections = dict(document.value)
    for section in SECTIONS:
        if section in sections and isinstance(sections[section].value, dict):
            chains = _Chains(section, sections[section].value, issues, broken)
            whole = {name: chains.whole(name, ()) for name in sections[section].value}
            sections[section] = sections[section].with_entries(whole)
    return document.with_entries(sections), issues, broken


class _Chains:
    def __init__(self, section: str, entries: dict[str, Node], issues: list[Issue], broken: set[Path]) -> None:
        self.section, self.entries, self.issues, self.broken = section, entries, issues, broken
        self.taken_over = 0

    def whole(self, name: str, followers: tuple[str, ...]) -> Node:
        """The entry with all that it takes over; `followers` start from it, one from the other."""
        entry = self.entries[name]
        if LIKE not in entry.entries():
            return entry
        chain = (*followers, name)
        base = self.base(chain, entry.value[LIKE].value)
        own = {key: value for key, value in entry.value.items() if key != LIKE}
        self.taken_over += sum(value.size() for value in base.values())
        if self.taken_over > MOST_TAKEN_OVER:
            self.wrong(chain, LIKE, f"all entries together take over more than {MOST_TAKEN_OVER} values")
            return entry.with_entries(own)
        if KIND in own and base and own[KIND].plain() != self.kind_of(base, own[KIND].plain()):
            self.wrong(chain, KIND, f"must be that of {entry.value[LIKE].value}, which it is like")
        return entry.with_entries({**base, **own})

    def kind_of(self, base: dict[str, Node], otherwise: object) -> object:
        """The word of what an entry starts from; of an agent that lacks it, which is told anyway, any will do."""
        return base[KIND].plain() if KIND in base else UNSAID if self.section == "humans" else otherwise

    def base(self, chain: tuple[str, ...], given: object) -> dict[str, Node]:
        """What the last of `chain` starts from."""
        if not isinstance(given, str) or given not in self.entries:
            others = [name for name in self.entries if name != chain[-1]]
            is_paper = self.section == "labs" and given == PAPER_LAB
            why = NO_ENTRY if is_paper else f"no {SECTIONS[self.section]} of this name{or_else(given, others)}"
            self.wrong(chain, LIKE, why)
        elif given in chain:
            self.wrong(chain, LIKE, f"goes round in a circle: {_arrows((*chain[chain.index(given) :], given))}")
        elif len(chain) > LONGEST_CHAIN:
            self.wrong(chain, LIKE, f"a chain of more than {LONGEST_CHAIN}")
        else:
            return self.whole(given, chain).entries()
        return {}

    def wrong(self, chain: tuple[str, ...], key: str, message: str) -> None:
        self.issues.append(Issue((self.section, chain[-1], key), message))
        self.broken.update((self.section, name) for name in chain)


def _arrows(chain: tuple[str, ...]) -> str:
    return " -> ".join(dotted((name,)) for name in chain)
