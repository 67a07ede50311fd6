"""Interrupts: how Ctrl-C ends the command before its work begins and after its end.

Loaded before everything else, and therefore without slow imports.
"""

import os
import signal
import sys

# How a command ends on Ctrl-C: 128 and the number of the signal, as in shells.
INTERRUPTED = 128 + signal.SIGINT


def stop_at_once(*_: object) -> None:
    """End the process with one line, while nothing needs tidying up."""
    try:
        os.write(2, b"geomtorsion: stopped\n")
    finally:
        os._exit(INTERRUPTED)


def begin_command() -> None:
    """Let Ctrl-C end the command quietly while it is imported and before it exits.

    The handler stays unchanged in a program that imports the package, and in a process that
    ignores Ctrl-C.
    """
    arguments = sys.orig_argv
    by_module = any(arguments[k : k + 2] == ["-m", "geomtorsion"] for k in range(len(arguments)))
    name = os.path.basename(sys.argv[0]) if sys.argv else ""
    by_script = name in ("geomtorsion", "geomtorsion.exe")
    if by_module or by_script:
        stop_quietly()


def stop_quietly() -> None:
    """Let Ctrl-C end the process at once, unless something else was made of it."""
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, stop_at_once)
