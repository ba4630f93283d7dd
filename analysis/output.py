"""What leaves the program: text for a terminal, and a page on the disk: whole or not at all, and only in place of
another page."""

import os


def visible(text):
    """`text` fit for a terminal: control characters but line ends become '?'. Texts of files may be commands to it."""
    return "".join("?" if c != "\n" and (ord(c) < 32 or 127 <= ord(c) < 160) else c for c in text)


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
    part = f"{path}.{os.getpid()}.part"
    try:
        with open(part, "w", encoding="utf-8", errors="replace") as file:  # a file's name may be no UTF-8
            file.write(text)
        os.replace(part, path)
    except OSError as error:
        raise OSError(f"{path}: cannot be written ({error.strerror})") from error
    finally:
        if os.path.exists(part):
            os.remove(part)


def _is_page(path):
    with open(path, "rb") as file:
        return file.read(9).lower().startswith(b"<!doctype")
