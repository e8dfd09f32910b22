"""Text tables: detection of encoding, compression, delimiter and columns, and row-by-row reading."""

import codecs
import contextlib
import csv
import gzip
import itertools
import math
import os
import re
import unicodedata
import zlib
from collections.abc import Iterator
from datetime import UTC, datetime
from pathlib import Path
from typing import IO, NamedTuple

from higvf_console.core.errors import InputError
from higvf_interfaces.paths import named

TIME_UNITS = {
    "s": 1.0,
    "ms": 1e-3,
    "μs": 1e-6,
    "us": 1e-6,
    "ns": 1e-9,
}  # [s]; NFKC maps both characters for mu to this one
_HEAD = 65_536  # bytes used to detect encoding and delimiter
_LONGEST_LINE = 1_000_000  # characters; a file with a longer line is not text
_TELLING = 20  # rows
_EPOCHS = ((1e17, 1e-9), (1e14, 1e-6), (1e11, 1e-3))  # scale to seconds of time stamps above a value
_WHOLE = re.compile(r"([+-]?\d+)[.,]0")
_DATE = re.compile(r"\d{4}-?\d\d-?\d\d[T ]")
_GZIP = b"\x1f\x8b"
_BOMS = {codecs.BOM_UTF8: "utf-8-sig", codecs.BOM_UTF16_LE: "utf-16", codecs.BOM_UTF16_BE: "utf-16"}


class Column(NamedTuple):
    """A column of a table: `Gaze point X [DACS px]` has the name "gaze point x" and the unit "dacs px"."""

    place: int
    title: str
    name: str
    unit: str


class TextFile(NamedTuple):
    """A file with the properties needed to detect its format and to read it as a text table.

    Attributes:
        path: a file, or a folder written by a device.
        encoding: encoding of the text.
        delimiter: delimiter of the cells.
        complete: whether the last line ends with a line break.
        first_line: first line that is not empty.
        columns: cells of that line.
        head: first bytes, decompressed; empty for a folder.
        packed: whether the file is compressed with gzip.
    """

    path: Path
    encoding: str
    delimiter: str
    complete: bool
    first_line: str
    columns: tuple[Column, ...]
    head: bytes = b""
    packed: bool = False

    @property
    def titles(self) -> str:
        """The column titles as text for messages, shortened if there are many."""
        shown = [column.title[:60] for column in self.columns[:40]]
        return ", ".join(shown) + (f", and {len(self.columns) - 40} more" if len(self.columns) > 40 else "")

    def find(self, *names: str, units: tuple[str, ...] | None = None) -> Column | None:
        """Return the first column with one of `names`, in order of preference, and one of `units` if given."""
        for name in names:
            for column in self.columns:
                if column.name == name and (units is None or column.unit in units):
                    return column
        return None

    def check_single(self, *columns: Column | None) -> None:
        """Refuse a header that gives the title of one of these columns to another one, too.

        Raises:
            InputError: naming the title; which of the columns is meant cannot be known.
        """
        for column in filter(None, columns):
            if sum((other.name, other.unit) == (column.name, column.unit) for other in self.columns) > 1:
                raise InputError(
                    f"{self.path}: several columns are called {column.title[:60]!r}; rename those that are not meant"
                )

    def lines(self, notes: list[str] | None = None, *, blank: bool = False) -> Iterator[str]:
        """Yield the lines without line breaks.

        Args:
            notes: receives a note if compressed data end prematurely.
            blank: whether to include empty lines.

        Raises:
            InputError: If the file is not text or cannot be read.
        """
        try:
            with self._open() as stream:
                while line := stream.readline(_LONGEST_LINE):
                    if len(line) == _LONGEST_LINE:
                        raise InputError(f"{self.path}: is not text: a line exceeds {_LONGEST_LINE} characters")
                    if blank or line.strip():
                        yield line.rstrip("\n")
        except (EOFError, zlib.error):
            if notes is not None:
                notes.append("the compressed data end prematurely: only the readable part is used")
        except OSError as problem:
            raise InputError(f"{self.path}: cannot be read: {problem}") from problem

    def rows(self, notes: list[str]) -> Iterator[list[str]]:
        """Yield the cells of each row below the header; a truncated last row is dropped with a note.

        Raises:
            InputError: If the text is not a table, or most rows have more cells than there are titles, as where decimal
                commas stand between commas; single ones are dropped with a note.
        """
        try:
            below = self._fitting(self._below(notes), notes)
            last = next(below, None)
            for row in below:
                if last is not None:
                    yield last
                last = row
            if last is not None and not self.complete and len(last) < len(self.columns):
                notes.append("truncated last row dropped")
            elif last is not None:
                yield last
        except csv.Error as problem:
            raise InputError(f"{self.path}: is not a table: {problem}") from problem

    def _below(self, notes: list[str]) -> Iterator[list[str]]:
        """Yield the cells of each line below the header."""
        quoting = csv.QUOTE_NONE if self.delimiter == "\t" else csv.QUOTE_MINIMAL
        return itertools.islice(csv.reader(self.lines(notes), delimiter=self.delimiter, quoting=quoting), 1, None)

    def _fitting(self, rows: Iterator[list[str]], notes: list[str]) -> Iterator[list[str]]:
        """Yield the rows whose text fits under the titles."""
        titles = len(self.columns)
        total = 0
        wide: list[tuple[int, int]] = []  # number and cells of each other row
        for row in rows:
            total += 1
            if any(text.strip() for text in row[titles:]):
                wide.append((total, len(row)))
                if len(wide) > _TELLING:
                    self._check_width(wide, total)
            else:
                yield row
        self._check_width(wide, total)
        if wide:
            notes.append(f"{len(wide)} rows with more cells than titles dropped")

    def _check_width(self, wide: list[tuple[int, int]], total: int) -> None:
        if 2 * len(wide) > total:
            number, cells = wide[0]
            raise InputError(
                f"{self.path}, row {number}: {cells} cells for {len(self.columns)} columns; numbers with a decimal "
                "comma need another delimiter, or quotation marks"
            )

    def first_rows(self, count: int) -> list[list[str]]:
        """Return the cells of at most `count` readable rows below the header, whatever their width."""
        rows: list[list[str]] = []
        with contextlib.suppress(InputError, csv.Error):
            rows.extend(itertools.islice(self._below([]), count))
        return rows

    def _open(self) -> IO[str]:
        if self.packed:
            return gzip.open(self.path, "rt", encoding=self.encoding, errors="replace")
        return self.path.open(encoding=self.encoding, errors="replace")


def look(source: str) -> TextFile:
    """Open a file or folder and detect its properties.

    Raises:
        InputError: If no file is named, or the file is missing, unreadable or empty.
    """
    if not source:
        raise InputError("no file is given; write CHANNEL=FILE")
    path = named(source)
    try:
        if path.is_dir():
            return TextFile(path, "utf-8", ",", True, "", ())
        head, tail, packed = _ends(path)
    except FileNotFoundError as problem:
        raise InputError(f"{path}: there is no such file") from problem
    except (OSError, ValueError) as problem:
        raise InputError(f"{path}: cannot be read: {problem}") from problem
    encoding = _encoding(head)
    text = codecs.getincrementaldecoder(encoding)("replace").decode(head)
    first_line = next((line for line in text.splitlines() if line.strip()), "")
    if not first_line:
        raise InputError(f"{path}: the file is empty")
    complete = packed or tail[-1:] in b"\r\n" or tail in (b"\n\0", b"\0\n")
    delimiter = max("\t;,", key=first_line.count)
    titles = [title.strip().strip('"') for title in first_line.split(delimiter)]
    columns = tuple(map(_column, range(len(titles)), titles))
    return TextFile(
        path=path,
        encoding=encoding,
        delimiter=delimiter,
        complete=complete,
        first_line=first_line,
        columns=columns,
        head=head,
        packed=packed,
    )


def cell(row: list[str], column: Column | None) -> str:
    """Return the text of a cell; empty if the column or the cell is missing."""
    return plain(row[column.place]) if column is not None and column.place < len(row) else ""


def plain(text: str) -> str:
    """Strip surrounding blanks and quotation marks, which some programs put around all text cells."""
    text = text.strip()
    return text[1:-1].strip() if len(text) > 1 and text[0] == text[-1] == '"' else text


def number(text: str) -> float:
    """Parse a number with decimal point or comma; NaN if it is missing, invalid or infinite."""
    if "," in text:
        grouping = "." if text.rfind(",") > text.rfind(".") else ","
        text = text.replace(grouping, "").replace(",", ".")
    try:
        value = float(text)
    except ValueError:
        return math.nan
    return value if math.isfinite(value) else math.nan


def epoch_seconds(text: str) -> float:
    """Parse a time stamp without unit to seconds: a number (see `without_unit`), or a date and time (ISO 8601).

    A date counts seconds since 1970; without a time zone it is taken as UTC.
    """
    if _DATE.match(text) is None:
        return without_unit(number(text))
    try:
        date = datetime.fromisoformat(text)
        return (date if date.tzinfo else date.replace(tzinfo=UTC)).timestamp()
    except (ValueError, OverflowError):
        return math.nan


def without_unit(stamp: float) -> float:
    """Convert a time stamp without unit to seconds; large values count milli-, micro- or nanoseconds since 1970."""
    return next((stamp * scale for above, scale in _EPOCHS if stamp > above), stamp)


def seconds_per(file: TextFile, column: Column) -> float:
    """Return the length [s] of the unit of time in a column's title.

    Raises:
        InputError: If the title has no unit, or an unknown one.
    """
    if column.unit not in TIME_UNITS:
        raise InputError(
            f"{file.path}: {column.unit[:80]!r} is not a unit of time; known units: {', '.join(TIME_UNITS)}"
        )
    return TIME_UNITS[column.unit]


def as_label(value: object) -> str:
    """Normalise a label: the numbers 1 and 1.0 give `1`; a value that is neither text nor number gives ``."""
    if isinstance(value, bool) or not isinstance(value, str | int | float):
        return ""
    if isinstance(value, float):
        return f"{value:.15g}" if math.isfinite(value) else ""
    text = str(value).strip()
    whole = _WHOLE.fullmatch(text)
    return whole[1] if whole else text


def _ends(path: Path) -> tuple[bytes, bytes, bool]:
    """Return the first bytes, decompressed; the last two bytes; and whether the file is compressed with gzip."""
    with path.open("rb") as stream:
        head = stream.read(_HEAD)
        stream.seek(max(0, stream.seek(0, os.SEEK_END) - 2))
        tail = stream.read()
    if not head.startswith(_GZIP):
        return head, tail, False
    unpacker = zlib.decompressobj(wbits=31)
    try:
        return unpacker.decompress(head[:-8], _HEAD), tail, True  # the reader reports a wrong checksum
    except zlib.error:
        return head, tail, False


def _encoding(head: bytes) -> str:
    for bom, name in _BOMS.items():
        if head.startswith(bom):
            return name
    if head[1::2].count(0) > len(head) / 4:
        return "utf-16-le"
    if head[0::2].count(0) > len(head) / 4:
        return "utf-16-be"
    try:
        codecs.getincrementaldecoder("utf-8")().decode(head)
    except UnicodeDecodeError:
        return "cp1252"
    return "utf-8"


def _column(place: int, title: str) -> Column:
    plain = " ".join(unicodedata.normalize("NFKC", title).casefold().split())
    opening = max(plain.rfind("["), plain.rfind("("))
    if opening < 0 or plain[-1] not in ")]":
        return Column(place, title, plain, "")
    return Column(place, title, plain[:opening].rstrip(), plain[opening + 1 : -1])
