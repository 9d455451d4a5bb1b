import pytest

from numpy_cae.course import catalogue
from numpy_cae.verify.grading import student_file
from numpy_cae.verify.grading.sandbox.child import do_apart, reply_to


@pytest.fixture
def graded(tmp_path, monkeypatch):
    """Grades a file by a process that is forked from this one, which saves starting Python."""
    monkeypatch.chdir(tmp_path)

    def grade(content, name="student.py", cpu_seconds=5.0, **options):
        path = tmp_path / name
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        monkeypatch.setattr(student_file, "EXERCISE_SECONDS", cpu_seconds)
        monkeypatch.setattr(student_file, "run", lambda r: do_apart(lambda: reply_to(r), 100))
        return student_file.grade(path, catalogue, megabytes=4096, **options)

    return grade
