"""Grade a submission in the folder /autograder of Gradescope: `grade.py LESSON`.

Reads submission/ and writes results/results.json in the format of Gradescope:
https://gradescope-autograders.readthedocs.io/en/latest/specs/
"""

import json
import subprocess
import sys
import tempfile
from pathlib import Path


def grade(lesson: str) -> dict:
    """What Gradescope shows: a test for each exercise, the best of all files that have it."""
    with tempfile.TemporaryDirectory() as folder:
        results = Path(folder, "results.json")
        command = [sys.executable, "-m", "numpy_cae", "verify", "submission"]
        ended = subprocess.run(
            [*command, "--lesson", lesson, "--json", str(results)], capture_output=True, text=True
        )
        if not results.exists():
            return {"score": 0, "output": ended.stderr}
        return as_gradescope(json.loads(results.read_text(encoding="utf-8"))["results"])


def as_gradescope(results: list[dict]) -> dict:
    """The results of `numpy-cae verify --json` in the format of Gradescope."""
    tests: dict[str, dict] = {}
    problems = []
    for result in results:
        name = result["exercise"]
        if name is None:
            problems.append(result["text"])
        elif name not in tests or result["points"] > tests[name]["score"]:
            tests[name] = {
                "name": name,
                "score": result["points"],
                "max_score": result["possible"],
                "output": result["text"],
            }
    score = sum(test["score"] for test in tests.values())
    return {"score": score, "output": "\n".join(problems), "tests": list(tests.values())}


if __name__ == "__main__":
    text = json.dumps(grade(sys.argv[1]), indent=1)
    Path("results").mkdir(exist_ok=True)
    Path("results", "results.json").write_text(text, encoding="utf-8")
