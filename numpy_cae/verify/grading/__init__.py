"""The report on one function, and the grading of a student's file in processes of its own."""
