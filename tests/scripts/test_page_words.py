"""Words of the link that the page of rc10-web writes, too."""

from __future__ import annotations

import re
from pathlib import Path

REPO = Path(__file__).resolve().parents[2]


def test_what_ends_with_its_client_is_asked_for_by_the_same_words_on_the_page() -> None:
    header = (REPO / "src" / "link" / "until_its_end.hpp").read_text()
    words = dict(re.findall(r'std::string_view (\w+) = "(\w+)";', header))
    assert len(words) == 2
    protocol = (REPO / "web" / "src" / "protocol.ts").read_text()
    assert words == dict(re.findall(r"export const (\w+) = \{ (\w+_at_end): 1 \};", protocol))


def test_they_stand_nowhere_else() -> None:
    sources = [*(REPO / "src").rglob("*.[ch]pp"), *(REPO / "web" / "src").glob("*.ts*")]
    written = re.compile(r"""["'{ ](disable|restore)_at_end["':]""")
    homes = {source.name for source in sources if written.search(source.read_text())}
    assert homes == {"until_its_end.hpp", "protocol.ts"}
