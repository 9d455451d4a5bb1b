"""Grade the requests that come by standard input, each in a fork of this process.

Each line is JSON: the folder to grade in, the request, and on how many cases each property is
tried, all if that is null. Each answer is JSON, too.
"""

import json
import os
import sys
from dataclasses import replace

from numpy_cae.confined.template import Template, can_fork

TEMPLATE = Template() if can_fork() else None  # before what its forks may not have in memory

from numpy_cae.course import catalogue  # noqa: E402
from numpy_cae.verify.grading.sandbox import reply_to  # noqa: E402
from numpy_cae.verify.operations import operation_catalogue  # noqa: E402


def try_few_cases(most_cases):
    """Let this process try each property on at most so many cases, evenly chosen from all."""
    for exercises in (catalogue.CATALOGUE, operation_catalogue.CATALOGUE):
        for name, exercise in exercises.items():
            few = [replace(stated, most_cases=most_cases) for stated in exercise.properties]
            exercises[name] = replace(exercise, properties=tuple(few))


def main():
    for line in sys.stdin:
        folder, request, most_cases = json.loads(line)
        reader, writer = os.pipe()
        process = os.fork()
        if process == 0:
            os.chdir(folder)
            if most_cases is not None:
                try_few_cases(most_cases)
            with open(writer, "w") as answer:
                answer.write(json.dumps(reply_to(request, TEMPLATE)))
            os._exit(0)
        os.close(writer)
        with open(reader) as answer:
            print(answer.read(), flush=True)
        os.waitpid(process, 0)


if __name__ == "__main__":
    main()
