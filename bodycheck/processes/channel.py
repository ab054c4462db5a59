"""Messages between a process and its worker process, through a pair of sockets.

An engine in the worker may write into any descriptor, also into this one. Every message therefore begins with a mark that the
two processes share, with the number of the call that it belongs to, and with its length and checksum; whatever else arrives is
recognised as foreign. The parent reads and writes only as much as the socket has or accepts at once, so that no worker makes it
wait.
"""

import secrets
import socket
import struct
import zlib
from collections.abc import Iterator

#: Mark, number of the call, length and checksum of a message.
HEADER = struct.Struct(">16sQQI")

#: The largest number of bytes that are read at once.
CHUNK_BYTES = 1 << 20


class Damaged(Exception):
    """Something that is not a message has arrived."""


def pair() -> "tuple[Parent, socket.socket, bytes]":
    """Return the parent's end of a new channel, the socket of the worker's end, and the mark for `Worker`."""
    ours, theirs = socket.socketpair()
    ours.setblocking(False)
    mark = secrets.token_bytes(16)
    return Parent(ours, mark), theirs, mark


class Parent:
    """The parent's end of a channel, which never waits.

    Attributes
    ----------
    socket
        The socket, for waiting until there is something to read.
    closed
        Whether the other end is closed.
    """

    def __init__(self, ours: socket.socket, mark: bytes) -> None:
        self.socket, self.closed = ours, False
        self._mark, self._received, self._unsent = mark, bytearray(), bytearray()

    @property
    def busy(self) -> bool:
        """True if a part of a message has not been sent yet."""
        return bool(self._unsent)

    def send(self, number: int, message: bytes) -> None:
        """Send a message, or as much of it as the socket accepts now; `read` sends the rest."""
        self._unsent += _framed(self._mark, number, message)
        self._flush()

    def read(self) -> bool:
        """Receive the bytes that have arrived, at most `CHUNK_BYTES`; return whether there were any."""
        self._flush()
        try:
            chunk = self.socket.recv(CHUNK_BYTES)
        except (BlockingIOError, InterruptedError):
            return False
        except OSError:
            chunk = b""
        self.closed = self.closed or not chunk
        self._received += chunk
        return bool(chunk)

    def messages(self) -> Iterator[tuple[int, bytes]]:
        """Yield the complete messages that have arrived, with their calls' numbers. Raises `Damaged` for other data."""
        while len(self._received) >= HEADER.size:
            mark, number, length, checksum = HEADER.unpack_from(self._received)
            if mark != self._mark:
                raise Damaged
            if len(self._received) < (end := HEADER.size + length):
                return
            message = bytes(self._received[HEADER.size : end])
            if zlib.crc32(message) != checksum:
                raise Damaged
            del self._received[:end]
            yield number, message
        if not self._mark.startswith(self._received[: len(self._mark)]):
            raise Damaged

    def close(self) -> None:
        """Close this end."""
        self.socket.close()

    def _flush(self) -> None:
        try:
            while self._unsent:
                del self._unsent[: self.socket.send(self._unsent)]
        except (BlockingIOError, InterruptedError):
            return
        except OSError:  # the worker has ended, which reading will show
            self._unsent.clear()


class Worker:
    """The worker's end of a channel, whose methods wait for the parent."""

    def __init__(self, theirs: socket.socket, mark: bytes) -> None:
        self._socket, self._mark = theirs, mark
        theirs.set_inheritable(False)  # processes that an engine starts do not inherit it

    def send(self, number: int, message: bytes) -> None:
        """Send a message. Raises `OSError` if the parent has closed its end."""
        self._socket.sendall(_framed(self._mark, number, message))

    def receive(self) -> tuple[int, bytes]:
        """Return the next message with the number of its call. Raises `EOFError` if the parent has closed its end."""
        _, number, length, _ = HEADER.unpack(self._read(HEADER.size))
        return number, self._read(length)

    def close(self) -> None:
        """Close this end."""
        self._socket.close()

    def _read(self, length: int) -> bytes:
        received = bytearray()
        while len(received) < length:
            chunk = self._socket.recv(min(length - len(received), CHUNK_BYTES))
            if not chunk:
                raise EOFError
            received += chunk
        return bytes(received)


def _framed(mark: bytes, number: int, message: bytes) -> bytes:
    return HEADER.pack(mark, number, len(message), zlib.crc32(message)) + message
