"""Files that are written whole or not at all."""
import contextlib
import os
import secrets


@contextlib.contextmanager
def replaced(path):
    """A path to write to; what is there becomes `path` at the end, or is removed when that fails. Raises OSError, in a
    line that starts with the path."""
    part = f"{path}.{secrets.token_hex(4)}.new"  # a name of one's own, where others can write too
    try:
        yield part
        with open(part, "rb") as file:
            os.fsync(file.fileno())
        os.replace(part, path)
    except OSError as error:
        raise OSError(f"{path}: cannot be written ({error.strerror or error})") from error
    finally:
        with contextlib.suppress(OSError):
            os.remove(part)
