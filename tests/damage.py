"""Damage: files spoilt at random as a disk, a transfer or a hand can spoil them."""

from __future__ import annotations

import io
import json
import random
import signal
import zipfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

# Replacements for a JSON value: other kinds, other sizes, and hostile texts.
VALUES: tuple[Any, ...] = (
    None, True, False, 0, 1, -1, 2, 10**6, 10**30, -(10**30), 1e308, -1e308, 0.5, 1e-320, "", "x",
    "-1", "1e999", "nan", "inf", "0x1p+9999", "a" * 5000, "__import__('os')", "9**9**9", "é\0",
    [], [[]], [1], ["x"], [None], {}, {"x": 1}, {"": {}}, [{}], [["x", "y", "z"]], "1/0", "x.y",
)  # fmt: skip


class Hang(BaseException):
    """Raised when reading a file takes too long."""


@contextmanager
def within(seconds: float) -> Iterator[None]:
    """Raise `Hang` after a number of seconds."""

    def ring(_number: int, _frame: Any) -> None:
        raise Hang

    before = signal.signal(signal.SIGALRM, ring)
    # The alarm repeats: a callback of the garbage collector (hypothesis has one) may swallow it.
    signal.setitimer(signal.ITIMER_REAL, seconds, 1.0)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)


# -- bytes ----------------------------------------------------------------------------------------


def spoilt_bytes(whole: bytes, draw: random.Random) -> bytes:
    """Bytes changed, removed or doubled, or the end missing."""
    data = bytearray(whole)
    for _ in range(draw.choice((1, 1, 2, 5))):
        place = draw.randrange(max(len(data), 1))
        kind = draw.randrange(5)
        if kind == 0:
            data[place : place + 1] = bytes([draw.randrange(256)])
        elif kind == 1:
            del data[place : place + draw.randrange(1, 40)]
        elif kind == 2:
            data[place:place] = data[: draw.randrange(1, 40)]
        elif kind == 3 and data:
            data[place] ^= 1 << draw.randrange(8)
        else:
            del data[place:]
            break
    return bytes(data)


# -- words ----------------------------------------------------------------------------------------

# Replacements for a number or a name.
WORDS = (
    "nan", "inf", "-1", "0", "1e999", "1e-320", "1e308", "-1e308", "1_0", "0x10", "9" * 30, "x",
    "0,0", "7,", ",", "1.5", "__import__('os')", "#", "[", "]", "=", "é", "1;2", "\t", "2**31",
)  # fmt: skip


def spoilt_words(whole: bytes, draw: random.Random) -> bytes:
    """Words of a text replaced, dropped, doubled or exchanged; rows as well."""
    rows = [row.split() for row in whole.decode().split("\n")]
    for _ in range(draw.choice((1, 1, 1, 2, 4))):
        filled = [k for k, row in enumerate(rows) if row]
        k, j = draw.choice(filled), draw.choice(filled)
        place, kind = draw.randrange(len(rows[k])), draw.randrange(7)
        if kind == 0:
            del rows[k][place]
        elif kind == 1:
            rows[k].insert(place, draw.choice(WORDS))
        elif kind == 2:
            rows[k], rows[j] = rows[j], rows[k]
        elif kind == 3:
            rows.insert(k, list(rows[j]))
        elif kind == 4:
            del rows[k]
        else:
            rows[k][place] = draw.choice((*WORDS, draw.choice(rows[j])))
    return "\n".join(" ".join(row) for row in rows).encode()


# -- JSON -----------------------------------------------------------------------------------------


def spoilt_json(text: str, draw: random.Random) -> str:
    """One to three values replaced, keys dropped, renamed or added, or lists shortened."""
    data = json.loads(text)
    for _ in range(draw.choice((1, 1, 1, 2, 3))):
        data = _spoilt_value(data, draw)
    return json.dumps(data)


def _spoilt_value(data: Any, draw: random.Random) -> Any:
    places = list(_places(data))
    if not places:
        return draw.choice(VALUES)
    holder, key = draw.choice(places)
    kind = draw.randrange(6)
    if kind == 0:
        del holder[key]
    elif kind == 1 and isinstance(holder, dict):
        holder[draw.choice(("x", "", "times", f"{key} ", key[:-1]))] = holder.pop(key)
    elif kind == 2 and isinstance(holder, list):
        holder.append(draw.choice((*VALUES, holder[key])))
    elif kind == 3:
        other, place = draw.choice(places)
        holder[key] = json.loads(json.dumps(other[place]))
    else:
        holder[key] = draw.choice(VALUES)
    return data


def _places(data: Any) -> Iterator[tuple[Any, Any]]:
    """Each pair (holder, key) within a JSON value."""
    keys = data if isinstance(data, dict) else range(len(data)) if isinstance(data, list) else ()
    for key in list(keys):
        yield data, key
        yield from _places(data[key])


# -- NPZ ------------------------------------------------------------------------------------------


def spoilt_npz(whole: bytes, draw: random.Random) -> bytes:
    """An NPZ file with damaged bytes, members, arrays, headers or JSON."""
    return draw.choice((_bytes, _members, _arrays, _arrays, _headers, _json, _json, _json))(
        whole, draw
    )


def _bytes(whole: bytes, draw: random.Random) -> bytes:
    return spoilt_bytes(whole, draw)


def _contents(whole: bytes) -> dict[str, bytes]:
    with zipfile.ZipFile(io.BytesIO(whole)) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


def packed(members: list[tuple[str, bytes]], kind: int = zipfile.ZIP_DEFLATED) -> bytes:
    """Archive of members; several may have the same name."""
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w", kind) as archive:
        # zipfile warns when two members have the same name.
        archive.NameToInfo = {}
        for name, content in members:
            archive.writestr(name, content)
            archive.NameToInfo.clear()
    return out.getvalue()


def _members(whole: bytes, draw: random.Random) -> bytes:
    """Members missing, renamed, doubled, exchanged, empty, spoilt, or packed by another method."""
    members = list(_contents(whole).items())
    k, j = draw.randrange(len(members)), draw.randrange(len(members))
    name, content = members[k]
    kind = draw.randrange(8)
    packing = zipfile.ZIP_DEFLATED
    if kind == 0:
        del members[k]
    elif kind == 1:
        members[k] = (
            draw.choice(("x.npy", " ", ".npy", name[:-4], f"../{name}", members[j][0])),
            content,
        )
    elif kind == 2:
        members.append(members[k])
    elif kind == 3:
        members[k], members[j] = (name, members[j][1]), (members[j][0], content)
    elif kind == 4:
        members[k] = (name, b"")
    elif kind == 5:
        members[k] = (name, spoilt_bytes(content, draw))
    elif kind == 6:
        members = []
    else:
        packing = draw.choice((zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA, zipfile.ZIP_STORED))
    return packed(members, packing)


def _saved(array: Any) -> bytes:
    out = io.BytesIO()
    np.save(out, array, allow_pickle=True)
    return out.getvalue()


def _arrays(whole: bytes, draw: random.Random) -> bytes:
    """One array of another kind, shape or size, or with nan and infinities in it."""
    contents = _contents(whole)
    name = draw.choice(list(contents))
    array = np.load(io.BytesIO(contents[name]))
    kind = draw.randrange(12)
    with np.errstate(all="ignore"):
        if kind == 0:
            array = array.astype(object)
        elif kind == 1:
            array = array.astype(str)
        elif kind == 2 and array.dtype.kind == "f":
            array = array.astype(draw.choice(("c16", "f2", ">f4", "i8", "u1", "?", "M8[s]")))
        elif kind == 3:
            array = array[..., None] if draw.random() < 0.5 else array[None]
        elif kind == 4:
            array = array.ravel()
        elif kind == 5:
            array = array.T.copy()
        elif kind == 6 and array.ndim:
            array = array[: draw.randrange(len(array) + 1)]
        elif kind == 7 and array.ndim:
            array = array[..., :-1]
        elif kind == 8 and array.ndim:
            array = np.concatenate((array, array))
        elif kind == 9 and array.dtype.kind == "f" and array.size:
            array = array.copy()
            array.flat[draw.randrange(array.size)] = draw.choice((np.nan, np.inf, -1e308, 1e308))
        elif kind == 10:
            array = np.array(draw.choice((0.0, "", "{}", "x", 7)))
        else:
            array = np.zeros(draw.choice(((0,), (0, 0), (1,), (1, 1, 1, 1), (3,))))
    contents[name] = _saved(array)
    return packed(list(contents.items()))


def _headers(whole: bytes, draw: random.Random) -> bytes:
    """A header that does not fit its data, or a member of megabytes packed into a few bytes."""
    contents = _contents(whole)
    name = draw.choice(list(contents))
    shape = draw.choice(("(100000000000,)", "(1000000000,)", "(-1,)", "(2, 2, 2, 2, 2)", "()", "3",
                         "(" + "1, " * 200 + ")", f"({10**22},)", "(4000000,)"))  # fmt: skip
    descr = draw.choice(("'<f8'", "'|O'", "'<U99999'", "'<f3'", "'|V8'", "[('a', '<f8')]", "'<U0'",
                         "__import__('os')", "'<M8[s]'"))  # fmt: skip
    order = draw.choice(("True", "False", "1"))
    header = f"{{'descr': {descr}, 'fortran_order': {order}, 'shape': {shape}, }}".encode()
    start = b"\x93NUMPY" + bytes([draw.choice((1, 1, 1, 2, 3, 9)), 0])
    body = b"\0" * draw.choice((0, 8, 100, 32_000_000))
    contents[name] = start + len(header).to_bytes(2, "little") + header + body
    return packed(list(contents.items()))


def _json(whole: bytes, draw: random.Random) -> bytes:
    """The text in the file, spoilt as text or as JSON."""
    contents = _contents(whole)
    texts = [name for name in contents if name.removesuffix(".npy") in ("metadata", "about")]
    if not texts:
        return _arrays(whole, draw)
    text = str(np.load(io.BytesIO(contents[texts[0]])))
    if draw.random() < 0.15:
        text = spoilt_bytes(text.encode(), draw).decode("utf-8", "replace").replace("\0", "?")
    else:
        text = spoilt_json(text, draw)
    contents[texts[0]] = _saved(np.array(text))
    return packed(list(contents.items()))


# -- campaigns ------------------------------------------------------------------------------------


def campaign(
    path: Path,
    spoil: Callable[[bytes, random.Random], bytes],
    read: Callable[[Path], object],
    error: type[Exception],
    seeds: range,
    seconds: float = 20.0,
) -> tuple[int, list[str]]:
    """The number of refused copies of a spoilt file, and the failures of the other copies.

    read: uses the file as a user would; error: the only class that it may raise, with the name of
    the file in its message.
    """
    whole = path.read_bytes()
    other = path.with_name(f"spoilt{path.suffix}")
    refused, wrong = 0, []
    for seed in seeds:
        other.write_bytes(spoil(whole, random.Random(seed)))
        try:
            with within(seconds):
                read(other)
        except error as reason:
            refused += 1
            said = str(reason)
            if other.name not in said or len(said) > 1000:
                wrong.append(f"seed {seed}: {said[:300]}")
        except (Exception, Hang) as reason:  # noqa: BLE001  (a campaign looks for such errors)
            wrong.append(f"seed {seed}: {type(reason).__name__}: {str(reason)[:300]}")
    return refused, wrong
