"""The card of the run, and what the buttons of all cards do."""

import json
import threading
import time
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import viser

from higvf_console.core.arguments import one_of
from higvf_console.core.commands import ContinueRun, LoadScenario, ResetRun, StartRun
from higvf_console.core.interface import PointerSink
from higvf_console.runtime.phase import Phase
from higvf_console.runtime.report import watched_report
from higvf_console.runtime.result import run_result
from higvf_console.scenario.kept import Draft, recent_files
from higvf_console.ui.cards.briefing import ready_html
from higvf_console.ui.cards.result_sheet import result_html
from higvf_console.ui.cards.scenarios import LOADING_HTML, Choice, recent_choices, scenarios_html, shipped_choices
from higvf_console.ui.page import cards
from higvf_console.ui.page.notice import telling
from higvf_console.ui.widgets.html import clock

if TYPE_CHECKING:
    from higvf_console.runtime.persistence.drafts import Drafts
    from higvf_console.runtime.session import Session
    from higvf_console.runtime.snapshot import Snapshot


class RunCard:
    """Shows what belongs to the phase of the run, and takes what is pressed on any card."""

    def __init__(
        self,
        server: viser.ViserServer,
        session: "Session",
        sink: PointerSink,
        drafts: "Drafts | None",
        choose_file: Callable[[int], None],
    ) -> None:
        """Installs the cards.

        Args:
            server: whose pages show them.
            session: whose run.
            sink: takes the commands.
            drafts: of this console; None = nothing is kept.
            choose_file: opens the file chooser of a page (client).
        """
        self._server, self._session, self._sink = server, session, sink
        self._drafts, self._choose_file = drafts, choose_file
        self._shown = ("", "")
        self._ready_of: tuple[object, ...] = ()
        self._ready = ""
        self._shipped: tuple[Choice, ...] = ()
        self._recent: tuple[Choice, ...] = ()
        cards.install(server, telling(server, self._act))

    def update(self, snapshot: "Snapshot") -> None:
        """Shows the card of a snapshot's phase."""
        card = self._card(snapshot)
        if card != self._shown:
            self._shown = card
            cards.show(self._server, *card)

    def _card(self, snapshot: "Snapshot") -> tuple[str, str]:
        offered = self._drafts.offered if self._drafts is not None else None
        match snapshot.phase.phase:
            case _ if self._session.interrupted is not None:
                return "interrupted", interrupted_html(self._session.interrupted)
            case Phase.READY:
                return "ready", self._ready_html(snapshot, offered)
            case Phase.ENDED if self._session.attended:
                return "ended", result_html(run_result(snapshot, self._session.baseline), snapshot.scenario.title)
            case _ if offered is not None:
                return "draft", f'<div class="body">{draft_html(offered)}</div>'
            case _:
                return "", ""

    def _ready_html(self, snapshot: "Snapshot", offered: Draft | None) -> str:
        """The briefing, made anew when what it tells of has changed."""
        armed = snapshot.team is not None and snapshot.team.armed
        key = (snapshot.scenario, snapshot.setup, snapshot.last, offered, armed)
        if len(self._ready_of) != len(key) or any(a is not b for a, b in zip(key, self._ready_of, strict=True)):
            self._ready_of = key
            self._ready = ready_html(snapshot, draft_html(offered) if offered is not None else "")
        return self._ready

    def _act(self, client_id: int, act: str, value: str) -> None:
        acts: dict[str, Callable[[], object]] = {
            "start": lambda: self._sink.push(StartRun()),
            "again": self._again,
            "keep": self._decided,
            "continue": lambda: self._sink.push(ContinueRun()),
            "report": lambda: self._save_report(client_id),
            "scenarios": lambda: self.open_scenarios(client_id),
            "own_file": lambda: self._choose_file(client_id),
            "load": lambda: self._load(value),
            "restore": self._restore,
            "dismiss": self._dismiss,
        }
        acts[one_of("button of a card", act, acts)]()

    def _again(self) -> None:
        self._decided()
        self._sink.push(ResetRun())

    def _decided(self) -> None:
        self._session.interrupted = None

    def open_scenarios(self, client_id: int) -> None:
        """Opens the scenarios on a page; their pictures are drawn on a thread of their own, the first time."""
        threading.Thread(target=self._open_scenarios, args=(client_id,), name="scenarios", daemon=True).start()

    def _open_scenarios(self, client_id: int) -> None:
        if not self._shipped:
            cards.open_card(self._server, LOADING_HTML, client_id)
            self._shipped = shipped_choices()
        self._recent = recent_choices(recent_files(self._drafts.folder)) if self._drafts is not None else ()
        html = scenarios_html(self._shipped, self._recent, self._session.scenario.text)
        cards.open_card(self._server, html, client_id)

    def _load(self, value: str) -> None:
        choices = {choice.value: choice for choice in (*self._shipped, *self._recent) if choice.text}
        choice = choices[one_of("scenario", value, choices)]
        self._sink.push(LoadScenario(choice.text, choice.name, waits=self._session.waits))

    def _restore(self) -> None:
        draft = self._drafts.take() if self._drafts is not None else None
        if draft is not None:
            self._sink.push(LoadScenario(draft.text, "draft.yaml", waits=self._session.waits))

    def _dismiss(self) -> None:
        if self._drafts is not None:
            self._drafts.dismiss()

    def _save_report(self, client_id: int) -> None:
        client: Any = self._server.get_clients().get(client_id)
        if client is not None:
            content = json.dumps(watched_report(self._session), indent=2, allow_nan=False) + "\n"
            name = f"{self._session.scenario.name}-report.json"
            client.send_file_download(name, content.encode(), save_immediately=True)


def interrupted_html(time: float) -> str:
    """The question what becomes of a run whose console was killed at session `time` [s]."""
    return (
        f"<header><h2>The console was killed at {clock(time)}</h2></header>"
        '<div class="body"><p>Its run is restored as it was within the last second. STOP is active: reset it when the '
        "team may move.</p></div>"
        '<footer><button class="act first" data-act="keep">Keep this run</button>'
        '<button class="act" data-act="again">Start anew</button></footer>'
    )


def draft_html(draft: Draft) -> str:
    """The offer of a draft that was left."""
    when = time.strftime("%d %b, %H:%M", time.localtime(draft.saved))
    return (
        f'<div class="note"><span>The console ended before an edited world was saved ({when}).</span>'
        '<button class="act" data-act="restore">Open it</button>'
        '<button class="act" data-act="dismiss">Dismiss</button></div>'
    )
