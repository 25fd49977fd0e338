"""Runs lifecycle.py in a process of its own: a crash is then a failure, not the end of the tests."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path


def test_edits_removal_and_destruction() -> None:
    """Two delegates live, change and end without a crash, a leak or a picture that never finishes."""
    script = Path(__file__).with_name("lifecycle.py")
    result = subprocess.run([sys.executable, str(script)], capture_output=True, text=True, timeout=600, check=False)
    assert result.returncode == 0, result.stdout + result.stderr
