"""A folder of named, checksummed files that only saves work: whatever is wrong with it is reported, never raised.

A folder that is missing, read-only, full or no folder at all costs time and nothing else. A file that is damaged is
removed and made anew. Writers replace whole files, so processes that write at once do not disturb each other.
"""

import contextlib
import hashlib
import logging
import os
import shutil
import uuid
from collections.abc import Callable
from pathlib import Path

_log = logging.getLogger(__name__)
_KEPT_FOR = 14 * 86400.0  # [s]; folders that nobody has used for so long are removed
_PROBE = "probe"  # a file that nobody reads
_DIGEST = hashlib.sha256().digest_size


class Store:
    """Files in one folder, read and written by name.

    Args:
        find: names the folder when it is first needed; its parent holds such folders only.
    """

    def __init__(self, find: Callable[[], Path]) -> None:
        """Touches nothing yet."""
        self._find = find
        self._folder: Path | None = None
        self._usable = True  # whether writing is worth a try

    @property
    def folder(self) -> Path:
        """Where the files are."""
        if self._folder is None:
            self._folder = self._find()
            with contextlib.suppress(OSError):
                os.utime(self._folder)  # in use: not to be removed
        return self._folder

    def read(self, name: str) -> bytes | None:
        """The content of a file; None where there is none, or it is damaged."""
        try:
            content = (self.folder / name).read_bytes()
        except FileNotFoundError:
            return None
        except OSError as error:
            self._give_up(error)
            return None
        digest, payload = content[:_DIGEST], content[_DIGEST:]
        if digest == hashlib.sha256(payload).digest():
            return payload
        self.discard(name, "its checksum is wrong")
        return None

    def writable(self) -> bool:
        """Whether files can be stored; the first failure is reported."""
        self.write(_PROBE, b"")
        return self._usable

    def write(self, name: str, payload: bytes) -> None:
        """Stores a file, in one piece or not at all."""
        if not self._usable:
            return
        try:
            self._make_folder()
            draft = self.folder / f"{name}.{uuid.uuid4().hex}.draft"
            try:
                draft.write_bytes(hashlib.sha256(payload).digest() + payload)
                draft.replace(self.folder / name)
            except OSError:
                draft.unlink(missing_ok=True)
                raise
        except OSError as error:
            self._give_up(error)

    def discard(self, name: str, reason: str) -> None:
        """Removes a file that cannot be used, and reports it."""
        _log.warning("The compile cache file %s cannot be used (%s); compiling it anew.", self.folder / name, reason)
        with contextlib.suppress(OSError):
            (self.folder / name).unlink()

    def _give_up(self, error: OSError) -> None:
        if self._usable:
            self._usable = False
            reason = error.strerror or str(error)
            _log.warning("The compile cache %s cannot be used (%s); compiling without it.", self.folder, reason)

    def _make_folder(self) -> None:
        if self.folder.is_dir():
            return
        self.folder.mkdir(parents=True, exist_ok=True)
        now = self.folder.stat().st_mtime
        for other in self.folder.parent.iterdir():
            if other.is_dir() and now - other.stat().st_mtime > _KEPT_FOR:
                shutil.rmtree(other, ignore_errors=True)
