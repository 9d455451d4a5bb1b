"""Report points to GitHub: `report_points.py results.json`, of `numpy-cae verify --json`.

Prints two notices in the form of GitHub Classroom's own reporter, from which it took the points
(https://github.com/classroom-resources/autograding-grading-reporter), and writes the reports on the
exercises to the summary of the job. Exit status: 0 if all points are reached, else 1.
"""

import json
import os
import sys
from pathlib import Path


def best_results(results: list[dict]) -> list[dict]:
    """The best result of each exercise, and of each file that cannot be graded."""
    best: dict[str, dict] = {}
    for result in results:
        name = result["exercise"] or result["file"]
        if name not in best or result["points"] > best[name]["points"]:
            best[name] = result
    return list(best.values())


def summary(results: list[dict]) -> str:
    """The reports in Markdown."""
    parts = []
    for result in results:
        name = result["exercise"] or result["file"]
        parts.append(f"### {name}: {result['points']} of {result['possible']} points\n")
        parts.append("\n".join(f"    {line}" for line in result["text"].splitlines()) + "\n")
    return "\n".join(parts)


def main(path: Path) -> int:
    if not path.exists():
        print("::error title=Autograding::there is no file to grade")
        return 1
    results = best_results(json.loads(path.read_text(encoding="utf-8"))["results"])
    points = sum(result["points"] for result in results)
    possible = sum(result["possible"] for result in results)
    report = json.dumps({"totalPoints": points, "maxPoints": possible}, separators=(",", ":"))
    print(f"::notice title=Autograding complete::Points {points}/{possible}")
    print(f"::notice title=Autograding report::{report}")
    with open(os.environ["GITHUB_STEP_SUMMARY"], "a", encoding="utf-8") as file:
        file.write(summary(results))
    return 0 if possible and points == possible else 1


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1])))
