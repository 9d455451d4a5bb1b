import pytest

from numpy_cae.course import catalogue
from numpy_cae.verify.grading import student_file


@pytest.fixture
def graded(tmp_path, forked_grading):
    """Grades a file of this content."""

    def grade(content, name="student.py", cpu_seconds=5.0, **options):
        path = tmp_path / name
        path.parent.mkdir(exist_ok=True)
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return student_file.grade(path, catalogue, seconds=cpu_seconds, **options)

    return grade
