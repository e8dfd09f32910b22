"""Labels of events that a file tells apart by more than one text."""

from collections import defaultdict
from collections.abc import Sequence

MOST = 30  # more kinds of one label are measurements, not kinds


def told_apart(events: Sequence[tuple[str, str]], form: str) -> tuple[list[str], list[str]]:
    """Return the label of each event, and notes.

    Args:
        events: label and kind of each; the kind is empty where unknown.
        form: label of the events that share a label and differ in their kind, such as `{label}/{kind}`.
    """
    kinds: defaultdict[str, set[str]] = defaultdict(set)
    for label, kind in events:
        kinds[label].add(kind)
    many = {label for label, found in kinds.items() if len(found) > MOST}
    shared = {label for label, found in kinds.items() if len(found) > 1} - many
    labels = [form.format(label=label, kind=kind) if kind and label in shared else label for label, kind in events]
    named = form.format(label="LABEL", kind="KIND")
    notes = [f"events labelled {label} are of {len(kinds[label])} kinds: read as {named}" for label in sorted(shared)]
    notes += [f"events labelled {label} are of {len(kinds[label])} kinds, which are ignored" for label in sorted(many)]
    return labels, notes


def joined_label(texts: Sequence[str]) -> str:
    """Return the label of a marker of several texts: all that are not empty, joined by `/`."""
    return "/".join(text for text in texts if text)
