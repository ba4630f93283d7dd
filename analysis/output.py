"""What leaves the program: text for a terminal, and a page on the disk: whole or not at all, and only in place of
another page."""

import os
import re
import signal
import sys

import jinja2

from .files import replaced

# As is_control of pipeline/terminal/words.cpp has them.
CONTROLS = re.compile(
    "[\0-\x09\x0b-\x1f\x7f-\x9f\xad\u061c\u180e\u200b-\u200f\u2028-\u202e\u2060-\u206f\ufeff\ufff9-\ufffb"
    "\U000e0000-\U000e007f]"
)


def open_standard_descriptors():
    """Opens those of 0, 1 and 2 that are closed, before anything else: the next file would get their number, and with
    it what is printed. Output to a closed stdout stays an error, to a closed stderr it is dropped."""
    for number, mode in ((0, os.O_RDONLY), (1, os.O_RDONLY), (2, os.O_RDWR)):
        try:
            os.fstat(number)
        except OSError:
            os.set_inheritable(os.open(os.devnull, mode), True)
    sys.stdout = sys.stdout or open(1, "w", closefd=False)
    sys.stderr = sys.stderr or open(2, "w", closefd=False)  # None means stdout to print()


def say(text):
    """Prints a result, made visible. Raises OSError when it is lost."""
    try:
        print(visible(text), flush=True)
    except OSError as error:
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)  # or the interpreter tries again at its end
        if isinstance(error, BrokenPipeError):  # `| head` has read enough
            sys.exit(128 + signal.SIGPIPE)
        raise OSError(f"stdout: cannot be written ({error.strerror})") from error


def complain(text):
    """Prints what is wrong, as one line."""
    print(visible(" ".join(str(text).split())), file=sys.stderr)


def visible(text):
    """`text` fit for a terminal, as the pipeline has it: control characters but line ends, and marks that turn or hide
    text, become '?'. Texts of files may be commands to it, or look like others."""
    return CONTROLS.sub("?", text)


def templates(folder):
    """The pages of a folder as templates: what is put into them is escaped unless it is marked safe."""
    return jinja2.Environment(
        loader=jinja2.FileSystemLoader(folder), autoescape=True, undefined=jinja2.StrictUndefined,
        trim_blocks=True, lstrip_blocks=True, keep_trailing_newline=True,
    )


def refuse(path):
    """Raises OSError, in a line that starts with the path, when a page cannot stand there."""
    if os.path.isdir(path):
        raise IsADirectoryError(f"{path}: is a folder; -o names the page's file")
    if os.path.lexists(path):
        if not os.path.isfile(path):  # a device, a pipe: the page would replace it
            raise FileExistsError(f"{path}: exists and is no file; -o names the page's file")
        if os.path.getsize(path) and not _is_page(path):
            raise FileExistsError(f"{path}: exists and is not an HTML page; it is not overwritten")
    folder = os.path.dirname(path) or "."
    if not os.path.isdir(folder) or not os.access(folder, os.W_OK):
        raise OSError(f"{path}: cannot be written: {folder} is no folder that can be written to")


def write(path, text):
    """Writes the page. Raises OSError, in a line that starts with the path."""
    refuse(path)
    with replaced(path) as part:
        with open(part, "x", encoding="utf-8", errors="replace") as file:  # a file's name may be no UTF-8
            if os.path.exists(path):
                os.fchmod(file.fileno(), os.stat(path).st_mode & 0o777)
            file.write(text)


def _is_page(path):
    with open(path, "rb") as file:
        return file.read(9).lower().startswith(b"<!doctype")
