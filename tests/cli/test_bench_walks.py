"""`numpy-cae bench --walks`: what it says it made, it made."""

import re

from numpy_cae.cli import main


def test_it_says_how_much_and_how_fast(capsys):
    assert main(["bench", "--walks", "0.5"]) == 0
    out = capsys.readouterr().out
    found = re.search(r"([\d.]+) minutes .* in ([\d.]+) s .*: (\d+) times", out)
    made, spent, times = map(float, found.groups())
    assert made >= 0.5
    assert times > 0
    assert spent > 0
