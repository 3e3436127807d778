"""Whether a wheel for Linux runs where its name says: `python tools/audit.py WHEEL` (auditwheel), and its size."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

MOST_MB = 15.0


def main() -> int:
    """The command; 1, and why, if the wheel is not what its name says."""
    wheel = Path(sys.argv[1])
    size = wheel.stat().st_size / 1e6
    print(f"{wheel}: {size:.1f} MB")
    if size > MOST_MB:
        print(f"expected at most {MOST_MB} MB", file=sys.stderr)
        return 1
    if sys.platform != "linux":
        return 0
    said = subprocess.run(
        [sys.executable, "-m", "auditwheel", "show", str(wheel)], capture_output=True, text=True, check=True
    ).stdout
    found = re.findall(r'"(\w+linux_\w+)"', said)
    if not any(tag in wheel.name for tag in found):
        print(f"expected what its name says, auditwheel says:\n{said}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
