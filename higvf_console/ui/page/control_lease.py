"""Who of several pages steers: a pure state machine, fed with the time, the pages' signs of life and their clicks.

One page has control and the others watch. Whoever comes while nobody has it gets it. A page that is not heard of for
`timeout` is forgotten, so that a reload keeps its control, and its place among those who wait; what a forgotten or a
willing holder leaves goes to whoever has waited longest. A forgotten page that comes back has its name again. Anybody
may take over, at any time.
"""

from typing import NamedTuple

from higvf_console.core.commands import ControlChange

AWAKE = 3.0  # a page that was heard of within so long can be given control unasked [s]
MOST_PAGES = 128  # that are remembered at once


class Page(NamedTuple):
    """A browser's page, through all its reloads.

    Attributes:
        identity: its own secret; the same after a reload.
        name: as people read it.
        last_seen: when it last gave a sign of life [s].
        may_steer: whether it can be given control; an observer cannot.
    """

    identity: str
    name: str
    last_seen: float
    may_steer: bool = True


class Change(NamedTuple):
    """Something to tell everybody.

    Attributes:
        how: what has happened.
        page: name of the page that steers now, asks or is refused; empty = nobody steers.
        by: name of the page that did it, or that was lost.
    """

    how: ControlChange
    page: str
    by: str


class Control(NamedTuple):
    """Who is there, who steers, who waits.

    Attributes:
        pages: in the order in which they came.
        holder: identity of the page that steers; empty = nobody does.
        waiting: identities of those who asked, longest first.
        names_given: how many pages have had a name so far.
        former: pages that were forgotten, the last one last.
    """

    pages: tuple[Page, ...] = ()
    holder: str = ""
    waiting: tuple[str, ...] = ()
    names_given: int = 0
    former: tuple[Page, ...] = ()

    def page(self, identity: str) -> Page | None:
        """The page of that identity, if it is there."""
        return next((page for page in self.pages if page.identity == identity), None)

    def name(self, identity: str) -> str:
        """Its name; empty when it is not there."""
        page = self.page(identity)
        return page.name if page else ""


Outcome = tuple[Control, Change | None]


def heartbeat(control: Control, identity: str, now: float, *, may_steer: bool = True) -> Outcome:
    """A page gave a sign of life at `now` [s]; one that was not there has come.

    Where there is no room, the page that was silent longest is forgotten: an observer, or else one that does not steer.

    Raises:
        ValueError: an observer has come, and all pages may steer.
    """
    if control.page(identity) is not None:
        pages = tuple(page._replace(last_seen=now) if page.identity == identity else page for page in control.pages)
        control = control._replace(pages=pages)
    else:
        if len(control.pages) >= MOST_PAGES:
            control = _with_room(control, may_steer)
        former = next((page for page in control.former if page.identity == identity), None)
        number = control.names_given + (former is None)
        page = Page(identity, former.name if former else f"Browser {number}", now, may_steer)
        others = tuple(page for page in control.former if page is not former)
        control = control._replace(pages=(*control.pages, page), names_given=number, former=others)
        if not control.holder and may_steer:
            return _given(control, identity, ControlChange.FIRST, identity)
    return control, None


def _with_room(control: Control, may_steer: bool) -> Control:
    """Without the page that can be spared most."""
    spared = [page for page in control.pages if not page.may_steer]
    if not spared and may_steer:
        spared = [page for page in control.pages if page.identity != control.holder]
    if not spared:
        raise ValueError(f"{MOST_PAGES} pages that may steer are here already")
    gone = min(spared, key=lambda page: page.last_seen)
    return control._replace(
        pages=tuple(page for page in control.pages if page is not gone),
        waiting=tuple(identity for identity in control.waiting if identity != gone.identity),
    )


def forgotten(control: Control, now: float, timeout: float) -> Outcome:
    """Forgets the pages that were not heard of for `timeout` [s]."""
    gone = {page.identity for page in control.pages if now - page.last_seen > timeout}
    if not gone:
        return control, None
    lost, by = control.holder in gone, control.name(control.holder)
    leave = tuple(page for page in control.pages if page.identity in gone)
    control = control._replace(
        former=(*control.former, *leave)[-MOST_PAGES:],
        pages=tuple(page for page in control.pages if page.identity not in gone),
        waiting=tuple(identity for identity in control.waiting if identity not in gone),
    )
    if not lost:
        return control, None
    awake = (page.identity for page in control.pages if now - page.last_seen <= AWAKE)
    return _left(control, tuple(awake), ControlChange.LOST, by)


def asked(control: Control, identity: str) -> Outcome:
    """A page asks for control; where nobody has it, it gets it."""
    if control.page(identity) is None or identity in (control.holder, *control.waiting):
        return control, None
    if not control.holder:
        return _given(control, identity, ControlChange.FIRST, identity)
    name = control.name(identity)
    return control._replace(waiting=(*control.waiting, identity)), Change(ControlChange.ASKED, name, name)


def answered(control: Control, identity: str, name: str, *, granted: bool) -> Outcome:
    """The page that steers grants or refuses control to the waiting page of a name."""
    asker = next((waiting for waiting in control.waiting if control.name(waiting) == name), None)
    if identity != control.holder or asker is None:
        return control, None
    if granted:
        return _given(control, asker, ControlChange.GRANTED, identity)
    waiting = tuple(other for other in control.waiting if other != asker)
    return control._replace(waiting=waiting), Change(ControlChange.REFUSED, name, control.name(identity))


def taken(control: Control, identity: str) -> Outcome:
    """A page takes control, whoever has it."""
    if control.page(identity) is None or identity == control.holder:
        return control, None
    return _given(control, identity, ControlChange.TAKEN if control.holder else ControlChange.FIRST, identity)


def released(control: Control, identity: str) -> Outcome:
    """The page that steers lets go of it."""
    if not identity or identity != control.holder:
        return control, None
    return _left(control, control.waiting, ControlChange.RELEASED, control.name(identity))


def _given(control: Control, identity: str, how: ControlChange, by: str) -> Outcome:
    waiting = tuple(other for other in control.waiting if other != identity)
    after = control._replace(holder=identity, waiting=waiting)
    return after, Change(how, after.name(identity), control.name(by))


def _left(control: Control, able: tuple[str, ...], how: ControlChange, by: str) -> Outcome:
    heir = next((identity for identity in control.waiting if identity in able), "")
    waiting = tuple(identity for identity in control.waiting if identity != heir)
    return control._replace(holder=heir, waiting=waiting), Change(how, control.name(heir), by)
