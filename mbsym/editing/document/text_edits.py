"""Primitives as edits of editor text: lines that say the same before and after are not touched.

The lines of the data before and after are compared label by label, and what differs is put into the lines that are
there.  Blocks are numbered anew where their order changes, and with them every line that names a body.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, field

from mbsym.editing.document.meaning import Edit, applied
from mbsym.editing.document.primitives import Add, Primitive, Remove, Replace, Shift
from mbsym.editing.document.written import Data, Refused, Written, node_at
from mbsym.source.labels import ASSUMPTIONS, SECTIONS
from mbsym.source.placed import Scalar
from mbsym.source.text_lines import HEADING, label_of, lines_of, word_of
from mbsym.source.text_writer import BLOCKS, ROWS, Line, lines_of_data, title_shown

_LISTS = {word.lower(): key for key, word in BLOCKS.items()}


@dataclass(slots=True)
class _Block:
    heading: Scalar | None
    lines: list[Scalar] = field(default_factory=list)


@dataclass(slots=True)
class _There:
    """The blocks of the text as they stand."""

    header: _Block
    sections: dict[str, _Block] = field(default_factory=dict)
    lists: dict[str, list[_Block]] = field(default_factory=dict)


def text_edits(document: Written, primitive: Primitive, before: Data, after: Data) -> list[Edit]:
    """The edits of the text that one primitive is."""
    if not isinstance(before, dict) or not isinstance(after, dict):
        raise Refused("bad-path", "a description is a mapping")
    direct = _value_in_place(document, primitive)
    if direct is not None:
        return direct
    there, old, new = _blocks(document.text), lines_of_data(before), lines_of_data(after)
    edits = _patched(document, there.header, old.header, new.header)
    for title in dict.fromkeys((*old.sections, *new.sections)):
        block = there.sections.get(title)
        if block is None:
            edits.append(_new_section(document, title, new.sections[title]))
        elif title not in new.sections:
            edits.append(Edit(*_region(document, block), ""))
        else:
            edits += _patched(document, block, old.sections.get(title, []), new.sections[title], title)
    for section in dict.fromkeys((*old.blocks, *new.blocks)):
        edits += _listed(document, primitive, section, there, old.blocks.get(section, []), new.blocks.get(section, []))
    return edits


def _value_in_place(document: Written, primitive: Primitive) -> list[Edit] | None:
    """One value for another where it stands in the text itself."""
    if not isinstance(primitive, Replace) or not isinstance(primitive.data, str):
        return None
    node = node_at(document.tree, primitive.path)
    if not isinstance(node, Scalar) or not node.literal or not node.text or primitive.path[-1] in ("name", "meaning"):
        return None
    if not primitive.data or any(mark in primitive.data for mark in '\n#;"'):
        return None
    return [Edit(*document.extent(node), primitive.data)]


def _blocks(text: str) -> _There:
    there = _There(_Block(None))
    current = there.header
    for line in lines_of(text):
        heading, title = HEADING.match(line.text), word_of(line.text.rstrip(":"))
        if heading is not None:
            current = _Block(line)
            there.lists.setdefault(_LISTS[heading[1].lower()], []).append(current)
        elif title in SECTIONS or title == ASSUMPTIONS:
            current = _Block(line)
            there.sections[title] = current
        else:
            current.lines.append(line)
    return there


# --- one block --------------------------------------------------------------------------------------------------------


@dataclass(slots=True)
class _Labelled:
    """A line with its label, and where its value stands; rows of a tensor belong to their label."""

    start: int
    value: tuple[int, int]
    end: int


def _patched(document: Written, block: _Block, old: list[Line], new: list[Line], section: str = "") -> list[Edit]:
    """What differs between the lines before and after, put into the lines that are there."""
    there = _labelled(document, block, section)
    before, after = _keyed(old, section), _keyed(new, section)
    if [key for key in before if key in after] != [key for key in after if key in before]:
        return [_rewritten(document, block, new, section)]
    edits = []
    for key in before:
        line = there.get(key)
        if key not in after and line is not None:
            end = min(len(document.text), line.end + 1)
            edits.append(Edit(document.line_start(line.start), end, ""))
    inserted: dict[int, str] = {}
    position = _behind_heading(document, block)
    for key, (label, value) in after.items():
        line = there.get(key)
        if line is None and (key not in before or before[key][1] != value):
            inserted[position] = inserted.get(position, "") + "\n" + _written(label, value, section, block)
        elif line is not None:
            position = line.end
            if key in before and before[key][1] != value:
                edits.append(_put(document, line, value))
    return edits + [Edit(place, place, text) for place, text in inserted.items()]


def _put(document: Written, line: _Labelled, value: str) -> Edit:
    start, end = line.value
    gap = "" if start == end or document.text[start - 1 : start] in (" ", "\t") or value.startswith("\n") else " "
    if start == end and not value.startswith("\n") and document.text[start - 1 : start] != " ":
        gap = " "
    if value.startswith("\n"):
        while document.text[start - 1 : start] in (" ", "\t", "\n"):
            start -= 1
    return Edit(start, end, gap + value)


def _keyed(lines: list[Line], section: str) -> dict[tuple[str, int], Line]:
    seen: Counter[str] = Counter()
    lines_by_key = {}
    for label, value in lines:
        word = label if section else word_of(label)
        lines_by_key[word, seen[word]] = (label, value)
        seen[word] += 1
    return lines_by_key


def _labelled(document: Written, block: _Block, section: str) -> dict[tuple[str, int], _Labelled]:
    seen: Counter[str] = Counter()
    there: dict[tuple[str, int], _Labelled] = {}
    last: _Labelled | None = None
    for line in block.lines:
        label, value = label_of(line)
        start, stop = _place(document, line)
        word = line.text if section == ASSUMPTIONS else None if label is None else label.text
        if word is None and word_of(line.text) == "tensor of inertia":
            word = line.text
        if word is None:
            if last is not None:  # a row of a tensor, or a value below its label
                first = last.value[0] if last.value[0] != last.value[1] else start
                last.value, last.end = (first, stop), document.line_end(stop)
            continue
        word = word if section else word_of(word)
        place = (stop, stop) if label is None or section == ASSUMPTIONS else _place(document, value)
        last = _Labelled(start, place, document.line_end(stop))
        there[word, seen[word]] = last
        seen[word] += 1
    return there


def _place(document: Written, scalar: Scalar) -> tuple[int, int]:
    start = document.offset(scalar.span)
    return start, start + len(scalar.text)


def _behind_heading(document: Written, block: _Block) -> int:
    if block.heading is not None:
        return document.line_end(document.offset(block.heading.span))
    return document.line_end(document.offset(block.lines[-1].span)) if block.lines else 0


def _written(label: str, value: str, section: str, block: _Block) -> str:
    if section == ASSUMPTIONS:
        return f"  {label}"
    if section:
        return f"  {label} = {value}"
    shown = label if block.heading is not None and label != label.lower() else label.capitalize()
    blank = "" if value.startswith("\n") else " "
    return f"{'  ' if block.heading is not None else ''}{shown}:{blank}{value}"


def _rewritten(document: Written, block: _Block, new: list[Line], section: str) -> Edit:
    """Where the order of lines is another one they are all written again."""
    if not block.lines:
        raise Refused("bad-path", "there is nothing to write again")
    start = document.line_start(document.offset(block.lines[0].span))
    end = document.line_end(document.offset(block.lines[-1].span))
    return Edit(start, end, "\n".join(_written(label, value, section, block) for label, value in new))


# --- blocks that come and go ------------------------------------------------------------------------------------------


def _region(document: Written, block: _Block) -> tuple[int, int]:
    """The whole lines of a block, its heading with them; one blank line before it."""
    lines = [*([block.heading] if block.heading is not None else []), *block.lines]
    start = document.line_start(document.offset(lines[0].span))
    end = min(len(document.text), document.line_end(document.offset(lines[-1].span)) + 1)
    if document.text[:start].endswith("\n\n"):
        start -= 1
    return start, end


def _at_end(document: Written, text: str) -> Edit:
    end = len(document.text)
    bare = document.text.endswith("\n") or not document.text
    return Edit(end, end, f"\n{text}\n" if bare else f"\n\n{text}")


def _new_section(document: Written, title: str, lines: list[Line]) -> Edit:
    block = _Block(Scalar(title, document.tree.span)) if document.tree is not None else _Block(None)
    written = [title_shown(title), *(_written(label, value, title, block) for label, value in lines)]
    return _at_end(document, "\n".join(written))


def _new_block(section: str, number: int, lines: Iterable[Line]) -> str:
    written = [f"{BLOCKS[section]} description ({number})"]
    for label, value in lines:
        shown = label if label != label.lower() or section in ("loads", "constraints") else label.capitalize()
        shown = shown[:1].upper() + shown[1:] if label.startswith("type of") else shown
        written.append(f"  {shown}:{'' if value.startswith(ROWS) else ' '}{value}")
    return "\n".join(written)


def _listed(
    document: Written, primitive: Primitive, section: str, there: _There, old: list[list[Line]], new: list[list[Line]]
) -> list[Edit]:
    """The blocks of one list: those that stay patched and numbered, others written, taken out or moved."""
    blocks = there.lists.get(section, [])
    if len(blocks) != len(old):
        raise Refused("not-so", f"not every block of '{section}' can be read", "mend the text first")
    order = _order(primitive, section, len(old), len(new))
    edits: list[Edit] = []
    texts: dict[int, str] = {}
    for number, origin in enumerate(order):
        if origin is None:
            continue
        inner = _patched(document, blocks[origin], old[origin], new[number]) + _numbered(
            document, blocks[origin], number + 1
        )
        if isinstance(primitive, Shift) and primitive.path[:1] == (section,) and primitive.path[1:2] == (origin,):
            start, end = _region(document, blocks[origin])
            moved = [Edit(edit.start - start, edit.end - start, edit.insert) for edit in inner]
            texts[number] = applied(document.text[start:end], moved).strip("\n")
            edits.append(Edit(start, end, ""))
        else:
            edits += inner
    remaining = {origin for origin in order if origin is not None}
    edits += [Edit(*_region(document, block), "") for index, block in enumerate(blocks) if index not in remaining]
    for number, origin in enumerate(order):
        if origin is None:
            texts[number] = _new_block(section, number + 1, new[number])
    behind: dict[int, str] = {}
    for number in sorted(texts):
        before = [earlier for earlier in order[:number] if earlier is not None and order.index(earlier) not in texts]
        if before:
            place = _region(document, blocks[before[-1]])[1]
        elif blocks:
            place = _region(document, blocks[0])[0]
        else:
            edits.append(_at_end(document, texts[number]))
            continue
        behind[place] = behind.get(place, "") + "\n" + texts[number] + "\n"
    for place, text in behind.items():
        bare = place == len(document.text) and not document.text.endswith("\n")
        edits.append(Edit(place, place, "\n" + text.removesuffix("\n") if bare else text))
    return edits


def _order(primitive: Primitive, section: str, old: int, new: int) -> list[int | None]:
    """For each block after the change which one it was before; None for a new one."""
    order: list[int | None] = list(range(old))
    path = primitive.path
    if path[0] != section:
        return order
    if len(path) == 1:
        return [k if k < old and not isinstance(primitive, Remove) else None for k in range(new)]
    index = path[1]
    assert isinstance(index, int)
    if len(path) == 2 and isinstance(primitive, Add):
        order.insert(index, None)
    elif len(path) == 2 and isinstance(primitive, Remove):
        del order[index]
    elif len(path) == 2 and isinstance(primitive, Shift):
        del order[index]
        before = primitive.before
        order.insert(len(order) if not isinstance(before, int) else before - (before > index), index)
    return order


def _numbered(document: Written, block: _Block, number: int) -> list[Edit]:
    match = HEADING.match(block.heading.text) if block.heading is not None else None
    if match is None or block.heading is None or int(match[2]) == number:
        return []
    start = document.offset(block.heading.span)
    return [Edit(start + match.start(2), start + match.end(2), str(number))]
