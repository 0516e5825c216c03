"""The command-line program: `stickslip`, or `python -m stickslip`."""

import signal
import sys
from pathlib import Path
from typing import NoReturn

from ._stickslip import program


def main() -> NoReturn:
    """Runs it with the arguments of this process and exits with its code."""
    # Its own handlers end it; those of Python would wait for the interpreter.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    # Workers are started by the script: this one, or that beside the interpreter.
    places = (Path(sys.argv[0]), Path(sys.executable).with_name("stickslip"))
    script = next((place.absolute() for place in places if place.name == "stickslip" and place.exists()), None)
    sys.exit(program(["stickslip", *sys.argv[1:]], script))


if __name__ == "__main__":
    main()
