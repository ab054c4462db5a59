"""Write elements as an XML file in UTF-8, without comments, processing instructions and document type definitions."""

from xml.sax.saxutils import escape, quoteattr

from bodycheck.robots.elements import MAX_DEPTH, Element, refuse


def written(root: Element) -> bytes:
    """Return the content of an XML file with an element and everything in it.

    Raises `BadInput` if elements are nested more than `MAX_DEPTH` deep, as they may be after files have been put into others.
    """
    parts = ['<?xml version="1.0" encoding="UTF-8"?>\n']
    left: list[tuple[Element | str, int]] = [(root, 1)]
    while left:
        one, depth = left.pop()
        if isinstance(one, str):
            parts.append(one)
            continue
        if depth > MAX_DEPTH:
            refuse(one, None, f"elements are nested more than {MAX_DEPTH} deep")
        attributes = "".join(f" {name}={quoteattr(value)}" for name, value in one.attributes.items())
        text = "".join(escape(piece, {"\r": "&#13;"}) for piece in one.text)
        if not one.children and not text:
            parts.append(f"<{one.tag}{attributes}/>\n")
            continue
        parts.append(f"<{one.tag}{attributes}>{text or chr(10)}")
        left.append((f"</{one.tag}>\n", depth))
        left += [(child, depth + 1) for child in reversed(one.children)]
    return "".join(parts).encode("utf-8")
