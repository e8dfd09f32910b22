"""The page's part in calibrating gaze: it shows the target to look at, and Esc gives the calibration up."""

import viser

from higvf_console.core.reports import Calibrated, CaptureReport
from higvf_console.ui.page import page
from higvf_console.ui.theme import CSS

_PROGRESS_STEP = 0.05  # smaller ones are not sent


class Calibration:
    """Shows every page the target, whenever it changes."""

    def __init__(self, server: viser.ViserServer, gaze: Calibrated | None) -> None:
        """Shows nothing yet. Install it ahead of the keys: Esc is its own while a target is shown.

        Args:
            server: whose pages show it.
            gaze: what is calibrated; None = nothing can be.
        """
        self._server = server
        self._shown: object = None
        colours = {"ground": CSS.surround, "faint": CSS.border, "colour": CSS.stroke, "text": CSS.axis_text}

        def cancel(_client_id: int, _body: page.Body) -> None:
            if gaze is not None:
                gaze.cancel_capture()

        page.listen(server, "calibration", cancel)
        page.install(server, "calibration", colours)

    def update(self, capture: CaptureReport | None) -> None:
        """Shows how the calibration stands; call it from the view thread."""
        target = shown_target(capture)
        if target != self._shown:
            self._shown = target
            page.call(self._server, "calibration", "show", target)


def shown_target(capture: CaptureReport | None) -> dict[str, object] | None:
    """The target as it is sent to the page; None when there is none."""
    if capture is None or capture.target is None:
        return None
    progress = round(capture.progress / _PROGRESS_STEP) * _PROGRESS_STEP
    return {"point": capture.target.tolist(), "number": capture.number, "targets": capture.targets,
            "progress": round(progress, 3)}  # fmt: skip
